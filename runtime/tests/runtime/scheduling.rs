//! When units are activated, and in which order.

use crate::support::*;

fn notes(ran: &Ran) -> Vec<String> {
    ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect()
}

#[test]
fn periods_and_offsets_and_priorities() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs ticker
  goal g { subgoal s by ticker achieved when count > 100 }
  done when achieved(g)
  within 300 ms
}
agent ticker {
  state count: Int = 0
  service slow every 200 ms { set count = count + 1 note "slow" }
  service fast every 100 ms after 50 ms { set count = count + 1 note "fast" }
  service first every 200 ms priority 5 { set count = count + 1 note "first" }
}
"#);
    assert_eq!(
        notes(&ran),
        ["0 first", "0 slow", "50 fast", "150 fast", "200 first", "200 slow", "250 fast"]
    );
    assert_eq!(ran.report.outcome, soifra_runtime::Outcome::Timeout);
    assert_eq!(ran.report.sim_time_s, 0.3);
    ran.check_records();
}

#[test]
fn what_takes_time_acts_when_it_finishes() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 190 ms
}
agent pilot {
  actuator base: Twist
  event ready
  state over: Bool = false
  state count: Int = 0
  service slow every 100 ms worst 30 ms {
    set count = count + 1
    note "begins", count
    command base twist(forward: 1 m/s)
    raise ready
  }
  service react on event ready { note "reacts", count }
}
"#);
    assert_eq!(notes(&ran), ["0 begins: 1", "30 reacts: 1", "100 begins: 2", "130 reacts: 2"]);
    let sent: Vec<(i64, i64)> =
        ran.world.sent.iter().map(|s| (s.0.0 / 1_000_000, (s.4 - s.0).0 / 1_000_000)).collect();
    assert_eq!(sent, [(30, 200), (130, 200)]);
    let times = ran.all(|r| match &r.event {
        soifra_runtime::Event::Activation { unit, start, finish, .. } if unit == "slow" => {
            Some((start.0, finish.map_or(-1, |t| t.0)))
        }
        _ => None,
    });
    assert_eq!(times, [(0, 30_000_000), (100_000_000, 130_000_000)]);
    ran.check_records();
}

#[test]
fn a_parameter_holds_from_the_next_activations_on() {
    let ran = run(r#"
edition 1
param gain: Number = 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 150 ms
}
agent pilot {
  state over: Bool = false
  service set_it every 100 ms priority 1 { set gain = gain + 1 }
  service read_it every 50 ms { note "gain", gain }
}
"#);
    assert_eq!(notes(&ran), ["0 gain: 1", "50 gain: 2", "100 gain: 2", "150 gain: 3"]);
    let set = ran.all(|r| match &r.event {
        soifra_runtime::Event::Param { param, registers, .. } => Some((param.clone(), registers.clone())),
        _ => None,
    });
    assert_eq!(set, [("gain".to_string(), vec![2.0]), ("gain".to_string(), vec![3.0])]);
}

#[test]
fn scenes_are_drawn_from_the_seed_by_name() {
    let text = r#"
edition 1
mission m {
  region pen[2] = circle(at: (draw(uniform(0 m, 1 m)), 1 m * index), radius: 1 m)
  robot a[2]: cart at (1 m * index, 0 m) to (draw(uniform(0 m, 9 m)), 0 m) scatter normal(sd: 1 cm) runs pilot
  robot b: cart at (9 m, 0 m) scatter normal(sd: 1 cm) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 100 ms
}
agent pilot {
  sensor pose: Pose<map>
  state over: Bool = false
  service look every 100 ms { note "x", pose.position.x }
}
"#;
    let scene =
        |text: &str, seed| mission(text).scene(&soifra_runtime::Settings { seed, ..settings() }).unwrap();
    let one = scene(text, 1);
    assert_eq!(one, scene(text, 1));
    assert_ne!(one.robots[0].start, scene(text, 2).robots[0].start);
    assert_eq!(one.robots.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["a[0]", "a[1]", "b"]);
    assert_eq!(one.robots[1].declared_start[0], 1.0);
    assert_eq!(one.world.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["pen[0]", "pen[1]"]);
    assert_eq!(one.robots[0].consumed, [true, false]);
    // What is declared besides does not change what is drawn.
    let fewer = scene(&text.replace("robot a[2]", "robot a[1]"), 1);
    assert_eq!(
        (&fewer.robots[0].start, &fewer.robots[1].start),
        (&one.robots[0].start, &one.robots[2].start)
    );
}
