//! What the planner-matcher, supervision and cores once did wrong, each in a few lines.

use crate::support::run;
use soifra_runtime::{Event, Record};

/// Four agents refuse for ever: each is asked once a second, not more and more often.
#[test]
fn who_refuses_is_asked_again_once_a_second() {
    let ran = run(r#"
edition 1
plan p for go_there { needs walk }
agent a { offers walk when ready state ready = false service rest every 1 s { set ready = now > 10000 s } service walk every 100 ms { note "w" } }
mission outing { host h[4] runs a goal arrive { subgoal go_there } within 600 s }
"#);
    ran.check_records();
    let asked = ran.all(|r| matches!(&r.event, Event::Acl { performative, sender, .. } if performative == "request" && sender == "planner").then_some(r.t));
    assert!((2390..=2410).contains(&asked.len()), "{}", asked.len());
}

/// Two of four agents refuse at once: the plan that the first refusal leads to hears of the second.
#[test]
fn a_refusal_counts_after_a_new_plan() {
    let ran = run(r#"
edition 1
plan p for go_there { needs fly, look }
agent f1 { offers fly when ok state ok = false service fly every 100 ms { note "f1" } }
agent f2 { offers fly service fly every 100 ms { note "f2" when now > 4 s => achieve } }
agent l1 { offers look when ok state ok = false service look every 100 ms { note "l1" } }
agent l2 { offers look service look every 100 ms { note "l2" when now > 4 s => achieve } }
mission outing {
  host h runs f1, f2, l1, l2
  goal arrive { subgoal go_there }
  within 8 s
  expect h.l2.look.activations > 1
}
"#);
    ran.check_records();
    assert_eq!(ran.report.outcome.name(), "success");
    assert_eq!(ran.report.expectations[0].held, Some(true));
}

/// A plan changes while a request is under way: what is not wanted any more never runs.
#[test]
fn what_is_taken_back_on_its_way_does_not_start() {
    let ran = run(r#"
edition 1
param alt: Bool = false
record W { n: Int }
plan p2 for go_there when alt { needs fly }
plan p1 for go_there { needs walk }
plan p3 for idle_goal { needs sit }
agent o { service go every 50 s after 1 s { pursue g tell s2 inform W(n: 1) } }
agent s2 { service got on inform W(w) { note "set" set alt = true } }
agent a { offers walk state n = 0 service walk every 1 s { set n = n + 1 note "a walks" } }
agent b { offers fly service fly every 1 s { note "f" when now > 10 s => achieve } }
agent z { offers sit service sit every 1 s { when now > 18 s => achieve } }
mission outing { host h runs o, a, b, s2, z goal main { subgoal idle_goal } goal g on request { subgoal go_there } within 20 s }
"#);
    ran.check_records();
    assert!(!ran.notes().iter().any(|(_, n)| n.contains("a walks")), "{:?}", ran.notes());
}

/// What is achieved at the instant at which the parameter changes is achieved.
#[test]
fn an_achievement_outlives_a_new_plan() {
    let ran = run(r#"
edition 1
param alt: Bool = false
plan p1 for go_there { needs walk }
plan p2 for go_there when alt { needs fly }
agent a { offers walk state said = false service walk every 1 s { when now > 1500 ms and not said => { set said = true set alt = true achieve } } }
agent b { offers fly service fly every 1 s { note "never needed" } }
mission outing { host h runs a, b goal arrive { subgoal go_there } within 20 s }
"#);
    ran.check_records();
    assert_eq!(ran.report.outcome.name(), "success");
}

/// A goal with a sub-goal that is allocated is not achieved before anybody has been asked.
#[test]
fn nothing_is_achieved_before_it_is_allocated() {
    let ran = run(r#"
edition 1
plan p for go_there { needs drive }
agent clerk { state ready = true service look every 1 s { note "x" } }
agent driver { offers drive service drive every 100 ms { when now > 4 s => achieve } }
mission outing {
  host h runs clerk, driver
  goal arrive { subgoal a by clerk achieved when ready subgoal go_there }
  within 30 s
  expect h.driver.drive.activations > 1
}
"#);
    ran.check_records();
    assert_eq!(ran.report.outcome.name(), "success");
    assert_eq!(ran.report.expectations[0].held, Some(true));
}

/// The directory is asked meanwhile.
#[test]
fn a_parameter_set_at_the_first_instant_chooses_the_plan() {
    let ran = run(r#"
edition 1
param windy: Bool = false
plan by_wheels for go_there when not windy { needs drive }
plan on_foot for go_there { needs walk }
agent weather { service look every 1 s { when now < 500 ms => set windy = true } }
agent driver { offers drive service drive every 100 ms { when now > 4 s => achieve } }
agent walker { offers walk service walk every 100 ms { when now > 4 s => achieve } }
mission outing {
  host h runs weather, driver, walker
  goal arrive { subgoal go_there }
  within 30 s
  expect h.driver.drive.activations < 1
}
"#);
    ran.check_records();
    assert_eq!(ran.report.outcome.name(), "success");
    assert_eq!(ran.report.expectations[0].held, Some(true));
}

/// It serves the sub-goal that names it.
#[test]
fn an_agent_that_is_named_is_not_allocated_after_a_restart() {
    let ran = run(r#"
edition 1
plan p for go_there { needs walk }
agent a restart 9 within 1 s { offers walk state k = 0 state ok = false
  service job every 100 ms { note "job" set ok = now > 9 s } 
  service walk every 100 ms { note "a walks" when now > 8 s => achieve }
  service bad every 10 s after 4 s { note "x", 1 / k } }
agent b { offers walk service walk every 100 ms { note "b walks" } }
mission m { host h runs a, b goal g { subgoal s by a achieved when ok } goal g2 { subgoal go_there } fault = kill(agent: "b", at: 2 s) within 20 s }
"#);
    ran.check_records();
    assert!(!ran.notes().iter().any(|(_, n)| n.contains("a walks")), "{:?}", ran.notes());
}

/// Also by an agent that offers a service as well.
#[test]
fn conversations_are_offered_again_after_a_restart() {
    let ran = run(r#"
edition 1
record Word { number: Int }
protocol ask<Say> { state start { initiator request Say -> asked } state asked { participant inform Say -> done after 500 ms -> done } state done }
conversation talk: ask<Word> = channel()
plan p for go_there { needs walk }
agent asker { state heard = 0 state n = 0
  service go every 1 s { set n = offering(talk).count(x => true) note "offering", offering(talk).count(x => true) open talk request Word(number: 1) to offering(talk) }
  service hear on talk inform(w) { set heard = heard + 1 } }
agent both restart 3 within 1 s { offers talk offers walk state k = 0
  service answer on talk request(w) { reply inform Word(number: w.number + 1) }
  service walk every 100 ms { note "walk" }
  service bad every 1 s { when now > 2500 ms and now < 3500 ms => note "x", 1 / k } }
mission m { host h runs asker, both
  goal g { subgoal go_there } within 8 s }
"#);
    ran.check_records();
    let offering: Vec<_> = ran.notes().into_iter().filter(|(_, n)| n.starts_with("offering")).collect();
    assert!(offering.iter().all(|(_, n)| n == "offering: 1"), "{offering:?}");
}

/// It needs two services of one agent for two sub-goals.
#[test]
fn a_goal_that_is_refused_disturbs_nobody() {
    let ran = run(r#"
edition 1
plan p1 for m1 { needs u }
plan p2 for e1 { needs v }
plan p3 for e2 { needs w }
agent y { offers u offers v offers w state n = 0 service u every 1 s { set n = n + 1 note "y.u" when n > 8 => achieve } service v every 1 s { note "v" } service w every 1 s { note "w" } }
agent x { offers u state n = 0 service u every 1 s { set n = n + 1 note "x.u" when n > 8 => achieve } }
mission m { host h runs y, x goal g { subgoal m1 } goal req on request { subgoal e1 subgoal e2 } fault = post(goal: "req", at: 4500 ms) done when achieved(g) within 30 s }
"#);
    ran.check_records();
    assert!(!ran.notes().iter().any(|(_, n)| n.contains("x.u")), "{:?}", ran.notes());
}

/// And is refused when it cannot be served.
#[test]
fn a_goal_asked_for_at_the_first_instant_waits_for_the_directory() {
    let ran = run(r#"
edition 1
plan p1 for extra { needs walk }
plan p2 for go_there { needs walk }
agent a { offers walk service walk every 100 ms { when now > 3 s => achieve } }
mission m { host h runs a goal g1 on request { subgoal extra } goal g2 { subgoal go_there } fault = post(goal: "g1", at: 0 s) within 10 s }
"#);
    ran.check_records();
    let refused = |r: &Record| matches!(&r.event, Event::Acl { performative, receiver, .. } if performative == "refuse" && receiver == "operator");
    assert_eq!(ran.records.iter().filter(|r| refused(r)).count(), 1);
    assert_eq!(ran.report.outcome.name(), "success");
}

/// Deadlines missed in a row are counted anew, and the core is free.
#[test]
fn a_core_goes_on_after_the_death_of_its_agent() {
    let ran = run(r#"
edition 1
agent a restart 9 within 1 s { state n = 0
  service hog every 100 ms worst 60 ms priority 2 core 0 { set n = n + 1 }
  service late every 100 ms worst 60 ms deadline 100 ms misses 3 priority 1 core 0 { set n = n + 1 } }
agent c { state ok = false service x every 4 s { set ok = now > 3 s } }
mission m { host h runs a, c goal g { subgoal s by c achieved when ok } within 40 s }
"#);
    ran.check_records();
    let deaths =
        ran.all(|r| matches!(&r.event, Event::Life { status, .. } if status == "dead").then_some(r.t));
    let last = ran.all(|r| matches!(&r.event, Event::Activation { .. }).then_some(r.t)).into_iter().max();
    assert!(last.is_some_and(|t| t.seconds() > ran.report.sim_time_s - 1.0), "{last:?} {deaths:?}");
}

/// A unit that misses its last deadline takes its agent with it.
#[test]
fn the_dead_send_nothing() {
    let ran = run(r#"
edition 1
param p: Int = 0
agent a restart 0 within 1 s { event e state k = 0
  service t1 every 10 s after 1 s { raise e }
  service t2 every 10 s after 1001 ms { raise e }
  service slow on event e worst 30 ms deadline 40 ms misses 0 { set p = p + 1 tell c inform W(n: p) note "slow" } }
record W { n: Int }
agent c { state ok = false service x every 1 s { set ok = now > 3 s } service got on inform W(w) { note "got", w.n } }
mission m { host h runs a, c goal g { subgoal s by c achieved when ok } within 20 s metric pp = p }
"#);
    ran.check_records();
    let dead =
        ran.records.iter().position(|r| matches!(&r.event, Event::Life { status, .. } if status == "dead"));
    let dead = dead.expect("a death");
    let who = match &ran.records[dead].event {
        Event::Life { agent, .. } => agent.clone(),
        _ => String::new(),
    };
    let speaks = |r: &Record| match &r.event {
        Event::Param { agent, .. } => *agent == who,
        Event::Acl { sender, performative, .. } => *sender == who && performative == "inform",
        _ => false,
    };
    assert!(!ran.records[dead..].iter().any(speaks));
}

/// A goal that has been achieved can be asked for once more.
#[test]
fn a_goal_on_request_is_pursued_as_often_as_it_is_asked_for() {
    let ran = run(r#"
edition 1
plan p for extra { needs work }
agent worker {
  offers work
  state n: Int = 0
  service work every 100 ms { set n = n + 1 when modulo(1 * n, 5) == 0 => achieve }
}
agent boss { service ask every 2 s after 1 s { pursue more } }
mission m {
  host h runs worker, boss
  goal more on request { subgoal extra }
  done when now > 4500 ms
  within 5 s
}
"#);
    ran.check_records();
    let agreed = |r: &Record| matches!(&r.event, Event::Acl { performative, receiver, .. } if performative == "agree" && receiver == "boss@h");
    assert_eq!(ran.records.iter().filter(|r| agreed(r)).count(), 2);
    let starts = |r: &Record| matches!(&r.event, Event::Service { running: true, .. });
    assert_eq!(ran.records.iter().filter(|r| starts(r)).count(), 2);
}
