//! What is told of an exploration. Names are the caller's: here states and messages are numbers.

use super::protocol::Role;

/// A step of a conversation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// Who takes it; of a message that is lost, who does not get it.
    pub by: Role,
    /// The state that role's copy was in.
    pub state: u32,
    /// What happens.
    pub action: Action,
}

/// What happens in a step, with the number of its message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// The role sends a message.
    Sends(u32),
    /// The role receives a message it expects.
    Receives(u32),
    /// The role's copy has ended: a message is received and without effect.
    Drops(u32),
    /// A message to the role is lost.
    Loses(u32),
    /// The role has waited too long.
    TimesOut,
}

/// A way in which a conversation goes wrong, or that nothing can be said. A witness is a shortest sequence of
/// steps from the start to where it does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// After the steps of the witness a message can arrive that the role has no use for in its state.
    Unexpected {
        /// Who receives.
        role: Role,
        /// The state its copy is in.
        state: u32,
        /// What arrives.
        message: u32,
        /// How it comes to that.
        witness: Vec<Step>,
    },
    /// After the steps of the witness nothing can be counted on to happen, and somebody waits.
    Stuck {
        /// Who waits for what: one role or both. A role that is not here has ended, or does not know of
        /// the conversation.
        waits: Vec<Wait>,
        /// How it comes to that.
        witness: Vec<Step>,
    },
    /// There are more configurations than may be visited, and nothing is wrong with those that were.
    NotProven {
        /// How many were visited.
        seen: usize,
    },
}

/// What a role waits for when a conversation is stuck.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Wait {
    /// Who waits.
    pub role: Role,
    /// The state its copy is in.
    pub state: u32,
    /// Messages of the other that would take it on; empty when only the role itself can move.
    pub awaited: Vec<u32>,
    /// Why it does not go on by itself.
    pub silence: Silence,
    /// The message under way to it that stands in the way, since it is unexpected: then that is told as well,
    /// and the wait is what follows from it.
    pub unexpected: Option<u32>,
}

/// Why a role cannot be counted on to send.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Silence {
    /// The protocol gives it no move here.
    OthersTurn,
    /// Its program can make none of the moves it has here.
    Unable,
    /// Its program may be silent here for ever.
    Chosen,
    /// The messages before have not been received, and no more fit. Since what is expected is received at some
    /// time, there is always an unexpected one at their head, or the capacity is 0.
    QueueFull,
}
