//! From a proof that a task cannot be served to a refusal that says with whom it competes.

use super::search::{Conflict, Verdict, search};
use super::seating::Hall;
use super::work::Work;
use super::{Outcome, Refusal, holdings::Holdings};
use std::collections::BTreeSet;

/// What keeps a task from being served.
#[derive(Clone)]
pub(super) struct Rivals {
    /// Tasks that are served and compete with it.
    tasks: BTreeSet<u32>,
    /// The agents that they compete for.
    agents: BTreeSet<u32>,
    /// Candidates of theirs that are not available.
    unavailable: BTreeSet<u32>,
}

/// Most tasks of a conflict of which the needless are taken out one by one.
const MOST_NARROWED: usize = 64;

impl Work<'_> {
    /// Refuses a task because of these.
    pub(super) fn refuse(&mut self, task: u32, mut rivals: Rivals) {
        rivals.tasks.insert(task);
        self.add_unavailable(task, &mut rivals.unavailable);
        let refusal = Refusal::NotAvailable {
            tasks: rivals.tasks.into_iter().collect(),
            agents: rivals.agents.into_iter().collect(),
            unavailable: rivals.unavailable.into_iter().collect(),
        };
        self.outcomes.insert(task, Outcome::Refused(refusal));
    }

    /// The others of a conflict.
    pub(super) fn rivals(&mut self, task: u32, conflict: Conflict) -> Rivals {
        let Conflict { mut tasks, agents } = conflict;
        tasks.remove(&task);
        let mut unavailable = BTreeSet::new();
        for other in &tasks {
            self.add_unavailable(*other, &mut unavailable);
        }
        Rivals { tasks, agents, unavailable }
    }

    /// Takes needless tasks out of a conflict, one by one, as far as the limit goes; tells how many steps of
    /// it that took.
    pub(super) fn narrow(&mut self, task: u32, found: &mut Conflict, limit: u64) -> u64 {
        found.tasks.insert(task);
        if found.tasks.len() > MOST_NARROWED {
            return 0;
        }
        let mut spent: u64 = 0;
        for other in found.tasks.clone() {
            if other == task || !found.tasks.contains(&other) {
                continue;
            }
            let mut holdings = Holdings::new(self.problem);
            for kept in found.tasks.iter().filter(|t| **t != other) {
                if let Some(choice) = self.holdings.choice(*kept) {
                    holdings.serve(*kept, choice.clone());
                }
            }
            if holdings.free_choice(task, None, &mut self.meter).is_some() {
                continue;
            }
            let (catalogue, meter) = (&mut self.catalogue, &mut self.meter);
            let mut hall = Hall { catalogue, holdings: &holdings, meter };
            let (verdict, steps) = search(task, limit.saturating_sub(spent), &mut hall);
            spent = spent.saturating_add(steps);
            if let Verdict::Impossible(smaller) = verdict {
                *found = smaller;
                found.tasks.insert(task);
            }
        }
        spent
    }

    /// Whether no task of a conflict is needless because each has one form only. If one of them is missing,
    /// everybody on the path to it can move up, which leaves a seat for a task that needs one.
    pub(super) fn is_narrow(&mut self, found: &Conflict) -> bool {
        found.tasks.iter().all(|task| self.catalogue.forms(*task, &mut self.meter).all.len() == 1)
    }

    /// Adds the candidates of a task that are not available, for needs that nobody can serve without being
    /// taken away, in ways that somebody could serve.
    fn add_unavailable(&mut self, task: u32, unavailable: &mut BTreeSet<u32>) {
        for way in self.problem.ways(task).iter().filter(|way| self.problem.has_candidates(way)) {
            for need in way.needs.iter().filter(|need| !self.problem.costs_nothing(need)) {
                self.meter.steps += need.candidates.len() as u64;
                let is_missing = |agent: &u32| self.problem.agent(*agent).is_some_and(|a| !a.available);
                unavailable.extend(need.candidates.iter().copied().filter(is_missing));
            }
        }
    }
}
