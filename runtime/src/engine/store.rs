//! Keeps the objects of a run as long as a state or a reading means them.

use crate::{
    Scene,
    objects::{self, Object, Shelf},
    scene::Part,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Objects by number. Those of cameras are numbered in order of delivery, those that an agent makes in the order in
/// which it does, so that no number depends on threads.
#[derive(Debug, Clone, Default)]
pub(crate) struct Store {
    all: BTreeMap<u64, Arc<dyn Object>>,
    /// How many each agent has made, by instance; cameras come before them, as 0.
    made: BTreeMap<u32, u32>,
    /// Something was added since it was last tidied.
    grown: bool,
}

/// What an activation has made: the agent's instance, the number, the object.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    pub instance: u32,
    pub number: u64,
    pub object: Arc<dyn Object>,
}

fn number(owner: u32, count: u32) -> u64 {
    u64::from(owner) << 32 | u64::from(count)
}

impl Store {
    /// Keeps what a camera took; its number.
    pub fn deliver(&mut self, object: Arc<dyn Object>) -> f64 {
        let count = self.made.entry(0).or_default();
        *count = count.wrapping_add(1);
        let number = number(0, *count);
        self.all.insert(number, object);
        self.grown = true;
        number as f64
    }

    /// Keeps what activations have made.
    pub fn commit(&mut self, made: impl Iterator<Item = Made>) {
        for m in made {
            let count = self.made.entry(m.instance + 1).or_default();
            *count = count.wrapping_add(1);
            self.all.insert(m.number, m.object);
            self.grown = true;
        }
    }

    /// The object of a number.
    pub fn get(&self, register: f64) -> Option<&Arc<dyn Object>> {
        if register >= 0.0 { self.all.get(&(register as u64)) } else { None }
    }

    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Whether anything was added since the last time.
    pub fn has_grown(&self) -> bool {
        self.grown
    }

    /// Forgets all but these.
    pub fn tidy(&mut self, used: &BTreeSet<u64>) {
        self.grown = false;
        self.all.retain(|n, _| used.contains(n));
    }
}

/// The store as one activation sees it: with what has been made since the store was last written to.
pub(crate) struct AgentShelf<'a> {
    pub store: &'a Store,
    pub made: &'a mut Vec<Made>,
    pub instance: u32,
    pub scene: &'a Scene,
    /// Whether it is for a judgement.
    pub truth: bool,
    /// Threads that a service may make use of.
    pub threads: usize,
}

impl Shelf for AgentShelf<'_> {
    fn get(&self, register: f64) -> Option<Arc<dyn Object>> {
        let fresh = self.made.iter().find(|m| m.number as f64 == register).map(|m| &m.object);
        fresh.or_else(|| self.store.get(register)).cloned()
    }

    fn put(&mut self, object: Arc<dyn Object>) -> f64 {
        let before = self.store.made.get(&(self.instance + 1)).copied().unwrap_or(0);
        let since = self.made.iter().filter(|m| m.instance == self.instance).count() as u32;
        let number = number(self.instance + 1, before.wrapping_add(since).wrapping_add(1));
        self.made.push(Made { instance: self.instance, number, object });
        number as f64
    }

    fn mapped(&self) -> Vec<&Part> {
        objects::standing(self.scene, false)
    }

    fn standing(&self) -> Option<Vec<&Part>> {
        self.truth.then(|| objects::standing(self.scene, true))
    }

    fn threads(&self) -> usize {
        self.threads
    }
}
