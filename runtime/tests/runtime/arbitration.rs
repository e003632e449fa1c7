//! Which proposal an actuator gets: the strategies by themselves, and in a mission.

use crate::support::*;
use soifra_runtime::{
    Event, Time,
    arbitration::{Losers, Proposal, Reason, blend, layers, priority, switch},
};

const NOW: Time = Time(100);

fn live(at: i64) -> Proposal {
    Proposal { proposed: Some(Time(at)), expires: Time(at + 50) }
}

const SILENT: Proposal = Proposal { proposed: None, expires: Time(0) };

#[test]
fn switch_takes_the_first() {
    let mut losers = Losers::new();
    assert_eq!(switch::decide(NOW, &[SILENT, live(10), live(90), live(60)], &mut losers), Some(2));
    assert_eq!(losers, [(0, Reason::Silent), (1, Reason::Expired), (3, Reason::After(2))]);
    assert_eq!(switch::decide(NOW, &[live(50)], &mut losers), None, "dead at the instant it expires");
}

#[test]
fn priority_takes_the_highest_index_and_the_first_of_equals() {
    let mut losers = Losers::new();
    let p = [live(90), live(90), live(90), SILENT];
    assert_eq!(priority::decide(NOW, &p, &[1.0, 2.0, 2.0, 9.0], &mut losers), Some(1));
    let expected = [(0, Reason::Index { own: 1.0, best: 2.0 }), (2, Reason::Tie(2.0)), (3, Reason::Silent)];
    assert_eq!(losers, expected);
}

#[test]
fn layers_suppress_hold_and_are_inhibited() {
    let layer = |suppresses, hold, inhibited| layers::Layer { suppresses, hold: Time(hold), inhibited };
    let decide = |p: &[Proposal], l: &[layers::Layer<'_>]| {
        let mut losers = Losers::new();
        let (winner, again) = layers::decide(NOW, p, l, &mut losers);
        (winner, again, losers)
    };
    let plain = [layer(&[1], 0, false), layer(&[], 0, false)];
    assert_eq!(decide(&[live(90), live(90)], &plain), (Some(0), None, vec![(1, Reason::Suppressed(0))]));
    assert_eq!(decide(&[SILENT, live(90)], &plain).0, Some(1));
    let inhibited = [layer(&[1], 0, true), layer(&[], 0, false)];
    assert_eq!(decide(&[live(90), live(90)], &inhibited), (Some(1), None, vec![(0, Reason::Inhibited)]));
    // Its proposal has expired, but it goes on suppressing until 110: nobody wins, and 110 must be looked at.
    let holding = [layer(&[1], 100, false), layer(&[], 0, false)];
    let (winner, again, losers) = decide(&[live(10), live(90)], &holding);
    assert_eq!((winner, again), (None, Some(Time(110))));
    assert_eq!(losers, [(0, Reason::Expired), (1, Reason::Suppressed(0))]);
    // A lower layer may suppress a higher one, unless it is suppressed itself.
    let upward = [layer(&[], 0, false), layer(&[0], 0, false)];
    assert_eq!(decide(&[live(90), live(90)], &upward).0, Some(1));
    let both = [layer(&[1], 0, false), layer(&[0], 0, false)];
    assert_eq!(decide(&[live(90), live(90)], &both).0, Some(0));
}

#[test]
fn blend_is_a_weighted_mean() {
    let (mut losers, mut out) = (Losers::new(), [0.0; 2]);
    let p = [live(90), live(60), SILENT, live(90)];
    let commands = [1.0, 0.0, 4.0, 8.0, 100.0, 100.0, 50.0, 50.0];
    let expires = blend::decide(NOW, &p, &[1.0, 3.0, 1.0, 0.0], &commands, &mut out, &mut losers);
    assert_eq!((expires, out), (Some(Time(110)), [3.25, 6.0]));
    assert_eq!(losers, [(2, Reason::Silent), (3, Reason::Weight(0.0))]);
    assert_eq!(blend::decide(NOW, &p[2..], &[1.0, -1.0], &commands, &mut out, &mut losers), None);
}

/// Speeds sent to actuator 0, as (ms, m/s).
fn speeds(ran: &Ran) -> Vec<(i64, f64)> {
    ran.world.sent.iter().filter(|s| s.2 == 0).map(|s| (s.0.0 / 1_000_000, s.3[0])).collect()
}

fn mission_with(arbiter: &str) -> String {
    format!(
        r#"
edition 1
mission m {{
  robot a: cart at (0 m, 0 m) runs pilot
  goal g {{ subgoal s by pilot achieved when over }}
  done when achieved(g)
  within 500 ms
}}
agent pilot {{
  actuator base: Twist
  state over: Bool = false
  state urgent: Bool = false
  service cruise every 100 ms {{ command base twist(forward: 0.1 m/s) }}
  service dodge every 100 ms {{
    set urgent = now >= 200 ms and now < 350 ms
    when urgent => command base twist(forward: 0.5 m/s)
  }}
  arbitrate base by {arbiter}
}}
"#
    )
}

#[test]
fn a_switch_in_a_mission_traces_losers_with_reasons() {
    let ran = run(&mission_with("switch [dodge, cruise]"));
    // The last dodge is proposed at 300 ms and lives until 500 ms.
    assert_eq!(speeds(&ran), [(0, 0.1), (100, 0.1), (200, 0.5), (300, 0.5), (500, 0.1)]);
    let decisions = ran.all(|r| match &r.event {
        Event::Arbitration { winner, losers, .. } => {
            Some((r.t.0 / 1_000_000, winner.clone(), losers.clone()))
        }
        _ => None,
    });
    let text = |s: &str| s.to_string();
    assert_eq!(
        decisions[0],
        (0, Some(text("pilot.cruise")), vec![(text("pilot.dodge"), text("proposes nothing"))])
    );
    let lost = vec![(text("pilot.cruise"), text("pilot.dodge comes before it"))];
    assert_eq!(decisions[2], (200, Some(text("pilot.dodge")), lost));
    ran.check_records();
}

#[test]
fn indices_change_with_the_state() {
    let ran = run(&mission_with("priority { dodge: if urgent then 2 else 0, cruise: 1 }"));
    assert_eq!(speeds(&ran), [(0, 0.1), (100, 0.1), (200, 0.5), (300, 0.5), (400, 0.1), (500, 0.1)]);
}

#[test]
fn layers_and_blends_in_a_mission() {
    let ran = run(&mission_with("layers { layer dodge suppresses [cruise] for 50 ms layer cruise }"));
    assert_eq!(speeds(&ran), [(0, 0.1), (100, 0.1), (200, 0.5), (300, 0.5), (500, 0.1)]);
    let ran = run(&mission_with("blend { dodge: 1, cruise: 3 }"));
    let mean = (0.5 + 3.0 * 0.1) / 4.0;
    let seen = speeds(&ran);
    assert!(seen[0].0 == 0 && (seen[0].1 - 0.1).abs() < 1e-12, "{seen:?}");
    assert!(seen.iter().any(|s| s.0 == 200 && (s.1 - mean).abs() < 1e-12), "{seen:?}");
}

#[test]
fn nobody_proposing_any_more_means_the_safe_action() {
    let ran = run(r#"
edition 1
mission m {
  robot a: cart at (0 m, 0 m) runs pilot
  goal g { subgoal s by pilot achieved when over }
  done when achieved(g)
  within 1 s
}
agent pilot {
  actuator base: Twist
  actuator arm: Twist
  state over: Bool = false
  service drive every 100 ms { when now < 250 ms => command base twist(forward: 0.1 m/s) }
  service wave every 100 ms { when now < 250 ms => command arm twist(forward: 0.1 m/s) }
}
"#);
    // Two periods of the unit, unless the actuator gives its own lifetime.
    let expires: Vec<(u32, i64)> = ran.world.sent.iter().map(|s| (s.2, (s.4 - s.0).0 / 1_000_000)).collect();
    assert!(expires.contains(&(0, 200)) && expires.contains(&(1, 150)), "{expires:?}");
    let safe = ran.all(|r| match &r.event {
        Event::SafeAction { action, reason, .. } => Some((r.t.0 / 1_000_000, action.clone(), reason.clone())),
        _ => None,
    });
    assert_eq!(safe[0].0, 350);
    assert_eq!(safe[1], (400, "stop".into(), "the command of pilot.drive has expired".into()));
    ran.check_records();
}
