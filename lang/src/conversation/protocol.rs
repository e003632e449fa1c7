//! What is explored: a protocol, what each party's program does of it, and how messages travel.

/// One of the two sides of a conversation. Arrays of two are indexed with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Begins the conversation.
    Initiator,
    /// Is drawn into it by the first message.
    Participant,
}

impl Role {
    /// Both, in the order of everything that is told of them.
    pub const BOTH: [Role; 2] = [Role::Initiator, Role::Participant];

    /// The one it talks with.
    pub fn other(self) -> Role {
        match self {
            Role::Initiator => Role::Participant,
            Role::Participant => Role::Initiator,
        }
    }

    /// Its place in arrays of two.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// States by index; the first is the initial state. A target that is no state counts as a final one: what is
/// wrong with it is told by who looks at names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Protocol {
    /// The states.
    pub states: Vec<State>,
}

/// A state of a protocol. Without moves and time-out it is final.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct State {
    /// What may be said here. Of two moves of one role with one message the first counts.
    pub moves: Vec<Move>,
    /// Where a role goes that has waited too long.
    pub timeout: Option<u32>,
}

/// A message that a role may send.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Move {
    /// Who sends.
    pub by: Role,
    /// Number of the message, as the caller counts.
    pub message: u32,
    /// Index of the state that follows, for both.
    pub target: u32,
}

impl Protocol {
    /// A state by index.
    pub fn state(&self, index: u32) -> Option<&State> {
        self.states.get(index as usize)
    }

    /// Whether nothing follows a state.
    pub fn is_final(&self, index: u32) -> bool {
        self.state(index).is_none_or(|s| s.moves.is_empty() && s.timeout.is_none())
    }

    /// What a role may say in a state.
    pub fn moves(&self, index: u32, by: Role) -> impl Iterator<Item = &Move> {
        self.state(index).into_iter().flat_map(|s| &s.moves).filter(move |m| m.by == by)
    }

    /// The move that a message of a role is in a state, if it is expected there.
    pub fn move_with(&self, index: u32, by: Role, message: u32) -> Option<&Move> {
        self.moves(index, by).find(|m| m.message == message)
    }

    /// Where the time-out of a state takes a role, if the role holds it: one that can send there decides itself
    /// how long it takes, unless the other may send as well.
    pub fn timeout(&self, index: u32, role: Role) -> Option<u32> {
        let sends = |r| self.moves(index, r).next().is_some();
        self.state(index)?.timeout.filter(|_| !sends(role) || sends(role.other()))
    }
}

/// What the program of one role does of a protocol. States that are not listed have no sends and no silence.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Party {
    /// For each state, the messages that the program can really send there; others than the protocol's moves of
    /// the role are without effect.
    pub can: Vec<Vec<u32>>,
    /// For each state, whether the program may stay there for ever without sending.
    pub silent: Vec<bool>,
}

impl Party {
    /// A program that makes every move of its role and is never silent for ever.
    #[cfg(test)]
    pub fn willing(protocol: &Protocol, role: Role) -> Party {
        let says = |s: &State| s.moves.iter().filter(|m| m.by == role).map(|m| m.message).collect();
        Party { can: protocol.states.iter().map(says).collect(), silent: vec![false; protocol.states.len()] }
    }

    /// Whether the program can send a message in a state.
    pub fn sends(&self, state: u32, message: u32) -> bool {
        self.can.get(state as usize).is_some_and(|c| c.contains(&message))
    }

    /// Whether the program may be silent for ever in a state.
    pub fn is_silent(&self, state: u32) -> bool {
        self.silent.get(state as usize).copied().unwrap_or(false)
    }
}

/// How messages travel: in each direction first in, first out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Queues {
    /// The most messages under way, by the role that sends them; a send beyond it waits.
    pub capacity: [usize; 2],
    /// Whether messages can be lost. A lost one leaves its queue when it is at the head: that takes room which
    /// it would not, and makes no difference as long as no send waits.
    pub lossy: bool,
}
