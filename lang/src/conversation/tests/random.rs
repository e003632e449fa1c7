//! Small protocols drawn at random, against the naive explorer: the same findings, with shortest witnesses.

use super::naive::{Model, Waits, World};
use crate::conversation::{
    Finding, MOST, Move, Party, Protocol, Queues, Role, Silence, State, Step, explore,
};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Protocols of up to four states and three messages; now and then with two moves of one kind.
pub fn protocols() -> impl Strategy<Value = Protocol> {
    (1..=4u32).prop_flat_map(|count| {
        let role = prop::bool::ANY.prop_map(|b| if b { Role::Initiator } else { Role::Participant });
        let step = (role, 0..3u32, 0..count).prop_map(|(by, message, target)| Move { by, message, target });
        let timeout = prop::option::weighted(0.3, 0..count);
        let state = (prop::collection::vec(step, 0..=3), timeout);
        let state = state.prop_map(|(moves, timeout)| State { moves, timeout });
        prop::collection::vec(state, count as usize).prop_map(|states| Protocol { states })
    })
}

/// A program for four states: some of the messages, sometimes silent.
fn parties() -> impl Strategy<Value = Party> {
    let can = prop::collection::vec(prop::sample::subsequence(vec![0u32, 1, 2], 0..=3), 4);
    let all = Just(vec![vec![0u32, 1, 2]; 4]);
    let silent = prop::collection::vec(prop::bool::weighted(0.2), 4);
    (prop_oneof![can, all], silent).prop_map(|(can, silent)| Party { can, silent })
}

fn setups() -> impl Strategy<Value = (Protocol, [Party; 2], Queues)> {
    let queues = (0..=2usize, 1..=2usize, prop::bool::ANY)
        .prop_map(|(a, b, lossy)| Queues { capacity: [a.max(usize::from(!lossy)), b], lossy });
    (protocols(), [parties(), parties()], queues)
}

/// The world after the steps of a witness.
fn end(model: &Model<'_>, witness: &[Step]) -> Option<World> {
    let mut w = World::default();
    for s in witness {
        w = model.replay(&w, s.by, s.state, s.action)?;
    }
    Some(w)
}

/// Keeps the least number of steps for each key.
fn least<K: Ord>(map: &mut BTreeMap<K, usize>, key: K, steps: usize) {
    let least = map.entry(key).or_insert(steps);
    *least = steps.min(*least);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_found_is_what_there_is((protocol, parties, queues) in setups()) {
        let model = Model { protocol: &protocol, parties: &parties, queues };
        let worlds = model.reachable();
        let (mut stuck, mut surprises) = (BTreeMap::new(), BTreeMap::new());
        let mut most = [0; 2];
        for (w, steps) in &worlds {
            let waits = model.waiting(w);
            if !waits.is_empty() {
                least(&mut stuck, waits, *steps);
            }
            for s in model.surprises(w) {
                least(&mut surprises, s, *steps);
            }
            most = [most[0].max(w[1].inbox.len()), most[1].max(w[0].inbox.len())];
        }

        let e = explore(&protocol, &parties, queues, MOST);
        prop_assert!(e.complete);
        prop_assert_eq!(e.seen, worlds.len());
        prop_assert_eq!(e.most_under_way, most);
        let (mut found_stuck, mut found_surprises) = (BTreeMap::new(), BTreeMap::new());
        let mut before = 0;
        for f in &e.findings {
            let (steps, new) = match f {
                Finding::Stuck { waits, witness } => {
                    let full = |s| s == Silence::QueueFull;
                    let waits: Waits = waits
                        .iter()
                        .map(|w| (w.role.index(), w.state as usize, w.unexpected, full(w.silence)))
                        .collect();
                    let there = end(&model, witness);
                    prop_assert_eq!(there.map(|w| model.waiting(&w)), Some(waits.clone()));
                    (witness.len(), found_stuck.insert(waits, witness.len()).is_none())
                }
                Finding::Unexpected { role, state, message, witness } => {
                    let key = (role.index(), *state as usize, *message);
                    let there = end(&model, witness);
                    prop_assert!(there.is_some_and(|w| model.surprises(&w).contains(&key)));
                    (witness.len(), found_surprises.insert(key, witness.len()).is_none())
                }
                Finding::NotProven { .. } => {
                    return Err(TestCaseError::fail("not proven, though all was visited"));
                }
            };
            prop_assert!(new, "told twice: {:?}", f);
            prop_assert!(before <= steps, "not the shortest first");
            before = steps;
        }
        prop_assert_eq!(found_stuck, stuck);
        prop_assert_eq!(found_surprises, surprises);
    }

    /// When no send ever waits, more room changes nothing; and without faults, less room makes none stuck.
    #[test]
    fn room_matters_only_where_a_send_waits((protocol, parties, queues) in setups()) {
        let some = explore(&protocol, &parties, queues, MOST);
        if some.blocked == [false; 2] {
            let more = Queues { capacity: queues.capacity.map(|c| c + 3), ..queues };
            prop_assert_eq!(&explore(&protocol, &parties, more, MOST), &some);
        }
        let less = Queues { capacity: [1; 2], ..queues };
        if some.findings.is_empty() && queues.capacity.iter().all(|c| *c > 0) {
            prop_assert_eq!(explore(&protocol, &parties, less, MOST).findings, []);
        }
    }

    /// What is told of a part of the configurations is true of all.
    #[test]
    fn a_limit_hides_findings_and_invents_none((protocol, parties, queues) in setups(), most in 0..40usize) {
        let all = explore(&protocol, &parties, queues, MOST);
        let part = explore(&protocol, &parties, queues, most);
        prop_assert_eq!(part.seen, most.min(all.seen));
        prop_assert_eq!(part.complete, all.seen <= most);
        if part.findings != [Finding::NotProven { seen: most }] {
            prop_assert_eq!(&part.findings[..], &all.findings[..part.findings.len()]);
        }
    }
}
