//! Conversations: typed messages between two agents, in an order that a protocol gives.

use crate::{Component, Expr, Name, Span};
use serde::{Deserialize, Serialize};

/// A conversation that agents can have. The agent that offers it is the participant; whoever opens it is the
/// initiator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conversation {
    /// Name; also of the service in the directory.
    pub name: Name,
    /// Name of its protocol.
    pub protocol: Name,
    /// Vocabulary of its contents: the name of the file that declares it.
    pub ontology: Name,
    /// States of the protocol with the contents of this conversation; the first is the initial one.
    pub states: Vec<ProtocolState>,
    /// How its messages travel: role `conversation`, model and arguments.
    pub channel: Component,
    /// Where it was written.
    pub at: Span,
}

/// A state of a protocol. Each side keeps its own copy; one without ways out is final.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProtocolState {
    /// Name.
    pub name: Name,
    /// Messages that lead on.
    pub moves: Vec<ProtocolMove>,
    /// Where whoever waits goes when nothing has come for a duration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timeout: Option<(Expr, u32)>,
    /// Where it was written.
    pub at: Span,
}

/// A message of a protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProtocolMove {
    /// Who sends it.
    pub by: Role,
    /// Performative, lower case.
    pub performative: Name,
    /// Record it carries, if it does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Name>,
    /// State it leads to.
    pub target: u32,
    /// Where it was written.
    pub at: Span,
}

/// A side of a conversation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Opens it.
    Initiator,
    /// Offers it.
    Participant,
}

impl Role {
    /// Index in arrays of two.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The other side.
    pub fn other(self) -> Role {
        match self {
            Role::Initiator => Role::Participant,
            Role::Participant => Role::Initiator,
        }
    }
}

impl ProtocolState {
    /// Whether it is over.
    pub fn is_final(&self) -> bool {
        self.moves.is_empty() && self.timeout.is_none()
    }

    /// The message of a side with a performative.
    pub fn move_of(&self, by: Role, performative: &str) -> Option<&ProtocolMove> {
        self.moves.iter().find(|m| m.by == by && *m.performative == *performative)
    }

    /// Whether a side waits here and holds the time-out: it has nothing to say, or both have.
    pub fn holds_timeout(&self, side: Role) -> bool {
        let speaks = |r: Role| self.moves.iter().any(|m| m.by == r);
        self.timeout.is_some() && (!speaks(side) || speaks(side.other()))
    }
}
