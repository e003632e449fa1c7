//! A recorded run is executed again and compared.

use crate::support::*;
use soifra_runtime::{
    Event, Outcome, Record, Time,
    replay::{self, ReplayError},
};

const MISSION: &str = r#"
edition 1
record Beat { x: Length }
topic beat: Beat = channel(delay: 20 ms)
mission m {
  robot a[2]: cart at (0 m, 1 m * index) to (1 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when arrived }
  done when achieved(g)
  within 5 s
  expect never collision
  expect each robot: eventually truth.path_length >= 50 cm
  metric paces = mean of (most robot: truth.path_length) upon (least robot: truth.path_length)
}
agent pilot {
  sensor pose: Pose<map>
  sensor slow: Pose<map>
  actuator base: Twist
  state arrived: Bool = false
  state noise: Length = 0 m
  service go every 100 ms {
    set noise = draw(normal(sd: 1 mm))
    set arrived = pose.position.x >= 1 m
    publish beat Beat(x: pose.position.x + noise)
    command base twist(forward: 0.5 m/s + 1 m/s * (noise / 1 m))
  }
  service watch on sensor slow { note "others", heard(beat).map(b => b.x) }
}
"#;

fn ran(prepare: impl FnOnce(&mut World)) -> Ran {
    run_with(&mission(MISSION), &settings(), prepare)
}

fn contacts(w: &mut World) {
    use soifra_runtime::Report::{ContactBegin, ContactEnd};
    w.script.push(ContactBegin { at: Time(333), robot: 0, other: Some(1), with: "a[1]".into() });
    w.script.push(ContactEnd { at: Time(130_000_000), robot: 0, other: Some(1), with: "a[1]".into() });
}

#[test]
fn a_replay_gives_the_same_records() {
    for prepare in [(|_| {}) as fn(&mut World), contacts] {
        let first = ran(prepare);
        first.check_records();
        let again = replay::verify(&mission(MISSION), &settings(), first.records.clone()).unwrap();
        assert_eq!(again, first.report);
    }
    let first = ran(contacts);
    assert_eq!(first.report.outcome, Outcome::Failed);
    assert_eq!(first.report.expectations[0].first_violation_s, Some(333e-9));
}

#[test]
fn an_altered_reading_is_found() {
    let mut records = ran(|_| {}).records;
    let at = records
        .iter()
        .position(|r| r.t > Time(500_000_000) && matches!(r.event, Event::Reading { sensor: 0, .. }))
        .unwrap();
    let Event::Reading { registers, .. } = &mut records[at].event else { unreachable!() };
    registers[0] += 1e-9;
    let Err(ReplayError::Difference(d)) = replay::verify(&mission(MISSION), &settings(), records.clone())
    else {
        panic!("not found")
    };
    // What was published is the first consequence.
    assert!(matches!(d.expected.unwrap().event, Event::Message { .. }));
    let scene = mission(MISSION).scene(&settings()).unwrap();
    let mut world = World::new(&scene);
    let again = replay::resimulate(&mission(MISSION), &settings(), &scene, &mut world, records.clone());
    let Err(ReplayError::Difference(d)) = again else { panic!("not found") };
    assert_eq!(d.record, at as u64, "a simulation gives the reading itself");
}

#[test]
fn a_recording_that_was_cut_off_is_verified_as_far_as_it_goes() {
    let records = ran(|_| {}).records;
    for n in [0, 1, 7, records.len() / 2, records.len() - 1] {
        let part = records[..n].to_vec();
        assert!(replay::verify(&mission(MISSION), &settings(), part).is_ok(), "{n}");
    }
    let mut longer = records.clone();
    let last = longer.last().unwrap().clone();
    longer.push(Record { n: last.n + 1, ..last });
    assert!(replay::verify(&mission(MISSION), &settings(), longer).is_ok(), "nothing after the end is read");
}

#[test]
fn another_seed_is_another_run() {
    let records = ran(|_| {}).records;
    let settings = soifra_runtime::Settings { seed: 2, ..settings() };
    assert!(replay::verify(&mission(MISSION), &settings, records).is_err());
}

#[test]
fn an_interrupted_run_is_replayed_to_where_it_was_stopped() {
    use std::sync::atomic::{AtomicBool, Ordering};
    let mission = mission(MISSION);
    let scene = mission.scene(&settings()).unwrap();
    let stop = AtomicBool::new(false);
    struct Stopping<'a>(Vec<Record>, &'a AtomicBool);
    impl soifra_runtime::TraceSink for Stopping<'_> {
        fn record(&mut self, r: &Record) -> Result<(), String> {
            self.0.push(r.clone());
            if self.0.len() == 60 {
                self.1.store(true, Ordering::Relaxed);
            }
            Ok(())
        }
    }
    let mut world = World::new(&scene);
    let mut sink = Stopping(Vec::new(), &stop);
    let engine = soifra_runtime::Engine::new(&mission, &settings(), &scene, &mut world, &mut sink, &stop);
    let report = engine.unwrap().run();
    assert!(report.interrupted());
    let again = replay::verify(&mission, &settings(), sink.0.clone()).unwrap();
    assert_eq!(again, report);
    let mut world = World::new(&scene);
    let again = replay::resimulate(&mission, &settings(), &scene, &mut world, sink.0).unwrap();
    assert_eq!(again, report);
}

#[test]
fn a_run_stopped_while_it_idles_ends_there_from_every_snapshot() {
    let text = r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs sleeper
  goal g { subgoal s by sleeper achieved when rounds > 9 }
  done when achieved(g)
  within 9000 s
}
agent sleeper {
  state rounds: Int = 0
  service wake every 600 s { set rounds = rounds + 1 }
}
"#;
    let ran = run_with(&mission(text), &settings(), |w| w.stops_when_idle = true);
    assert_eq!((ran.report.outcome, ran.report.sim_time_s), (Outcome::Aborted, 0.0));
}
