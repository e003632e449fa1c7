//! What goes wrong ends the run with safe actions, and says where.

use crate::support::*;
use soifra_runtime::{Engine, Event, Outcome, Record, Report, Time, TraceSink};
use std::sync::atomic::{AtomicBool, Ordering};

const DIVIDES: &str = r#"
edition 1
mission m {
  robot a[2]: cart at (0 m, 1 m * index) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 1 s
}
agent pilot {
  sensor pose: Pose<map>
  actuator base: Twist
  state over: Bool = false
  state count: Int = 3
  service go every 100 ms {
    command base twist(forward: 0.1 m/s)
    when robot.index == 1 => {
      set count = count - 1
      command base twist(forward: 1 m/s / count)
    }
  }
}
"#;

fn told(report: &soifra_runtime::RunReport) -> Vec<&str> {
    report.faults.iter().map(|f| f.text.as_str()).collect()
}

#[test]
fn a_fault_drops_the_activation_and_stops_everybody() {
    let ran = run(DIVIDES);
    assert_eq!(ran.report.outcome, Outcome::Aborted);
    assert_eq!(ran.report.sim_time_s, 0.2);
    let text = "pilot@a[1]: mission.soi:18:35: division by zero in `1 m/s / count`";
    assert_eq!((ran.report.reason.as_str(), told(&ran.report)), (text, vec![text]));
    assert_eq!(ran.world.safe.iter().map(|s| s.1).collect::<Vec<_>>(), [0, 1]);
    // Robot 0 was commanded at the instant of the fault, robot 1 was not: its activation counts for nothing.
    let last: Vec<u32> = ran.world.sent.iter().filter(|s| s.0 == Time(200_000_000)).map(|s| s.1).collect();
    assert_eq!(last, [0]);
    assert!(matches!(&ran.records.last().unwrap().event, Event::End { outcome, .. } if outcome == "aborted"));
    ran.check_records();
}

#[test]
fn an_absent_reading_skips_the_unit_and_lets_its_command_expire() {
    let text = DIVIDES.replace("when robot.index == 1", "when pose.position.x > 9 m and robot.index == 1");
    let ran = run_with(&mission(&text), &settings(), |w| {
        w.blind.push((0, 0, Time(250_000_000), Time(900_000_000)));
    });
    let skipped = ran.all(|r| match &r.event {
        Event::Activation { robot: 0, skipped: Some(why), .. } => Some((r.t.0 / 1_000_000, why.clone())),
        _ => None,
    });
    // The last reading is of 200 ms and counts for two periods, 200 ms.
    assert_eq!(skipped[0], (500, "no reading of pose: the reading has expired".into()));
    assert_eq!(skipped.last().unwrap().0, 800);
    assert_eq!(ran.world.safe[0], (Time(600_000_000), 0));
    assert_eq!(ran.report.outcome, Outcome::Timeout);
}

#[test]
fn an_invalid_number_is_an_absent_reading() {
    let text = DIVIDES.replace("when robot.index == 1", "when pose.position.x > 9 m and robot.index == 1");
    let ran = run_with(&mission(&text), &settings(), |w| {
        w.altered.push((0, 0, Time(300_000_000), f64::NAN));
    });
    let skipped = ran.all(|r| match &r.event {
        Event::Activation { skipped: Some(why), .. } => Some((r.t.0 / 1_000_000, why.clone())),
        _ => None,
    });
    assert_eq!(skipped, [(300, "no reading of pose: the reading was not finite".into())]);
    assert_eq!(ran.report.outcome, Outcome::Timeout);
}

#[test]
fn a_lost_platform_aborts() {
    let ran = run_with(&mission(DIVIDES), &settings(), |w| {
        w.script.push(Report::Lost { at: Time(100_000_000), robot: 1, reason: "cable".into() });
    });
    assert_eq!(ran.report.outcome, Outcome::Aborted);
    assert_eq!(told(&ran.report), ["platform of a[1]: the platform is lost: cable"]);
}

#[test]
fn raising_each_other_for_ever_ends_the_agent() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when count > 100000000 }
  done when achieved(g)
  within 1 s
}
agent pilot {
  event ping
  event pong
  state count: Int = 0
  service begin every 1 s { raise ping }
  service one on event ping { set count = count + 1 raise pong }
  service two on event pong { raise ping }
}
"#);
    // The agent is killed, and nobody else harmed: its sub-goal fails, and the run comes to its end.
    assert_eq!(ran.report.outcome, Outcome::Timeout);
    let died = |r: &Record| matches!(&r.event, Event::Life { reason, .. } if reason.contains("it floods"));
    assert_eq!(ran.records.iter().filter(|r| died(r)).count(), 1);
    assert_eq!(ran.report.goals[0].status, "failed");
}

/// A disk that is full after some records.
struct Full(usize);

impl TraceSink for Full {
    fn record(&mut self, _: &Record) -> Result<(), String> {
        self.0 = self.0.checked_sub(1).ok_or("no space left")?;
        Ok(())
    }
}

#[test]
fn a_trace_that_cannot_be_written_aborts() {
    let mission = mission(DIVIDES);
    let scene = mission.scene(&settings()).unwrap();
    let mut world = World::new(&scene);
    let (mut sink, stop) = (Full(20), AtomicBool::new(false));
    let report = Engine::new(&mission, &settings(), &scene, &mut world, &mut sink, &stop).unwrap().run();
    assert_eq!(report.outcome, Outcome::Aborted);
    assert_eq!(report.reason, "the trace cannot be written: no space left");
    assert_eq!(world.safe.len(), 2);
}

#[test]
fn the_operator_stops_the_run() {
    let mission = mission(DIVIDES);
    let scene = mission.scene(&settings()).unwrap();
    let mut world = World::new(&scene);
    let (mut records, stop) = (Vec::new(), AtomicBool::new(false));
    stop.store(true, Ordering::Relaxed);
    let report = Engine::new(&mission, &settings(), &scene, &mut world, &mut records, &stop).unwrap().run();
    assert!(report.interrupted());
    assert_eq!((report.sim_time_s, world.safe.len()), (0.0, 2));
}

#[test]
fn parameters_are_checked_and_set() {
    use soifra_graph::Value;
    let text = DIVIDES.replace("edition 1", "edition 1\nparam speed: Velocity = 1 m/s");
    let mission = mission(&text);
    let refused = |name: &str, v: Value| mission.scene(&with(&[(name, v)])).unwrap_err();
    assert_eq!(refused("spead", Value::Number(1.0)).hint.as_deref(), Some("did you mean `speed`?"));
    assert_eq!(refused("speed", Value::Bool(true)).title, "parameter `speed` must be a Velocity");
    assert!(mission.scene(&with(&[("speed", Value::Number(f64::NAN))])).is_err());
}

/// A platform that always has something to hand over, and never does.
struct Stuck;

impl soifra_runtime::Platform for Stuck {
    fn next_due(&self) -> Option<Time> {
        Some(Time::ZERO)
    }
    fn poll(&mut self, _: Time, _: &mut soifra_runtime::Readings, _: &mut Vec<Report>) {}
    fn send(&mut self, _: Time, _: u32, _: u32, _: &[f64], _: Time) {}
    fn safe_action(&mut self, _: Time, _: u32) -> &'static str {
        "stop"
    }
    fn truth(&self) -> Option<&dyn soifra_runtime::WorldTruth> {
        None
    }
}

#[test]
fn a_platform_that_stands_still_in_time_aborts() {
    let mission = mission(DIVIDES);
    let scene = mission.scene(&settings()).unwrap();
    let (mut records, stop) = (Vec::new(), AtomicBool::new(false));
    let report = Engine::new(&mission, &settings(), &scene, &mut Stuck, &mut records, &stop).unwrap().run();
    assert_eq!(report.outcome, Outcome::Aborted);
    assert!(report.reason.contains("times at one instant"), "{}", report.reason);
}
