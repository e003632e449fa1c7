//! What a mission expects: when it is violated first, and by how much.

use crate::support::*;
use soifra_runtime::{Outcome, Report, Time};

/// A cart that drives 1 m/s along x from 0, and some expectations.
fn drive(expects: &str) -> String {
    format!(
        r#"
edition 1
mission m {{
  robot a: cart at (0 m, 0 m) to (2 m, 0 m) runs pilot
  robot b: cart at (0 m, 5 m) to (2 m, 5 m) runs pilot
  goal g {{ subgoal s by pilot achieved when arrived }}
  done when achieved(g)
  within 5 s
  {expects}
  metric way = most robot: truth.path_length
  metric nothing = 1 / (steps_of(0) - 0)
}}
fn steps_of(x: Number) -> Number = x
agent pilot {{
  sensor pose: Pose<map>
  actuator base: Twist
  state arrived: Bool = false
  service go every 100 ms {{
    set arrived = pose.position.x >= 2 m - 1 um
    command base twist(forward: 1 m/s)
  }}
}}
"#
    )
}

struct Seen {
    held: Option<bool>,
    violated: Option<f64>,
    margin: Option<f64>,
    outcome: Outcome,
}

fn judge_with(expect: &str, prepare: impl FnOnce(&mut World)) -> Seen {
    let ran = run_with(&mission(&drive(&format!("expect {expect}"))), &settings(), prepare);
    ran.check_records();
    let e = ran.report.expectations[0].clone();
    assert_eq!(e.text.trim(), expect.trim());
    Seen { held: e.held, violated: e.first_violation_s, margin: e.margin, outcome: ran.report.outcome }
}

fn check(expect: &str, held: bool, violated: Option<f64>, margin: Option<f64>) {
    let seen = judge_with(expect, |_| {});
    assert_eq!(seen.held, Some(held), "{expect}");
    assert_eq!(seen.outcome, if held { Outcome::Success } else { Outcome::Failed }, "{expect}");
    assert_eq!(seen.violated, violated, "{expect}");
    match (seen.margin, margin) {
        (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9, "{expect}: {a} {b}"),
        (a, b) => assert_eq!(a, b, "{expect}"),
    }
}

#[test]
fn kinds_and_margins() {
    check("each robot: always truth.position.x <= 3 m", true, None, Some(1.0));
    check("each robot: always truth.position.x < 1.5 m", false, Some(1.5), Some(-0.5));
    check("each robot: never truth.position.x > 3 m", true, None, Some(1.0));
    check("each robot: eventually truth.position.x >= 1.5 m within 1 s", false, Some(1.0), Some(-0.5));
    check("each robot: eventually truth.position.x >= 0.5 m within 1 s", true, None, Some(0.5));
    check("each robot: truth.position.x < 1 m until truth.position.x >= 0.95 m", true, None, Some(0.05));
    check(
        "each robot: truth.position.x < 0.95 m until truth.position.x >= 1.45 m",
        false,
        Some(1.0),
        Some(-0.25),
    );
    check(
        "each robot: truth.position.x >= 0.5 m leads to truth.position.x >= 0.95 m within 1 s",
        true,
        None,
        Some(0.5),
    );
    check(
        "each robot: truth.position.x >= 0.5 m leads to truth.position.x >= 1.75 m within 1 s",
        false,
        Some(1.5),
        Some(-0.3),
    );
    // An answer that is due at the last instant and is not there is missed.
    check(
        "each robot: truth.position.x >= 0.95 m leads to truth.position.x >= 9 m within 1 s",
        false,
        Some(2.0),
        Some(0.0),
    );
    check("each robot: truth.position.x >= 1.9 m", true, None, Some(0.1));
    // Whole conditions: `and` the smaller, `or` the greater, `not` the negative, `each` the least.
    check("always (each robot: truth.position.x <= 3 m) and collisions <= 4", true, None, Some(1.0));
    check("never not (each robot: truth.position.x <= 3 m)", true, None, Some(1.0));
    // At 2 s the goal is achieved, which is no distance: the least one is that of 1.9 s.
    check("always achieved(g) or now < 7 s", true, None, Some(5.1));
    check("each robot: eventually pilot.arrived", true, None, None);
}

#[test]
fn what_cannot_be_told_has_not_held() {
    let seen = judge_with("always 1 / (now - 1 s) < 1000 / 1 s", |_| {});
    assert_eq!((seen.held, seen.violated, seen.outcome), (Some(false), Some(1.0), Outcome::Aborted));
}

#[test]
fn metrics_without_a_value_are_null() {
    let ran = run(&drive(""));
    assert_eq!(ran.report.metrics["nothing"], None);
    assert!((ran.report.metrics["way"].unwrap() - 2.0).abs() < 1e-9);
}

#[test]
fn metrics_of_samples() {
    let ran = run(&drive(
        "metric n = count upon a.pilot.go.activations
         metric late = count upon a.pilot.go.activations when now > 1 s
         metric total = sum of now / 1 s upon a.pilot.go.activations
         metric mean_time = mean of now upon a.pilot.go.activations
         metric first = least of now upon a.pilot.go.activations
         metric last = most of now upon a.pilot.go.activations
         metric never = mean of now upon a.pilot.arrived when now < 1 s
         metric none_at_all = sum of 1 upon a.pilot.arrived when now < 1 s
         metric broken = mean of 1 / (steps_of(0) - 0) upon a.pilot.arrived",
    ));
    let m = |name: &str| ran.report.metrics[name];
    // What it is at the end of the first instant is no change: activations at 0.1 s, 0.2 s …
    let (n, last) = (m("n").unwrap(), m("last").unwrap());
    assert!((n * 0.1 - last).abs() < 1e-9 && n > 15.0, "{n} {last}");
    assert_eq!(m("late"), Some(n - 10.0));
    assert!((m("total").unwrap() - 0.1 * n * (n + 1.0) / 2.0).abs() < 1e-9);
    assert!((m("mean_time").unwrap() - 0.1 * (n + 1.0) / 2.0).abs() < 1e-9);
    assert!((m("first").unwrap() - 0.1).abs() < 1e-9);
    assert_eq!((m("never"), m("none_at_all"), m("broken")), (None, Some(0.0), None));
}

fn touch(from: i64, to: i64) -> impl FnOnce(&mut World) {
    move |w| {
        let with = "wall".to_string();
        w.script.push(Report::ContactBegin { at: Time(from), robot: 1, other: None, with: with.clone() });
        w.script.push(Report::ContactEnd { at: Time(to), robot: 1, other: None, with });
    }
}

#[test]
fn a_contact_that_ended_before_it_was_reported_is_seen() {
    let seen = judge_with("never collision", touch(110_000_000, 120_000_000));
    assert_eq!((seen.held, seen.violated), (Some(false), Some(0.11)));
    let seen = judge_with("each robot: never truth.collision", touch(110_000_000, 120_000_000));
    assert_eq!((seen.held, seen.violated), (Some(false), Some(0.11)));
    let seen = judge_with("always collisions <= 1", touch(110_000_000, 120_000_000));
    assert_eq!((seen.held, seen.margin), (Some(true), Some(0.0)));
}

#[test]
fn without_world_truth_nothing_is_claimed_about_it() {
    let seen = judge_with("each robot: always truth.position.x <= 3 m", |w| w.truth = false);
    assert_eq!((seen.held, seen.outcome), (None, Outcome::Success));
}
