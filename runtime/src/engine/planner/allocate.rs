//! Makes the allocation, and carries out what changes in it.

use super::{DELAY, Engine, Notice, PLANNER, Task};
use crate::{
    Event,
    engine::{
        goals::word,
        minds::{ACHIEVED, ACTIVE, FAILED},
    },
};
use soifra_graph::{
    Name,
    allocation::{self, Changes, Matcher, Outcome, Problem, Refusal},
    planning::{Means, Wanted},
};
use std::collections::{BTreeMap, BTreeSet};

impl Engine<'_> {
    /// The first allocation, of all that is wanted from the start.
    pub(super) fn allocate(&mut self, cause: Option<u64>) {
        // Parameters may have been set while the directory was asked.
        self.holds_now();
        let agents = (0..self.cast.instances.len() as u32).map(|i| allocation::Agent {
            collaborative: self.mission.graph.agents[self.cast.instances[i as usize].agent as usize]
                .collaborative,
            available: self.is_free(i) && !self.lives.is_dead(i),
        });
        let agents: Vec<_> = agents.collect();
        let mut tasks = Vec::new();
        for (number, w) in (0..).zip(self.all_wanted()) {
            let (task, means, partial) = self.task(w);
            self.planner.places.push(number);
            self.planner.tasks.push(Task::new(w, number, means, partial));
            tasks.push(task);
        }
        let mut matcher = Matcher::new(Problem { agents, tasks });
        let changes = matcher.solve();
        self.planner.matcher = Some(matcher);
        self.carry_out(Some(changes), cause);
    }

    /// Whether no sub-goal has an agent for itself by its name.
    pub(super) fn is_free(&self, instance: u32) -> bool {
        let graph = &self.mission.graph;
        let kind = self.cast.instances[instance as usize].agent;
        graph.agents[kind as usize].collaborative || !graph.is_bound(kind)
    }

    /// A sub-goal as a task, without those who refused it or have withdrawn what it needs; and whether anybody
    /// was left out.
    pub(super) fn task(&self, w: Wanted) -> (allocation::Task, Vec<Means>, bool) {
        let planner = &self.planner;
        let holds = |p: u32| planner.holds.get(p as usize).copied().unwrap_or(false);
        let (mut task, means) = self.pool.task(&self.mission.graph, w, &holds);
        let refused: BTreeSet<u32> =
            planner.refused.iter().filter(|(x, _, _)| *x == w).map(|(_, a, _)| *a).collect();
        let mut partial = false;
        for way in &mut task.ways {
            let plan =
                means.get(way.label as usize).and_then(|m| self.mission.graph.plans.get(m.plan as usize));
            for (need, (service, _)) in way.needs.iter_mut().zip(plan.map(|p| &p.needs).into_iter().flatten())
            {
                let before = need.candidates.len();
                need.candidates.retain(|a| {
                    let withdrawn = |o: u32| planner.withdrawn.contains(&(*a, o));
                    !refused.contains(a) && !self.offer_of(*a, service).is_some_and(withdrawn)
                });
                partial |= need.candidates.len() < before;
            }
        }
        (task, means, partial)
    }

    /// A sub-goal is wanted from now on.
    pub(super) fn want(&mut self, w: Wanted, cause: Option<u64>) {
        let (task, means, partial) = self.task(w);
        let Some(matcher) = &mut self.planner.matcher else { return };
        let (number, changes) = matcher.task_added(task);
        self.planner.places.push(self.planner.tasks.len() as u32);
        self.planner.tasks.push(Task::new(w, number, means, partial));
        self.carry_out(Some(changes), cause);
    }

    /// A sub-goal is not wanted any more.
    pub(super) fn give_up(&mut self, place: u32, cause: Option<u64>) {
        if let Some(t) = self.planner.tasks.get_mut(place as usize) {
            t.current = false;
        }
        self.release_task(place, cause);
    }

    /// The agents of a task are free for others.
    pub(super) fn release_task(&mut self, place: u32, cause: Option<u64>) {
        let Some(number) = self.planner.tasks.get(place as usize).map(|t| t.number) else { return };
        let changes = self.planner.matcher.as_mut().map(|m| m.task_removed(number));
        self.carry_out(changes, cause);
    }

    /// A task is planned anew: by other plans, or with others. Who serves it and can go on does.
    pub(super) fn replan(&mut self, place: u32, cause: Option<u64>) {
        let Some(old) = self.planner.tasks.get(place as usize).filter(|t| t.current) else { return };
        let (before, wanted) = (old.number, old.wanted);
        let (task, means, partial) = self.task(wanted);
        let Some(matcher) = &mut self.planner.matcher else { return };
        let removed = matcher.task_removed(before);
        let (number, added) = matcher.task_added(task);
        self.planner.places.push(place);
        let t = &mut self.planner.tasks[place as usize];
        (t.number, t.means, t.partial) = (number, means, partial);
        self.carry_out(Some(removed), cause);
        self.carry_out(Some(added), cause);
    }

    /// Tasks that nobody serves and that somebody was left out of are planned once more.
    pub(super) fn reconsider(&mut self, cause: Option<u64>) {
        let open = |t: &Task| t.status == FAILED && t.partial;
        let places: Vec<u32> = self.current().filter(|(_, t)| open(t)).map(|(p, _)| p).collect();
        places.into_iter().for_each(|p| self.replan(p, cause));
    }

    /// Requests and dismisses agents as the allocation has changed.
    pub(super) fn carry_out(&mut self, changes: Option<Changes>, cause: Option<u64>) {
        for change in changes.into_iter().flat_map(|c| c.tasks) {
            let Some(&number) = self.planner.places.get(change.task as usize) else { continue };
            // What was planned before is told by what is planned now.
            let Some(t) = self.planner.tasks.get(number as usize).filter(|t| t.number == change.task) else {
                continue;
            };
            // A later change of the same task may have been carried out before.
            let outcome = self.planner.matcher.as_ref().map(|m| m.outcome(change.task).clone());
            let wanted: BTreeSet<(u32, u32)> = match outcome.as_ref().and_then(Outcome::choice) {
                Some(choice) => {
                    let means = t.means.get(choice.label as usize);
                    let plan = means.and_then(|m| self.mission.graph.plans.get(m.plan as usize));
                    let needs = plan.map(|p| p.needs.as_slice()).unwrap_or_default();
                    let offers = needs.iter().zip(&choice.agents);
                    offers.filter_map(|((s, _), a)| Some((*a, self.offer_of(*a, s)?))).collect()
                }
                None => BTreeSet::new(),
            };
            let engaged = t.engaged.clone();
            let (status, current) = (t.status, t.current);
            for (agent, offers) in by_agent(engaged.difference(&wanted)) {
                self.dismiss(agent, number, offers, cause);
            }
            for (agent, offers) in by_agent(wanted.difference(&engaged)) {
                self.engage(agent, number, offers, cause);
            }
            let t = &mut self.planner.tasks[number as usize];
            t.awaiting.retain(|a, _| wanted.iter().any(|(b, _)| a == b));
            t.engaged = wanted;
            if current && status != ACHIEVED {
                match self.why_refused(number) {
                    Some(why) => self.set_status(number, FAILED, Some(why), cause),
                    None => self.set_status(number, ACTIVE, None, cause),
                }
            }
        }
        self.count_goals();
    }

    fn engage(&mut self, agent: u32, task: u32, offers: Vec<u32>, cause: Option<u64>) {
        self.planner.count += 1;
        let ticket = self.planner.count;
        let Some(t) = self.planner.tasks.get_mut(task as usize) else { return };
        t.awaiting.insert(agent, ticket);
        let wanted = t.wanted;
        let content = format!("{} for {}", self.offer_names(agent, &offers), self.subgoal_name(wanted));
        let record = self.trace_planner(PLANNER, "request", agent, &content, None, "request", cause);
        self.notify(Notice::Request { instance: agent, task, offers, ticket, record });
    }

    fn dismiss(&mut self, agent: u32, task: u32, offers: Vec<u32>, cause: Option<u64>) {
        if self.lives.is_dead(agent) {
            return;
        }
        let Some(wanted) = self.planner.tasks.get(task as usize).map(|t| t.wanted) else { return };
        let content = format!("{} for {}", self.offer_names(agent, &offers), self.subgoal_name(wanted));
        let record = self.trace_planner(PLANNER, "cancel", agent, &content, None, "request", cause);
        self.notify(Notice::Cancel { instance: agent, task, offers, record });
    }

    /// All agents of a task have agreed.
    pub(super) fn allocated(&mut self, number: u32, cause: Option<u64>) {
        let Some(t) = self.planner.tasks.get(number as usize) else { return };
        let mut agents: Vec<u32> = t.engaged.iter().map(|(a, _)| *a).collect();
        agents.dedup();
        let names: Vec<String> = agents.into_iter().map(|a| self.agent_name(a)).collect();
        let (wanted, reason) = (t.wanted, format!("allocated to {}", names.join(", ")));
        self.trace_status(wanted, ACTIVE, Some(reason), cause);
    }

    /// Why a task is not served.
    pub(super) fn why_refused(&self, place: u32) -> Option<String> {
        let t = self.planner.tasks.get(place as usize)?;
        self.why(self.planner.matcher.as_ref()?, t.number, &t.means)
    }

    /// Why a matcher does not serve one of its tasks.
    pub(super) fn why(&self, matcher: &Matcher, number: u32, means: &[Means]) -> Option<String> {
        let graph = &self.mission.graph;
        let names =
            |agents: &[u32]| agents.iter().map(|a| self.agent_name(*a)).collect::<Vec<_>>().join(", ");
        match matcher.outcome(number) {
            Outcome::Refused(Refusal::NoPlan) => Some("no plan".into()),
            Outcome::Refused(Refusal::NoCapable { needs }) => {
                let lacks = means.iter().zip(needs).find_map(|(m, n)| {
                    let plan = graph.plans.get(m.plan as usize)?;
                    Some(plan.needs.get(*n as usize)?.0.clone())
                });
                Some(match lacks {
                    Some(service) => {
                        format!("no capable agent: nobody offers {service}, or all have refused")
                    }
                    None => "no capable agent".into(),
                })
            }
            Outcome::Refused(Refusal::NotAvailable { tasks, agents, unavailable }) => {
                let name = |n: &u32| {
                    let place = self.planner.places.get(*n as usize)?;
                    Some(self.subgoal_name(self.planner.tasks.get(*place as usize)?.wanted))
                };
                let rivals: Vec<String> = tasks.iter().filter(|n| **n != number).filter_map(name).collect();
                let dead: Vec<u32> = unavailable.iter().copied().filter(|a| self.lives.is_dead(*a)).collect();
                Some(match (rivals.is_empty(), dead.is_empty()) {
                    (true, false) => format!("no agent: {} dead", names(&dead)),
                    (true, true) => format!("capable agents are not available: {}", names(unavailable)),
                    (false, _) => {
                        let rivals = rivals.join(", ");
                        format!("capable agents are not available: {} serves {rivals}", names(agents))
                    }
                })
            }
            Outcome::Undecided => Some("not decided in the time there is".into()),
            Outcome::Served(_) | Outcome::Removed => None,
        }
    }

    /// A sub-goal has this status from now on.
    pub(super) fn set_status(&mut self, number: u32, status: u8, reason: Option<String>, cause: Option<u64>) {
        let Some(t) = self.planner.tasks.get_mut(number as usize) else { return };
        let before = std::mem::replace(&mut t.status, status);
        t.why = reason.clone().filter(|_| status == FAILED);
        let wanted = t.wanted;
        if before != status {
            self.trace_status(wanted, status, reason, cause);
        }
    }

    fn trace_status(&mut self, w: Wanted, status: u8, reason: Option<String>, cause: Option<u64>) {
        let goal = self.subgoal_name(w);
        let robot = w.robot;
        let status = word(status).to_string();
        self.recorder.record(self.now, cause, || Event::Goal { goal, robot, status, reason });
    }

    pub(super) fn subgoal_name(&self, w: Wanted) -> String {
        let goal = self.mission.graph.goals.get(w.goal as usize);
        goal.and_then(|g| g.subgoals.get(w.subgoal as usize)).map_or_else(String::new, |s| s.name.to_string())
    }

    fn offer_of(&self, agent: u32, service: &Name) -> Option<u32> {
        let kind = self.cast.instances.get(agent as usize)?.agent;
        let offers = &self.mission.graph.agents[kind as usize].offers;
        offers.iter().position(|o| o.name == *service).map(|o| o as u32)
    }

    fn offer_names(&self, agent: u32, offers: &[u32]) -> String {
        let kind = self.cast.instances[agent as usize].agent;
        let declared = &self.mission.graph.agents[kind as usize].offers;
        let names = offers.iter().filter_map(|o| Some(&*declared.get(*o as usize)?.name));
        names.collect::<Vec<_>>().join(", ")
    }

    /// An agent begins anew: what it had withdrawn it offers again.
    pub(in crate::engine) fn planner_forgets(&mut self, instance: u32) {
        self.planner.withdrawn.retain(|(a, _)| *a != instance);
    }

    /// An agent that has died serves nothing; its platform tells the directory.
    pub(in crate::engine) fn agent_gone(&mut self, instance: u32, cause: Option<u64>) {
        self.planner.serving.retain(|(a, _, _)| *a != instance);
        let kind = self.cast.instances[instance as usize].agent;
        let offers = self.mission.graph.agents[kind as usize].offers.iter().any(|o| o.unit.is_some());
        if !offers || !self.plans() {
            self.directory.deregister(instance);
            return;
        }
        let content = format!("deregister {}", self.agent_name(instance));
        let record = self.trace_planner("ams", "request", super::DIRECTORY, &content, None, "request", cause);
        let notice = Notice::Deregister { instance, record };
        self.queue.put(self.now + DELAY, crate::engine::queue::Scheduled::Notice(Box::new(notice)));
    }
}

impl Task {
    fn new(wanted: Wanted, number: u32, means: Vec<Means>, partial: bool) -> Task {
        Task {
            wanted,
            number,
            means,
            partial,
            status: ACTIVE,
            why: None,
            current: true,
            engaged: BTreeSet::new(),
            awaiting: BTreeMap::new(),
        }
    }
}

fn by_agent<'a>(pairs: impl Iterator<Item = &'a (u32, u32)>) -> BTreeMap<u32, Vec<u32>> {
    let mut out: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (agent, offer) in pairs {
        out.entry(*agent).or_default().push(*offer);
    }
    out
}
