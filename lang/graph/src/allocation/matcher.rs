//! An allocation that is kept up to date.

use super::work::Work;
use super::{Agent, Change, Changes, Choice, Outcome, Place, Problem, Refusal, Task, check};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// After how many steps the search in one component, or in one repair, gives up.
pub const STEP_LIMIT: u64 = 10_000_000;

/// A problem and its allocation at present. See [`crate::allocation`] for what is promised.
///
/// Numbers that no agent or task has are taken for what is not there: nothing changes. Reading one from a
/// file fails when its outcomes are no allocation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Matcher {
    problem: Problem,
    outcomes: Vec<Outcome>,
    limit: u64,
}

#[derive(Deserialize)]
struct Unchecked {
    problem: Problem,
    outcomes: Vec<Outcome>,
    limit: u64,
}

impl TryFrom<Unchecked> for Matcher {
    type Error = String;

    fn try_from(mut read: Unchecked) -> Result<Self, String> {
        read.problem.tidy(0);
        check(&read.problem, &read.outcomes)?;
        Ok(Matcher { problem: read.problem, outcomes: read.outcomes, limit: read.limit })
    }
}

impl Matcher {
    /// Holds a problem; nothing is decided yet.
    pub fn new(problem: Problem) -> Self {
        Matcher::with_limit(problem, STEP_LIMIT)
    }

    /// The same with another limit than [`STEP_LIMIT`].
    pub fn with_limit(mut problem: Problem, limit: u64) -> Self {
        problem.tidy(0);
        let outcomes = vec![Outcome::Undecided; problem.tasks.len()];
        Matcher { problem, outcomes, limit }
    }

    /// Agents and tasks as they are at present.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How each task stands, by its number.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// How a task stands; one that is not there is removed.
    pub fn outcome(&self, task: u32) -> &Outcome {
        self.outcomes.get(task as usize).unwrap_or(&Outcome::Removed)
    }

    /// Allocates all tasks anew, whatever they have at present.
    pub fn solve(&mut self) -> Changes {
        let wanted = self.tasks_with(|outcome| *outcome != Outcome::Removed);
        let mut work = Work::new(&self.problem, &[]);
        work.serve_all(&wanted, self.limit);
        adopt(&mut self.outcomes, work)
    }

    /// An agent is no longer available. The tasks that it serves get another: one that is free if there is
    /// one, otherwise others are moved; those that cannot be served any more are refused.
    pub fn agent_lost(&mut self, agent: u32) -> Changes {
        match self.problem.agents.get_mut(agent as usize) {
            Some(a) if a.available => a.available = false,
            _ => return Changes::default(),
        }
        let lost = self.tasks_with(|outcome| outcome.choice().is_some_and(|c| c.agents.contains(&agent)));
        // It is no longer among those that others compete for.
        self.repair(&lost, |_, refusal| match refusal {
            Some(Refusal::NotAvailable { agents, .. }) => agents.contains(&agent),
            _ => false,
        })
    }

    /// An agent is available again. Tasks that were refused for want of it are tried again.
    pub fn agent_returned(&mut self, agent: u32) -> Changes {
        match self.problem.agents.get_mut(agent as usize) {
            Some(a) if !a.available => a.available = true,
            _ => return Changes::default(),
        }
        self.repair(&[], |_, refusal| match refusal {
            Some(Refusal::NotAvailable { unavailable, .. }) => unavailable.contains(&agent),
            Some(_) => false,
            None => true,
        })
    }

    /// An agent appears that offers what these needs ask for; gives its number. Tasks that were refused for
    /// want of candidates are tried again. Places that are not there are passed over.
    pub fn agent_added(&mut self, agent: Agent, places: &[Place]) -> (u32, Changes) {
        let number = u32::try_from(self.problem.agents.len()).unwrap_or(u32::MAX);
        self.problem.agents.push(agent);
        let mut tasks = BTreeSet::new();
        for place in places {
            let task = self.problem.tasks.get_mut(place.task as usize);
            let way = task.and_then(|t| t.ways.get_mut(place.way as usize));
            if let Some(need) = way.and_then(|w| w.needs.get_mut(place.need as usize)) {
                need.candidates.insert(need.candidates.len().min(place.rank as usize), number);
                tasks.insert(place.task);
            }
        }
        let changes = self.repair(&[], |task, refusal| match refusal {
            Some(Refusal::NotAvailable { tasks: rivals, .. }) => rivals.iter().any(|r| tasks.contains(r)),
            Some(_) => tasks.contains(&task),
            None => true,
        });
        (number, changes)
    }

    /// A task appears; gives its number. Others are moved for it if necessary, but none is refused.
    pub fn task_added(&mut self, task: Task) -> (u32, Changes) {
        let number = u32::try_from(self.problem.tasks.len()).unwrap_or(u32::MAX);
        self.problem.tasks.push(task);
        self.problem.tidy(self.outcomes.len());
        self.outcomes.push(Outcome::Undecided);
        (number, self.repair(&[], |task, _| task == number))
    }

    /// A task is no longer wanted: its agents are free, and tasks that competed with it are tried again. Its
    /// number stays its own.
    pub fn task_removed(&mut self, task: u32) -> Changes {
        let Some(outcome) = self.outcomes.get_mut(task as usize).filter(|o| **o != Outcome::Removed) else {
            return Changes::default();
        };
        let before = std::mem::replace(outcome, Outcome::Removed);
        if let Some(task) = self.problem.tasks.get_mut(task as usize) {
            task.ways = Vec::new();
        }
        let was_served = before.choice().is_some();
        let mut changes = self.repair(&[], |_, refusal| match refusal {
            Some(Refusal::NotAvailable { tasks, .. }) => was_served && tasks.contains(&task),
            Some(_) => false,
            None => was_served,
        });
        changes.tasks.push(Change::between(task, &before, &Outcome::Removed));
        changes.tasks.sort_by_key(|change| change.task);
        changes
    }

    /// Serves the tasks that lost an agent in some other manner, and then those of the others for which that
    /// may have become possible: where `is_open` says so of the refusal (none for what is undecided), or
    /// where one of the tasks they compete with is not served any more. What else was refused cannot be
    /// served now either: its refusal is a proof, and nothing in it has changed.
    fn repair(&mut self, lost: &[u32], is_open: impl Fn(u32, Option<&Refusal>) -> bool) -> Changes {
        let mut work = Work::new(&self.problem, &self.outcomes);
        let before: Vec<(u32, Option<Choice>)> =
            lost.iter().map(|task| (*task, work.holdings.release(*task))).collect();
        let mut left = self.limit;
        let mut unserved = BTreeSet::new();
        let rest: Vec<_> =
            before.iter().filter(|(task, old)| !work.serve_free(*task, old.as_ref())).collect();
        for (task, old) in rest {
            left = left.saturating_sub(work.serve(*task, old.as_ref(), left));
            if work.holdings.choice(*task).is_none() {
                unserved.insert(*task);
            }
        }
        for (task, outcome) in (0..).zip(&self.outcomes) {
            let is_tried = match outcome {
                Outcome::Undecided => !unserved.is_empty() || is_open(task, None),
                Outcome::Refused(refusal) => {
                    is_open(task, Some(refusal))
                        || matches!(refusal, Refusal::NotAvailable { tasks, .. }
                            if tasks.iter().any(|t| unserved.contains(t)))
                }
                Outcome::Served(_) | Outcome::Removed => false,
            };
            if is_tried {
                left = left.saturating_sub(work.serve(task, None, left));
            }
        }
        adopt(&mut self.outcomes, work)
    }

    fn tasks_with(&self, is_meant: impl Fn(&Outcome) -> bool) -> Vec<u32> {
        (0..).zip(&self.outcomes).filter(|(_, outcome)| is_meant(outcome)).map(|(task, _)| task).collect()
    }
}

/// Takes over the outcomes of an operation and tells which are new.
fn adopt(outcomes: &mut [Outcome], work: Work) -> Changes {
    let (looked_at, steps) = (work.meter.looked_at.len(), work.meter.steps);
    let mut tasks = Vec::new();
    for (task, after) in work.outcomes {
        if let Some(before) = outcomes.get_mut(task as usize).filter(|before| **before != after) {
            tasks.push(Change::between(task, before, &after));
            *before = after;
        }
    }
    Changes { tasks, looked_at, steps }
}
