//! The planner-matcher: asks the directory who offers what, allocates agents to sub-goals by the plans of the
//! library, requests them, and does so again when an agent appears, fails or refuses, when the state that plans
//! are chosen by changes, or when somebody asks for a goal.
//!
//! What the planner, the directory facilitator and the platforms of the agents say to each other are FIPA-ACL
//! messages of a microsecond each; they are never lost. `messages.rs` has what happens when one arrives,
//! `allocate.rs` what an allocation means for those concerned.

mod allocate;
mod messages;

use super::{
    Engine,
    minds::{ACHIEVED, ACTIVE},
};
use crate::{Event, Thread, Time, mission::Mission};
pub(super) use messages::Notice;
use serde::{Deserialize, Serialize};
use soifra_graph::{
    allocation::Matcher,
    eval::{Memory, NoEnv},
    planning::{Means, Pool, Wanted},
};
use std::collections::{BTreeMap, BTreeSet};

/// A message between planner, directory and agents takes this long.
const DELAY: Time = Time(1_000);

/// After how long an agent that refused is asked again, where nobody else could be found.
const AGAIN: Time = Time(1_000_000_000);

/// What the planner-matcher knows.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Planner {
    /// The allocation; none before the directory has answered.
    matcher: Option<Matcher>,
    /// Sub-goals that are or were wanted; each keeps its place, however often it is planned anew.
    tasks: Vec<Task>,
    /// Place in `tasks` of each number of the matcher.
    places: Vec<u32>,
    /// Which plans hold.
    holds: Vec<bool>,
    /// Which goals are pursued.
    pursued: Vec<bool>,
    /// Who has refused what, and until when.
    refused: BTreeSet<(Wanted, u32, Time)>,
    /// Offers that their agents have withdrawn.
    withdrawn: BTreeSet<(u32, u32)>,
    /// Questions to the directory that are not answered yet.
    unanswered: u32,
    /// Numbers engagements and conversations.
    count: u64,
    /// Agents, numbers of their offers, and the tasks, by place, they are engaged for.
    serving: BTreeSet<(u32, u32, u32)>,
}

/// A sub-goal that agents are to be found for.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Task {
    wanted: Wanted,
    /// Its number in the matcher, a new one each time it is planned.
    number: u32,
    /// Whether somebody was left out who had refused.
    partial: bool,
    /// What the labels of its ways stand for.
    means: Vec<Means>,
    status: u8,
    /// Why it has failed.
    why: Option<String>,
    /// Whether it is still wanted in this form.
    current: bool,
    /// Agents and offers it has, or has asked for.
    engaged: BTreeSet<(u32, u32)>,
    /// Of them, the agents that have not answered, and with which request.
    awaiting: BTreeMap<u32, u64>,
}

impl Planner {
    /// Before anything has happened.
    pub fn new(mission: &Mission) -> Self {
        let g = &mission.graph;
        Planner {
            holds: vec![false; g.plans.len()],
            pursued: g.goals.iter().map(|x| !x.on_request).collect(),
            ..Planner::default()
        }
    }

    /// Tasks that an agent is engaged for with an offer.
    fn serves(&self, agent: u32, offer: u32) -> impl Iterator<Item = u32> {
        self.serving.range((agent, offer, 0)..=(agent, offer, u32::MAX)).map(|(_, _, task)| *task)
    }

    /// Whether it can be the planner of a run of the same mission with so many agents.
    pub fn fits(&self, other: &Planner, pool: &Pool) -> bool {
        let agents = pool.members().len();
        let numbers = self.matcher.as_ref().map_or(0, |m| m.problem().tasks.len());
        self.holds.len() == other.holds.len()
            && self.pursued.len() == other.pursued.len()
            && self.places.len() == numbers
            && self.places.iter().all(|p| (*p as usize) < self.tasks.len())
            && self.tasks.iter().all(|t| (t.number as usize) < numbers)
            && self.matcher.as_ref().is_none_or(|m| m.problem().agents.len() == agents)
            && self.tasks.iter().flat_map(|t| &t.engaged).all(|(a, _)| (*a as usize) < agents)
            && self.tasks.iter().flat_map(|t| &t.means).all(|m| (m.plan as usize) < self.holds.len())
            && self.tasks.iter().all(|t| (t.wanted.goal as usize) < self.pursued.len())
            && self.serving.iter().all(|(a, _, _)| (*a as usize) < agents)
    }
}

impl Engine<'_> {
    /// Whether the mission has sub-goals that agents are allocated to.
    pub(super) fn plans(&self) -> bool {
        self.mission.graph.goals.iter().flat_map(|g| &g.subgoals).any(|s| s.agent.is_none())
    }

    /// At the start agents register, and the planner asks the directory who offers what its plans need.
    pub(super) fn open_planner(&mut self) {
        if !self.plans() {
            return;
        }
        self.holds_now();
        for instance in 0..self.cast.instances.len() as u32 {
            self.ask_to_register(instance, None);
        }
        let mission = self.mission;
        let mut services: Vec<_> =
            mission.graph.plans.iter().flat_map(|p| &p.needs).map(|(n, _)| n).collect();
        services.sort_unstable();
        services.dedup();
        self.planner.unanswered = services.len() as u32;
        for service in &services {
            let record = self.trace_planner(PLANNER, "query_ref", DIRECTORY, service, None, "query", None);
            self.notify(Notice::Query { service: (*service).clone(), record });
        }
        if services.is_empty() {
            self.allocate(None);
        }
    }

    /// Works out which plans hold; gives those that changed.
    fn holds_now(&mut self) -> Vec<u32> {
        let mission = self.mission;
        let mut changed = Vec::new();
        for (p, block) in (0..).zip(&mission.plans) {
            let holds = match block {
                Some(block) => {
                    let mut frame = std::mem::take(&mut self.judge.frame);
                    frame.resize(frame.len().max(block.frame as usize), 0.0);
                    let mut memory = Memory { states: &mut [], arguments: &[], params: &self.params };
                    let run = mission.program.run(block, &mut frame, &mut memory, &mut NoEnv);
                    let holds = frame.get(block.result as usize).is_some_and(|x| *x != 0.0);
                    self.judge.frame = frame;
                    if let Err(fault) = run {
                        self.fault(None, PLANNER, &fault, None);
                    }
                    holds
                }
                None => true,
            };
            if let Some(known) = self.planner.holds.get_mut(p as usize)
                && *known != holds
            {
                *known = holds;
                changed.push(p);
            }
        }
        changed
    }

    /// Parameters have changed: other plans may be the ones to follow.
    pub(super) fn params_changed(&mut self, cause: Option<u64>) {
        if self.mission.plans.iter().all(Option::is_none) || self.planner.matcher.is_none() {
            return;
        }
        let changed = self.holds_now();
        if changed.is_empty() {
            return;
        }
        let mission = self.mission;
        let wanted: BTreeSet<Wanted> = self.all_wanted().into_iter().collect();
        let present: Vec<(u32, Wanted)> = self.current().map(|(n, t)| (n, t.wanted)).collect();
        for (number, w) in &present {
            let name = &mission.graph.goals[w.goal as usize].subgoals[w.subgoal as usize].name;
            let concerned = |p: &u32| mission.graph.plans[*p as usize].target == *name;
            let achieved = self.planner.tasks[*number as usize].status == ACHIEVED;
            if !wanted.contains(w) {
                self.give_up(*number, cause);
            } else if !achieved && changed.iter().any(concerned) {
                self.replan(*number, cause);
            }
        }
        for w in wanted {
            if !present.iter().any(|(_, p)| *p == w) {
                self.want(w, cause);
            }
        }
        self.count_goals();
    }

    /// Sub-goals of the goals that are pursued, by the plans that hold.
    fn all_wanted(&self) -> Vec<Wanted> {
        let (graph, planner) = (&self.mission.graph, &self.planner);
        let holds = |p: u32| planner.holds.get(p as usize).copied().unwrap_or(false);
        let bodies = self.scene.bodies().len() as u32;
        let goals = (0..graph.goals.len() as u32).filter(|g| planner.pursued[*g as usize]);
        goals.flat_map(|g| graph.wanted(g, bodies, &holds)).collect()
    }

    /// Tasks that are still wanted.
    fn current(&self) -> impl Iterator<Item = (u32, &Task)> {
        (0..).zip(&self.planner.tasks).filter(|(_, t)| t.current)
    }

    /// Which sub-goals of a goal nobody serves, and why.
    pub(super) fn unserved(&self, goal: u32) -> Option<String> {
        let of_goal = self.current().filter(|(_, t)| t.wanted.goal == goal);
        let told = of_goal.filter_map(|(_, t)| {
            let robot = t.wanted.robot.and_then(|r| self.scene.robots.get(r as usize));
            let of = robot.map_or(String::new(), |r| format!(" of {}", r.name));
            Some(format!("{}{of}: {}", self.subgoal_name(t.wanted), t.why.as_ref()?))
        });
        let all: Vec<String> = told.collect();
        (!all.is_empty()).then(|| all.join("; "))
    }

    /// Tells the goals how their allocated sub-goals stand.
    fn count_goals(&mut self) {
        let mut counts = vec![[0u32; 3]; self.mission.graph.goals.len()];
        for (_, t) in self.current() {
            let of = &mut counts[t.wanted.goal as usize];
            of[0] += 1;
            match t.status {
                ACHIEVED => of[1] += 1,
                ACTIVE => {}
                _ => of[2] += 1,
            }
        }
        let graph = &self.mission.graph;
        for ((count, goal), pursued) in counts.iter_mut().zip(&graph.goals).zip(&mut self.planner.pursued) {
            let allocated = goal.subgoals.iter().any(|s| s.agent.is_none());
            match count[0] {
                // What nobody has asked for yet is not achieved.
                0 if allocated => count[0] = 1,
                // What has been achieved can be asked for again.
                n if goal.on_request && n == count[1] => *pursued = false,
                _ => {}
            }
        }
        self.goals.set_allocated(&counts);
    }

    /// Where planner and directory are: on the first host, else on the first robot.
    fn seat(&self) -> u32 {
        let bodies = self.scene.bodies().len();
        if bodies < self.scene.robots.len() { bodies as u32 } else { 0 }
    }

    /// Something for planner, directory or an agent's platform, a microsecond later.
    fn notify(&mut self, notice: Notice) {
        self.queue.put(self.now + DELAY, super::queue::Scheduled::Notice(Box::new(notice)));
    }

    /// Name of an agent, the planner or the directory.
    #[expect(clippy::too_many_arguments, reason = "the parts of a FIPA-ACL message")]
    fn trace_planner(
        &mut self,
        sender: impl Party,
        performative: &str,
        receiver: impl Party,
        content: &str,
        reason: Option<String>,
        protocol: &str,
        cause: Option<u64>,
    ) -> Option<u64> {
        if !self.recorder.on() {
            return None;
        }
        let (sender, at) = sender.name(self);
        let (receiver, _) = receiver.name(self);
        let thread = Thread {
            protocol: Some(protocol.to_string()),
            ontology: Some("planning".into()),
            ..Thread::default()
        };
        let event = Event::Acl {
            robot: at,
            performative: performative.to_string(),
            sender,
            receiver,
            content: Some(content.to_string()),
            registers: Vec::new(),
            reason,
            thread: Box::new(thread),
        };
        self.recorder.record(self.now, cause, || event)
    }
}

/// The names of those who are not agents of the mission.
const PLANNER: &str = "planner";
const DIRECTORY: &str = "df";

/// Who sends or receives: an agent by its number, or planner and directory by name.
trait Party {
    fn name(&self, engine: &Engine<'_>) -> (String, u32);
}

impl Party for u32 {
    fn name(&self, engine: &Engine<'_>) -> (String, u32) {
        (engine.agent_name(*self), engine.cast.instances[*self as usize].robot)
    }
}

impl Party for &str {
    fn name(&self, engine: &Engine<'_>) -> (String, u32) {
        (self.to_string(), engine.seat())
    }
}
