//! Messages that are delivered, to units that a message sets off, and their mailboxes.

use serde::{Deserialize, Serialize};
use soifra_graph::Name;
use std::{
    collections::{BTreeMap, VecDeque},
    sync::Arc,
};

/// A message on its way or in a mailbox.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Letter {
    /// What it is called in the trace: the topic, or performative and content.
    pub topic: Name,
    pub registers: Vec<f64>,
    /// Its record.
    pub record: u64,
    /// Most letters that may wait in a mailbox.
    pub capacity: usize,
    /// Who is talking, and in which conversation.
    pub envelope: Option<[f64; 2]>,
}

/// A letter in a mailbox, with the record of its delivery.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Delivered {
    pub letter: Arc<Letter>,
    pub record: Option<u64>,
}

/// Mailboxes that are not empty, by unit.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Mail(BTreeMap<u32, VecDeque<Delivered>>);

impl Mail {
    /// Puts a letter into a mailbox; returns the oldest when the mailbox is full.
    pub fn put(&mut self, unit: u32, letter: Delivered) -> Option<Delivered> {
        let capacity = letter.letter.capacity.max(1);
        let waiting = self.0.entry(unit).or_default();
        waiting.push_back(letter);
        if waiting.len() > capacity { waiting.pop_front() } else { None }
    }

    /// Takes the oldest letter.
    pub fn take(&mut self, unit: u32) -> Option<Delivered> {
        let waiting = self.0.get_mut(&unit)?;
        let letter = waiting.pop_front();
        if waiting.is_empty() {
            self.0.remove(&unit);
        }
        letter
    }

    /// Whether all are mailboxes of the first `units` units.
    pub fn fits(&self, units: usize) -> bool {
        self.0.keys().all(|u| (*u as usize) < units)
    }

    /// Whether letters wait.
    pub fn waits(&self, unit: u32) -> bool {
        self.0.contains_key(&unit)
    }
}
