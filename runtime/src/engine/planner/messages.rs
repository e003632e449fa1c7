//! What planner, directory and agents do when a message arrives.

use super::{AGAIN, DIRECTORY, Engine, PLANNER};
use crate::engine::{
    minds::{ACHIEVED, FAILED},
    queue::Scheduled,
};
use serde::{Deserialize, Serialize};
use soifra_graph::{
    Govern, Name,
    eval::{Memory, NoEnv},
    planning::Wanted,
};

/// A message between planner, directory and agents.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::engine) enum Notice {
    /// To the directory: an agent offers these from now on.
    Register { instance: u32, offers: Vec<u32>, record: Option<u64> },
    /// To the directory: an agent offers nothing any more.
    Deregister { instance: u32, record: Option<u64> },
    /// To the directory: an agent offers this, or not, from now on.
    Modify { instance: u32, offer: u32, present: bool, record: Option<u64> },
    /// To the planner: the same.
    Modified { instance: u32, offer: u32, present: bool, record: Option<u64> },
    /// To the directory: who offers this?
    Query { service: Name, record: Option<u64> },
    /// To the planner: those who offer it.
    Found { record: Option<u64> },
    /// To the planner: an agent offers something new.
    Appeared { instance: u32, record: Option<u64> },
    /// To the planner: an agent is gone.
    Gone { instance: u32, record: Option<u64> },
    /// To an agent: serve this task with these offers.
    Request { instance: u32, task: u32, offers: Vec<u32>, ticket: u64, record: Option<u64> },
    /// To an agent: these offers are not wanted for the task any more.
    Cancel { instance: u32, task: u32, offers: Vec<u32>, record: Option<u64> },
    /// To the planner: an agent agrees, or refuses.
    Answer { instance: u32, task: u32, ticket: u64, agreed: bool, record: Option<u64> },
    /// To the planner: an agent has achieved a task, or cannot, and why.
    Done { instance: u32, task: u32, achieved: bool, record: Option<u64> },
    /// To the planner: a goal is wanted, by number when it is one.
    Post { goal: Option<u32>, name: String, from: Option<u32>, record: Option<u64> },
    /// To the planner itself: those who refused may be asked again.
    Again { wanted: Wanted },
}

impl Notice {
    /// Whether it can be one in a run with so many agents.
    pub fn fits(&self, instances: usize) -> bool {
        match self {
            Notice::Register { instance, .. }
            | Notice::Deregister { instance, .. }
            | Notice::Modify { instance, .. }
            | Notice::Modified { instance, .. }
            | Notice::Appeared { instance, .. }
            | Notice::Gone { instance, .. }
            | Notice::Request { instance, .. }
            | Notice::Cancel { instance, .. }
            | Notice::Answer { instance, .. }
            | Notice::Done { instance, .. } => (*instance as usize) < instances,
            Notice::Post { from, .. } => from.is_none_or(|i| (i as usize) < instances),
            Notice::Query { .. } | Notice::Found { .. } | Notice::Again { .. } => true,
        }
    }
}

impl Engine<'_> {
    /// A message arrives.
    pub(in crate::engine) fn notice(&mut self, notice: Notice) {
        match notice {
            Notice::Register { instance, offers, record } => self.register(instance, &offers, record),
            Notice::Deregister { instance, record } => {
                self.directory.deregister(instance);
                if !self.lives.is_dead(instance) {
                    // It has begun anew in the meantime.
                    self.offer_conversations(instance);
                }
                let content = self.agent_name(instance);
                let record = self.trace_planner(
                    DIRECTORY,
                    "inform_ref",
                    PLANNER,
                    &content,
                    Some("gone".into()),
                    "subscribe",
                    record,
                );
                self.notify(Notice::Gone { instance, record });
            }
            Notice::Modify { instance, offer, present, record } => {
                self.modify(instance, offer, present, record);
            }
            Notice::Modified { instance, offer, present, record } => {
                self.modified(instance, offer, present, record);
            }
            Notice::Query { service, record } => {
                let found: Vec<String> =
                    self.directory.search(&service).map(|i| self.agent_name(i)).collect();
                let who = if found.is_empty() { "nobody".into() } else { found.join(", ") };
                let record = self.trace_planner(
                    DIRECTORY,
                    "inform_ref",
                    PLANNER,
                    &service,
                    Some(who),
                    "query",
                    record,
                );
                self.notify(Notice::Found { record });
            }
            Notice::Found { record } => {
                self.planner.unanswered = self.planner.unanswered.saturating_sub(1);
                if self.planner.unanswered == 0 && self.planner.matcher.is_none() {
                    self.allocate(record);
                }
            }
            Notice::Appeared { instance, record } => {
                if self.is_free(instance) && !self.lives.is_dead(instance) {
                    let changes = self.planner.matcher.as_mut().map(|m| m.agent_returned(instance));
                    self.carry_out(changes, record);
                    self.reconsider(record);
                }
            }
            Notice::Gone { instance, record } => {
                // One that has begun anew may have been requested before that was known.
                let serving: Vec<(u32, u32, u32)> = self
                    .planner
                    .serving
                    .range((instance, 0, 0)..=(instance, u32::MAX, u32::MAX))
                    .copied()
                    .collect();
                for (_, offer, task) in serving {
                    self.dismissed(instance, task, &[offer], record);
                }
                for t in &mut self.planner.tasks {
                    t.engaged.retain(|(a, _)| *a != instance);
                    t.awaiting.remove(&instance);
                }
                let changes = self.planner.matcher.as_mut().map(|m| m.agent_lost(instance));
                self.carry_out(changes, record);
                self.reconsider(record);
            }
            Notice::Request { instance, task, offers, ticket, record } => {
                self.asked(instance, task, &offers, ticket, record);
            }
            Notice::Cancel { instance, task, offers, record } => {
                self.dismissed(instance, task, &offers, record);
            }
            Notice::Answer { instance, task, ticket, agreed, record } => {
                self.answered(instance, task, ticket, agreed, record);
            }
            Notice::Done { instance, task, achieved, record } => {
                let known = self.planner.tasks.get(task as usize);
                // What was given to somebody else in the meantime is not this agent's any more.
                if !known.is_some_and(|t| t.current && t.engaged.iter().any(|(a, _)| *a == instance)) {
                    return;
                }
                if achieved {
                    self.set_status(task, ACHIEVED, None, record);
                    self.release_task(task, record);
                } else {
                    self.refuse(task, instance, record);
                }
                self.count_goals();
            }
            Notice::Post { goal, name, from, record } => self.posted(goal, &name, from, record),
            Notice::Again { wanted } => {
                let now = self.now;
                self.planner.refused.retain(|(w, _, until)| *w != wanted || *until > now);
                let open = self.current().find(|(_, t)| t.wanted == wanted && t.status == FAILED);
                if let Some(place) = open.map(|(p, _)| p) {
                    self.replan(place, None);
                    self.count_goals();
                }
            }
        }
    }

    /// An agent's platform registers what the agent offers to the planner.
    pub(in crate::engine) fn ask_to_register(&mut self, instance: u32, cause: Option<u64>) {
        let agent = self.cast.instances[instance as usize].agent;
        let all = (0..).zip(&self.mission.graph.agents[agent as usize].offers);
        let (offers, names): (Vec<u32>, Vec<&str>) =
            all.filter(|(_, o)| o.unit.is_some()).map(|(i, o)| (i, &*o.name)).unzip();
        if offers.is_empty() || !self.plans() {
            return;
        }
        let content = format!("register {}", names.join(", "));
        let record = self.trace_planner(instance, "request", DIRECTORY, &content, None, "request", cause);
        self.notify(Notice::Register { instance, offers, record });
    }

    fn register(&mut self, instance: u32, offers: &[u32], record: Option<u64>) {
        let agent = self.cast.instances[instance as usize].agent;
        let mission = self.mission;
        let declared = &mission.graph.agents[agent as usize].offers;
        let mut names = Vec::new();
        for o in offers.iter().filter_map(|o| declared.get(*o as usize)) {
            self.directory.register(&o.name, instance);
            names.push(&*o.name);
        }
        let content = format!("registered {}", names.join(", "));
        let record = self.trace_planner(DIRECTORY, "inform", instance, &content, None, "request", record);
        // The planner wants to know of those who come later.
        if self.planner.matcher.is_some() {
            let content = self.agent_name(instance);
            let record = self.trace_planner(
                DIRECTORY,
                "inform_ref",
                PLANNER,
                &content,
                Some(names.join(", ")),
                "subscribe",
                record,
            );
            self.notify(Notice::Appeared { instance, record });
        }
    }

    /// An agent offers something, or not, from now on: its platform tells the directory.
    fn ask_to_modify(&mut self, instance: u32, offer: u32, present: bool, cause: Option<u64>) {
        let kind = self.cast.instances[instance as usize].agent;
        let Some(declared) = self.mission.graph.agents[kind as usize].offers.get(offer as usize) else {
            return;
        };
        let word = if present { "offer" } else { "withdraw" };
        let content = format!("{word} {}", declared.name);
        let record = self.trace_planner(instance, "request", DIRECTORY, &content, None, "request", cause);
        self.notify(Notice::Modify { instance, offer, present, record });
    }

    fn modify(&mut self, instance: u32, offer: u32, present: bool, record: Option<u64>) {
        let kind = self.cast.instances[instance as usize].agent;
        let mission = self.mission;
        let Some(declared) = mission.graph.agents[kind as usize].offers.get(offer as usize) else { return };
        if self.lives.is_dead(instance) {
            return;
        }
        match present {
            true => self.directory.register(&declared.name, instance),
            false => self.directory.withdraw(&declared.name, instance),
        }
        if declared.unit.is_some() && self.plans() {
            let word = if present { "offered" } else { "withdrawn" };
            let content = format!("{} {word}", self.agent_name(instance));
            let reason = Some(declared.name.to_string());
            let record =
                self.trace_planner(DIRECTORY, "inform_ref", PLANNER, &content, reason, "subscribe", record);
            self.notify(Notice::Modified { instance, offer, present, record });
        }
    }

    /// The planner allocates without what is withdrawn, and tries again with what is offered.
    fn modified(&mut self, instance: u32, offer: u32, present: bool, record: Option<u64>) {
        let concerned: Vec<u32> = if present {
            self.planner.withdrawn.remove(&(instance, offer));
            self.current().filter(|(_, t)| t.status == FAILED).map(|(n, _)| n).collect()
        } else {
            self.planner.withdrawn.insert((instance, offer));
            self.planner.serves(instance, offer).collect()
        };
        concerned.into_iter().for_each(|number| self.replan(number, record));
        self.count_goals();
    }

    /// An agent is requested: it agrees or refuses by its conditions.
    fn asked(&mut self, instance: u32, task: u32, offers: &[u32], ticket: u64, record: Option<u64>) {
        let Some(known) = self.planner.tasks.get(task as usize) else { return };
        // A request that has been taken back on its way is not answered.
        if known.awaiting.get(&instance) != Some(&ticket) {
            return;
        }
        let subgoal = self.subgoal_name(known.wanted);
        let refusal = match self.lives.is_dead(instance) {
            true => Some("it is dead".to_string()),
            false => self.refusal(instance, offers),
        };
        let agreed = refusal.is_none();
        let performative = if agreed { "agree" } else { "refuse" };
        let record =
            self.trace_planner(instance, performative, PLANNER, &subgoal, refusal, "request", record);
        self.notify(Notice::Answer { instance, task, ticket, agreed, record });
        if agreed {
            for offer in offers {
                let first = self.planner.serves(instance, *offer).next().is_none();
                self.planner.serving.insert((instance, *offer, task));
                if first {
                    self.switch_offer(instance, *offer, true, Some(&subgoal), record);
                }
            }
        }
    }

    /// Why an agent will not serve: the condition of an offer that does not hold.
    fn refusal(&mut self, instance: u32, offers: &[u32]) -> Option<String> {
        let mission = self.mission;
        let who = self.cast.instances[instance as usize];
        let code = &mission.agents[who.agent as usize];
        for offer in offers {
            let Some(block) = code.offers.get(*offer as usize).and_then(|o| o.when.as_ref()) else {
                continue;
            };
            let mut frame = std::mem::take(&mut self.desk.frame);
            frame.resize(frame.len().max(block.frame as usize), 0.0);
            let (from, to) = (who.states, who.states + code.states.len());
            let mut states = self.minds.states.get(from..to).unwrap_or_default().to_vec();
            let mut memory = Memory {
                states: &mut states,
                arguments: self.cast.arguments_of(instance as usize),
                params: &self.params,
            };
            let run = mission.program.run(block, &mut frame, &mut memory, &mut NoEnv);
            let holds = frame.get(block.result as usize).is_some_and(|x| *x != 0.0);
            self.desk.frame = frame;
            let declared = &mission.graph.agents[who.agent as usize].offers[*offer as usize];
            match run {
                Ok(()) if holds => {}
                Ok(()) => {
                    let written = declared.when.as_ref().map_or("", |e| mission.written(e.span));
                    let written = written.split_whitespace().collect::<Vec<_>>().join(" ");
                    return Some(format!("it does not hold: {written}"));
                }
                Err(fault) => return Some(fault.to_string()),
            }
        }
        None
    }

    fn dismissed(&mut self, instance: u32, task: u32, offers: &[u32], record: Option<u64>) {
        let subgoal = self.planner.tasks.get(task as usize).map(|t| self.subgoal_name(t.wanted));
        for offer in offers {
            let removed = self.planner.serving.remove(&(instance, *offer, task));
            if removed && self.planner.serves(instance, *offer).next().is_none() {
                self.switch_offer(instance, *offer, false, subgoal.as_deref(), record);
            }
        }
    }

    /// The unit of an offer runs from now on, or no more.
    fn switch_offer(
        &mut self,
        instance: u32,
        offer: u32,
        on: bool,
        subgoal: Option<&str>,
        cause: Option<u64>,
    ) {
        let who = self.cast.instances[instance as usize];
        let offer = self.mission.graph.agents[who.agent as usize].offers.get(offer as usize);
        if let Some(unit) = offer.and_then(|o| o.unit) {
            self.switch_unit(who.units + unit, on, subgoal, cause);
        }
    }

    fn answered(&mut self, instance: u32, task: u32, ticket: u64, agreed: bool, record: Option<u64>) {
        let Some(t) = self.planner.tasks.get_mut(task as usize) else { return };
        if t.awaiting.get(&instance) != Some(&ticket) {
            return;
        }
        t.awaiting.remove(&instance);
        if agreed {
            let complete = t.awaiting.is_empty();
            if complete {
                self.allocated(task, record);
            }
        } else {
            self.refuse(task, instance, record);
        }
        self.count_goals();
    }

    /// An agent will not serve a task: it is not asked for it any more, for a while.
    fn refuse(&mut self, task: u32, instance: u32, record: Option<u64>) {
        let Some(wanted) = self.planner.tasks.get(task as usize).map(|t| t.wanted) else { return };
        self.planner.refused.insert((wanted, instance, self.now + AGAIN));
        self.queue.put(self.now + AGAIN, Scheduled::Notice(Box::new(Notice::Again { wanted })));
        self.replan(task, record);
    }

    /// A unit says that what it is engaged for is achieved, or that it cannot be.
    pub(in crate::engine) fn govern(&mut self, unit: u32, what: &Govern, cause: Option<u64>) {
        let info = self.cast.units[unit as usize];
        let who = self.cast.instances[info.instance as usize];
        match what {
            Govern::Offer(o) => self.ask_to_modify(info.instance, *o, true, cause),
            Govern::Withdraw(o) => self.ask_to_modify(info.instance, *o, false, cause),
            Govern::Start(u) => self.switch_unit(who.units + u, true, None, cause),
            Govern::Stop(u) => self.switch_unit(who.units + u, false, None, cause),
            Govern::Achieve | Govern::Fail(_) => {
                let offers = &self.mission.graph.agents[who.agent as usize].offers;
                let own = offers.iter().position(|o| o.unit == Some(info.unit)).map(|o| o as u32);
                let mut tasks: Vec<u32> = self
                    .planner
                    .serving
                    .range((info.instance, 0, 0)..=(info.instance, u32::MAX, u32::MAX))
                    .filter(|(_, offer, _)| own.is_none_or(|o| o == *offer))
                    .map(|(_, _, task)| *task)
                    .collect();
                tasks.sort_unstable();
                tasks.dedup();
                for task in tasks {
                    let Some(wanted) = self.planner.tasks.get(task as usize).map(|t| t.wanted) else {
                        continue;
                    };
                    let subgoal = self.subgoal_name(wanted);
                    let (achieved, performative, reason) = match what {
                        Govern::Fail(why) => (false, "failure", Some(why.clone())),
                        _ => (true, "inform", Some("achieved".to_string())),
                    };
                    let record = self.trace_planner(
                        info.instance,
                        performative,
                        PLANNER,
                        &subgoal,
                        reason,
                        "request",
                        cause,
                    );
                    self.notify(Notice::Done { instance: info.instance, task, achieved, record });
                }
            }
            Govern::Pursue(goal) => {
                let name = self.mission.graph.goals[*goal as usize].name.to_string();
                let content = format!("achieve {name}");
                let record =
                    self.trace_planner(info.instance, "request", PLANNER, &content, None, "request", cause);
                self.notify(Notice::Post { goal: Some(*goal), name, from: Some(info.instance), record });
            }
        }
    }

    /// Somebody outside the mission asks for a goal.
    pub(in crate::engine) fn post_goal(&mut self, name: &str) {
        let goal = self.mission.graph.goals.iter().position(|g| *g.name == *name).map(|g| g as u32);
        let content = format!("achieve {name}");
        let record = self.trace_planner("operator", "request", PLANNER, &content, None, "request", None);
        self.notify(Notice::Post { goal, name: name.into(), from: None, record });
    }

    fn posted(&mut self, goal: Option<u32>, name: &str, from: Option<u32>, record: Option<u64>) {
        if self.planner.matcher.is_none() && self.plans() {
            // The directory has not answered yet.
            self.notify(Notice::Post { goal, name: name.into(), from, record });
            return;
        }
        let refusal = match goal.and_then(|g| Some((g, *self.planner.pursued.get(g as usize)?))) {
            None => Some(format!("no plan: there is no goal {name}")),
            Some((_, true)) => Some("it is pursued".to_string()),
            Some((goal, false)) => self.pursue(goal, name, record),
        };
        let performative = if refusal.is_some() { "refuse" } else { "agree" };
        let content = format!("achieve {name}");
        match from {
            Some(agent) => {
                self.trace_planner(PLANNER, performative, agent, &content, refusal, "request", record)
            }
            None => {
                self.trace_planner(PLANNER, performative, "operator", &content, refusal, "request", record)
            }
        };
    }

    /// A goal is pursued from now on, unless its sub-goals cannot be served as a whole: why not.
    fn pursue(&mut self, goal: u32, name: &str, record: Option<u64>) -> Option<String> {
        self.planner.pursued[goal as usize] = true;
        let wanted: Vec<Wanted> = self.all_wanted().into_iter().filter(|w| w.goal == goal).collect();
        // Tried on a copy, so that nobody is disturbed for what is not to be.
        let mut trial = self.planner.matcher.clone()?;
        let mut refusal = wanted.is_empty().then(|| format!("no plan for {name} holds"));
        for w in &wanted {
            let (task, means, _) = self.task(*w);
            let (number, _) = trial.task_added(task);
            refusal = refusal.or_else(|| self.why(&trial, number, &means));
        }
        if refusal.is_some() {
            self.planner.pursued[goal as usize] = false;
            return refusal;
        }
        let old: Vec<u32> = self.current().filter(|(_, t)| t.wanted.goal == goal).map(|(p, _)| p).collect();
        old.into_iter().for_each(|p| self.give_up(p, record));
        wanted.into_iter().for_each(|w| self.want(w, record));
        self.count_goals();
        None
    }
}
