//! One operation on an allocation, from its beginning to its end.

use super::catalogue::Catalogue;
use super::components::components;
use super::conflict::Rivals;
use super::holdings::Holdings;
use super::search::{Verdict, search};
use super::seating::Hall;
use super::{Choice, Outcome, Problem};
use std::collections::{BTreeMap, BTreeSet};

/// What an operation cost.
#[derive(Default)]
pub(super) struct Meter {
    /// Candidates looked at.
    pub steps: u64,
    /// Tasks looked at.
    pub looked_at: BTreeSet<u32>,
}

/// An allocation while it is made. Availability does not change in the meantime.
pub(super) struct Work<'p> {
    /// What is to be allocated.
    pub problem: &'p Problem,
    /// Who serves what so far.
    pub holdings: Holdings<'p>,
    /// Forms of tasks.
    pub catalogue: Catalogue<'p>,
    /// What it cost.
    pub meter: Meter,
    /// Outcomes that are new.
    pub outcomes: BTreeMap<u32, Outcome>,
    /// By set of candidates: the tasks that between them need all agents a task with these candidates could
    /// get. They are served, and remain so for the whole operation.
    full: BTreeMap<u32, Rivals>,
}

impl<'p> Work<'p> {
    /// Goes on from these outcomes.
    pub fn new(problem: &'p Problem, outcomes: &[Outcome]) -> Self {
        let mut holdings = Holdings::new(problem);
        for (task, outcome) in (0..).zip(outcomes) {
            if let Some(choice) = outcome.choice() {
                holdings.serve(task, choice.clone());
            }
        }
        let catalogue = Catalogue::new(problem);
        let (meter, outcomes, full) = (Meter::default(), BTreeMap::new(), BTreeMap::new());
        Work { problem, holdings, catalogue, meter, outcomes, full }
    }

    /// Serves a task by agents that are free, if that is possible.
    pub fn serve_free(&mut self, task: u32, before: Option<&Choice>) -> bool {
        self.meter.looked_at.insert(task);
        let choice = self.holdings.free_choice(task, before, &mut self.meter);
        choice.map(|choice| self.settle(task, choice)).is_some()
    }

    /// Serves a task, moving others if that is necessary; refuses it if that is impossible. Tells how many
    /// steps of the limit that took.
    pub fn serve(&mut self, task: u32, before: Option<&Choice>, limit: u64) -> u64 {
        self.meter.looked_at.insert(task);
        if let Some(refusal) = self.problem.hopeless(task) {
            self.outcomes.insert(task, Outcome::Refused(refusal));
            return 0;
        }
        if self.serve_free(task, before) {
            return 0;
        }
        // Many are refused for the same reason, if at all: needs for one service have the same candidates.
        let set = self.only_set(task);
        if let Some(rivals) = set.and_then(|set| self.full.get(&set)).cloned() {
            self.refuse(task, rivals);
            return 0;
        }
        let (catalogue, meter) = (&mut self.catalogue, &mut self.meter);
        let (verdict, mut spent) =
            search(task, limit, &mut Hall { catalogue, holdings: &self.holdings, meter });
        match verdict {
            Verdict::Possible(moved) => {
                self.holdings.rearrange(&moved, before.map(|b| (task, b)), &mut self.meter);
                for (task, _) in moved {
                    let choice = self.holdings.choice(task).cloned();
                    self.outcomes.insert(task, choice.map_or(Outcome::Undecided, Outcome::Served));
                }
            }
            Verdict::Impossible(mut conflict) => {
                let set = set.filter(|_| self.is_narrow(&conflict));
                if set.is_none() {
                    let steps = self.narrow(task, &mut conflict, limit.saturating_sub(spent));
                    spent = spent.saturating_add(steps);
                }
                let rivals = self.rivals(task, conflict);
                if let Some(set) = set {
                    self.full.insert(set, rivals.clone());
                }
                self.refuse(task, rivals);
            }
            Verdict::Undecided => {
                self.outcomes.insert(task, Outcome::Undecided);
            }
        }
        spent
    }

    /// The candidates of a task for which one of them is always enough.
    fn only_set(&mut self, task: u32) -> Option<u32> {
        match &self.catalogue.forms(task, &mut self.meter).all[..] {
            [form] => match &form[..] {
                [demand] => Some(demand.set),
                _ => None,
            },
            _ => None,
        }
    }

    /// Serves these tasks from nothing, in order; `limit` is for each component.
    pub fn serve_all(&mut self, tasks: &[u32], limit: u64) {
        // Components are found out when the first search takes steps of its limit; most problems need none.
        let mut parts: Option<Vec<u32>> = None;
        let mut spent: BTreeMap<u32, u64> = BTreeMap::new();
        for task in tasks {
            let part = |parts: &Vec<u32>| parts.get(*task as usize).copied().unwrap_or_default();
            let used = parts.as_ref().and_then(|all| spent.get(&part(all)).copied()).unwrap_or_default();
            let steps = self.serve(*task, None, limit.saturating_sub(used));
            if steps > 0 {
                let all = parts.get_or_insert_with(|| components(self.problem, &mut self.meter));
                spent.insert(part(all), used.saturating_add(steps));
            }
        }
        self.improve(tasks, limit);
    }

    /// Lets every task have the best that it can have without taking from others, until none can have better:
    /// what one leaves may be better for another. Everyone only ever changes for the better, so that it ends.
    fn improve(&mut self, tasks: &[u32], limit: u64) {
        let start = self.meter.steps;
        let mut is_settled = false;
        while !is_settled && self.meter.steps - start <= limit {
            is_settled = true;
            for task in tasks {
                let Some(present) = self.holdings.choice(*task) else { continue };
                let best = self.holdings.free_choice(*task, None, &mut self.meter);
                if let Some(choice) = best.filter(|best| best != present) {
                    is_settled = false;
                    self.settle(*task, choice);
                }
            }
        }
    }

    fn settle(&mut self, task: u32, choice: Choice) {
        self.outcomes.insert(task, Outcome::Served(choice.clone()));
        self.holdings.serve(task, choice);
    }
}
