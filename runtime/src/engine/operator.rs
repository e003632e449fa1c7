//! What an operator does to a run, and the pacer through whom it comes. Every input is recorded before it
//! takes effect, as the cause of what follows from it.

use super::Engine;
use crate::{
    Event, Mission, Scene, Time,
    ports::{Input, Operation, Pacer},
};
use soifra_graph::Value;
use std::sync::atomic::Ordering;

/// Stands for the agent where an operator sets a parameter.
const OPERATOR: &str = "operator";

/// Who holds the run to a pace, and what was done by way of it.
#[derive(Default)]
pub(super) struct Operator<'m> {
    pacer: Option<&'m mut dyn Pacer>,
    /// Inputs of the instant.
    inputs: Vec<Input>,
    /// The operator stopped the run; the record that says so.
    stop: Option<Option<u64>>,
}

impl Operator<'_> {
    /// The run begins.
    pub fn begin(&mut self, now: Time) {
        if let Some(pacer) = &mut self.pacer {
            pacer.begin(now);
        }
    }

    /// Whether the operator stopped the run by an input.
    pub fn stopped(&self) -> bool {
        self.stop.is_some()
    }

    /// The record of the input that stopped the run.
    pub fn cause(&self) -> Option<u64> {
        self.stop.flatten()
    }
}

impl<'m> Engine<'m> {
    /// Holds the run to a pace.
    pub fn paced(&mut self, pacer: &'m mut dyn Pacer) {
        self.operator.pacer = Some(pacer);
    }

    /// Waits until the next instant is due, or until an operator does something before that: the instant to go
    /// to. `None` when the run was stopped meanwhile.
    pub(super) fn pace(&mut self, next: Time) -> Option<Time> {
        let Some(pacer) = &mut self.operator.pacer else { return Some(next) };
        let at = pacer.pace(self.now, next, &mut self.operator.inputs);
        // Time goes on whatever a pacer says, and nothing that is due is passed over.
        let at = at.clamp(self.now + Time(1), next);
        (!self.stop.load(Ordering::Relaxed)).then_some(at)
    }

    /// Carries out the inputs of this instant, in the order in which they came.
    pub(super) fn operate_all(&mut self) {
        if self.operator.inputs.is_empty() {
            return;
        }
        let mut inputs = std::mem::take(&mut self.operator.inputs);
        inputs.drain(..).for_each(|input| self.operate(&input));
        self.operator.inputs = inputs;
    }

    /// Carries out an input. One about an agent or a parameter that the mission does not have does nothing:
    /// whoever takes inputs from a person tells that person.
    fn operate(&mut self, input: &Input) {
        let cause = self.recorder.record(self.now, None, || input.event());
        match &input.operation {
            Operation::Kill { agent } => {
                let Some(instance) = self.instance_of(agent) else { return };
                if self.lives.is_dead(instance) {
                    let (target, text) = (agent.clone(), "is dead already".to_string());
                    self.recorder.record(self.now, cause, || Event::Trouble { target, text });
                }
                self.kill(instance, "killed by the operator", cause);
            }
            Operation::Set { param, registers } => self.set_param(param, registers, cause),
            Operation::Stop => self.operator.stop = self.operator.stop.or(Some(cause)),
        }
    }

    /// The agent on a robot that is called `agent@robot`.
    fn instance_of(&self, identifier: &str) -> Option<u32> {
        let (agent, robot) = identifier.split_once('@')?;
        let is_it = |i: &super::cast::Instance| {
            *self.mission.graph.agents[i.agent as usize].name == *agent
                && self.scene.robots[i.robot as usize].name == robot
        };
        self.cast.instances.iter().position(is_it).map(|i| i as u32)
    }

    /// Sets a parameter; it holds for everything that is evaluated from now on.
    fn set_param(&mut self, name: &str, registers: &[f64], cause: Option<u64>) {
        let Some(index) = self.mission.graph.params.iter().position(|p| *p.name == *name) else { return };
        if let Some(slot) = self.mission.params.range(index).and_then(|r| self.params.get_mut(r))
            && slot.len() == registers.len()
        {
            slot.copy_from_slice(registers);
            self.recorder.record(self.now, cause, || Event::Param {
                agent: OPERATOR.to_string(),
                param: name.to_string(),
                registers: registers.to_vec(),
            });
            self.params_set(&[index as u32], cause);
        }
    }
}

impl Mission {
    /// Everybody who acts on a scene of this mission, as `agent@robot`.
    pub fn agents(&self, scene: &Scene) -> Vec<String> {
        let of_robot = |r: &'_ crate::scene::RobotScene| {
            let bindings = self.groups.get(r.group as usize).map(|g| g.agents.as_slice()).unwrap_or_default();
            let name =
                |agent: u32| self.graph.agents.get(agent as usize).map(|a| format!("{}@{}", a.name, r.name));
            bindings.iter().filter_map(|b| name(b.agent)).collect::<Vec<_>>()
        };
        scene.robots.iter().flat_map(of_robot).collect()
    }

    /// Registers of a value for the parameter at `index` of the graph's, as an input carries them.
    ///
    /// # Errors
    /// Why the value cannot be given to it while a run is under way.
    pub fn parameter(&self, index: usize, value: &Value) -> Result<Vec<f64>, String> {
        let Some(p) = self.graph.params.get(index) else { return Err("there is no such parameter".into()) };
        let (mut registers, mut texts) = (Vec::new(), self.texts.clone());
        if value.flatten(&p.ty, &self.graph.types, &mut texts, &mut registers).is_none()
            || !registers.iter().all(|x| x.is_finite())
        {
            return Err(format!("parameter `{}` must be a {}", p.name, p.ty));
        }
        // Registers hold numbers of texts: a replay would not know what this one stands for.
        if texts != self.texts {
            return Err(format!("parameter `{}` can be set to a new text before a run only", p.name));
        }
        Ok(registers)
    }
}
