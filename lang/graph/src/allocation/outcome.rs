//! What comes out of an allocation.

use serde::{Deserialize, Serialize};

/// How a task stands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It is served.
    Served(Choice),
    /// It cannot be served.
    Refused(Refusal),
    /// Not yet solved, or the search was given up at its limit.
    Undecided,
    /// It is no longer wanted.
    Removed,
}

/// How a task is served.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// Index of the way.
    pub way: u32,
    /// The way's label.
    pub label: u32,
    /// The agent for each need of the way.
    pub agents: Vec<u32>,
}

/// Why a task is not served, in the order in which a matcher asks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Refusal {
    /// It has no way at all: the system is not compatible.
    NoPlan,
    /// Every way has a need without any candidate: the robot is not functionally competent.
    NoCapable {
        /// For each way its first such need.
        needs: Vec<u32>,
    },
    /// There are candidates, but they are not available or taken.
    NotAvailable {
        /// Tasks that compete, this one among them: all of them cannot be served together. When it is found
        /// out, no task is needless, up to 64 tasks and within the limit of steps: without any one of them
        /// the rest could be served. It stays true as it is when more agents are lost.
        tasks: Vec<u32>,
        /// The available exclusive agents they compete for, too few: these tasks could not all be served even
        /// if every other agent that is available were collaborative. Where each task needs one agent, these
        /// are all candidates that are available, one fewer than tasks.
        agents: Vec<u32>,
        /// Candidates of these tasks that are not available. Nothing but the return of one of them, a new
        /// candidate, or the end of a competing task can help.
        unavailable: Vec<u32>,
    },
}

/// What an operation changed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Changes {
    /// Tasks whose outcome is another than before, in order.
    pub tasks: Vec<Change>,
    /// How many tasks the operation looked at.
    pub looked_at: usize,
    /// How many candidates it looked at, counted as often as it did: the work it was.
    pub steps: u64,
}

/// How one task changed; its present outcome is with the matcher.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Task.
    pub task: u32,
    /// How it was served before.
    pub before: Option<Choice>,
    /// How it is served now.
    pub after: Option<Choice>,
    /// Agents that do not serve it any more, also those that are lost.
    pub released: Vec<u32>,
    /// Agents that are to serve it from now on.
    pub requested: Vec<u32>,
}

impl Outcome {
    /// How the task is served.
    pub fn choice(&self) -> Option<&Choice> {
        match self {
            Outcome::Served(choice) => Some(choice),
            _ => None,
        }
    }
}

impl Change {
    /// The change from one outcome to another.
    pub(super) fn between(task: u32, before: &Outcome, after: &Outcome) -> Change {
        let agents = |o: &Outcome| {
            let mut agents = o.choice().map_or_else(Vec::new, |c| c.agents.clone());
            agents.sort_unstable();
            agents.dedup();
            agents
        };
        let (old, new) = (agents(before), agents(after));
        let without = |all: &[u32], some: &[u32]| all.iter().copied().filter(|a| !some.contains(a)).collect();
        Change {
            task,
            released: without(&old, &new),
            requested: without(&new, &old),
            before: before.choice().cloned(),
            after: after.choice().cloned(),
        }
    }
}
