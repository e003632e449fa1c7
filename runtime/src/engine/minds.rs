//! What agents keep between activations, flat: states, machines, plans, sub-goals, randomness. Views of
//! it can be split between threads, because no activation touches the mind of another agent.

use super::cast::{Cast, UnitInfo};
use crate::{
    Time,
    mission::{Mission, code::KindCode},
};
use serde::{Deserialize, Serialize};

/// A machine, or the plan of a sub-goal that has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct Position {
    /// State of the machine.
    pub state: u32,
    /// When it was entered.
    pub entered: Time,
    /// Whether the machine has entered its first state, or the plan has achieved its sub-goal.
    pub begun: bool,
}

/// Status of a sub-goal on a robot.
pub(crate) const ACTIVE: u8 = 0;
pub(crate) const ACHIEVED: u8 = 1;
pub(crate) const FAILED: u8 = 2;

/// The minds of all agents.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Minds {
    pub states: Vec<f64>,
    /// One for each unit.
    pub positions: Vec<Position>,
    /// Status and slot of each plan node.
    pub status: Vec<u8>,
    pub slots: Vec<i64>,
    /// Status of each sub-goal.
    pub subgoals: Vec<u8>,
    /// Words each agent has drawn from its stream.
    pub drawn: Vec<u64>,
}

/// The minds of consecutive instances from `first` on.
pub(crate) struct MindsMut<'a> {
    pub states: &'a mut [f64],
    pub positions: &'a mut [Position],
    pub status: &'a mut [u8],
    pub slots: &'a mut [i64],
    pub subgoals: &'a mut [u8],
    pub drawn: &'a mut [u64],
    at: Offsets,
}

#[derive(Clone, Copy)]
struct Offsets {
    states: usize,
    units: usize,
    nodes: usize,
    subgoals: usize,
    instance: usize,
}

impl Offsets {
    /// Where instance `i` begins.
    fn of(cast: &Cast, i: usize) -> Offsets {
        match cast.instances.get(i) {
            Some(x) => Offsets {
                states: x.states,
                units: x.units as usize,
                nodes: x.nodes,
                subgoals: x.subgoals,
                instance: i,
            },
            None => Offsets {
                states: cast.states.len(),
                units: cast.units.len(),
                nodes: cast.nodes,
                subgoals: cast.subgoals,
                instance: cast.instances.len(),
            },
        }
    }
}

/// The mind of one agent.
pub(crate) struct MindMut<'a> {
    pub states: &'a mut [f64],
    pub positions: &'a mut [Position],
    pub status: &'a mut [u8],
    pub slots: &'a mut [i64],
    pub subgoals: &'a mut [u8],
    pub drawn: &'a mut u64,
}

impl Minds {
    pub fn new(cast: &Cast) -> Self {
        Minds {
            states: cast.states.clone(),
            positions: vec![Position::default(); cast.units.len()],
            status: vec![0; cast.nodes],
            slots: vec![0; cast.nodes],
            subgoals: vec![ACTIVE; cast.subgoals],
            drawn: vec![0; cast.instances.len()],
        }
    }

    /// Whether these are minds of the same agents.
    pub fn fits(&self, other: &Minds, mission: &Mission, cast: &Cast) -> bool {
        let shape = |m: &Minds| {
            let known = (m.states.len(), m.positions.len(), m.subgoals.len());
            (known, m.status.len(), m.slots.len(), m.drawn.len())
        };
        let is_state = |(p, unit): (&Position, &UnitInfo)| {
            let agent = cast.instances[unit.instance as usize].agent;
            match &mission.agents[agent as usize].units[unit.unit as usize].kind {
                KindCode::Machine { states, .. } => (p.state as usize) < states.len(),
                _ => true,
            }
        };
        shape(self) == shape(other) && self.positions.iter().zip(&cast.units).all(is_state)
    }

    /// A view of all.
    pub fn all(&mut self, cast: &Cast) -> MindsMut<'_> {
        MindsMut {
            states: &mut self.states,
            positions: &mut self.positions,
            status: &mut self.status,
            slots: &mut self.slots,
            subgoals: &mut self.subgoals,
            drawn: &mut self.drawn,
            at: Offsets::of(cast, 0),
        }
    }
}

impl<'a> MindsMut<'a> {
    /// The minds before instance `i`, and from it on.
    pub fn split_at(self, cast: &Cast, i: usize) -> (MindsMut<'a>, MindsMut<'a>) {
        let (a, b) = (self.at, Offsets::of(cast, i));
        let (states, states_b) = self.states.split_at_mut(b.states - a.states);
        let (positions, positions_b) = self.positions.split_at_mut(b.units - a.units);
        let (status, status_b) = self.status.split_at_mut(b.nodes - a.nodes);
        let (slots, slots_b) = self.slots.split_at_mut(b.nodes - a.nodes);
        let (subgoals, subgoals_b) = self.subgoals.split_at_mut(b.subgoals - a.subgoals);
        let (drawn, drawn_b) = self.drawn.split_at_mut(b.instance - a.instance);
        (
            MindsMut { states, positions, status, slots, subgoals, drawn, at: a },
            MindsMut {
                states: states_b,
                positions: positions_b,
                status: status_b,
                slots: slots_b,
                subgoals: subgoals_b,
                drawn: drawn_b,
                at: b,
            },
        )
    }

    /// The mind of instance `i`, which must be in this view.
    pub fn mind(&mut self, cast: &Cast, i: usize) -> MindMut<'_> {
        let (from, to, at) = (Offsets::of(cast, i), Offsets::of(cast, i + 1), self.at);
        let nodes = from.nodes - at.nodes..to.nodes - at.nodes;
        MindMut {
            states: &mut self.states[from.states - at.states..to.states - at.states],
            positions: &mut self.positions[from.units - at.units..to.units - at.units],
            status: &mut self.status[nodes.clone()],
            slots: &mut self.slots[nodes],
            subgoals: &mut self.subgoals[from.subgoals - at.subgoals..to.subgoals - at.subgoals],
            drawn: &mut self.drawn[from.instance - at.instance],
        }
    }
}
