//! Declared faults: messages that are lost, late, doubled or unreadable, sensors that fall silent or are off,
//! agents that die in the middle of a conversation. A replay of each gives the same records.

use crate::support::*;
use soifra_runtime::{Event, Settings, replay};

/// A clerk asks an oracle every 20 ms; a beacon is published every 10 ms; a cart looks at its pose.
fn text(fault: &str) -> String {
    format!(
        r#"
edition 1
import std.protocols
record Question {{ number: Int }}
record Answer {{ number: Int }}
record Beat {{ number: Int }}
conversation ask: request<Question, Answer>(answer: 8 ms, work: 8 ms) = channel(delay: 1 ms)
topic beat: Beat = channel(delay: 1 ms)
agent clerk {{
  state number: Int = 0
  service wonder every 20 ms {{
    set number = number + 1
    open ask request Question(number: number) to offering(ask)
  }}
  service hear on ask inform(a) {{ note "answer", a.number }}
  service late on ask timeout {{ note "late" }}
  service odd on ask not_understood {{ note "not understood" }}
  service gone on ask failure {{ note "failure" }}
  service pulse on beat(b) {{ note "beat", b.number }}
}}
agent oracle {{
  offers ask
  state beats: Int = 0
  service answer on ask request(q) {{
    reply agree
    reply inform Answer(number: q.number)
  }}
  service pulse every 10 ms {{
    set beats = beats + 1
    publish beat Beat(number: beats)
  }}
}}
agent pilot {{
  sensor pose: Pose<map>
  state x: Length = 0 m
  service look on sensor pose {{ set x = pose.position.x note "x", x }}
}}
mission m {{
  robot c: cart at (0 m, 0 m) runs pilot
  host office runs clerk
  host temple runs oracle
  goal g {{ subgoal s by clerk achieved when number >= 100 }}
  done when now >= 90 ms
  within 95 ms
  {fault}
}}
"#
    )
}

fn ran(fault: &str) -> Ran {
    let mission = mission(&text(fault));
    let ran = run_with(&mission, &settings(), |_| {});
    ran.check_records();
    for threads in [1, 2] {
        let again = run_with(&mission, &Settings { threads, ..settings() }, |_| {});
        assert_eq!(again.records, ran.records, "{fault} with {threads} threads");
    }
    let again = replay::verify(&mission, &settings(), ran.records.clone());
    assert_eq!(again.as_ref(), Ok(&ran.report), "{fault}");
    ran
}

fn notes(fault: &str, about: &str) -> Vec<String> {
    let ran = ran(fault);
    let of = |(t, s): (i64, String)| s.starts_with(about).then(|| format!("{t} {s}"));
    ran.notes().into_iter().filter_map(of).collect()
}

#[test]
fn nothing_goes_wrong_by_itself() {
    assert_eq!(
        notes("", "answer"),
        ["2 answer: 1", "22 answer: 2", "42 answer: 3", "62 answer: 4", "82 answer: 5"]
    );
    assert_eq!(notes("", "beat").len(), 9);
}

#[test]
fn messages_are_lost_for_a_while() {
    let fault = "fault = drop(of: \"ask\", from: 30 ms, until: 70 ms)";
    assert_eq!(notes(fault, "answer"), ["2 answer: 1", "22 answer: 2", "82 answer: 5"]);
    assert_eq!(notes(fault, "late"), ["48 late", "68 late"]);
    assert_eq!(notes("fault = drop(of: \"beat\", from: 5 ms, until: 75 ms)", "beat").len(), 2);
    let some = notes("fault = drop(of: \"beat\", chance: 50 %)", "beat").len();
    assert!((2..=8).contains(&some), "{some}");
}

#[test]
fn messages_are_late() {
    assert_eq!(
        notes("fault = delay(of: \"beat\", by: 5 ms, until: 15 ms)", "beat")[..3],
        ["6 beat: 1", "16 beat: 2", "21 beat: 3"]
    );
    let fault = "fault = delay(of: \"ask\", by: 10 ms, from: 30 ms, until: 50 ms)";
    // The question comes late, so that the clerk has given up.
    assert!(notes(fault, "late").contains(&"48 late".to_string()));
}

#[test]
fn messages_come_twice() {
    // A conversation knows a message that it has had; a topic does not.
    assert_eq!(notes("fault = duplicate(of: \"ask\")", "answer").len(), 5);
    assert_eq!(notes("fault = duplicate(of: \"ask\")", "not understood").len(), 0);
    assert_eq!(
        notes("fault = duplicate(of: \"beat\", until: 15 ms)", "beat")[..4],
        ["1 beat: 1", "1 beat: 1", "11 beat: 2", "11 beat: 2"]
    );
}

#[test]
fn messages_arrive_unreadable() {
    let fault = "fault = corrupt(of: \"ask\", from: 30 ms, until: 41 ms)";
    assert_eq!(notes(fault, "not understood"), ["42 not understood"]);
    assert_eq!(notes(fault, "answer").len(), 4);
    assert_eq!(notes("fault = corrupt(of: \"beat\")", "beat").len(), 0);
}

#[test]
fn a_sensor_falls_silent_or_is_off() {
    let all = notes("", "x").len();
    assert_eq!(all, 1);
    assert_eq!(notes("fault = dropout(sensor: \"c.pose\")", "x").len(), 0);
    assert_eq!(notes("fault = bias(sensor: \"c.pose\", by: 25 cm)", "x"), ["0 x: 0.25 m"]);
    let struck = ran("fault = bias(sensor: \"c.pose\", by: 25 cm)").all(|r| match &r.event {
        Event::Trouble { target, text } => Some(format!("{target}: {text}")),
        _ => None,
    });
    assert_eq!(struck, ["c.pose: the reading is off"]);
}

#[test]
fn whoever_talks_with_the_dead_is_told() {
    let fault = "fault = kill(agent: \"oracle@temple\", at: 40500 us)";
    let ran = ran(fault);
    let notes: Vec<String> = ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect();
    // The question was under way: its platform answers for the dead; later nobody offers it.
    assert!(notes.contains(&"41 failure".to_string()), "{notes:?}");
    assert!(!notes.iter().any(|n| n.contains("late")), "{notes:?}");
    assert_eq!(notes.iter().filter(|n| n.contains("failure")).count(), 1);
    assert_eq!(notes.iter().filter(|n| n.contains("beat")).count(), 5);
    // The clerk dies: the oracle goes on.
    let notes = notes_of("fault = kill(agent: \"clerk\", at: 21 ms)");
    assert_eq!(notes.iter().filter(|n| n.contains("answer")).count(), 1, "{notes:?}");
}

fn notes_of(fault: &str) -> Vec<String> {
    ran(fault).notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect()
}

/// Two agents that answer each other as fast as messages travel, and one that has nothing to do with them.
#[test]
fn a_ping_pong_without_time_passing_is_ended() {
    let ran = run(r#"
edition 1
record Ball { number: Int }
agent ping {
  state n: Int = 0
  service serve every 1 s { tell pong inform Ball(number: 0) }
  service back on inform Ball(b) { set n = n + 1 tell pong inform Ball(number: b.number + 1) }
}
agent pong {
  state n: Int = 0
  service back on inform Ball(b) { set n = n + 1 tell ping inform Ball(number: b.number + 1) }
}
agent clerk {
  state ticks: Int = 0
  service tick every 10 ms { set ticks = ticks + 1 }
}
mission m {
  host h runs ping, pong, clerk
  goal g { subgoal s by clerk achieved when ticks >= 100 }
  within 10 s
}
"#);
    assert_eq!(ran.report.outcome.name(), "success");
    let deaths = ran.all(|r| match &r.event {
        Event::Life { agent, status, reason, .. } => Some(format!("{agent} {status}: {reason}")),
        _ => None,
    });
    assert_eq!(deaths.len(), 1);
    assert!(deaths[0].ends_with("dead: it floods: more than 40000 activations within 100 ms"), "{deaths:?}");
}
