//! What an activation did, kept until it is committed in the deterministic order.

use super::store::Made;
use crate::nodes::Ended;
use serde::{Deserialize, Serialize};
use soifra_graph::{Govern, Name, Span};
use std::ops::Range;

/// Something an activation did, in order. Ranges are registers of the log.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum Item {
    Command {
        port: u32,
        registers: Range<u32>,
    },
    Publish {
        topic: u32,
        registers: Range<u32>,
    },
    Tell(Box<Told>),
    Raise(u32),
    Govern(Box<Govern>),
    Use {
        device: u32,
        seconds: f64,
    },
    Open(Box<Opened>),
    Reply(Box<Replied>),
    SetParam {
        param: u32,
        registers: Range<u32>,
    },
    /// A sub-goal of the agent has this status now.
    Subgoal {
        index: u32,
        status: u8,
    },
    // For the trace only.
    Note(Box<str>),
    Rule {
        rule: u32,
        at: Span,
    },
    Transition {
        from: u32,
        to: u32,
    },
    Node {
        node: u32,
        how: Ended,
    },
    State {
        state: u32,
        registers: Range<u32>,
    },
    /// The record of a message that was heard.
    Heard(u64),
}

/// Content told to another agent.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Told {
    pub performative: Name,
    pub to: Name,
    pub content: Name,
    pub registers: Range<u32>,
}

/// A conversation to be opened.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Opened {
    pub conversation: u32,
    pub performative: Name,
    pub registers: Range<u32>,
    pub to: Range<u32>,
    pub within: Option<f64>,
}

/// Something to be said in a conversation.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Replied {
    pub performative: Name,
    pub reason: Option<String>,
    pub registers: Range<u32>,
    pub thread: f64,
}

/// The items of consecutive activations.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Log {
    pub items: Vec<Item>,
    pub registers: Vec<f64>,
    /// Objects that were made.
    #[serde(skip)]
    pub made: Vec<Made>,
}

impl Log {
    /// Keeps registers.
    pub fn keep(&mut self, registers: &[f64]) -> Range<u32> {
        let from = self.registers.len() as u32;
        // Of a known length, so that it needs no call.
        match *registers {
            [a] => self.registers.push(a),
            [a, b, c] => self.registers.extend_from_slice(&[a, b, c]),
            [a, b, c, d, e, f] => self.registers.extend_from_slice(&[a, b, c, d, e, f]),
            _ => self.registers.extend_from_slice(registers),
        }
        from..self.registers.len() as u32
    }

    // A function for each of the frequent items: one that is first made and then moved is slow to move.

    /// Keeps a command.
    #[inline(never)]
    pub fn command(&mut self, port: u32, registers: &[f64]) {
        let registers = self.keep(registers);
        self.items.push(Item::Command { port, registers });
    }

    /// Keeps a message.
    #[inline(never)]
    pub fn publish(&mut self, topic: u32, registers: &[f64]) {
        let registers = self.keep(registers);
        self.items.push(Item::Publish { topic, registers });
    }

    /// Registers of an item.
    pub fn get(&self, range: &Range<u32>) -> &[f64] {
        self.registers.get(range.start as usize..range.end as usize).unwrap_or_default()
    }

    /// Forgets everything, keeps the memory.
    pub fn clear(&mut self) {
        self.items.clear();
        self.registers.clear();
        self.made.clear();
    }
}

impl Item {
    /// Whether it leaves the agent, so that it appears when the activation finishes.
    pub fn is_output(&self) -> bool {
        matches!(
            self,
            Item::Command { .. }
                | Item::Publish { .. }
                | Item::Tell(_)
                | Item::Raise(_)
                | Item::Govern(_)
                | Item::Use { .. }
                | Item::Open(_)
                | Item::Reply(_)
                | Item::SetParam { .. }
        )
    }
}
