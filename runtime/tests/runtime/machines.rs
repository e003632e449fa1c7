//! State machines, plans and sub-goals in missions.

use crate::support::*;
use soifra_runtime::{Event, Outcome};

#[test]
fn a_machine_takes_one_transition_an_activation_and_carries_data() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 2 s
}
agent pilot {
  state over: Bool = false
  machine mood every 100 ms {
    state idle {
      on enter { note "idle in" }
      on exit { note "idle out" }
      when elapsed >= 200 ms -> busy(rounds: 7) { note "go" }
      note "idle"
    }
    state busy(rounds: Int) {
      on enter { note "busy in", rounds }
      when rounds <= 6 and elapsed >= 100 ms -> idle
      when rounds > 6 -> busy(rounds: rounds - 1)
      note "busy", rounds
      when elapsed > 5 s => set over = true
    }
  }
  service stop every 700 ms after 600 ms { set over = true }
}
"#);
    let notes: Vec<String> = ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect();
    let expected = [
        "0 idle in",
        "0 idle",
        "100 idle",
        "200 idle out",
        "200 go",
        "200 busy in: 7",
        "200 busy: 7",
        "300 busy in: 6",
        "300 busy: 6",
        "400 idle in",
        "400 idle",
        "500 idle",
    ];
    assert_eq!(notes[..expected.len()], expected);
    let transitions = ran.all(|r| match &r.event {
        Event::Transition { from, to, .. } => Some(format!("{} {from} {to}", r.t.0 / 1_000_000)),
        _ => None,
    });
    assert_eq!(transitions[..3], ["200 idle busy", "300 busy busy", "400 busy idle"]);
    assert_eq!(ran.report.outcome, Outcome::Success);
    ran.check_records();
}

const PLAN: &str = r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal get_there by pilot }
  done when achieved(g)
  within 3 s
}
agent pilot {
  sensor pose: Pose<map>
  actuator base: Twist
  state tries: Int = 0
  action drive() until pose.position.x >= 30 cm { command base twist(forward: 1 m/s) } on halt { note "halted" }
  action look() until tries >= 3 fails when tries == 1 { set tries = tries + 1 }
  plan go for get_there every 100 ms {
    sequence {
      retry 2 { do look }
      wait 200 ms
      timeout 2 s { do drive }
    }
  }
}
"#;

#[test]
fn a_plan_achieves_its_sub_goal_and_ends() {
    let ran = run(PLAN);
    assert_eq!(ran.report.outcome, Outcome::Timeout, "tries == 1 fails for ever: {:?}", ran.report);
    let goals = ran.all(|r| match &r.event {
        Event::Goal { goal, robot, status, .. } => Some(format!("{goal} {robot:?} {status}")),
        _ => None,
    });
    assert_eq!(goals[..2], ["get_there Some(0) failed", "g None failed"]);
    let ran = run(&PLAN.replace("fails when tries == 1 ", ""));
    assert_eq!((ran.report.outcome, ran.report.goals[0].status), (Outcome::Success, "achieved"));
    assert!(ran.report.robots[0].reached);
    assert_eq!(ran.report.robots[0].steps, None);
    let drive: Vec<i64> = ran.world.sent.iter().map(|s| s.0.0 / 1_000_000).collect();
    // Three tries at 0, 100 and 200, which ends at 300; the wait is over at 500.
    assert_eq!(drive, [500, 600, 700]);
    let nodes = ran.all(|r| match &r.event {
        Event::Node { node, result, .. } => Some(format!("{} {node} {result}", r.t.0 / 1_000_000)),
        _ => None,
    });
    assert!(nodes.contains(&"500 3 success".to_string()), "{nodes:?}");
    ran.check_records();
}

#[test]
fn steps_count_the_ticks_that_lie_behind() {
    let ran = run(r#"
edition 1
mission m {
  clock step 1 s
  robot a[2]: pawn at (0 m, 1 m * index) to (5 m, 1 m * index) runs walker(stride: 1 m + 1 m * index)
  goal g { subgoal s by walker achieved when arrived }
  done when achieved(g)
  within 20 steps
}
agent walker(stride: Length) {
  sensor pose: Pose<map>
  actuator legs: Stride
  state arrived: Bool = false
  service walk every step {
    let target = robot.target
    let remaining = target.x - pose.position.x
    set arrived = remaining <= 1 mm
    command legs Stride(heading: towards(0 deg), length: min(stride, remaining))
  }
}
"#);
    let steps: Vec<Option<u64>> = ran.report.robots.iter().map(|r| r.steps).collect();
    assert_eq!(steps, [Some(5), Some(3)]);
    assert_eq!((ran.report.outcome, ran.report.sim_time_s), (Outcome::Success, 5.0));
    assert_eq!(ran.report.robots[1].path_length_m, Some(5.0));
    assert_eq!(ran.report.robots[1].distance_to_target_m, Some(0.0));
    assert_eq!(ran.report.robots[0].name, "a[0]");
}
