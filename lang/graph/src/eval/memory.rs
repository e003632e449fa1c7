//! Where slots of states, arguments and parameters lie in memory.

use crate::{Agent, Graph, Type, TypeTable};
use std::ops::Range;

/// Registers a run reads and writes besides its frame.
#[derive(Debug)]
pub struct Memory<'a> {
    /// States of the agent, laid out by [`Layout::states`].
    pub states: &'a mut [f64],
    /// Arguments of the agent, laid out by [`Layout::arguments`].
    pub arguments: &'a [f64],
    /// Mission parameters, laid out by [`Layout::params`].
    pub params: &'a [f64],
}

/// Slots one after the other, in the order of their declaration, without gaps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layout {
    slots: Vec<(usize, Type)>,
    len: usize,
}

impl Layout {
    /// Slots of the given types.
    pub fn new<'t>(table: &TypeTable, types: impl IntoIterator<Item = &'t Type>) -> Self {
        let mut layout = Layout::default();
        for t in types {
            layout.slots.push((layout.len, t.clone()));
            layout.len = layout.len.saturating_add(table.width(t));
        }
        layout
    }

    /// The states of an agent.
    pub fn states(table: &TypeTable, agent: &Agent) -> Self {
        Layout::new(table, agent.states.iter().map(|s| &s.ty))
    }

    /// The parameters of an agent, which a robot's binding gives as arguments.
    pub fn arguments(table: &TypeTable, agent: &Agent) -> Self {
        Layout::new(table, agent.parameters.iter().map(|(_, t)| t))
    }

    /// The parameters of a mission.
    pub fn params(graph: &Graph) -> Self {
        Layout::new(&graph.types, graph.params.iter().map(|p| &p.ty))
    }

    /// Registers of slot `index`.
    pub fn range(&self, index: usize) -> Option<Range<usize>> {
        let from = self.slots.get(index)?.0;
        let to = self.slots.get(index + 1).map_or(self.len, |s| s.0);
        Some(from..to)
    }

    /// Type of slot `index`.
    pub fn ty(&self, index: usize) -> Option<&Type> {
        self.slots.get(index).map(|s| &s.1)
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    /// Registers of all slots together.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no register at all.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}
