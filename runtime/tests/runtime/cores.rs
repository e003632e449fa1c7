//! Cores: preemption, shared resources, budgets, deadlines.

use crate::support::{Ran, run};
use soifra_runtime::{Event, Outcome};

fn host(units: &str, ending: &str) -> Ran {
    run(&format!(
        "edition 1
agent tasks {{
  state over: Bool = false
  state x: Number = 0
  event go
{units}
}}
mission m {{
  host box runs tasks
  goal g {{ subgoal s by tasks achieved when over }}
  {ending}
}}
"
    ))
}

/// When each unit got a core, as `time unit`.
fn switches(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Switch { unit, .. } => {
            Some(format!("{} {}", r.t.0 / 1_000_000, unit.as_deref().unwrap_or("-")))
        }
        _ => None,
    })
}

fn completions(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Completion { unit, rounds, .. } => {
            let rounds = rounds.map_or(String::new(), |n| format!(" {n}"));
            Some(format!("{} {unit}{rounds}", r.t.0 / 1_000_000))
        }
        _ => None,
    })
}

#[test]
fn the_more_urgent_interrupts() {
    let ran = host(
        "  service low every 100 ms worst 30 ms priority 1 core 0 { note \"low\" }
  service high every 20 ms after 10 ms worst 5 ms priority 2 core 0 { note \"high\" }",
        "within 60 ms",
    );
    assert_eq!(
        switches(&ran),
        ["0 low", "10 high", "15 low", "30 high", "35 low", "40 -", "50 high", "55 -"]
    );
    assert_eq!(completions(&ran), ["15 high", "35 high", "40 low", "55 high"]);
    ran.check_records();
}

#[test]
fn what_it_sends_appears_when_it_is_done() {
    let ran = host(
        "  service low every 100 ms worst 30 ms priority 1 core 0 { raise go }
  service high every 100 ms after 10 ms worst 5 ms priority 2 core 0 { set x = 1 }
  service hear on event go { note \"then\", x }",
        "within 60 ms",
    );
    assert_eq!(ran.notes(), [(35, "then: 1".to_string())]);
}

/// While the low one holds the resource, the high one waits, and the middle one with it.
#[test]
fn who_holds_a_resource_is_not_interrupted_by_who_shares_it() {
    let ran = host(
        "  service low every 100 ms worst 20 ms priority 1 core 0 shares bus for 15 ms { note \"low\" }
  service middle every 100 ms after 4 ms worst 5 ms priority 2 core 0 { note \"middle\" }
  service high every 100 ms after 8 ms worst 5 ms priority 3 core 0 shares bus for 1 ms { note \"high\" }",
        "within 60 ms",
    );
    assert_eq!(switches(&ran), ["0 low", "15 high", "20 middle", "25 low", "30 -"]);
}

#[test]
fn an_anytime_service_gets_exactly_its_budget() {
    let ran = host(
        "  service better every 100 ms worst 5 ms budget 32 ms deadline 80 ms core 0 {
    refine n = 0 by n + 1 cost 10 ms
    set x = n
    note \"rounds\", n
  }",
        "within 150 ms",
    );
    // 5 ms, and three rounds of 10 ms: a fourth is not paid for.
    assert_eq!(completions(&ran), ["35 better 3", "135 better 3"]);
    assert_eq!(ran.notes(), [(35, "rounds: 3".to_string()), (135, "rounds: 3".to_string())]);
}

#[test]
fn an_anytime_service_stops_when_it_is_good_enough() {
    let ran = host(
        "  service better every 100 ms worst 5 ms budget 90 ms core 0 {
    refine n = 0 by n + 1 cost 10 ms until n >= 4
    set x = n
    note \"rounds\", n
  }",
        "within 60 ms",
    );
    assert_eq!(completions(&ran), ["45 better 4"]);
}

/// Its core is busy with something more urgent: at the deadline it answers with what it got.
#[test]
fn an_anytime_service_answers_at_its_deadline_with_less() {
    let ran = host(
        "  service urgent every 10 ms worst 6 ms priority 2 core 0 { set x = 1 }
  service better every 100 ms worst 5 ms budget 80 ms deadline 50 ms priority 1 core 0 {
    refine n = 0 by n + 1 cost 5 ms
    note \"rounds\", n
  }",
        "within 100 ms",
    );
    // Of 50 ms it gets 20: 5 ms, and three rounds.
    let better: Vec<String> = completions(&ran).into_iter().filter(|c| c.contains("better")).collect();
    assert_eq!(better, ["50 better 3"]);
    let misses = ran.all(|r| matches!(r.event, Event::Miss { .. }).then_some(()));
    assert!(misses.is_empty());
}

#[test]
fn what_comes_too_soon_waits_and_is_traced() {
    let ran = host(
        "  service stir every 10 ms { raise go }
  service slow on event go at most every 25 ms worst 2 ms core 0 { note \"slow\" }",
        "within 70 ms",
    );
    let at: Vec<i64> = ran.notes().into_iter().map(|(t, _)| t).collect();
    assert_eq!(at, [0, 25, 50]);
    let deferred = ran.all(|r| match &r.event {
        Event::Deferral { until, .. } => Some((r.t.0 / 1_000_000, until.0 / 1_000_000)),
        _ => None,
    });
    assert_eq!(deferred, [(10, 25), (30, 50), (50, 75)]);
}

#[test]
fn so_many_misses_are_tolerated_and_no_more() {
    let units = |misses: &str| {
        format!(
            "  service urgent every 20 ms worst 19 ms priority 2 core 0 {{ set x = x + 1 }}
  service late every 40 ms worst 4 ms deadline 30 ms {misses} priority 1 core 0 {{ note \"late\" }}"
        )
    };
    let soft = host(&units("soft"), "within 300 ms");
    let misses = soft.all(|r| match &r.event {
        Event::Miss { unit, deadline, .. } => Some(format!("{unit} {}", deadline.0 / 1_000_000)),
        _ => None,
    });
    assert_eq!(misses[..2], ["late 30", "late 110"], "the next release is skipped while it runs");
    assert_eq!(soft.report.outcome, Outcome::Timeout);
    let tolerant = host(&units("misses 1"), "within 300 ms");
    assert_eq!(tolerant.report.outcome, Outcome::Aborted);
    let why = "late has missed 2 deadlines in a row";
    assert!(tolerant.report.reason.ends_with(why), "{}", tolerant.report.reason);
    assert_eq!(tolerant.report.sim_time_s, 0.11);
}

#[test]
fn executions_can_be_asked_for() {
    let ran = host(
        "  service low every 100 ms worst 30 ms priority 1 core 0 { set x = 2 }
  service high every 20 ms after 10 ms worst 5 ms priority 2 core 0 { set over = x > 3 }",
        "within 95 ms
  expect box.tasks.low.activations == 1
  expect box.tasks.high.activations == 5
  expect box.tasks.low.response == 40 ms
  expect never box.tasks.high.response > 5 ms
  expect box.tasks.low.misses == 0",
    );
    assert!(ran.report.expectations.iter().all(|e| e.held == Some(true)), "{:#?}", ran.report.expectations);
}

/// What has not even begun at its deadline gives its first answer as soon as it can.
#[test]
fn an_anytime_service_that_begins_too_late_makes_no_rounds() {
    let ran = host(
        "  service urgent every 100 ms worst 60 ms deadline 90 ms priority 2 core 0 { set x = 1 }
  service better every 100 ms worst 5 ms budget 30 ms deadline 50 ms soft priority 1 core 0 {
    refine n = 0 by n + 1 cost 5 ms
    note \"rounds\", n
  }",
        "within 100 ms",
    );
    assert_eq!(completions(&ran), ["60 urgent", "65 better 0"]);
    let misses = ran.all(|r| matches!(r.event, Event::Miss { .. }).then_some(r.t.0 / 1_000_000));
    assert_eq!(misses, [50]);
}
