//! Mistakes that a protocol's states tell.

use super::protocol;
use crate::conversation::{Fault, Move, Protocol, Role, State, faults};
use proptest::prelude::*;

#[test]
fn a_protocol_without_states_says_nothing() {
    assert!(faults(&Protocol::default()).is_empty());
}

#[test]
fn each_mistake_is_told() {
    let n = protocol(
        "idle: I go on, I go off, P go on, I go idle
         on: P tick on
         lost: P found off",
    );
    assert_eq!(n.faults(), ["lost is not reached", "on does not end", "I says go twice in idle"]);
}

#[test]
fn a_target_that_is_no_state_ends() {
    let moves = vec![Move { by: Role::Initiator, message: 0, target: 7 }];
    let p = Protocol { states: vec![State { moves, timeout: Some(u32::MAX) }] };
    assert!(faults(&p).is_empty());
}

#[test]
fn timeouts_in_a_ring_are_a_livelock_of_who_holds_them_all() {
    assert_eq!(protocol("idle: I go wait\n wait: P answer over, after wait").faults(), ["I in wait"]);
    assert_eq!(
        protocol(
            "idle: I go a
             a: P answer over, after b
             b: P answer over, after c
             c: P answer over, I stop over, after a"
        )
        .faults(),
        ["I in a b c"]
    );
    assert_eq!(protocol("idle: I go over, after a\n a: after b\n b: after a").faults()[2..], ["IP in a b"]);
    // Entered in the middle.
    assert_eq!(
        protocol("idle: I go over, after b\n a: after b\n b: after a").faults(),
        ["a does not end", "b does not end", "IP in a b"]
    );
    // Each comes to a state in which only it may send.
    assert!(protocol("idle: I go over, after a\n a: P go over, after idle").faults().is_empty());
    // Asking again is no ring of time-outs.
    assert!(protocol("idle: I ask asked\n asked: P answer over, after idle").faults().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Against the reachability of every state from every other.
    #[test]
    fn states_are_reached_and_end_as_their_closure_says(p in super::random::protocols()) {
        let count = p.states.len();
        let mut leads = vec![vec![false; count]; count];
        for (from, s) in p.states.iter().enumerate() {
            leads[from][from] = true;
            for to in s.moves.iter().map(|m| m.target).chain(s.timeout) {
                leads[from][to as usize] = true;
            }
        }
        for via in 0..count {
            for from in 0..count {
                for to in 0..count {
                    leads[from][to] |= leads[from][via] && leads[via][to];
                }
            }
        }
        let ends = |i: usize| (0..count).any(|f| leads[i][f] && p.is_final(f as u32));
        let mut expected = Vec::new();
        let each = || 0..count as u32;
        expected.extend(each().filter(|s| !leads[0][*s as usize]).map(|state| Fault::Unreachable { state }));
        expected.extend(each().filter(|s| !ends(*s as usize)).map(|state| Fault::Endless { state }));
        let found: Vec<Fault> = faults(&p)
            .into_iter()
            .filter(|f| matches!(f, Fault::Unreachable { .. } | Fault::Endless { .. }))
            .collect();
        prop_assert_eq!(found, expected);
    }
}
