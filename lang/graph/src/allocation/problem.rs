//! What is to be allocated.

use super::Refusal;
use serde::{Deserialize, Serialize};

/// Agents and tasks; everything refers to them by their index.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Problem {
    /// Agents.
    pub agents: Vec<Agent>,
    /// Tasks; where not all can be served, earlier ones have priority.
    pub tasks: Vec<Task>,
}

/// An agent on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Agent {
    /// Whether it serves several tasks at a time; otherwise it is exclusive.
    pub collaborative: bool,
    /// False while it is dead, gone or has refused.
    pub available: bool,
}

/// A sub-goal on a robot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Task {
    /// Alternatives, the best first.
    pub ways: Vec<Way>,
}

/// A way to achieve a task: a plan on a robot.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Way {
    /// Tells the caller which it is; means nothing here.
    pub label: u32,
    /// All of them must be served.
    pub needs: Vec<Need>,
}

/// A service that a way needs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Need {
    /// Agents that offer it, the best first. Numbers that no agent has are taken out.
    pub candidates: Vec<u32>,
}

/// A place among the candidates of a need, for an agent that is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// Task.
    pub task: u32,
    /// Way of the task.
    pub way: u32,
    /// Need of the way.
    pub need: u32,
    /// How many candidates go before it; with a large number it is the last.
    pub rank: u32,
}

impl Problem {
    /// The agent of a number.
    pub fn agent(&self, number: u32) -> Option<&Agent> {
        self.agents.get(number as usize)
    }

    /// The ways of a task; none for a number that no task has.
    pub fn ways(&self, task: u32) -> &[Way] {
        self.tasks.get(task as usize).map_or(&[], |t| &t.ways)
    }

    /// Takes candidates that are no agents out of the tasks from this one on, lest they become agents later.
    pub(super) fn tidy(&mut self, first: usize) {
        let Problem { agents, tasks } = self;
        for need in tasks.iter_mut().skip(first).flat_map(|t| &mut t.ways).flat_map(|w| &mut w.needs) {
            need.candidates.retain(|agent| (*agent as usize) < agents.len());
        }
    }

    /// Whether an agent is there and can be asked.
    pub(super) fn is_available(&self, agent: u32) -> bool {
        self.agent(agent).is_some_and(|a| a.available)
    }

    /// Whether an agent serves one task at most.
    pub(super) fn is_exclusive(&self, agent: u32) -> bool {
        self.agent(agent).is_some_and(|a| !a.collaborative)
    }

    /// Whether a collaborative agent can serve a need, so that nobody has to stand back for it.
    pub(super) fn costs_nothing(&self, need: &Need) -> bool {
        need.candidates.iter().any(|a| self.agent(*a).is_some_and(|a| a.collaborative && a.available))
    }

    /// Whether every need of a way has a candidate, available or not.
    pub(super) fn has_candidates(&self, way: &Way) -> bool {
        way.needs.iter().all(|need| self.has_candidate(need))
    }

    fn has_candidate(&self, need: &Need) -> bool {
        need.candidates.iter().any(|a| self.agent(*a).is_some())
    }

    /// Why a task can be served with none of the agents, whether they are available or not.
    pub(super) fn hopeless(&self, task: u32) -> Option<Refusal> {
        let ways = self.ways(task);
        if ways.is_empty() {
            return Some(Refusal::NoPlan);
        }
        let lacking = |way: &Way| (0..).zip(&way.needs).find(|(_, n)| !self.has_candidate(n)).map(|(n, _)| n);
        let needs: Option<Vec<u32>> = ways.iter().map(lacking).collect();
        needs.map(|needs| Refusal::NoCapable { needs })
    }
}
