//! The model once more, as plainly as can be: every event is tried in every configuration, and what follows is
//! kept in a map. It shares the protocol's data with what it is compared to, and no code.

use crate::conversation::{Action, Move, Party, Protocol, Queues, Role};
use std::collections::{BTreeMap, VecDeque};

/// Something that may happen, whether or not it can.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    Send(usize, u32),
    Deliver(usize),
    Lose(usize),
    TimeOut(usize),
}

/// A role's side: its state, whether it took a step, and what is under way to it.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side {
    pub state: usize,
    pub begun: bool,
    pub inbox: VecDeque<u32>,
}

pub type World = [Side; 2];

/// A protocol with what its parties do.
pub struct Model<'a> {
    pub protocol: &'a Protocol,
    pub parties: &'a [Party; 2],
    pub queues: Queues,
}

/// A role that waits: who, where, what arrives that it does not know, whether it ran out of room.
pub type Waits = Vec<(usize, usize, Option<u32>, bool)>;

fn who(role: Role) -> usize {
    if role == Role::Initiator { 0 } else { 1 }
}

impl Model<'_> {
    fn moves(&self, state: usize, by: usize) -> Vec<Move> {
        let all = &self.protocol.states[state].moves;
        all.iter().filter(|m| who(m.by) == by).copied().collect()
    }

    fn is_over(&self, state: usize) -> bool {
        let s = &self.protocol.states[state];
        s.moves.is_empty() && s.timeout.is_none()
    }

    fn events(&self) -> Vec<Event> {
        let mut messages: Vec<u32> =
            self.protocol.states.iter().flat_map(|s| &s.moves).map(|m| m.message).collect();
        messages.sort_unstable();
        messages.dedup();
        let mut out = Vec::new();
        for r in [0, 1] {
            out.extend(messages.iter().map(|m| Event::Send(r, *m)));
            out.extend([Event::Deliver(r), Event::Lose(r), Event::TimeOut(r)]);
        }
        out
    }

    /// What follows from an event, if it can happen, and whether it can be counted on.
    fn apply(&self, w: &World, e: Event) -> Option<(World, bool)> {
        let mut n = w.clone();
        match e {
            Event::Send(r, m) => {
                let s = w[r].state;
                if !self.parties[r].can[s].contains(&m) || w[1 - r].inbox.len() == self.queues.capacity[r] {
                    return None;
                }
                let target = self.moves(s, r).iter().find(|x| x.message == m)?.target;
                n[r].state = target as usize;
                n[r].begun = true;
                n[1 - r].inbox.push_back(m);
                Some((n, !self.parties[r].silent[s]))
            }
            Event::Deliver(r) => {
                let m = n[r].inbox.pop_front()?;
                if !self.is_over(w[r].state) {
                    let x = self.moves(w[r].state, 1 - r).into_iter().find(|x| x.message == m)?;
                    n[r].state = x.target as usize;
                    n[r].begun = true;
                }
                Some((n, true))
            }
            Event::Lose(r) => {
                n[r].inbox.pop_front()?;
                self.queues.lossy.then_some((n, false))
            }
            Event::TimeOut(r) => {
                let s = w[r].state;
                let target = self.protocol.states[s].timeout?;
                let (own, others) = (!self.moves(s, r).is_empty(), !self.moves(s, 1 - r).is_empty());
                if own && !others {
                    return None;
                }
                n[r].state = target as usize;
                n[r].begun = true;
                Some((n, true))
            }
        }
    }

    /// Every world that can be reached, with the least number of steps to it.
    pub fn reachable(&self) -> BTreeMap<World, usize> {
        let start = World::default();
        let mut found = BTreeMap::from([(start.clone(), 0)]);
        let mut layer = vec![start];
        for steps in 1.. {
            let mut next = Vec::new();
            for w in &layer {
                for (n, _) in self.events().into_iter().filter_map(|e| self.apply(w, e)) {
                    if !found.contains_key(&n) {
                        found.insert(n.clone(), steps);
                        next.push(n);
                    }
                }
            }
            if next.is_empty() {
                break;
            }
            layer = next;
        }
        found
    }

    /// What may arrive though nobody expects it: role, state, message.
    pub fn surprises(&self, w: &World) -> Vec<(usize, usize, u32)> {
        let surprise = |r: usize| {
            let m = *w[r].inbox.front()?;
            self.apply(w, Event::Deliver(r)).is_none().then_some((r, w[r].state, m))
        };
        [0, 1].into_iter().filter_map(surprise).collect()
    }

    /// Who waits, when nothing can be counted on.
    pub fn waiting(&self, w: &World) -> Waits {
        if self.events().into_iter().any(|e| self.apply(w, e).is_some_and(|(_, counts)| counts)) {
            return Vec::new();
        }
        let surprises = self.surprises(w);
        let mut out = Vec::new();
        for r in [0, 1] {
            if self.is_over(w[r].state) || (w[1 - r].begun && !w[r].begun) {
                continue;
            }
            let s = w[r].state;
            let met = surprises.iter().find(|x| x.0 == r).map(|x| x.2);
            let wants = self.moves(s, r).iter().any(|m| self.parties[r].can[s].contains(&m.message));
            out.push((r, s, met, wants && !self.parties[r].silent[s]));
        }
        out
    }

    /// The world after a step that was told, if it can be taken as told.
    pub fn replay(&self, w: &World, by: Role, state: u32, action: Action) -> Option<World> {
        let r = who(by);
        if w[r].state != state as usize {
            return None;
        }
        let heads = |m: u32| w[r].inbox.front() == Some(&m);
        let event = match action {
            Action::Sends(m) => Event::Send(r, m),
            Action::Receives(m) if heads(m) && !self.is_over(w[r].state) => Event::Deliver(r),
            Action::Drops(m) if heads(m) && self.is_over(w[r].state) => Event::Deliver(r),
            Action::Loses(m) if heads(m) => Event::Lose(r),
            Action::TimesOut => Event::TimeOut(r),
            _ => return None,
        };
        Some(self.apply(w, event)?.0)
    }
}
