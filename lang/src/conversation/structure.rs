//! What is wrong with a protocol whoever follows it: its states as a graph, without parties and messages.

use super::protocol::{Protocol, Role};

/// A mistake in a protocol.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// No way leads from the first state to this one.
    Unreachable {
        /// Index of the state.
        state: u32,
    },
    /// No way leads from this state to a final one.
    Endless {
        /// Index of the state.
        state: u32,
    },
    /// A role has two moves with one message in a state: the receiver cannot tell which was meant.
    Ambiguous {
        /// Index of the state.
        state: u32,
        /// Whose moves.
        role: Role,
        /// The message of both.
        message: u32,
    },
    /// Time-outs of a ring of states, all held by one role: it goes round alone and for ever. A ring in which
    /// each role comes to a state where only it may send is none: there it stops.
    Livelock {
        /// The ring, from the state with the least index.
        states: Vec<u32>,
        /// Who goes round.
        roles: Vec<Role>,
    },
}

/// All mistakes, by kind and state.
pub fn faults(protocol: &Protocol) -> Vec<Fault> {
    let mut out = unreachable(protocol);
    out.extend(endless(protocol));
    out.extend(ambiguous(protocol));
    out.extend(livelocks(protocol));
    out
}

/// The indices of the states.
fn indices(protocol: &Protocol) -> impl Iterator<Item = u32> {
    (0..).take(protocol.states.len())
}

/// For each state, where moves and the time-out lead.
fn targets(protocol: &Protocol) -> Vec<Vec<u32>> {
    protocol.states.iter().map(|s| s.moves.iter().map(|m| m.target).chain(s.timeout).collect()).collect()
}

/// Which states ways lead to, from some.
fn reached(ways: &[Vec<u32>], mut open: Vec<u32>) -> Vec<bool> {
    let mut seen = vec![false; ways.len()];
    while let Some(i) = open.pop() {
        let (Some(seen), Some(next)) = (seen.get_mut(i as usize), ways.get(i as usize)) else { continue };
        if !std::mem::replace(seen, true) {
            open.extend(next);
        }
    }
    seen
}

fn unreachable(protocol: &Protocol) -> Vec<Fault> {
    let seen = reached(&targets(protocol), vec![0]);
    indices(protocol).zip(seen).filter(|(_, s)| !s).map(|(state, _)| Fault::Unreachable { state }).collect()
}

fn endless(protocol: &Protocol) -> Vec<Fault> {
    let mut back: Vec<Vec<u32>> = vec![Vec::new(); protocol.states.len()];
    let mut ends: Vec<u32> = indices(protocol).filter(|i| protocol.is_final(*i)).collect();
    for (from, next) in indices(protocol).zip(targets(protocol)) {
        for to in next {
            match back.get_mut(to as usize) {
                Some(b) => b.push(from),
                None => ends.push(from),
            }
        }
    }
    let seen = reached(&back, ends);
    indices(protocol).zip(seen).filter(|(_, s)| !s).map(|(state, _)| Fault::Endless { state }).collect()
}

fn ambiguous(protocol: &Protocol) -> Vec<Fault> {
    let mut out = Vec::new();
    for (state, s) in indices(protocol).zip(&protocol.states) {
        let mut all: Vec<(Role, u32)> = s.moves.iter().map(|m| (m.by, m.message)).collect();
        all.sort_unstable();
        let mut twice: Vec<(Role, u32)> = all
            .windows(2)
            .filter_map(|w| if let [a, b] = w { (a == b).then_some(*a) } else { None })
            .collect();
        twice.dedup();
        out.extend(twice.into_iter().map(|(role, message)| Fault::Ambiguous { state, role, message }));
    }
    out
}

/// A state has one time-out at most, so that there is one way to follow from each; a ring is found by the first
/// state from which the way leads into it.
fn livelocks(protocol: &Protocol) -> Vec<Fault> {
    let mut out = Vec::new();
    let mut followed = vec![false; protocol.states.len()];
    for first in indices(protocol) {
        let mut way = Vec::new();
        let mut next = Some(first);
        while let Some(i) = next
            && let Some(f) = followed.get_mut(i as usize)
            && !std::mem::replace(f, true)
        {
            way.push(i);
            next = protocol.state(i).and_then(|s| s.timeout);
        }
        // The way ends in itself, in one that was followed before, or in a state without time-out.
        let Some(start) = way.iter().position(|i| Some(*i) == next) else { continue };
        let mut states = way.split_off(start);
        let least = states.iter().enumerate().min_by_key(|(_, i)| **i).map_or(0, |(at, _)| at);
        states.rotate_left(least);
        let holds = |r: &Role| states.iter().all(|i| protocol.timeout(*i, *r).is_some());
        let roles: Vec<Role> = Role::BOTH.into_iter().filter(holds).collect();
        if !roles.is_empty() {
            out.push(Fault::Livelock { states, roles });
        }
    }
    out
}
