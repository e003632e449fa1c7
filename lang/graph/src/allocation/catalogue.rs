//! What tasks take: the forms in which each can be served, in terms of exclusive agents alone.
//!
//! A need that an available collaborative agent can serve takes nothing. Two needs of a way may be served by
//! one agent or by two; each such grouping is a form of its own, so that within a form every demand is for an
//! agent of its own, and finding agents for chosen forms is a bipartite matching.

use super::work::Meter;
use super::{Need, Problem, Way};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Most forms of one task that are considered. Seven needs of a way can be grouped in fewer ways.
const MOST_FORMS: usize = 1024;

/// Most needs of a way for which it is considered that one agent may serve several.
const MOST_GROUPED: usize = 64;

/// A demand for one of several exclusive agents.
#[derive(Clone)]
pub(super) struct Demand {
    /// The available ones, the best first.
    pub order: Rc<[u32]>,
    /// The same by number.
    pub members: Rc<[u32]>,
    /// The same for every demand with these members.
    pub set: u32,
}

/// One of the forms in which a task can be served: all of these demands, by different agents.
pub(super) type Form = Vec<Demand>;

/// The forms of a task.
pub(super) struct Forms {
    /// The forms; none that takes an agent that would be enough by itself, and others besides.
    pub all: Vec<Form>,
    /// False when there are more than are considered.
    pub complete: bool,
}

/// Forms of tasks, worked out when they are first asked for. It holds for as long as nobody becomes available
/// or unavailable.
pub(super) struct Catalogue<'p> {
    problem: &'p Problem,
    sets: BTreeMap<Rc<[u32]>, u32>,
    known: BTreeMap<u32, Rc<Forms>>,
}

impl<'p> Catalogue<'p> {
    /// An empty catalogue.
    pub fn new(problem: &'p Problem) -> Self {
        Catalogue { problem, sets: BTreeMap::new(), known: BTreeMap::new() }
    }

    /// The forms of a task.
    pub fn forms(&mut self, task: u32, meter: &mut Meter) -> Rc<Forms> {
        if let Some(forms) = self.known.get(&task) {
            return Rc::clone(forms);
        }
        let forms = Rc::new(self.compile(task, meter));
        self.known.insert(task, Rc::clone(&forms));
        forms
    }

    /// A demand for one of these agents; it is no matter if some are named twice.
    pub fn demand(&mut self, mut order: Vec<u32>) -> Demand {
        let mut members = order.clone();
        members.sort_unstable();
        if members.windows(2).any(|pair| pair.first() == pair.last()) {
            members.dedup();
            let mut seen = BTreeSet::new();
            order.retain(|agent| seen.insert(*agent));
        }
        let members: Rc<[u32]> = members.into();
        let next = u32::try_from(self.sets.len()).unwrap_or(u32::MAX);
        let set = *self.sets.entry(Rc::clone(&members)).or_insert(next);
        Demand { order: order.into(), members, set }
    }

    fn compile(&mut self, task: u32, meter: &mut Meter) -> Forms {
        let (mut single, mut several, mut complete) = (Vec::new(), Vec::new(), true);
        for way in self.problem.ways(task) {
            let Some(demands) = self.demands(way, meter) else { continue };
            if demands.is_empty() {
                return Forms { all: vec![Vec::new()], complete: true };
            }
            let (found, is_all) = self.groupings(demands, MOST_FORMS.saturating_sub(several.len()), meter);
            complete &= is_all;
            for form in found {
                match <[Demand; 1]>::try_from(form) {
                    Ok([demand]) => single.push(demand),
                    Err(form) => several.push(form),
                }
            }
        }
        // Where one agent is enough it does not matter in which way: all those ways are one form.
        let single = match <[Demand; 1]>::try_from(single) {
            Ok([demand]) => Some(demand),
            Err(none) if none.is_empty() => None,
            Err(many) => Some(self.demand(many.iter().flat_map(|d| d.order.iter().copied()).collect())),
        };
        let mut all: Vec<Form> = single.clone().map(|demand| vec![demand]).into_iter().collect();
        let mut kinds = BTreeSet::new();
        for form in several {
            let mut kind: Vec<u32> = form.iter().map(|d| d.set).collect();
            kind.sort_unstable();
            let is_needless = single.as_ref().is_some_and(|s| form.iter().any(|d| d.is_within(s)));
            if !is_needless && kinds.insert(kind) {
                all.push(form);
            }
        }
        Forms { all, complete }
    }

    /// The demands of a way, none of which is met whenever another is; `None` when nobody is available for a
    /// need.
    fn demands(&mut self, way: &Way, meter: &mut Meter) -> Option<Vec<Demand>> {
        let mut demands: Vec<Demand> = Vec::new();
        for need in &way.needs {
            meter.steps += need.candidates.len() as u64;
            if self.problem.costs_nothing(need) {
                continue;
            }
            let order = self.available(need);
            if order.is_empty() {
                return None;
            }
            let demand = self.demand(order);
            if demands.iter().any(|d| d.is_within(&demand)) {
                continue;
            }
            demands.retain(|d| !demand.is_within(d));
            demands.push(demand);
        }
        Some(demands)
    }

    /// The forms of a way with these demands, so many at most, and whether these are all.
    fn groupings(&mut self, demands: Vec<Demand>, room: usize, meter: &mut Meter) -> (Vec<Form>, bool) {
        let mut agents: Vec<u32> = demands.iter().flat_map(|d| d.members.iter().copied()).collect();
        agents.sort_unstable();
        let is_apart = agents.windows(2).all(|pair| pair.first() != pair.last());
        if is_apart || demands.len() > MOST_GROUPED {
            return (vec![demands], is_apart);
        }
        let mut grouping = Grouping { catalogue: self, groups: Vec::new(), found: Vec::new(), room };
        let is_all = grouping.extend(&demands, meter);
        (grouping.found, is_all)
    }

    fn available(&self, need: &Need) -> Vec<u32> {
        let is_usable = |a: &u32| self.problem.is_available(*a) && self.problem.is_exclusive(*a);
        need.candidates.iter().copied().filter(is_usable).collect()
    }
}

impl Demand {
    /// Whether an agent can meet it.
    pub fn has(&self, agent: u32) -> bool {
        self.members.binary_search(&agent).is_ok()
    }

    /// Whether whoever meets this demand meets the other.
    fn is_within(&self, other: &Demand) -> bool {
        self.set == other.set
            || (self.members.len() <= other.members.len() && self.members.iter().all(|a| other.has(*a)))
    }
}

/// The ways to group the demands of a way so that one agent can meet all of a group: each alone first.
struct Grouping<'c, 'p> {
    catalogue: &'c mut Catalogue<'p>,
    groups: Form,
    found: Vec<Form>,
    room: usize,
}

impl Grouping<'_, '_> {
    /// Adds the first of the demands to the groups so far in every possible manner, then the others. False
    /// when there is no room for all that is found.
    fn extend(&mut self, demands: &[Demand], meter: &mut Meter) -> bool {
        if self.found.len() >= self.room {
            return false;
        }
        let Some((demand, rest)) = demands.split_first() else {
            self.found.push(self.groups.clone());
            return true;
        };
        self.groups.push(demand.clone());
        let mut complete = self.extend(rest, meter);
        self.groups.pop();
        for place in 0..self.groups.len() {
            let Some(group) = self.groups.get(place).cloned() else { continue };
            meter.steps += group.order.len() as u64;
            let common: Vec<u32> = group.order.iter().copied().filter(|a| demand.has(*a)).collect();
            if common.is_empty() {
                continue;
            }
            let common = self.catalogue.demand(common);
            if let Some(slot) = self.groups.get_mut(place) {
                *slot = common;
            }
            complete &= self.extend(rest, meter);
            if let Some(slot) = self.groups.get_mut(place) {
                *slot = group;
            }
        }
        complete
    }
}
