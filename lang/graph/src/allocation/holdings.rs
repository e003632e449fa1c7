//! Who holds whom while an allocation is made.

use super::work::Meter;
use super::{Choice, Need, Problem};

/// The choices of the tasks that are served, and the task that holds each exclusive agent.
#[derive(Clone)]
pub(super) struct Holdings<'p> {
    problem: &'p Problem,
    holders: Vec<Option<u32>>,
    choices: Vec<Option<Choice>>,
}

impl<'p> Holdings<'p> {
    /// Nobody serves anything.
    pub fn new(problem: &'p Problem) -> Self {
        Holdings {
            problem,
            holders: vec![None; problem.agents.len()],
            choices: vec![None; problem.tasks.len()],
        }
    }

    /// How a task is served.
    pub fn choice(&self, task: u32) -> Option<&Choice> {
        self.choices.get(task as usize)?.as_ref()
    }

    /// The task that holds an exclusive agent.
    pub fn holder(&self, agent: u32) -> Option<u32> {
        self.holders.get(agent as usize).copied().flatten()
    }

    /// The exclusive agents that a task holds, each once.
    pub fn held(&self, task: u32) -> Vec<u32> {
        let agents = self.choice(task).map_or(&[][..], |c| &c.agents);
        let mut held: Vec<u32> = agents.iter().copied().filter(|a| self.problem.is_exclusive(*a)).collect();
        held.sort_unstable();
        held.dedup();
        held
    }

    /// Serves a task in this way and no longer in another.
    pub fn serve(&mut self, task: u32, choice: Choice) {
        self.release(task);
        if let Some(place) = self.choices.get_mut(task as usize) {
            *place = Some(choice);
        }
        let held = self.held(task);
        self.reserve(task, &held);
    }

    /// Serves a task no longer; gives back how it was served.
    pub fn release(&mut self, task: u32) -> Option<Choice> {
        for agent in self.held(task) {
            if let Some(holder) = self.holders.get_mut(agent as usize).filter(|h| **h == Some(task)) {
                *holder = None;
            }
        }
        self.choices.get_mut(task as usize)?.take()
    }

    /// Moves several tasks at once: each is given agents that are enough for it, and then chooses among these
    /// and those that are free. It stays as near to its old choice as it can.
    pub fn rearrange(&mut self, moved: &[(u32, Vec<u32>)], old: Option<(u32, &Choice)>, meter: &mut Meter) {
        let mut before: Vec<Option<Choice>> = moved.iter().map(|(task, _)| self.release(*task)).collect();
        for ((task, agents), before) in moved.iter().zip(&mut before) {
            self.reserve(*task, agents);
            if let Some((_, choice)) = old.filter(|(t, _)| t == task) {
                *before = Some(choice.clone());
            }
        }
        for ((task, agents), before) in moved.iter().zip(before) {
            let choice = self.free_choice(*task, before.as_ref(), meter);
            for agent in agents {
                if let Some(holder) = self.holders.get_mut(*agent as usize) {
                    *holder = None;
                }
            }
            if let Some(choice) = choice {
                self.serve(*task, choice);
            }
        }
    }

    /// How a task can be served by agents that no other task holds: as before where that is possible, with
    /// other agents only for needs that lost theirs; otherwise in the first way that is possible, by the
    /// first candidate of each need.
    ///
    /// Needs do not disturb each other, since one agent may serve several needs of a task.
    pub fn free_choice(&self, task: u32, before: Option<&Choice>, meter: &mut Meter) -> Option<Choice> {
        let ways = self.problem.ways(task);
        if let Some(choice) = before
            && let Some(way) = ways.get(choice.way as usize)
            && way.needs.len() == choice.agents.len()
        {
            let stay = |(need, agent): (&Need, &u32)| {
                if self.is_free(*agent, task) { Some(*agent) } else { self.first_free(need, task, meter) }
            };
            let agents: Option<Vec<u32>> = way.needs.iter().zip(&choice.agents).map(stay).collect();
            if let Some(agents) = agents {
                return Some(Choice { agents, ..choice.clone() });
            }
        }
        (0..).zip(ways).find_map(|(number, way)| {
            let agents = way.needs.iter().map(|n| self.first_free(n, task, meter));
            Some(Choice { way: number, label: way.label, agents: agents.collect::<Option<Vec<u32>>>()? })
        })
    }

    fn first_free(&self, need: &Need, task: u32, meter: &mut Meter) -> Option<u32> {
        need.candidates.iter().copied().find(|agent| {
            meter.steps += 1;
            self.is_free(*agent, task)
        })
    }

    /// Whether an agent can serve a task without being taken from another.
    fn is_free(&self, agent: u32, task: u32) -> bool {
        self.problem.is_available(agent)
            && (!self.problem.is_exclusive(agent) || self.holder(agent).is_none_or(|holder| holder == task))
    }

    fn reserve(&mut self, task: u32, agents: &[u32]) {
        for agent in agents {
            if let Some(holder) = self.holders.get_mut(*agent as usize) {
                *holder = Some(task);
            }
        }
    }
}
