//! Sub-goals that the planner-matcher finds agents for, before anything happens and again when something does.

use crate::support::{Ran, run};
use soifra_runtime::Event;

/// Two watchers on hosts and one who lists; `extra` goes into the mission, `when` after the watchers' offer.
fn guarded(header: &str, when: &str, extra: &str) -> Ran {
    run(&format!(
        r#"
edition 1
param tired: Bool = false
plan by_eye for look when not tired {{ needs watch }}
plan by_ear for look {{ needs listen }}
plan tell_it for report {{ needs speak }}
agent watcher {header} {{
  offers watch {when}
  state strength: Int = 3
  state seen: Int = 0
  service watch every 10 ms {{
    set seen = seen + 1
    when strength > 0 => set strength = strength - 1
    note "watch", seen
  }}
}}
agent listener {{
  offers listen
  state heard: Int = 0
  service listen every 10 ms {{ set heard = heard + 1 note "listen", heard }}
}}
agent speaker collaborative {{
  offers speak
  service speak every 10 ms {{ note "speak" }}
}}
agent boss {{
  state asked: Bool = false
  service command every 35 ms {{
    when not asked => {{ set asked = true }}
  }}
}}
mission m {{
  host north runs watcher
  host south runs watcher
  host east runs listener, speaker, boss
  goal safety {{ subgoal look }}
  goal news on request {{ subgoal report }}
  done when now >= 100 ms
  within 200 ms
  {extra}
}}
"#
    ))
}

fn notes(ran: &Ran) -> Vec<String> {
    ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect()
}

/// What planner, directory and agents say: performative, sender, receiver, content and reason.
fn said(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Acl { performative, sender, receiver, content, reason, .. } => {
            let content = content.as_deref().unwrap_or_default();
            let reason = reason.as_ref().map_or(String::new(), |why| format!(": {why}"));
            Some(format!("{performative} {sender} {receiver} {content}{reason}"))
        }
        _ => None,
    })
}

/// How sub-goals and goals stand, and when.
fn standing(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Goal { goal, status, reason, .. } => {
            let reason = reason.as_ref().map_or(String::new(), |why| format!(": {why}"));
            Some(format!("{} {goal} {status}{reason}", r.t.0 / 1_000_000))
        }
        _ => None,
    })
}

/// Which services start and stop, and when.
fn services(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Service { agent, service, running, .. } => {
            let sign = if *running { '+' } else { '-' };
            Some(format!("{} {sign}{agent}.{service}", r.t.0 / 1_000_000))
        }
        _ => None,
    })
}

#[test]
fn registration_query_request_agreement() {
    let ran = guarded("", "", "");
    ran.check_records();
    let expected = [
        "request watcher@north df register watch",
        "request watcher@south df register watch",
        "request listener@east df register listen",
        "request speaker@east df register speak",
        "query_ref planner df listen",
        "query_ref planner df speak",
        "query_ref planner df watch",
        "inform df watcher@north registered watch",
        "inform df watcher@south registered watch",
        "inform df listener@east registered listen",
        "inform df speaker@east registered speak",
        "inform_ref df planner listen: listener@east",
        "inform_ref df planner speak: speaker@east",
        "inform_ref df planner watch: watcher@north, watcher@south",
        "request planner watcher@north watch for look",
        "agree watcher@north planner look",
    ];
    assert_eq!(said(&ran), expected);
    assert_eq!(services(&ran), ["0 +watcher@north.watch"]);
    assert_eq!(standing(&ran), ["0 look active: allocated to watcher@north"]);
    assert_eq!(notes(&ran)[..2], ["10 watch: 1", "20 watch: 2"]);
    assert_eq!(notes(&ran).len(), 10);
}

#[test]
fn who_dies_is_replaced_while_anybody_is_capable() {
    let kill = |who: &str, ms: u32| format!("fault = kill(agent: \"{who}\", at: {ms} ms)\n");
    let one = kill("watcher@north", 25);
    let ran = guarded("", "", &one);
    ran.check_records();
    assert_eq!(services(&ran), ["0 +watcher@north.watch", "25 +watcher@south.watch"]);
    assert_eq!(notes(&ran)[..4], ["10 watch: 1", "20 watch: 2", "30 watch: 1", "40 watch: 2"]);
    let new = said(&ran)[16..].to_vec();
    let expected = [
        "request ams df deregister watcher@north",
        "inform_ref df planner watcher@north: gone",
        "request planner watcher@south watch for look",
        "agree watcher@south planner look",
    ];
    assert_eq!(new, expected);

    let all = one + &kill("watcher@south", 45) + &kill("listener@east", 65);
    let ran = guarded("", "", &all);
    ran.check_records();
    let running = ["0 +watcher@north.watch", "25 +watcher@south.watch", "45 +listener@east.listen"];
    assert_eq!(services(&ran), running);
    assert_eq!(standing(&ran).last().map(String::as_str), Some("65 safety failed"));
    let why = "65 look failed: no agent: watcher@north, watcher@south, listener@east dead";
    assert!(standing(&ran).contains(&why.to_string()), "{:?}", standing(&ran));
}

#[test]
fn an_agent_that_is_started_again_serves_again() {
    let ran = guarded("restart 2 within 1 s", "", "fault = kill(agent: \"watcher@north\", at: 25 ms)");
    // A declared fault kills for good.
    assert_eq!(services(&ran), ["0 +watcher@north.watch", "25 +watcher@south.watch"]);
}

/// A watcher that fails when it has seen so much.
fn failing(header: &str, others: &str) -> Ran {
    run(&format!(
        r#"
edition 1
plan by_eye for look {{ needs watch }}
agent watcher {header} {{
  offers watch
  state seen: Int = 0
  service watch every 10 ms {{
    set seen = seen + 1
    note "seen", 10 / (3 - seen)
  }}
  service live every 10 ms {{ note "alive", seen }}
}}
mission m {{
  host north runs watcher
  {others}
  goal safety {{ subgoal look }}
  done when now >= 100 ms
  within 200 ms
}}
"#
    ))
}

fn lives(ran: &Ran) -> Vec<String> {
    ran.all(|r| match &r.event {
        Event::Life { agent, status, .. } => Some(format!("{} {agent} {status}", r.t.0 / 1_000_000)),
        _ => None,
    })
}

#[test]
fn a_supervised_agent_is_started_again_and_then_given_up() {
    let ran = failing("restart 1 within 1 s", "host south runs watcher");
    ran.check_records();
    let expected = [
        "30 watcher@north dead",
        "30 watcher@north restarted",
        // Its place has been taken by then.
        "60 watcher@south dead",
        "60 watcher@south restarted",
        "90 watcher@north dead",
    ];
    assert_eq!(lives(&ran), expected);
    assert_eq!(ran.report.outcome.name(), "success");
    assert_eq!(ran.report.faults.iter().map(|f| f.times).sum::<u32>(), 3);
    assert!(standing(&ran).iter().all(|s| !s.contains("failed")), "{:?}", standing(&ran));
}

#[test]
fn without_supervision_a_fault_ends_the_run() {
    let ran = failing("", "host south runs watcher");
    assert_eq!(ran.report.outcome.name(), "aborted");
    assert_eq!(lives(&ran).len(), 0);
}

#[test]
fn a_restart_forgets_what_was_known() {
    let ran = failing("restart 5 within 1 s", "");
    let alive: Vec<_> = notes(&ran).into_iter().filter(|n| n.contains("alive")).collect();
    // The first activation after the fault sees the initial state.
    assert_eq!(
        alive[..6],
        ["0 alive: 0", "10 alive: 1", "20 alive: 2", "40 alive: 1", "50 alive: 2", "70 alive: 1"]
    );
}

#[test]
fn an_agent_that_refuses_is_not_asked_for_a_while() {
    let ran = guarded("", "when strength > 2", "fault = kill(agent: \"listener@east\", at: 25 ms)");
    // Nobody refuses at the start.
    assert_eq!(services(&ran), ["0 +watcher@north.watch"]);
    let ran = guarded("", "when strength > 3", "");
    let refused = said(&ran).into_iter().filter(|s| s.starts_with("refuse")).collect::<Vec<_>>();
    let expected = [
        "refuse watcher@north planner look: it does not hold: strength > 3",
        "refuse watcher@south planner look: it does not hold: strength > 3",
    ];
    assert_eq!(refused, expected);
    assert_eq!(services(&ran), ["0 +listener@east.listen"]);
}

#[test]
fn plans_are_chosen_by_the_state_of_parameters() {
    let ran = run(r#"
edition 1
param tired: Bool = false
plan by_eye for look when not tired { needs watch }
plan by_ear for look when tired { needs listen }
plan daily for safety when not tired { subgoal look }
plan nightly for safety when tired { subgoal look subgoal rest }
plan sleep for rest { needs doze }
agent watcher {
  offers watch
  service watch every 10 ms { note "watch" when now >= 25 ms => set tired = true }
}
agent listener collaborative {
  offers listen
  offers doze
  service listen every 10 ms { note "listen" when now >= 55 ms => set tired = false }
  service doze every 10 ms { note "doze" }
}
agent clerk {
  service hear on param tired { note "tired", tired }
}
mission m {
  host h runs watcher, listener, clerk
  goal safety
  done when now >= 85 ms
  within 200 ms
}
"#);
    ran.check_records();
    let expected = [
        "0 +watcher@h.watch",
        "30 -watcher@h.watch",
        "30 +listener@h.listen",
        "30 +listener@h.doze",
        "60 -listener@h.doze",
        "60 -listener@h.listen",
        "60 +watcher@h.watch",
        "70 -watcher@h.watch",
    ];
    let got = services(&ran);
    let mut sorted = got[..8].to_vec();
    sorted.sort();
    let mut wanted = expected.map(str::to_string).to_vec();
    wanted.sort();
    assert_eq!(sorted, wanted, "{got:?}");
    assert!(notes(&ran).contains(&"30 tired: true".to_string()), "{:?}", notes(&ran));
}

#[test]
fn the_three_refusals_at_run_time() {
    // No plan: a goal that nobody knows is asked for by a message.
    let ran = guarded("", "", "fault = post(goal: \"fetch_coffee\", at: 50 ms)");
    let last = said(&ran).into_iter().next_back();
    assert_eq!(
        last.as_deref(),
        Some("refuse planner operator achieve fetch_coffee: no plan: there is no goal fetch_coffee")
    );
    // A goal on request that there is a plan for.
    let ran = guarded("", "", "fault = post(goal: \"news\", at: 50 ms)");
    assert!(said(&ran).contains(&"agree planner operator achieve news".to_string()));
    assert_eq!(services(&ran).last().map(String::as_str), Some("50 +speaker@east.speak"));
    // No agent: whoever could do it is dead.
    let faults = "fault = kill(agent: \"speaker\", at: 20 ms) fault = post(goal: \"news\", at: 50 ms)";
    let ran = guarded("", "", faults);
    assert!(
        said(&ran).contains(&"refuse planner operator achieve news: no agent: speaker@east dead".to_string()),
        "{:#?}",
        said(&ran)
    );
    // Not available: after a death, two sub-goals want the one who is left.
    let ran = run(r#"
edition 1
plan by_eye for look { needs watch }
plan by_nose for smell { needs watch }
agent watcher { offers watch service watch every 10 ms { note "watch" } }
mission m {
  host north runs watcher
  host south runs watcher
  goal a { subgoal look }
  goal b { subgoal smell }
  done when now >= 90 ms
  within 200 ms
  fault = kill(agent: "watcher@south", at: 50 ms)
}
"#);
    ran.check_records();
    let failed: Vec<_> = standing(&ran).into_iter().filter(|s| s.contains("smell failed")).collect();
    assert_eq!(failed, ["50 smell failed: capable agents are not available: watcher@north serves look"]);
}

#[test]
fn agents_say_what_is_achieved_and_what_cannot_be() {
    let ran = run(r#"
edition 1
plan first for one { needs work }
plan second for two { needs work }
agent worker(skill: Int) {
  offers work
  state done: Int = 0
  service work every 10 ms {
    set done = done + 1
    when done == 2 and skill == 0 => fail "too hard"
    when done == 3 => { set done = 0 achieve }
  }
}
mission m {
  host clumsy runs worker(skill: 0)
  host able runs worker(skill: 1)
  host handy runs worker(skill: 2)
  goal all { subgoal one subgoal two }
  within 200 ms
}
"#);
    ran.check_records();
    assert_eq!(ran.report.outcome.name(), "success");
    let told: Vec<_> =
        said(&ran).into_iter().filter(|s| s.starts_with("failure") || s.starts_with("inform w")).collect();
    assert_eq!(told[0], "failure worker@clumsy planner one: too hard");
    assert_eq!(
        told[1..],
        ["inform worker@able planner two: achieved", "inform worker@handy planner one: achieved"]
    );
    let ends = standing(&ran);
    assert!(
        ends.contains(&"30 two achieved".into()) && ends.last().unwrap().ends_with("all achieved"),
        "{ends:?}"
    );
}

#[test]
fn services_are_started_and_stopped_by_their_agent() {
    let ran = run(r#"
edition 1
agent clerk {
  state ticks: Int = 0
  service tick every 10 ms {
    set ticks = ticks + 1
    when ticks == 2 => start extra
    when ticks == 5 => stop extra
    when ticks == 7 => start extra
  }
  service extra every 10 ms stopped { note "extra", ticks }
}
mission m {
  host h runs clerk
  goal g { subgoal s by clerk achieved when ticks >= 9 }
  within 200 ms
}
"#);
    ran.check_records();
    let expected = ["20 extra: 3", "30 extra: 4", "40 extra: 5", "70 extra: 8", "80 extra: 9"];
    assert_eq!(notes(&ran), expected);
}

#[test]
fn a_collaborative_agent_serves_several_and_an_exclusive_one_is_free_again() {
    let text = |kind: &str| {
        format!(
            r#"
edition 1
plan p for one {{ needs work }}
plan q for two {{ needs work }}
agent worker {kind} {{
  offers work
  state n: Int = 0
  service work every 10 ms {{ set n = n + 1 note "work", n when n == 5 => achieve }}
}}
mission m {{
  host h runs worker
  goal a {{ subgoal one }}
  goal b on request {{ subgoal two }}
  done when now >= 90 ms
  within 200 ms
  fault = post(goal: "b", at: 25 ms)
  fault = post(goal: "b", at: 75 ms)
}}
"#
        )
    };
    // What has been achieved, which it is at 50 ms, can be asked for again.
    let ran = run(&text("collaborative"));
    let agreed = said(&ran)
        .into_iter()
        .filter(|s| s.contains("achieve b") && s.contains("planner operator"))
        .collect::<Vec<_>>();
    assert_eq!(agreed, ["agree planner operator achieve b", "agree planner operator achieve b"]);
    let ran = run(&text("exclusive"));
    let agreed = said(&ran)
        .into_iter()
        .filter(|s| s.contains("achieve b") && s.contains("planner operator"))
        .collect::<Vec<_>>();
    let busy = "refuse planner operator achieve b: capable agents are not available: worker@h serves one";
    assert_eq!(agreed, [busy, "agree planner operator achieve b"]);
}

#[test]
fn offers_are_withdrawn_and_made_again() {
    let ran = run(r#"
edition 1
plan p for look { needs watch }
agent watcher(shy: Bool) {
  offers watch
  state n: Int = 0
  service watch every 10 ms { note "watch" }
  service mind every 10 ms {
    set n = n + 1
    when shy and n == 3 => withdraw watch
    when shy and n == 7 => offer watch
  }
}
mission m {
  host north runs watcher(shy: true)
  host south runs watcher(shy: false)
  goal a { subgoal look }
  done when now >= 90 ms
  within 200 ms
  fault = kill(agent: "watcher@south", at: 45 ms)
}
"#);
    ran.check_records();
    let expected = [
        "0 +watcher@north.watch",
        "20 -watcher@north.watch",
        "20 +watcher@south.watch",
        // South is dead, and north offers it again from 60 ms on.
        "60 +watcher@north.watch",
    ];
    let mut got = services(&ran);
    got.sort();
    let mut wanted = expected.map(str::to_string).to_vec();
    wanted.sort();
    assert_eq!(got, wanted);
    assert!(standing(&ran).iter().any(|s| s.starts_with("45 look failed")), "{:?}", standing(&ran));
    assert!(said(&ran).contains(&"request watcher@north df withdraw watch".to_string()));
}
