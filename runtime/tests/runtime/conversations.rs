//! Conversations: who gets the work, what comes too late, gets lost, or was never to be said.

use crate::support::{Ran, run};
use soifra_runtime::Event;

const RECORDS: &str = "
edition 1
import std.protocols
record Parcel { number: Int }
record Bid { cost: Int }
record Receipt { number: Int }
record Candidate { talk: Conversation<deliver>, cost: Int }
";

/// A dispatcher with three couriers that ask 7, 3 and 5 for their work.
fn contract_net(channel: &str, courier: &str) -> Ran {
    run(&format!(
        r#"{RECORDS}
conversation deliver: contract_net<Parcel, Bid, Receipt>(answer: 100 ms, award: 200 ms, work: 300 ms) = channel({channel})
agent dispatcher {{
  state bids: List<Candidate, 8> = []
  state number: Int = 0
  state done: Int = 0
  service announce every 1 s {{
    set number = number + 1
    set bids = []
    open deliver cfp Parcel(number: number) to offering(deliver)
  }}
  service collect on deliver propose(b) {{ set bids = bids.push(Candidate(talk: conversation, cost: b.cost)) }}
  service award on deliver settled {{
    note "settled", length(bids)
    when bids.min_by(b => b.cost) is some(best) => {{
      for b in bids {{
        if b.talk == best.talk {{ reply accept_proposal in b.talk }} else {{ reply reject_proposal in b.talk }}
      }}
    }}
  }}
  service received on deliver inform(r) {{ set done = done + 1 note "received", r.number }}
  service late on deliver timeout {{ note "late" }}
}}
agent courier(cost: Int) {{
  offers deliver
  state number: Int = 0
  service consider on deliver cfp(p) {{
    set number = p.number
    {courier}
  }}
  service deliver on deliver accept_proposal worst 50 ms {{
    note "won", cost
    reply inform Receipt(number: number)
  }}
}}
mission m {{
  host office runs dispatcher
  host one runs courier(cost: 7)
  host two runs courier(cost: 3)
  host three runs courier(cost: 5)
  goal g {{ subgoal s by dispatcher achieved when done >= 2 }}
  within 1900 ms
}}
"#
    ))
}

fn notes(ran: &Ran) -> Vec<String> {
    ran.notes().into_iter().map(|(t, s)| format!("{t} {s}")).collect()
}

/// Conversations that some side has not ended.
fn open_sides(ran: &Ran) -> usize {
    let mut open: Vec<(String, String)> = Vec::new();
    for r in &ran.records {
        let Event::Conversation { agent, conversation_id, over, .. } = &r.event else { continue };
        let key = (agent.clone(), conversation_id.clone());
        match over {
            true => {
                if let Some(i) = open.iter().position(|k| *k == key) {
                    open.swap_remove(i);
                }
            }
            false if !agent.starts_with("dispatcher") && !open.contains(&key) => open.push(key),
            false => {}
        }
    }
    open.len()
}

#[test]
fn the_cheapest_gets_the_work() {
    let ran = contract_net("delay: 10 ms", "reply propose Bid(cost: cost)");
    let won = [
        "20 settled: 3",
        "30 won: 3",
        "90 received: 1",
        "1020 settled: 3",
        "1030 won: 3",
        "1090 received: 2",
    ];
    assert_eq!(notes(&ran), won);
    assert_eq!(open_sides(&ran), 0);
    let said = ran.all(|r| match &r.event {
        Event::Acl { performative, sender, receiver, thread, .. } => {
            assert_eq!(thread.protocol.as_deref(), Some("contract_net"));
            assert_eq!(thread.ontology.as_deref(), Some("mission"));
            Some(format!("{} {performative} {sender} {receiver}", thread.conversation_id.as_ref().unwrap()))
        }
        _ => None,
    });
    assert_eq!(said.len(), 20);
    assert_eq!(said[0], "deliver/dispatcher@office/1 cfp dispatcher@office courier@one");
    assert_eq!(said[3], "deliver/dispatcher@office/1 propose courier@one dispatcher@office");
    assert_eq!(said[9], "deliver/dispatcher@office/1 inform courier@two dispatcher@office");
    assert_eq!(said[10], "deliver/dispatcher@office/2 cfp dispatcher@office courier@one");
    ran.check_records();
}

#[test]
fn an_answer_refers_to_what_it_answers() {
    let ran = contract_net("delay: 10 ms", "reply propose Bid(cost: cost)");
    let threads = ran.all(|r| match &r.event {
        Event::Acl { thread, performative, .. } => Some((performative.clone(), (**thread).clone())),
        _ => None,
    });
    for (performative, t) in &threads {
        assert!(t.reply_with.is_some());
        assert_eq!(t.in_reply_to.is_none(), performative == "cfp", "{performative}");
        if let Some(to) = &t.in_reply_to {
            assert!(threads.iter().any(|(_, o)| o.reply_with.as_ref() == Some(to)));
        }
    }
    let cfp = &threads[0].1;
    assert_eq!(cfp.reply_by.map(|t| t.0), Some(100_000_000), "the answers are waited for");
}

#[test]
fn who_refuses_is_not_waited_for() {
    let ran = contract_net(
        "delay: 10 ms",
        r#"if cost > 4 { reply refuse "too dear" } else { reply propose Bid(cost: cost) }"#,
    );
    assert_eq!(notes(&ran)[..2], ["20 settled: 1", "30 won: 3"]);
    let reasons = ran.all(|r| match &r.event {
        Event::Acl { reason: Some(why), sender, .. } => Some(format!("{sender} {why}")),
        _ => None,
    });
    assert_eq!(reasons[..2], ["courier@one too dear", "courier@three too dear"]);
}

#[test]
fn what_comes_after_the_time_is_dropped_and_everything_ends() {
    // Answers arrive after 160 ms, the dispatcher waits for 100.
    let ran = contract_net("delay: 80 ms", "reply propose Bid(cost: cost)");
    let got = notes(&ran);
    assert_eq!(got.iter().filter(|n| n.starts_with("100 late")).count(), 3, "{got:?}");
    assert!(got.contains(&"100 settled: 0".to_string()));
    assert!(!got.iter().any(|n| n.contains("received")));
    let dropped = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), topic, .. } => {
            Some(format!("{} {topic} {why}", r.t.0 / 1_000_000))
        }
        _ => None,
    });
    assert_eq!(dropped[0], "160 propose the conversation is over");
    // The couriers wait for an award that never comes: 200 ms from their proposals.
    assert_eq!(open_sides(&ran), 0);
    ran.check_records();
}

#[test]
fn lost_messages_leave_nobody_waiting() {
    let ran = contract_net("delay: 10 ms, loss: 40 %", "reply propose Bid(cost: cost)");
    let lost = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), .. } if why == "lost on the way" => Some(()),
        _ => None,
    });
    assert!(!lost.is_empty());
    assert_eq!(open_sides(&ran), 0);
    let all = contract_net("delay: 10 ms, loss: 100 %", "reply propose Bid(cost: cost)");
    assert_eq!(notes(&all).iter().filter(|n| n.ends_with("late")).count(), 6);
}

/// What the protocol does not have where the sender is, is not sent; nobody else is troubled.
#[test]
fn what_is_out_of_order_is_not_said() {
    let ran = contract_net(
        "delay: 10 ms",
        "reply propose Bid(cost: cost) reply propose Bid(cost: cost - 1) reply inform Receipt(number: 9)",
    );
    let unsaid = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), topic, agent, .. } if why.starts_with("not sent") => {
            Some(format!("{agent} {topic} {why}"))
        }
        _ => None,
    });
    assert_eq!(
        unsaid[0],
        "courier@one propose not sent: the participant does not say that in state proposed"
    );
    assert_eq!(unsaid[1], "courier@one inform not sent: the participant does not say that in state proposed");
    assert_eq!(notes(&ran)[..3], ["20 settled: 3", "30 won: 3", "90 received: 1"]);
}

/// A conversation that is over is not spoken in any more.
#[test]
fn a_conversation_that_is_over_stays_so() {
    let ran = run(&format!(
        r#"{RECORDS}
conversation ask: query<Parcel, Receipt>(answer: 100 ms)
agent asker {{
  state heard: Int = 0
  service ask every 1 s {{ open ask query_ref Parcel(number: 1) to offering(ask) }}
  service hear on ask inform(r) {{ set heard = r.number }}
}}
agent oracle {{
  offers ask
  state kept: Conversation<ask>? = none
  service answer on ask query_ref(p) {{ set kept = conversation reply inform Receipt(number: 5) }}
  service again every 300 ms after 200 ms {{ when kept is some(c) => reply inform Receipt(number: 6) in c }}
}}
mission m {{
  host a runs asker
  host b runs oracle
  goal g {{ subgoal s by asker achieved when heard > 5 }}
  within 900 ms
  expect a.asker.heard == 5
}}
"#
    ));
    let why = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), .. } => Some(why.clone()),
        _ => None,
    });
    assert_eq!(why, ["not sent: the conversation is over"; 3]);
    assert_eq!(ran.report.expectations[0].held, Some(true));
    ran.check_records();
}

#[test]
fn nobody_to_ask_is_settled_at_once() {
    let ran = run(&format!(
        r#"{RECORDS}
conversation ask: query<Parcel, Receipt>(answer: 100 ms)
agent asker {{
  state heard: Int = 0
  service ask every 1 s {{ open ask query_ref Parcel(number: 1) to offering(ask).filter(a => false) }}
  service over on ask settled {{ note "settled" }}
  service hear on ask inform(r) {{ set heard = r.number }}
}}
agent oracle {{
  offers ask
  service answer on ask query_ref(p) {{ reply inform Receipt(number: 5) }}
}}
mission m {{
  host a runs asker, oracle
  goal g {{ subgoal s by asker achieved when heard > 5 }}
  within 500 ms
}}
"#
    ));
    assert_eq!(notes(&ran), ["0 settled"]);
}

/// A mailbox is bounded: who floods loses his own oldest messages.
#[test]
fn a_flood_fills_a_mailbox_and_nothing_else() {
    let ran = run(&format!(
        r#"{RECORDS}
conversation ask: query<Parcel, Receipt>(answer: 5 s) = channel(capacity: 4)
agent asker {{
  state heard: Int = 0
  state asked: Int = 0
  service ask every 1 ms {{
    set asked = asked + 1
    open ask query_ref Parcel(number: asked) to offering(ask)
  }}
  service hear on ask inform(r) {{ set heard = heard + 1 }}
}}
agent oracle {{
  offers ask
  service answer on ask query_ref(p) worst 20 ms {{ reply inform Receipt(number: p.number) }}
}}
mission m {{
  host a runs asker
  host b runs oracle
  goal g {{ subgoal s by asker achieved when heard > 1000 }}
  within 210 ms
  expect a.asker.heard >= 9
}}
"#
    ));
    let full = ran.all(|r| match &r.event {
        Event::Delivery { dropped: Some(why), .. } if why == "the mailbox is full" => Some(()),
        _ => None,
    });
    assert!(full.len() > 150, "{}", full.len());
    assert_eq!(ran.report.expectations[0].held, Some(true));
}
