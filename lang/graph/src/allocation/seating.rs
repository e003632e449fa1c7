//! Agents for the demands of tasks in chosen forms: augmenting paths.
//!
//! A seat stands for one demand of one task. The tasks that are served at present are drawn in only when a
//! path reaches one of their agents, so that a change touches what depends on it and nothing else.

use super::catalogue::{Catalogue, Demand, Form, Forms};
use super::holdings::Holdings;
use super::work::Meter;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::rc::Rc;

/// A demand of a task in its present form.
#[derive(Clone)]
pub(super) struct Seat {
    /// Task.
    pub task: u32,
    /// Which demand of the form.
    pub index: usize,
    /// What is demanded.
    pub demand: Demand,
    /// Who has it.
    pub agent: Option<u32>,
}

/// What an exclusive agent does.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Post {
    /// Nothing.
    Free,
    /// It serves a task that could do without it.
    Spare,
    /// It has a seat.
    Seat(usize),
}

/// A task that has been drawn in.
#[derive(Clone)]
pub(super) struct Party {
    /// All its forms.
    pub forms: Rc<Forms>,
    /// Those that it may still take.
    pub open: Vec<usize>,
    /// The one it has.
    pub form: usize,
    /// Its seats in that form.
    pub seats: Vec<usize>,
}

/// Seats that are short of agents: together they have one agent too few, and no other can meet their demands.
pub(super) struct Shortage {
    /// Seats; the first is the one that stays empty.
    pub seats: Vec<usize>,
    /// All agents that can have one of them.
    pub agents: BTreeSet<u32>,
}

/// Seats, and who has them.
#[derive(Clone, Default)]
pub(super) struct Seating {
    /// Seats, by index; some belong to forms that tasks have left.
    pub seats: Vec<Seat>,
    /// Tasks that have been drawn in.
    pub parties: BTreeMap<u32, Party>,
    posts: BTreeMap<u32, Post>,
    empty: VecDeque<usize>,
}

/// What a seating is made from.
pub(super) struct Hall<'s, 'p> {
    /// Forms of tasks.
    pub catalogue: &'s mut Catalogue<'p>,
    /// The allocation at present.
    pub holdings: &'s Holdings<'p>,
    /// Counts the work.
    pub meter: &'s mut Meter,
}

impl Seating {
    /// Draws in a task that is not served, in its first form. False when it has none.
    pub fn enter(&mut self, task: u32, hall: &mut Hall) -> bool {
        let forms = hall.catalogue.forms(task, hall.meter);
        let open: Vec<usize> = (0..forms.all.len()).collect();
        let exists = !open.is_empty();
        self.parties.insert(task, Party { forms, open, form: 0, seats: Vec::new() });
        self.take_form(task, 0);
        exists
    }

    /// What an agent does. The task that holds it is drawn in.
    pub fn post(&mut self, agent: u32, hall: &mut Hall) -> Post {
        if let Some(post) = self.posts.get(&agent) {
            return *post;
        }
        let Some(task) = hall.holdings.holder(agent).filter(|task| !self.parties.contains_key(task)) else {
            return Post::Free;
        };
        self.draw_in(task, hall);
        self.posts.get(&agent).copied().unwrap_or(Post::Free)
    }

    fn draw_in(&mut self, task: u32, hall: &mut Hall) {
        hall.meter.looked_at.insert(task);
        let mut forms = hall.catalogue.forms(task, hall.meter);
        let held = hall.holdings.held(task);
        let fits = forms.all.iter().enumerate().find_map(|(i, f)| Some((i, fit(f, &held, hall.meter)?)));
        let (form, agents) = match fits {
            Some(found) => found,
            None => {
                // Its form is one of too many to be considered: each of its agents has a seat to itself.
                let mut all = forms.all.clone();
                all.push(held.iter().map(|a| hall.catalogue.demand(vec![*a])).collect());
                forms = Rc::new(Forms { all, complete: false });
                (forms.all.len().saturating_sub(1), held.clone())
            }
        };
        for agent in held {
            self.posts.insert(agent, Post::Spare);
        }
        let demands = forms.all.get(form).cloned().unwrap_or_default();
        let mut seats = Vec::new();
        for ((index, demand), agent) in demands.into_iter().enumerate().zip(agents) {
            seats.push(self.seats.len());
            self.posts.insert(agent, Post::Seat(self.seats.len()));
            self.seats.push(Seat { task, index, demand, agent: Some(agent) });
        }
        let open = (0..forms.all.len()).collect();
        self.parties.insert(task, Party { forms, open, form, seats });
    }

    /// Puts a task that has been drawn in into another form; its seats are empty at first.
    pub fn take_form(&mut self, task: u32, form: usize) {
        let Some(party) = self.parties.get_mut(&task) else { return };
        for seat in std::mem::take(&mut party.seats) {
            if let Some(agent) = self.seats.get_mut(seat).and_then(|s| s.agent.take()) {
                self.posts.insert(agent, Post::Free);
            }
            self.empty.retain(|s| *s != seat);
        }
        party.form = form;
        for (index, demand) in party.forms.all.get(form).into_iter().flatten().enumerate() {
            let number = self.seats.len();
            party.seats.push(number);
            self.empty.push_back(number);
            self.seats.push(Seat { task, index, demand: demand.clone(), agent: None });
        }
    }

    /// Finds agents for all empty seats, moving others from seat to seat where that is necessary.
    pub fn fill(&mut self, hall: &mut Hall) -> Result<(), Shortage> {
        while let Some(seat) = self.empty.front().copied() {
            self.fill_one(seat, hall)?;
            self.empty.pop_front();
        }
        Ok(())
    }

    /// The shortest augmenting path, which moves as few as possible.
    fn fill_one(&mut self, root: usize, hall: &mut Hall) -> Result<(), Shortage> {
        let mut reached_from: BTreeMap<u32, usize> = BTreeMap::new();
        let mut sets = BTreeSet::new();
        let mut queue = VecDeque::new();
        let mut seats = Vec::new();
        let mut next = Some(root);
        while let Some(number) = next {
            seats.push(number);
            // Seats with the same candidates are common, since needs for one service have the same: once is
            // enough.
            let demand = self.seats.get(number).map(|s| s.demand.clone());
            for agent in demand.iter().filter(|d| sets.insert(d.set)).flat_map(|d| d.order.iter().copied()) {
                hall.meter.steps += 1;
                if reached_from.contains_key(&agent) {
                    continue;
                }
                reached_from.insert(agent, number);
                if self.post(agent, hall) == Post::Free {
                    self.shift(agent, &reached_from);
                    return Ok(());
                }
                queue.push_back(agent);
            }
            next = match queue.pop_front().map(|agent| (agent, self.post(agent, hall))) {
                Some((_, Post::Seat(seat))) => Some(seat),
                Some((agent, Post::Spare | Post::Free)) => {
                    self.shift(agent, &reached_from);
                    return Ok(());
                }
                None => None,
            };
        }
        Err(Shortage { seats, agents: reached_from.into_keys().collect() })
    }

    /// Moves everybody on a path up by one seat.
    fn shift(&mut self, last: u32, reached_from: &BTreeMap<u32, usize>) {
        let mut agent = Some(last);
        while let Some((a, seat)) = agent.and_then(|a| Some((a, *reached_from.get(&a)?))) {
            self.posts.insert(a, Post::Seat(seat));
            agent = self.seats.get_mut(seat).and_then(|s| s.agent.replace(a));
        }
    }

    /// The agents in the seats of a task.
    pub fn agents(&self, task: u32) -> Vec<u32> {
        let seats = self.parties.get(&task).map_or(&[][..], |p| &p.seats);
        seats.iter().filter_map(|s| self.seats.get(*s)?.agent).collect()
    }

    /// The tasks that no longer have what they had, and all that need agents for the first time; and who is
    /// enough for each.
    pub fn moved(&self, holdings: &Holdings) -> Vec<(u32, Vec<u32>)> {
        let is_kept = |agent: u32, task: u32| match self.posts.get(&agent) {
            Some(Post::Seat(seat)) => self.seats.get(*seat).is_some_and(|s| s.task == task),
            _ => true,
        };
        let stays = |task: u32, agents: &[u32]| {
            let held = holdings.held(task);
            holdings.choice(task).is_some()
                && held.iter().all(|a| is_kept(*a, task))
                && agents.iter().all(|a| held.contains(a))
        };
        let tasks = self.parties.keys().map(|task| (*task, self.agents(*task)));
        tasks.filter(|(task, agents)| !stays(*task, agents)).collect()
    }

    /// How much there is to copy.
    pub fn size(&self) -> u64 {
        (self.seats.len() + self.posts.len() + self.parties.len()) as u64
    }
}

/// How many agents change their demands at most when those of a task are told apart; it bounds a recursion.
const DEEPEST: usize = 1000;

/// Which of the held agents meet the demands of a form, each another one.
fn fit(form: &Form, held: &[u32], meter: &mut Meter) -> Option<Vec<u32>> {
    if let [demand] = &form[..] {
        return held.iter().find(|agent| demand.has(**agent)).map(|agent| vec![*agent]);
    }
    let mut taken: BTreeMap<u32, usize> = BTreeMap::new();
    for index in 0..form.len() {
        let mut tried = BTreeSet::new();
        if !fit_one(form, index, held, &mut taken, &mut tried, meter) {
            return None;
        }
    }
    let mut agents: Vec<(usize, u32)> = taken.into_iter().map(|(agent, index)| (index, agent)).collect();
    agents.sort_unstable();
    Some(agents.into_iter().map(|(_, agent)| agent).collect())
}

fn fit_one(
    form: &Form,
    index: usize,
    held: &[u32],
    taken: &mut BTreeMap<u32, usize>,
    tried: &mut BTreeSet<u32>,
    meter: &mut Meter,
) -> bool {
    let Some(demand) = form.get(index) else { return true };
    for agent in held.iter().copied().filter(|a| demand.has(*a)) {
        meter.steps += 1;
        if tried.len() >= DEEPEST || !tried.insert(agent) {
            continue;
        }
        let is_free = match taken.get(&agent).copied() {
            None => true,
            Some(other) => fit_one(form, other, held, taken, tried, meter),
        };
        if is_free {
            taken.insert(agent, index);
            return true;
        }
    }
    false
}
