//! Programs that do not do what the protocol would let them.

use super::{Named, protocol};
use crate::conversation::Role;

fn request() -> Named {
    protocol("idle: I request requested\n requested: P inform done, P refuse refused")
}

fn call() -> Named {
    protocol("idle: I call talking\n talking: I ask asked, P offer offered")
}

#[test]
fn a_silent_participant_is_waited_for() {
    let n = request();
    let mut parties = n.willing();
    parties[Role::Participant.index()].silent[n.at("requested")] = true;
    assert_eq!(
        n.findings_of(&parties),
        ["stuck I in requested (OthersTurn) inform refuse P in requested (Chosen) | I!request P?request"]
    );
    // Not when the initiator has a time-out.
    let n = protocol("idle: I request requested\n requested: P inform done, after done");
    let mut parties = n.willing();
    parties[Role::Participant.index()].silent[n.at("requested")] = true;
    assert_eq!(n.findings_of(&parties), ["stuck P in requested (Chosen) | I!request I~requested P?request"]);
}

#[test]
fn a_program_that_can_make_no_move_is_stuck() {
    let n = request();
    let mut parties = n.willing();
    parties[Role::Participant.index()].can[n.at("requested")].clear();
    assert_eq!(
        n.findings_of(&parties),
        ["stuck I in requested (OthersTurn) inform refuse P in requested (Unable) | I!request P?request"]
    );
    // One of two moves is enough.
    let mut parties = n.willing();
    parties[Role::Participant.index()].can[n.at("requested")].pop();
    assert!(n.findings_of(&parties).is_empty());
}

#[test]
fn each_waits_for_the_other() {
    let n = call();
    let mut parties = n.willing();
    for p in &mut parties {
        p.can[n.at("talking")].clear();
    }
    assert_eq!(
        n.findings_of(&parties),
        ["stuck I in talking (Unable) offer P in talking (Unable) ask | I!call P?call"]
    );
}

#[test]
fn a_conversation_that_nobody_can_begin_is_stuck() {
    let n = request();
    let mut parties = n.willing();
    parties[Role::Initiator.index()].can[n.at("idle")].clear();
    assert_eq!(n.findings_of(&parties), ["stuck I in idle (Unable) P in idle (OthersTurn) request |"]);
}

#[test]
fn where_both_may_speak_they_may_speak_at_once() {
    // Each has ended when the other's message comes: it is dropped, as a late reply is.
    assert_eq!(call().findings(1, false), [""; 0]);
    let n = protocol(
        "idle: I call talking
         talking: I ask asked, P offer offered
         asked: P answer over
         offered: I take over",
    );
    assert_eq!(
        n.findings(1, false),
        [
            "unexpected offer at I in asked | I!call P?call I!ask P!offer",
            "unexpected ask at P in offered | I!call P?call I!ask P!offer",
            "stuck I in asked (OthersTurn) answer not offer P in offered (OthersTurn) take not ask \
             | I!call P?call I!ask P!offer",
        ]
    );
}
