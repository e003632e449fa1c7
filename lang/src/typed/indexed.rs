//! Lists whose items are found by name.

use soifra_graph::{Agent, Name, Topic};
use std::{collections::BTreeMap, ops::Deref};

/// What an indexed list may hold.
pub trait Named {
    /// The name to find it by.
    fn name(&self) -> &Name;
}

impl Named for Name {
    fn name(&self) -> &Name {
        self
    }
}

impl<A, B> Named for (Name, A, B) {
    fn name(&self) -> &Name {
        &self.0
    }
}

impl Named for Agent {
    fn name(&self) -> &Name {
        &self.name
    }
}

impl Named for soifra_graph::Conversation {
    fn name(&self) -> &Name {
        &self.name
    }
}

impl Named for Topic {
    fn name(&self) -> &Name {
        &self.channel.name
    }
}

/// A list in the order of declaration. A program of a hundred thousand lines has thousands of each thing, and
/// tens of thousands of uses.
#[derive(Debug)]
pub struct Indexed<T> {
    items: Vec<T>,
    places: BTreeMap<Name, usize>,
}

impl<T: Named> Indexed<T> {
    /// Adds an item; a name keeps meaning the first that has it.
    pub fn push(&mut self, item: T) {
        self.places.entry(item.name().clone()).or_insert(self.items.len());
        self.items.push(item);
    }

    /// Where the item called `name` stands.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    /// The items, without their index.
    pub fn into_items(self) -> Vec<T> {
        self.items
    }
}

impl<T> Default for Indexed<T> {
    fn default() -> Self {
        Indexed { items: Vec::new(), places: BTreeMap::new() }
    }
}

impl<T: Named> FromIterator<T> for Indexed<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut list = Indexed::default();
        items.into_iter().for_each(|item| list.push(item));
        list
    }
}

impl<T> Deref for Indexed<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.items
    }
}
