//! Who acts in a run: the agents of all robots and their units, with the places of their state. Fixed
//! at the start.

use super::work;
use crate::{
    Scene, Time,
    mission::{
        Mission, START_VALUE,
        code::{TriggerCode, UnitCode},
        start::Start,
    },
    seed::{Stream, stream_id},
};
use soifra_graph::{Diagnostic, Distribution, Misses, Name, eval::Block};
use std::collections::BTreeMap;

/// Lifetime of commands and messages of units without a period of any kind.
pub const DEFAULT_LIFETIME: Time = Time(1_000_000_000);

/// An agent on a robot. Robots come in order, on each the agents in order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instance {
    pub agent: u32,
    pub robot: u32,
    /// Number among the agents of its robot.
    pub binding: u32,
    /// First state register.
    pub states: usize,
    /// First argument register.
    pub arguments: usize,
    /// First unit.
    pub units: u32,
    /// First plan node.
    pub nodes: usize,
    /// First sub-goal.
    pub subgoals: usize,
    /// First device.
    pub devices: u32,
    /// Random stream.
    pub stream: u64,
}

/// A unit of an agent on a robot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnitInfo {
    pub instance: u32,
    /// Number in its agent.
    pub unit: u32,
    pub priority: i64,
    pub worst: Time,
    /// Relative deadline; [`Time::MAX`] without one.
    pub deadline: Time,
    /// Least time between releases; 0 without one.
    pub gap: Time,
    /// How long its commands and messages live unless said otherwise.
    pub lifetime: Time,
    /// Its period, when it is released periodically.
    pub period: Option<Time>,
    /// Index in [`Cast::works`], for units on a core and those that do not just take their worst case.
    pub work: Option<u32>,
}

/// What executing a unit asks for.
#[derive(Debug, Clone)]
pub(crate) struct Work {
    /// Index in [`Cast::cores`].
    pub core: Option<u32>,
    pub takes: Option<Distribution>,
    /// Rounds of an anytime service that its budget pays for, and what one costs.
    pub rounds: u32,
    pub cost: Time,
    pub jitter: Time,
    pub misses: Misses,
    /// Resources it holds at its beginning, one after the other, and for how long.
    pub resources: Vec<(Name, Time)>,
    /// The ceiling of each, and for how long.
    pub sections: Vec<(Rank, Time)>,
    /// Random stream.
    pub stream: u64,
}

/// Rank on a core; the least goes first.
pub(crate) type Rank = (std::cmp::Reverse<i64>, u32);

/// A device of an agent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DeviceInfo {
    pub instance: u32,
    pub capacity: u32,
}

/// A virtual core.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CoreInfo {
    pub robot: u32,
    /// Absent for one that a unit has for itself.
    pub number: Option<u32>,
}

/// Units that are released together.
#[derive(Debug, Clone)]
pub(crate) struct Timer {
    pub next: Time,
    pub period: Time,
    /// In order of priority, robot, agent, unit.
    pub members: Vec<u32>,
}

/// Who acts.
#[derive(Debug, Default)]
pub(crate) struct Cast {
    pub instances: Vec<Instance>,
    /// First instance of each robot, and the end.
    pub first: Vec<u32>,
    pub units: Vec<UnitInfo>,
    pub arguments: Vec<f64>,
    pub timers: Vec<Timer>,
    pub devices: Vec<DeviceInfo>,
    pub works: Vec<Work>,
    pub cores: Vec<CoreInfo>,
    /// Initial states.
    pub states: Vec<f64>,
    pub nodes: usize,
    pub subgoals: usize,
}

impl Cast {
    /// The agents of a robot.
    pub fn of_robot(&self, robot: u32) -> std::ops::Range<usize> {
        let at = |r: usize| self.first.get(r).copied().unwrap_or(0) as usize;
        at(robot as usize)..at(robot as usize + 1)
    }

    /// The instance of agent type `agent` on a robot.
    pub fn find(&self, robot: u32, agent: u32) -> Option<usize> {
        self.of_robot(robot).find(|&i| self.instances[i].agent == agent)
    }

    /// Arguments of an instance.
    pub fn arguments_of(&self, instance: usize) -> &[f64] {
        let from = self.instances[instance].arguments;
        let to = self.instances.get(instance + 1).map_or(self.arguments.len(), |i| i.arguments);
        &self.arguments[from..to]
    }

    /// Evaluates arguments, initial states and durations of everybody.
    pub fn new<'m>(
        mission: &'m Mission,
        scene: &'m Scene,
        start: &mut Start<'m>,
    ) -> Result<Cast, Diagnostic> {
        let mut cast = Cast::default();
        let mut timers: BTreeMap<(Time, Time), Vec<u32>> = BTreeMap::new();
        let mut array = (u32::MAX, 0usize);
        for (r, robot) in scene.robots.iter().enumerate() {
            cast.first.push(cast.instances.len() as u32);
            let Some(group) = mission.groups.get(robot.group as usize) else {
                return Err(Diagnostic::error(
                    START_VALUE,
                    "the scene has a robot that the graph does not have",
                ));
            };
            array = if array.0 == robot.group { (array.0, array.1 + 1) } else { (robot.group, 0) };
            start.robot = Some((scene, r as u32));
            for (b, binding) in group.agents.iter().enumerate() {
                let agent = &mission.agents[binding.agent as usize];
                let name = format!("{}@{}", mission.graph.agents[binding.agent as usize].name, robot.name);
                start.stream = Some(Stream::new(start.seed, &format!("arguments/{name}")));
                let instance = Instance {
                    agent: binding.agent,
                    robot: r as u32,
                    binding: b as u32,
                    states: cast.states.len(),
                    arguments: cast.arguments.len(),
                    units: cast.units.len() as u32,
                    nodes: cast.nodes,
                    subgoals: cast.subgoals,
                    devices: cast.devices.len() as u32,
                    stream: stream_id(&format!("agent/{name}")),
                };
                for block in &binding.arguments {
                    let value = start.run(block, &[(0, array.1 as f64)])?;
                    cast.arguments.extend_from_slice(value);
                }
                start.stream = None;
                let arguments = cast.arguments[instance.arguments..].to_vec();
                for block in &agent.initial {
                    cast.states.extend_from_slice(start.run_with(block, &[], &arguments)?);
                }
                let number = cast.instances.len() as u32;
                for (u, unit) in agent.units.iter().enumerate() {
                    let (info, timer) = schedule(
                        start,
                        scene,
                        robot.platform,
                        unit,
                        &binding.sensors,
                        number,
                        u as u32,
                        &arguments,
                    )?;
                    if let Some(t) = timer {
                        timers.entry(t).or_default().push(cast.units.len() as u32);
                    }
                    let of = &mission.graph.agents[binding.agent as usize].units[u].name;
                    let source = format!("work/{name}.{of}");
                    let work = work::of_unit(&mut cast, start, r as u32, unit, &source, &arguments)?;
                    let info = UnitInfo { work, ..info };
                    cast.units.push(info);
                }
                cast.nodes += agent.nodes;
                cast.subgoals += agent.subgoals.len();
                for d in &mission.graph.agents[binding.agent as usize].devices {
                    cast.devices.push(DeviceInfo { instance: number, capacity: d.capacity });
                }
                cast.instances.push(instance);
            }
        }
        cast.first.push(cast.instances.len() as u32);
        work::ceilings(&mut cast);
        for ((period, next), mut members) in timers {
            members.sort_by_key(|&u| (std::cmp::Reverse(cast.units[u as usize].priority), u));
            cast.timers.push(Timer { next, period, members });
        }
        Ok(cast)
    }
}

/// The shortest period, in nanoseconds: a bound on the number of events of a run.
const SHORTEST_PERIOD: i64 = 1_000;
/// The longest duration in the timing of a unit, in nanoseconds: twice as long is still an instant.
pub(super) const LONGEST: i64 = 900_000_000 * 1_000_000_000;

/// Durations of a unit, and period and first release of a periodic one.
#[expect(clippy::too_many_arguments, reason = "each is another side of the one unit")]
fn schedule(
    start: &mut Start<'_>,
    scene: &Scene,
    platform: u32,
    unit: &UnitCode,
    sensors: &[u32],
    instance: u32,
    number: u32,
    arguments: &[f64],
) -> Result<(UnitInfo, Option<(Time, Time)>), Diagnostic> {
    let mut duration = |block: Option<&Block>, least: i64| -> Result<Option<Time>, Diagnostic> {
        let Some(block) = block else { return Ok(None) };
        let s = start.run_with(block, &[], arguments)?[0];
        match Time::from_seconds(s) {
            Some(t) if (least..=LONGEST).contains(&t.0) => Ok(Some(t)),
            _ => Err(Diagnostic::error(START_VALUE, format!("a duration of {s} s is not possible here"))
                .at(unit.span, "in the timing of this unit")),
        }
    };
    let step = scene.step.unwrap_or(Time(1));
    let (period, offset) = match &unit.trigger {
        TriggerCode::Every { period, offset } => {
            (duration(Some(period), SHORTEST_PERIOD)?, duration(offset.as_ref(), 0)?)
        }
        TriggerCode::Step { offset } => (Some(step), duration(offset.as_ref(), 0)?),
        _ => (None, None),
    };
    let gap = duration(unit.timing.at_most_every.as_ref(), 0)?.unwrap_or_default();
    let sensor = match &unit.trigger {
        TriggerCode::Reading(port) => {
            sensors.get(*port as usize).and_then(|s| sensor_period(scene, platform, *s))
        }
        _ => None,
    };
    let rhythm = period.or(sensor).or((gap > Time::ZERO).then_some(gap));
    let info = UnitInfo {
        instance,
        unit: number,
        priority: unit.timing.priority,
        worst: duration(unit.timing.worst_case.as_ref(), 0)?.unwrap_or_default(),
        // On a core the next release is the latest that counts as in time.
        deadline: duration(unit.timing.deadline.as_ref(), 0)?
            .or(rhythm.filter(|_| unit.timing.core.is_some() || unit.timing.budget.is_some()))
            .unwrap_or(Time::MAX),
        gap: if period.is_some() { Time::ZERO } else { gap },
        lifetime: rhythm.map_or(DEFAULT_LIFETIME, |p| p + p),
        period,
        work: None,
    };
    Ok((info, period.map(|p| (p, offset.unwrap_or_default()))))
}

/// Period of a platform sensor; that of the step clock for one that is read at every step.
pub(crate) fn sensor_period(scene: &Scene, platform: u32, sensor: u32) -> Option<Time> {
    let part = scene.platforms.get(platform as usize)?.of_role("sensor").nth(sensor as usize)?;
    part.optional("period").and_then(Time::from_seconds).or(scene.step)
}
