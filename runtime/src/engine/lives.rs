//! Supervision: agents that fail are started again, stay dead, or end the run; units are switched on and off.
//!
//! A dead agent does nothing and answers nothing. What it had sent arrives; what it had not finished is lost. Its
//! platform tells the directory, and those it was talking with. Started again, it begins as at the start of the
//! run, without what it knew; its random numbers go on.

use super::{
    Engine,
    minds::{ACTIVE, FAILED, Position},
    queue::Scheduled,
};
use crate::{Event, Time};
use serde::{Deserialize, Serialize};
use soifra_graph::eval::Fault;
use std::collections::{BTreeMap, BTreeSet};

/// Which agents live, and how often they have failed lately.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lives {
    dead: BTreeSet<u32>,
    failures: BTreeMap<u32, Vec<Time>>,
    /// Units that are released.
    on: Vec<bool>,
    /// Of each agent: a span of a tenth of a second, and its activations in it.
    busy: Vec<(Time, u32)>,
}

/// The most activations of an agent within a tenth of a second. Two that answer each other as fast as messages travel
/// would hold a run up for good.
pub(super) const FLOOD: u32 = 40_000;
const SPAN: Time = Time(100_000_000);

impl Lives {
    /// Everybody lives; offered and stopped units wait.
    pub fn new(instances: usize, on: Vec<bool>) -> Self {
        Lives { on, busy: vec![(Time::ZERO, 0); instances], ..Lives::default() }
    }

    /// Counts an activation of an agent; whether it is one too many.
    pub fn floods(&mut self, instance: u32, now: Time) -> bool {
        let (since, count) = &mut self.busy[instance as usize];
        if now - *since > SPAN {
            (*since, *count) = (now, 0);
        }
        *count += 1;
        *count > FLOOD
    }

    /// Whether an agent is dead.
    pub fn is_dead(&self, instance: u32) -> bool {
        !self.dead.is_empty() && self.dead.contains(&instance)
    }

    /// Whether a unit is released when its time comes.
    pub fn is_on(&self, unit: u32) -> bool {
        self.on.get(unit as usize).copied().unwrap_or(false)
    }

    /// Whether they can be the lives of so many agents with so many units.
    pub fn fits(&self, instances: usize, units: usize) -> bool {
        self.on.len() == units
            && self.busy.len() == instances
            && self.dead.iter().chain(self.failures.keys()).all(|i| (*i as usize) < instances)
    }
}

impl Engine<'_> {
    /// Something went wrong in a unit: its agent fails, or the run does.
    pub(super) fn unit_fault(&mut self, unit: u32, fault: &Fault, cause: Option<u64>) {
        let text = self.fault_text(fault);
        self.unit_fails(unit, text, cause);
    }

    /// As [`Engine::unit_fault`], in words.
    pub(super) fn unit_fails(&mut self, unit: u32, text: String, cause: Option<u64>) {
        let instance = self.cast.units[unit as usize].instance;
        let robot = self.cast.instances[instance as usize].robot;
        let (agent, _) = self.names(unit);
        let Some((times, within)) = self.restarts[instance as usize] else {
            self.fail(Some(robot), &agent, text, cause);
            return;
        };
        let (name, told) = (agent.clone(), text.clone());
        let record = self.recorder.record(self.now, cause, || Event::Fault {
            robot: Some(robot),
            agent: name,
            text: told,
        });
        self.note_fault(format!("{agent}: {text}"));
        let since = self.now;
        let failures = self.lives.failures.entry(instance).or_default();
        failures.retain(|t| since - *t < within);
        failures.push(since);
        let again = failures.len() <= times as usize;
        self.die(instance, &text, record);
        if again {
            self.restart(instance, record);
        }
    }

    /// An agent dies, and is not started again.
    pub(super) fn kill(&mut self, instance: u32, why: &str, cause: Option<u64>) {
        if !self.lives.is_dead(instance) {
            self.die(instance, why, cause);
        }
    }

    fn units_of(&self, instance: u32) -> std::ops::Range<u32> {
        let from = self.cast.instances[instance as usize].units;
        let next = self.cast.instances.get(instance as usize + 1);
        from..next.map_or(self.cast.units.len() as u32, |i| i.units)
    }

    fn die(&mut self, instance: u32, why: &str, cause: Option<u64>) {
        self.lives.dead.insert(instance);
        self.reset.insert(instance);
        let record = self.trace_life(instance, "dead", why, cause);
        let units = self.units_of(instance);
        for unit in units.clone() {
            self.lives.on[unit as usize] = false;
            self.forget_unit(unit);
        }
        self.releases.retain(|r| !units.contains(&r.unit));
        self.queue.drop_units(&units);
        let who = self.cast.instances[instance as usize];
        for (device, info) in (0..).zip(&self.cast.devices) {
            if info.instance == instance {
                self.devices[device as usize] = Default::default();
            }
        }
        self.silence(who.robot, who.binding);
        let mission = self.mission;
        for (i, s) in mission.agents[who.agent as usize].subgoals.iter().enumerate() {
            self.believe(who.subgoals + i, s.goal, who.robot, &s.name, FAILED, record);
        }
        self.agent_gone(instance, record);
        self.leave_talks(instance, record);
    }

    /// An agent that has died begins anew.
    fn restart(&mut self, instance: u32, cause: Option<u64>) {
        self.lives.dead.remove(&instance);
        let record = self.trace_life(instance, "restarted", "", cause);
        let who = self.cast.instances[instance as usize];
        let next = self.cast.instances.get(instance as usize + 1);
        let states = who.states..next.map_or(self.cast.states.len(), |n| n.states);
        self.minds.states[states.clone()].copy_from_slice(&self.cast.states[states]);
        let nodes = who.nodes..next.map_or(self.cast.nodes, |n| n.nodes);
        self.minds.status[nodes.clone()].fill(0);
        self.minds.slots[nodes].fill(0);
        for unit in self.units_of(instance) {
            self.minds.positions[unit as usize] = Position { entered: self.now, ..Position::default() };
            self.lives.on[unit as usize] = self.starts_on(unit);
            self.tallies[unit as usize].in_a_row = 0;
        }
        let mission = self.mission;
        for (i, s) in mission.agents[who.agent as usize].subgoals.iter().enumerate() {
            self.believe(who.subgoals + i, s.goal, who.robot, &s.name, ACTIVE, record);
        }
        self.offer_conversations(instance);
        self.planner_forgets(instance);
        self.ask_to_register(instance, record);
    }

    /// The conversations that an agent offers are in the directory at once.
    pub(super) fn offer_conversations(&mut self, instance: u32) {
        let kind = self.cast.instances[instance as usize].agent;
        let mission = self.mission;
        let offers = mission.graph.agents[kind as usize].offers.iter();
        offers.filter(|o| o.unit.is_none()).for_each(|o| self.directory.register(&o.name, instance));
    }

    /// Whether a unit runs when its agent begins.
    pub(super) fn starts_on(&self, unit: u32) -> bool {
        let info = &self.cast.units[unit as usize];
        let who = &self.cast.instances[info.instance as usize];
        let agent = &self.mission.graph.agents[who.agent as usize];
        let offered = agent.offers.iter().any(|o| o.unit == Some(info.unit));
        !offered && !agent.units[info.unit as usize].stopped
    }

    /// A unit is released from now on, or no more. It begins anew.
    pub(super) fn switch_unit(&mut self, unit: u32, on: bool, subgoal: Option<&str>, cause: Option<u64>) {
        let info = self.cast.units[unit as usize];
        if self.lives.is_dead(info.instance) || self.lives.is_on(unit) == on {
            return;
        }
        self.lives.on[unit as usize] = on;
        let who = self.cast.instances[info.instance as usize];
        if on {
            self.minds.positions[unit as usize] = Position { entered: self.now, ..Position::default() };
            let nodes = self.mission.agents[who.agent as usize].units[info.unit as usize].nodes();
            let nodes = who.nodes + nodes.start..who.nodes + nodes.end;
            self.minds.status[nodes.clone()].fill(0);
            self.minds.slots[nodes].fill(0);
        } else {
            self.forget_unit(unit);
        }
        if self.recorder.on() {
            let (agent, service) = self.names(unit);
            let (robot, subgoal) = (who.robot, subgoal.map(str::to_string));
            self.recorder.record(self.now, cause, || Event::Service {
                robot,
                agent,
                service,
                running: on,
                subgoal,
            });
        }
    }

    /// Letters, releases and jobs of a unit are dropped.
    fn forget_unit(&mut self, unit: u32) {
        while let Some(d) = self.mail.take(unit) {
            self.trace_delivery(unit, &d.letter, Some("it runs no more"));
        }
        let clock = &mut self.clocks[unit as usize];
        (clock.due, clock.busy, clock.waiting) = (None, Time::ZERO, false);
        if let Some(core) = self.core_of(unit)
            && self.cores[core as usize].drop_unit(unit, self.now)
        {
            self.touched.push(core);
        }
    }

    /// A sub-goal that names its agent has this status from now on.
    fn believe(&mut self, at: usize, goal: u32, robot: u32, name: &str, status: u8, cause: Option<u64>) {
        self.minds.subgoals[at] = status;
        let before = std::mem::replace(&mut self.subgoals[at], status);
        if before == status {
            return;
        }
        self.goals.change(self.now, goal, robot, before, status);
        self.recorder.record(self.now, cause, || Event::Goal {
            goal: name.to_string(),
            robot: Some(robot),
            status: super::goals::word(status).to_string(),
            reason: None,
        });
    }

    fn trace_life(&mut self, instance: u32, status: &str, reason: &str, cause: Option<u64>) -> Option<u64> {
        if !self.recorder.on() {
            return None;
        }
        let robot = self.cast.instances[instance as usize].robot;
        let agent = self.agent_name(instance);
        let (status, reason) = (status.to_string(), reason.to_string());
        self.recorder.record(self.now, cause, || Event::Life { robot, agent, status, reason })
    }

    /// The instant at which a declared fault kills an agent.
    pub(super) fn schedule_kill(&mut self, at: Time, instance: u32) {
        self.queue.put(at, Scheduled::Kill(instance));
    }
}
