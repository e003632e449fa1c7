//! A pacer holds a run to a pace and changes nothing; what an operator does by way of it is recorded, has the
//! effects it should have, and is done again by a replay.

use crate::support::*;
use soifra_graph::Value;
use soifra_runtime::{
    Event, Input, Operation, Outcome, Pacer, Record, Time,
    replay::{self, ReplayError},
};
use std::sync::{Arc, atomic::AtomicBool, atomic::Ordering};

const MISSION: &str = r#"
edition 1
record Beat { x: Length }
topic beat: Beat = channel(delay: 20 ms)
param speed: Velocity = 0.5 m/s
param label: Text = "plain"
mission m {
  robot a[2]: cart at (0 m, 1 m * index) to (1 m, 0 m) runs pilot, listener
  goal g { subgoal s by pilot achieved when arrived }
  done when achieved(g)
  within 5 s
}
agent pilot {
  sensor pose: Pose<map>
  actuator base: Twist
  state arrived: Bool = false
  service go every 100 ms {
    set arrived = pose.position.x >= 1 m
    publish beat Beat(x: pose.position.x)
    command base twist(forward: speed)
  }
}
agent listener {
  service hear on beat(b) { note "heard", b.x }
}
"#;

/// Does what it is told to at given instants, and writes down what it is asked.
#[derive(Default)]
struct Script {
    inputs: Vec<(Time, Input)>,
    asked: Vec<(Time, Time)>,
    begun: Vec<Time>,
    /// Stops the run when it is asked for the so-and-so-manieth time.
    stop: Option<(usize, Arc<AtomicBool>)>,
    /// Added to every answer.
    shift: i64,
}

impl Pacer for Script {
    fn begin(&mut self, now: Time) {
        self.begun.push(now);
    }

    fn pace(&mut self, now: Time, next: Time, inputs: &mut Vec<Input>) -> Time {
        self.asked.push((now, next));
        if let Some((n, stop)) = &self.stop
            && self.asked.len() == *n
        {
            stop.store(true, Ordering::Relaxed);
        }
        let mut at = next;
        while let Some((t, _)) = self.inputs.first()
            && *t <= at
        {
            at = *t;
            inputs.push(self.inputs.remove(0).1);
        }
        Time(at.0 + self.shift)
    }
}

fn ms(t: i64) -> Time {
    Time(t * 1_000_000)
}

fn input(operation: Operation) -> Input {
    Input { text: format!("{operation:?}"), operation }
}

fn kill(agent: &str) -> Input {
    input(Operation::Kill { agent: agent.into() })
}

fn set(param: &str, registers: &[f64]) -> Input {
    input(Operation::Set { param: param.into(), registers: registers.to_vec() })
}

/// A run of the mission with these inputs, which both kinds of replay find to be the same again.
fn operated(text: &str, inputs: &[(Time, Input)]) -> Ran {
    let mission = mission(text);
    let mut script = Script { inputs: inputs.to_vec(), ..Script::default() };
    let ran = run_paced(&mission, &settings(), |_| {}, Some(&mut script));
    ran.check_records();
    replays(text, &ran);
    ran
}

fn replays(text: &str, ran: &Ran) {
    let mission = mission(text);
    let again = replay::verify(&mission, &settings(), ran.records.clone()).unwrap();
    assert_eq!(again, ran.report);
    let scene = mission.scene(&settings()).unwrap();
    let mut world = World::new(&scene);
    let again = replay::resimulate(&mission, &settings(), &scene, &mut world, ran.records.clone()).unwrap();
    assert_eq!(again, ran.report);
}

/// Number and time of the record of the only input.
fn recorded(ran: &Ran) -> (u64, Time) {
    let found = ran.all(|r| matches!(r.event, Event::Input { .. }).then_some((r.n, r.t)));
    assert_eq!(found.len(), 1, "{found:?}");
    found[0]
}

fn caused(ran: &Ran, by: u64) -> Vec<&Record> {
    ran.records.iter().filter(|r| r.causes.contains(&by)).collect()
}

#[test]
fn a_pacer_without_inputs_changes_nothing() {
    let mission = mission(MISSION);
    let free = run_with(&mission, &settings(), |_| {});
    let mut script = Script::default();
    let paced = run_paced(&mission, &settings(), |_| {}, Some(&mut script));
    assert_eq!((paced.report, &paced.records), (free.report, &free.records));
    assert_eq!(script.begun, [Time::ZERO]);
    assert!(script.asked.iter().all(|(now, next)| now < next));
    assert!(script.asked.windows(2).all(|w| w[0].1 == w[1].0), "every instant is asked for, in order");
    let times: std::collections::BTreeSet<Time> = free.records.iter().map(|r| r.t).collect();
    let asked: std::collections::BTreeSet<Time> = script.asked.iter().map(|a| a.1).collect();
    assert!(times.iter().skip(1).all(|t| asked.contains(t)));
}

#[test]
fn a_killed_agent_does_nothing_more_and_hears_nothing() {
    let at = ms(777) + Time(5);
    let ran = operated(MISSION, &[(at, kill("pilot@a[1]"))]);
    let (n, t) = recorded(&ran);
    assert_eq!(t, at, "an instant of its own");
    let life = caused(&ran, n);
    assert!(
        matches!(&life[..], [r] if matches!(&r.event, Event::Life { robot: 1, agent, status, .. }
            if agent == "pilot@a[1]" && status == "dead")),
        "{life:?}"
    );
    let acts = |who: &'static str| {
        ran.all(move |r| match &r.event {
            Event::Activation { agent, .. } if agent == who => Some(r.t),
            _ => None,
        })
    };
    assert_eq!(acts("pilot@a[1]").last(), Some(&ms(700)));
    assert!(acts("pilot@a[0]").last() > Some(&ms(4000)), "the other goes on");
    assert_eq!(ran.report.outcome, Outcome::Timeout, "the goal needs both");
    assert!(ran.report.robots[1].safe_actions > 0, "its commands expire");

    // The input comes with the units that are released at that instant: they are not evaluated any more.
    let ran = operated(MISSION, &[(ms(800), kill("listener@a[0]"))]);
    let dropped = ran.all(|r| match &r.event {
        Event::Delivery { agent, dropped: Some(why), .. } if agent == "listener@a[0]" => {
            Some((r.t, why.clone()))
        }
        _ => None,
    });
    assert_eq!(dropped.first(), Some(&(ms(820), "the agent is dead".to_string())));
    let ran = operated(MISSION, &[(ms(800), kill("pilot@a[0]"))]);
    let late = ran.all(|r| match &r.event {
        Event::Activation { agent, .. } if agent == "pilot@a[0]" => Some(r.t),
        _ => None,
    });
    assert_eq!(late.last(), Some(&ms(700)));
    assert!(late.len() == 8, "{late:?}");
}

#[test]
fn a_parameter_holds_from_the_instant_of_the_input_on() {
    let at = ms(500);
    let ran = operated(MISSION, &[(at, set("speed", &[2.0]))]);
    let (n, t) = recorded(&ran);
    assert_eq!(t, at);
    let param = caused(&ran, n);
    assert!(
        matches!(&param[..], [r] if matches!(&r.event, Event::Param { agent, param, registers }
            if agent == "operator" && param == "speed" && *registers == [2.0])),
        "{param:?}"
    );
    let speeds = ran.all(|r| match &r.event {
        Event::Command { robot: 0, registers, .. } => Some((r.t, registers[0])),
        _ => None,
    });
    assert!(speeds.iter().all(|(t, v)| *v == if *t < at { 0.5 } else { 2.0 }), "{speeds:?}");
    assert_eq!(ran.report.outcome, Outcome::Success);
    assert!(ran.report.sim_time_s < 1.0);
}

#[test]
fn a_stop_is_an_input_that_ends_the_run_with_safe_actions() {
    let ran = operated(MISSION, &[(ms(333), input(Operation::Stop))]);
    let (n, _) = recorded(&ran);
    assert!(ran.report.interrupted());
    assert_eq!(ran.report.sim_time_s, 0.333);
    let kinds: Vec<_> = caused(&ran, n).iter().map(|r| &r.event).collect();
    assert!(
        matches!(kinds[..], [Event::SafeAction { .. }, Event::SafeAction { .. }, Event::End { .. }]),
        "{kinds:?}"
    );
}

#[test]
fn several_inputs_are_done_in_their_order() {
    let script = [
        (ms(150), set("speed", &[1.0])),
        (ms(150), set("speed", &[0.25])),
        (ms(150), kill("listener@a[1]")),
        (ms(151), kill("listener@a[1]")),
        (ms(2000), input(Operation::Stop)),
        (ms(2000), set("speed", &[3.0])),
    ];
    let ran = operated(MISSION, &script);
    let inputs = ran.all(|r| Input::of(&r.event).map(|i| (r.t, i)));
    assert_eq!(inputs, script, "recorded as they were given");
    assert_eq!(ran.all(|r| matches!(r.event, Event::Life { .. }).then_some(r.t)), [ms(150)], "dead is dead");
    let fast = ran.all(|r| match &r.event {
        Event::Command { registers, .. } => Some(registers[0]),
        _ => None,
    });
    assert!(fast.contains(&0.25) && !fast.contains(&1.0), "the last of one instant holds");
    let again = operated(MISSION, &script);
    assert_eq!((again.records, again.report), (ran.records, ran.report));
}

#[test]
fn inputs_about_nothing_change_nothing_but_are_recorded() {
    let strange = [
        kill("pilot@b"),
        kill("pilot"),
        kill(""),
        set("sped", &[1.0]),
        set("speed", &[]),
        set("speed", &[1.0, 2.0]),
    ];
    let ran = operated(MISSION, &strange.clone().map(|i| (ms(300), i)));
    let free = run_with(&mission(MISSION), &settings(), |_| {});
    assert_eq!(ran.report, free.report);
    assert_eq!(ran.records.len(), free.records.len() + strange.len());
}

#[test]
fn a_pacer_cannot_turn_time_back_or_pass_over_an_instant() {
    let mission = mission(MISSION);
    let free = run_with(&mission, &settings(), |_| {});
    let mut late = Script { shift: 5_000_000_000, ..Script::default() };
    let ran = run_paced(&mission, &settings(), |_| {}, Some(&mut late));
    assert_eq!(ran.records, free.records, "nothing that is due is passed over");
    // Always a nanosecond after the instant before: only an end of patience comes of it.
    struct Early(Vec<(Time, Time)>, Arc<AtomicBool>);
    impl Pacer for Early {
        fn pace(&mut self, now: Time, next: Time, _: &mut Vec<Input>) -> Time {
            self.0.push((now, next));
            self.1.store(self.0.len() == 50, Ordering::Relaxed);
            Time(now.0 - 7)
        }
    }
    let scene = mission.scene(&settings()).unwrap();
    let (mut world, mut sink) = (World::new(&scene), Vec::new());
    let mut early = Early(Vec::new(), Arc::clone(&world.stop));
    let stop = Arc::clone(&world.stop);
    let mut engine =
        soifra_runtime::Engine::new(&mission, &settings(), &scene, &mut world, &mut sink, &stop).unwrap();
    engine.paced(&mut early);
    let report = engine.run();
    assert!(report.interrupted());
    assert!(early.0.windows(2).all(|w| w[1].0 == w[0].0 + Time(1)), "{:?}", early.0);
}

#[test]
fn a_run_stopped_while_it_waits_is_replayed_to_where_it_was_stopped() {
    let mission = mission(MISSION);
    for n in 1..20 {
        let flag = Arc::new(AtomicBool::new(false));
        let inputs = vec![(ms(50), set("speed", &[1.0]))];
        let mut script = Script { inputs, stop: Some((n, Arc::clone(&flag))), ..Script::default() };
        let ran = run_paced(&mission, &settings(), |w| w.stop = flag, Some(&mut script));
        assert!(ran.report.interrupted(), "{n}");
        assert_eq!(script.asked.len(), n);
        assert_eq!(Time::from_seconds(ran.report.sim_time_s), Some(script.asked[n - 1].0));
        replays(MISSION, &ran);
    }
}

#[test]
fn an_altered_input_is_found() {
    let ran = operated(MISSION, &[(ms(250), set("speed", &[1.0]))]);
    let (n, _) = recorded(&ran);
    let differs = |change: &dyn Fn(&mut Record)| {
        let mut records = ran.records.clone();
        change(&mut records[n as usize]);
        match replay::verify(&mission(MISSION), &settings(), records) {
            Err(ReplayError::Difference(d)) => d.record,
            other => panic!("not found: {other:?}"),
        }
    };
    let registers = |to: f64| {
        move |r: &mut Record| match &mut r.event {
            Event::Input { registers, .. } => registers[0] = to,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(differs(&registers(1.5)), n + 1, "what it caused is the first consequence");
    assert_eq!(differs(&registers(f64::NAN)), n + 1);
    let unknown = |r: &mut Record| match &mut r.event {
        Event::Input { operation, .. } => *operation = "dance".into(),
        other => panic!("{other:?}"),
    };
    assert_eq!(differs(&unknown), n, "nobody does it again");
    // Times that cannot be: before the record before it, and long after the end.
    differs(&|r| r.t = Time::ZERO);
    differs(&|r| r.t = Time(-5));
    differs(&|r| r.t = ms(1_000_000));
}

#[test]
fn a_swarm_gives_the_same_bytes_with_any_number_of_threads() {
    let text = r#"
edition 1
param gain: Number = 1
mission m {
  robot a[400]: cart at (1 m * modulo(1 * index, 20), 1.5 m * floor(index / 20)) runs walker
  goal g { subgoal s by walker achieved when sum > 100 }
  done when achieved(g)
  within 1 s
}
agent walker {
  sensor pose: Pose<map>
  actuator base: Twist
  state sum: Number = 0
  service go every 100 ms {
    set sum = sum + gain * draw(uniform(0, 1))
    command base twist(forward: 0.1 m/s)
  }
}
"#;
    let mission = mission(text);
    let script =
        [(ms(120), set("gain", &[0.5])), (ms(300), kill("walker@a[17]")), (ms(555), set("gain", &[3.0]))];
    let run = |threads| {
        let settings = soifra_runtime::Settings { threads, ..settings() };
        let mut script = Script { inputs: script.to_vec(), ..Script::default() };
        let ran = run_paced(&mission, &settings, |_| {}, Some(&mut script));
        ran.records.iter().map(|r| serde_json::to_string(r).unwrap()).collect::<Vec<_>>()
    };
    let one = run(1);
    assert!(one.len() > 4_000);
    assert!(one == run(3), "threads change nothing");
}

#[test]
fn agents_and_values_for_inputs() {
    let mission = mission(MISSION);
    let scene = mission.scene(&settings()).unwrap();
    assert_eq!(mission.agents(&scene), ["pilot@a[0]", "listener@a[0]", "pilot@a[1]", "listener@a[1]"]);
    assert_eq!(mission.parameter(0, &Value::Number(2.0)), Ok(vec![2.0]));
    assert!(mission.parameter(0, &Value::Bool(true)).is_err());
    assert!(mission.parameter(0, &Value::Number(f64::INFINITY)).is_err());
    assert!(mission.parameter(9, &Value::Number(1.0)).is_err());
    assert!(mission.parameter(1, &Value::Text("plain".into())).is_ok(), "a text of the mission");
    assert!(mission.parameter(1, &Value::Text("unheard of".into())).is_err());
}
