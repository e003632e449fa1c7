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

/// Mailboxes of all units. Asked at every message, so each has its place.
#[derive(Debug, Default)]
pub(crate) struct Mail(Vec<VecDeque<Delivered>>);

/// What waits in mailboxes, by unit.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Waiting(BTreeMap<u32, VecDeque<Delivered>>);

impl Mail {
    /// Empty mailboxes.
    pub fn new(units: usize) -> Self {
        Mail((0..units).map(|_| VecDeque::new()).collect())
    }

    /// Puts a letter into a mailbox; returns the oldest when the mailbox is full.
    pub fn put(&mut self, unit: u32, letter: Delivered) -> Option<Delivered> {
        let capacity = letter.letter.capacity.max(1);
        let waiting = self.0.get_mut(unit as usize)?;
        waiting.push_back(letter);
        if waiting.len() > capacity { waiting.pop_front() } else { None }
    }

    /// Takes the oldest letter.
    pub fn take(&mut self, unit: u32) -> Option<Delivered> {
        self.0.get_mut(unit as usize)?.pop_front()
    }

    /// Whether letters wait.
    pub fn waits(&self, unit: u32) -> bool {
        self.0.get(unit as usize).is_some_and(|waiting| !waiting.is_empty())
    }

    /// Letters that wait.
    pub fn letters(&self) -> impl Iterator<Item = &Letter> {
        self.0.iter().flatten().map(|d| d.letter.as_ref())
    }

    /// What waits.
    pub fn waiting(&self) -> Waiting {
        let all = (0..).zip(&self.0).filter(|(_, waiting)| !waiting.is_empty());
        Waiting(all.map(|(unit, waiting)| (unit, waiting.clone())).collect())
    }

    /// Goes on from what was waiting; what is for a unit that is not there is left out.
    pub fn resume(&mut self, waiting: Waiting) {
        self.0.iter_mut().for_each(VecDeque::clear);
        for (unit, letters) in waiting.0 {
            if let Some(mailbox) = self.0.get_mut(unit as usize) {
                *mailbox = letters;
            }
        }
    }
}

impl Waiting {
    /// Whether all are mailboxes of the first `units` units.
    pub fn fits(&self, units: usize) -> bool {
        self.0.keys().all(|u| (*u as usize) < units)
    }
}
