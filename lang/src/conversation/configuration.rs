//! A configuration, what can happen in it, and what of that can be counted on.

use super::finding::{Action, Silence, Step, Wait};
use super::protocol::{Party, Protocol, Queues, Role};

/// Both copies and the messages under way. Arrays are by role.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Configuration {
    /// The state each copy is in.
    pub at: [u32; 2],
    /// Whether each copy has taken a step. A protocol may come back to its first state, so that the state does
    /// not tell.
    pub begun: [bool; 2],
    /// Messages under way, by the role that has sent them, the first sent first.
    pub under_way: [Vec<u32>; 2],
}

impl Configuration {
    /// The state of a role's copy.
    fn state(&self, role: Role) -> u32 {
        self.at[role.index()]
    }

    /// The message that a role receives next.
    fn head(&self, role: Role) -> Option<u32> {
        self.under_way[role.other().index()].first().copied()
    }

    /// Takes a role's copy to a state.
    fn go(&mut self, role: Role, target: u32) {
        self.at[role.index()] = target;
        self.begun[role.index()] = true;
    }

    /// Puts a message of a role under way. The new queue is as long as it must be: many are kept.
    fn put(&mut self, by: Role, message: u32) {
        let queue = &mut self.under_way[by.index()];
        *queue = [queue.as_slice(), &[message]].concat();
    }

    /// Takes away what a role would receive next.
    fn take(&mut self, role: Role) {
        let queue = &mut self.under_way[role.other().index()];
        *queue = queue.get(1..).unwrap_or_default().to_vec();
    }
}

/// What is explored.
#[derive(Debug, Clone, Copy)]
pub struct Product<'a> {
    /// What both follow.
    pub protocol: &'a Protocol,
    /// What each does of it.
    pub parties: &'a [Party; 2],
    /// How messages travel.
    pub queues: Queues,
}

impl Product<'_> {
    /// What can happen in a configuration, and what follows; for each role sends, its head, its time-out.
    pub fn steps(&self, c: &Configuration) -> Vec<(Step, Configuration)> {
        let mut out = Vec::new();
        for role in Role::BOTH {
            let state = c.state(role);
            let mut push = |action, change: &dyn Fn(&mut Configuration)| {
                let mut next = c.clone();
                change(&mut next);
                out.push((Step { by: role, state, action }, next));
            };
            if !self.is_full(c, role) {
                for (message, target) in self.sends(c, role) {
                    push(Action::Sends(message), &|n| {
                        n.go(role, target);
                        n.put(role, message);
                    });
                }
            }
            if let Some(message) = c.head(role) {
                if self.protocol.is_final(state) {
                    push(Action::Drops(message), &|n| n.take(role));
                } else if let Some(m) = self.protocol.move_with(state, role.other(), message) {
                    push(Action::Receives(message), &|n| {
                        n.take(role);
                        n.go(role, m.target);
                    });
                }
                if self.queues.lossy {
                    push(Action::Loses(message), &|n| n.take(role));
                }
            }
            if let Some(target) = self.protocol.timeout(state, role) {
                push(Action::TimesOut, &|n| n.go(role, target));
            }
        }
        out
    }

    /// The messages that a role's program can send, with the states that follow, whether they fit or not.
    fn sends(&self, c: &Configuration, role: Role) -> impl Iterator<Item = (u32, u32)> {
        let state = c.state(role);
        self.protocol
            .moves(state, role)
            .filter(move |m| self.parties[role.index()].sends(state, m.message))
            .filter_map(move |m| self.protocol.move_with(state, role, m.message))
            .map(|m| (m.message, m.target))
    }

    /// Whether no further message of a role fits.
    fn is_full(&self, c: &Configuration, role: Role) -> bool {
        c.under_way[role.index()].len() >= self.queues.capacity[role.index()]
    }

    /// Whether a role can send what does not fit.
    pub fn is_blocked(&self, c: &Configuration, role: Role) -> bool {
        self.is_full(c, role) && self.sends(c, role).next().is_some()
    }

    /// The message whose arrival at a role would be a fault, with the state.
    pub fn unexpected(&self, c: &Configuration, role: Role) -> Option<(u32, u32)> {
        let (state, message) = (c.state(role), c.head(role)?);
        let expected = self.protocol.move_with(state, role.other(), message).is_some();
        (!expected && !self.protocol.is_final(state)).then_some((state, message))
    }

    /// Who waits for what, when nothing can be counted on to happen; else, and when all is over, nobody.
    pub fn stuck(&self, c: &Configuration) -> Vec<Wait> {
        if Role::BOTH.into_iter().any(|r| self.goes_on(c, r)) {
            return Vec::new();
        }
        Role::BOTH.into_iter().filter_map(|r| self.wait(c, r)).collect()
    }

    /// Whether something that a role does can be counted on: losing a message never, sending only where its
    /// program may not be silent for ever.
    fn goes_on(&self, c: &Configuration, role: Role) -> bool {
        let state = c.state(role);
        let receives = c.head(role).is_some() && self.unexpected(c, role).is_none();
        receives || self.protocol.timeout(state, role).is_some() || self.silence(c, role).is_none()
    }

    /// Why a role cannot be counted on to send, if it cannot.
    fn silence(&self, c: &Configuration, role: Role) -> Option<Silence> {
        let state = c.state(role);
        if self.protocol.moves(state, role).next().is_none() {
            Some(Silence::OthersTurn)
        } else if self.sends(c, role).next().is_none() {
            Some(Silence::Unable)
        } else if self.parties[role.index()].is_silent(state) {
            Some(Silence::Chosen)
        } else if self.is_full(c, role) {
            Some(Silence::QueueFull)
        } else {
            None
        }
    }

    /// What a role waits for that neither has ended nor is still to hear of the conversation.
    fn wait(&self, c: &Configuration, role: Role) -> Option<Wait> {
        let state = c.state(role);
        let unaware = !c.begun[role.index()] && c.begun[role.other().index()];
        if self.protocol.is_final(state) || unaware {
            return None;
        }
        let mut awaited = Vec::new();
        for m in self.protocol.moves(state, role.other()) {
            if !awaited.contains(&m.message) {
                awaited.push(m.message);
            }
        }
        let unexpected = self.unexpected(c, role).map(|(_, message)| message);
        Some(Wait { role, state, awaited, silence: self.silence(c, role)?, unexpected })
    }
}
