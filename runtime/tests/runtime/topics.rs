//! Messages between agents: boards, deliveries, mailboxes.

use crate::support::*;
use soifra_graph::Value;
use soifra_runtime::Event;

const HEAR: &str = r#"
edition 1
record Beat { from: Int, count: Int }
param radio: Length = 100 m
param drop: Number = 0
topic beat: Beat = channel(delay: 30 ms, range: radio, loss: drop)
mission m {
  robot a[3]: cart at (10 m * index, 0 m) runs heart
  goal g { subgoal s by heart achieved when over }
  done when achieved(g)
  within 450 ms
}
agent heart {
  state over: Bool = false
  state count: Int = 0
  service send every 100 ms {
    when now < 250 ms => publish beat Beat(from: robot.index, count: count)
    set count = count + 1
  }
  service hear every 50 ms after 40 ms {
    note "heard", heard(beat).map(b => b.from * 10 + b.count)
  }
}
"#;

fn heard(ran: &Ran, robot: u32) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Note { robot: n, text, .. } if *n == robot => Some(format!("{} {text}", r.t.0 / 1_000_000)),
        _ => None,
    })
}

#[test]
fn the_latest_of_every_other_sender_after_the_delay_within_the_lifetime() {
    let ran = run(HEAR);
    let expected = [
        "40 heard: [10, 20]",
        "90 heard: [10, 20]",
        "140 heard: [11, 21]",
        "190 heard: [11, 21]",
        "240 heard: [12, 22]",
        "290 heard: [12, 22]",
        "340 heard: [12, 22]",
        "390 heard: [12, 22]",
        // Sent at 200, on the air from 230, heard for two periods of its service.
        "440 heard: []",
    ];
    assert_eq!(heard(&ran, 0), expected);
    assert_eq!(heard(&ran, 1)[0], "40 heard: [0, 20]");
    ran.check_records();
}

#[test]
fn range_is_measured_between_true_positions() {
    let ran = run_with(&mission(HEAR), &with(&[("radio", Value::Number(12.0))]), |_| {});
    assert_eq!(heard(&ran, 0)[0], "40 heard: [10]");
    assert_eq!(heard(&ran, 1)[0], "40 heard: [0, 20]");
    // Without world truth nobody is out of range.
    let ran = run_with(&mission(HEAR), &with(&[("radio", Value::Number(12.0))]), |w| w.truth = false);
    assert_eq!(heard(&ran, 0)[0], "40 heard: [10, 20]");
}

#[test]
fn loss_depends_on_the_seed_alone() {
    let all = |seed| {
        let settings = soifra_runtime::Settings { seed, ..with(&[("drop", Value::Number(0.5))]) };
        let ran = run_with(&mission(HEAR), &settings, |_| {});
        (0..3).flat_map(|r| heard(&ran, r)).collect::<Vec<_>>()
    };
    assert_eq!(all(1), all(1));
    assert_ne!(all(1), all(2));
    let none = run_with(&mission(HEAR), &with(&[("drop", Value::Number(1.0))]), |_| {});
    assert!(heard(&none, 0).iter().all(|h| h.ends_with("[]")));
}

#[test]
fn a_message_sets_off_a_unit_and_mailboxes_drop_the_oldest() {
    let ran = run(r#"
edition 1
record Beat { count: Int }
topic beat: Beat = channel(delay: 10 ms, capacity: 2)
mission m {
  robot a: cart at (0 m, 0 m) runs source
  robot b: cart at (1 m, 0 m) runs sink
  goal g { subgoal s by sink achieved when over }
  done when achieved(g)
  within 1 s
}
agent source {
  state count: Int = 0
  service send every 100 ms { set count = count + 1 publish beat Beat(count: count) }
}
agent sink {
  state over: Bool = false
  service slow on beat(b) at most every 350 ms { note "got", b.count }
}
"#);
    let got: Vec<String> = ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect();
    // The first at once; then 2 letters wait at most, and the older ones are dropped.
    assert_eq!(got, ["10 got: 1", "360 got: 3", "710 got: 7"]);
    let dropped = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), .. } => Some(format!("{} {why}", r.t.0 / 1_000_000)),
        _ => None,
    });
    assert_eq!(dropped[0], "310 the mailbox is full");
    ran.check_records();
}

#[test]
fn agents_of_one_robot_tell_each_other() {
    let ran = run(r#"
edition 1
record Found { side: Int }
mission m {
  robot a: cart at (0 m, 0 m) runs eye, hand
  robot b: cart at (1 m, 0 m) runs hand
  goal g { subgoal s by hand achieved when over }
  done when any robot: hand.over
  within 1 s
}
agent eye {
  state seen: Int = 0
  service look every 100 ms {
    set seen = seen + 1
    when seen == 2 => tell hand inform Found(side: seen)
  }
}
agent hand {
  state over: Bool = false
  event grasp
  service take on inform Found(f) from eye { note "told", f.side raise grasp }
  service close on event grasp { note "closed" set over = true }
}
"#);
    let got: Vec<String> = ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect();
    assert_eq!(got, ["100 told: 2", "100 closed"]);
    assert_eq!(ran.report.sim_time_s, 0.100_001);
    ran.check_records();
}
