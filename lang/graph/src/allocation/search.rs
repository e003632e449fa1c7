//! Finding a form for every task so that there are agents for all: a complete search.
//!
//! It changes the allocation at present only where a shortage shows that something must be changed. A
//! shortage (seats with one agent too few) is overcome only if one of its tasks takes a form that demands
//! fewer of the agents; the search decides for one task whether it does, and remembers which tasks a failure
//! was about, so that decisions about other tasks are not tried again.

use super::catalogue::Form;
use super::seating::{Hall, Seating, Shortage};
use std::collections::{BTreeMap, BTreeSet};

/// Tasks that cannot all be served.
#[derive(Clone, Default)]
pub(super) struct Conflict {
    /// Tasks.
    pub tasks: BTreeSet<u32>,
    /// The agents that they are short of.
    pub agents: BTreeSet<u32>,
}

/// What a search finds.
pub(super) enum Verdict {
    /// All can be served: these tasks are to be moved, to agents that are enough for them.
    Possible(Vec<(u32, Vec<u32>)>),
    /// They cannot.
    Impossible(Conflict),
    /// The limit was reached.
    Undecided,
}

/// A decision: a task demands fewer of certain agents than in its form at present, or it does not.
struct Decision {
    task: u32,
    /// Where to go on when it was wrong; then [`Decision::failure`] tells why.
    otherwise: Option<Seating>,
    failure: Conflict,
}

/// Looks for a way to serve a task together with all that are served. It gives up when there are decisions to
/// be made and it has taken `limit` steps. Also tells how many steps it took, none where nothing was to be
/// decided.
pub(super) fn search(task: u32, limit: u64, hall: &mut Hall) -> (Verdict, u64) {
    let start = hall.meter.steps;
    let mut seating = Seating::default();
    let mut decisions: Vec<Decision> = Vec::new();
    let mut has_decided = false;
    hall.meter.looked_at.insert(task);
    if !seating.enter(task, hall) {
        return (Verdict::Impossible(conflict([task], [])), 0);
    }
    let verdict = loop {
        let shortage = match seating.fill(hall) {
            Ok(()) => break Verdict::Possible(seating.moved(hall.holdings)),
            Err(shortage) => shortage,
        };
        let failure = match seating.judge(&shortage, task, hall) {
            Judgement::Open { task, fewer, others } => {
                has_decided = true;
                hall.meter.steps += seating.size();
                if hall.meter.steps - start > limit {
                    break Verdict::Undecided;
                }
                let mut otherwise = seating.clone();
                otherwise.restrict(task, others);
                let form = fewer.first().copied();
                seating.restrict(task, fewer);
                seating.take_form(task, form.unwrap_or_default());
                decisions.push(Decision { task, otherwise: Some(otherwise), failure: Conflict::default() });
                continue;
            }
            Judgement::Closed(failure) => failure,
        };
        match take_back(&mut decisions, failure) {
            Ok(otherwise) => seating = otherwise,
            Err(failure) => break seating.believe(failure, hall),
        }
    };
    (verdict, if has_decided { hall.meter.steps - start } else { 0 })
}

/// Goes back to the last decision that a failure is about and takes the other side of it; if there is none,
/// the failure is final.
fn take_back(decisions: &mut Vec<Decision>, mut failure: Conflict) -> Result<Seating, Conflict> {
    while let Some(decision) = decisions.last_mut() {
        if failure.tasks.contains(&decision.task) {
            if let Some(otherwise) = decision.otherwise.take() {
                decision.failure = failure;
                return Ok(otherwise);
            }
            failure.tasks.append(&mut decision.failure.tasks);
            failure.agents.append(&mut decision.failure.agents);
        }
        decisions.pop();
    }
    Err(failure)
}

/// What a shortage means.
enum Judgement {
    /// It stands whatever forms its tasks take that they may still take.
    Closed(Conflict),
    /// A task could demand fewer of the agents.
    Open {
        task: u32,
        /// Forms in which it does.
        fewer: Vec<usize>,
        /// Forms in which it does not.
        others: Vec<usize>,
    },
}

impl Seating {
    /// Lets a task take only these forms from now on.
    fn restrict(&mut self, task: u32, open: Vec<usize>) {
        if let Some(party) = self.parties.get_mut(&task) {
            party.open = open;
        }
    }

    /// What a shortage means. Decides for the newest task if it can, since that moves nobody else; otherwise
    /// for the one with the fewest forms.
    fn judge(&mut self, shortage: &Shortage, newest: u32, hall: &mut Hall) -> Judgement {
        let mut demands: BTreeMap<u32, usize> = BTreeMap::new();
        for seat in shortage.seats.iter().filter_map(|s| self.seats.get(*s)) {
            *demands.entry(seat.task).or_default() += 1;
        }
        let mut best: Option<((bool, usize, u32), Vec<usize>)> = None;
        for (task, demand) in &demands {
            let Some(party) = self.parties.get(task).filter(|p| p.open.len() > 1) else { continue };
            let demands_fewer = |form: &usize| {
                let form = party.forms.all.get(*form);
                form.is_some_and(|f| demand_for(&shortage.agents, f, &mut hall.meter.steps) < *demand)
            };
            let fewer: Vec<usize> = party.open.iter().copied().filter(demands_fewer).collect();
            let key = (*task != newest, party.open.len(), *task);
            if !fewer.is_empty() && best.as_ref().is_none_or(|(least, _)| key < *least) {
                best = Some((key, fewer));
            }
        }
        let Some(((_, _, task), fewer)) = best else {
            return Judgement::Closed(conflict(demands.into_keys(), shortage.agents.iter().copied()));
        };
        if let Some(conflict) = self.pigeonholes(shortage, hall) {
            return Judgement::Closed(conflict);
        }
        let open = self.parties.get(&task).map_or(&[][..], |p| &p.open);
        let others = open.iter().copied().filter(|f| !fewer.contains(f)).collect();
        Judgement::Open { task, fewer, others }
    }

    /// A failure proves nothing when there are forms that were not considered.
    fn believe(&self, failure: Conflict, hall: &mut Hall) -> Verdict {
        if failure.tasks.iter().all(|task| hall.catalogue.forms(*task, hall.meter).complete) {
            Verdict::Impossible(failure)
        } else {
            Verdict::Undecided
        }
    }
}

/// How many agents out of these a form demands at least.
fn demand_for(agents: &BTreeSet<u32>, form: &Form, steps: &mut u64) -> usize {
    let mut is_inside = |agent: &u32| {
        *steps += 1;
        agents.contains(agent)
    };
    form.iter().filter(|demand| demand.members.iter().all(&mut is_inside)).count()
}

/// A conflict of these tasks about these agents.
pub(super) fn conflict(
    tasks: impl IntoIterator<Item = u32>,
    agents: impl IntoIterator<Item = u32>,
) -> Conflict {
    Conflict { tasks: tasks.into_iter().collect(), agents: agents.into_iter().collect() }
}
