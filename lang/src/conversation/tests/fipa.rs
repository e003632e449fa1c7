//! FIPA interaction protocols, between two parties.

use super::{Named, protocol};

const NONE: [&str; 0] = [];

fn request() -> Named {
    protocol(
        "idle: I request requested
         requested: P refuse refused, P not_understood refused, P failure failed, P agree agreed
         agreed: P inform done, P failure failed",
    )
}

/// Contract net between the initiator and one of its participants, with the states that have a time-out.
fn contract_net(timeouts: &[&str]) -> Named {
    let after = |state| if timeouts.contains(&state) { ", after expired" } else { "" };
    protocol(&format!(
        "idle: I cfp called
         called: P propose proposed, P refuse refused{}
         proposed: I accept_proposal accepted, I reject_proposal rejected{}
         accepted: P inform done, P failure failed{}",
        after("called"),
        after("proposed"),
        after("accepted")
    ))
}

/// Subscribe, with what else may come while the initiator waits for the end.
fn subscribe(cancelling: &str) -> Named {
    protocol(&format!(
        "idle: I subscribe asked
         asked: P refuse refused, P agree agreed
         agreed: P inform agreed, P failure failed, I cancel cancelling
         cancelling: P confirm over{cancelling}"
    ))
}

#[test]
fn request_cannot_get_stuck() {
    let n = request();
    assert_eq!(n.faults(), NONE);
    assert_eq!(n.findings(1, false), NONE);
    let e = n.explored(16, false);
    assert_eq!((e.most_under_way, e.blocked), ([1, 2], [false; 2]));
    let e = n.explored(1, false);
    assert_eq!((e.most_under_way, e.blocked), ([1, 1], [false, true]));
}

#[test]
fn query_cannot_get_stuck() {
    let n = protocol(
        "idle: I query_if asked_if, I query_ref asked_ref
         asked_if: P refuse refused, P agree agreed_if
         agreed_if: P inform_if done, P failure failed
         asked_ref: P refuse refused, P agree agreed_ref
         agreed_ref: P inform_ref done, P failure failed",
    );
    assert_eq!(n.faults(), NONE);
    assert_eq!(n.findings(2, false), NONE);
}

#[test]
fn a_lost_message_is_waited_for_without_a_timeout() {
    // Of the four the second is another fault, and the third what follows from it: see below.
    let found = request().findings(2, true);
    assert_eq!(
        [&found[0], &found[3]],
        [
            "stuck I in requested (OthersTurn) refuse not_understood failure agree | I!request P*request",
            "stuck I in agreed (OthersTurn) inform failure \
             | I!request P?request P!agree I?agree P!inform I*inform",
        ]
    );
    let patient = protocol(
        "idle: I request requested
         requested: P refuse refused, P failure failed, P agree agreed, after expired
         agreed: P inform done, P failure failed, after expired",
    );
    // The agreement is lost: what follows it has no meaning for who has not agreed.
    assert_eq!(
        patient.findings(2, true),
        ["unexpected inform at I in requested | I!request P?request P!agree I*agree P!inform"]
    );
    let direct =
        protocol("idle: I request requested\n requested: P inform done, P failure failed, after expired");
    assert_eq!(direct.findings(2, true), NONE);
}

#[test]
fn a_cancel_crosses_what_is_under_way() {
    assert_eq!(
        subscribe("").findings(2, false)[..2],
        [
            "unexpected inform at I in cancelling \
             | I!subscribe P?subscribe P!agree I?agree I!cancel P!inform",
            "unexpected failure at I in cancelling \
             | I!subscribe P?subscribe P!agree I?agree I!cancel P!failure",
        ]
    );
    let n = subscribe(", P inform cancelling, P failure failed");
    assert_eq!(n.faults(), NONE);
    for capacity in [1, 2, 16] {
        assert_eq!(n.findings(capacity, false), NONE);
        let e = n.explored(capacity, false);
        assert_eq!((e.most_under_way, e.blocked[1]), ([1, capacity], true));
    }
}

#[test]
fn a_contract_net_in_which_nothing_is_lost_needs_no_timeout() {
    let n = contract_net(&[]);
    assert_eq!(n.faults(), NONE);
    assert_eq!(n.findings(1, false), NONE);
}

#[test]
fn a_timeout_of_one_leaves_the_other_waiting() {
    assert_eq!(
        contract_net(&["called"]).findings(2, false),
        ["stuck P in proposed (OthersTurn) accept_proposal reject_proposal \
             | I!cfp I~called P?cfp P!propose I-propose"]
    );
    // The participant gives up before the acceptance arrives.
    assert_eq!(
        contract_net(&["called", "proposed"]).findings(2, false),
        ["stuck I in accepted (OthersTurn) inform failure \
             | I!cfp P?cfp P!propose I?propose I!accept_proposal P~proposed P-accept_proposal"]
    );
    assert_eq!(contract_net(&["called", "proposed", "accepted"]).findings(2, false), NONE);
}

#[test]
fn with_timeouts_everywhere_messages_may_be_lost() {
    let all = ["called", "proposed", "accepted"];
    assert_eq!(contract_net(&all).findings(2, true), NONE);
    for forgotten in all {
        let others: Vec<&str> = all.into_iter().filter(|s| *s != forgotten).collect();
        let found = contract_net(&others).findings(2, true);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains(&format!(" in {forgotten} (OthersTurn)")), "{found:?}");
    }
}

#[test]
fn who_never_heard_of_a_conversation_does_not_wait() {
    let n = protocol("idle: I inform done");
    assert_eq!(n.findings(1, true), NONE);
    // Coming back to the first state is another matter: who is there again waits for what was promised.
    let n = protocol("idle: I ping asked, I bye over\n asked: P pong idle, after over");
    assert_eq!(
        n.findings(1, false),
        ["stuck P in idle (OthersTurn) ping bye | I!ping I~asked P?ping P!pong I-pong"]
    );
}
