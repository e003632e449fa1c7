//! Who uses which core for how long, read off a graph: the tables of `soifra check --timing` and the findings
//! of the checks are made from it.

pub mod analysis;
mod chains;

use crate::check::Constants;
use analysis::Load;
pub use chains::{Chain, Link};
use soifra_graph::{Expr, Graph, Misses, Name, Op, RobotGroup, Span, StmtKind, Trigger, UnitKind};
use std::collections::BTreeMap;

/// The timing of a mission, with parameters at their defaults.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Timing {
    /// Cores, by robot and number.
    pub cores: Vec<Core>,
    /// From a reading to the command that takes it into account.
    pub chains: Vec<Chain>,
}

/// A core of a robot and the units on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Core {
    /// Robot, or array of robots.
    pub robot: Name,
    /// Its number.
    pub number: i64,
    /// Tasks in order of priority, the most urgent first.
    pub tasks: Vec<Task>,
    /// Share of the core that is asked for, optional work left out; absent when not all is known.
    pub utilization: Option<f64>,
    /// Liu and Layland's bound for so many tasks.
    pub bound: f64,
    /// Whether shorter periods have higher priorities, and deadlines are the periods: then the bound counts.
    pub rate_monotonic: bool,
}

/// A unit on a core.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Agent.
    pub agent: Name,
    /// Unit.
    pub unit: Name,
    /// Indices of both in the graph.
    pub index: (u32, u32),
    /// Priority.
    pub priority: i64,
    /// Period, or least distance of releases, in nanoseconds.
    pub period: Option<i64>,
    /// Whether it is released periodically.
    pub periodic: bool,
    /// Worst case, without the rounds of an anytime service.
    pub worst: i64,
    /// Budget of an anytime service.
    pub budget: i64,
    /// Release jitter.
    pub jitter: i64,
    /// Relative deadline: the period unless declared.
    pub deadline: Option<i64>,
    /// What a miss means.
    pub misses: Misses,
    /// Longest wait for a resource held below it.
    pub blocking: i64,
    /// Longest time from arrival to completion, without budget; absent when it has no bound.
    pub response: Option<i64>,
    /// The same with the whole budget.
    pub full_response: Option<i64>,
    /// Where it was written.
    pub span: Span,
}

impl Task {
    /// Whether it is sure to be done in time.
    pub fn is_met(&self) -> bool {
        matches!((self.response, self.deadline), (Some(r), Some(d)) if r <= d)
    }
}

/// The timing of a graph that may be damaged.
pub fn of_graph(g: &Graph) -> Option<Timing> {
    crate::check::fits_together(g).then(|| timing(g))
}

/// Reads the timing off a graph.
pub fn timing(g: &Graph) -> Timing {
    let mut known = Constants::new(g);
    let mut cores = Vec::new();
    for group in &g.robots {
        let mut by_number: BTreeMap<i64, Vec<(Task, Load)>> = BTreeMap::new();
        let mut resources: Vec<Name> = Vec::new();
        for binding in &group.agents {
            let Some(agent) = g.agents.get(binding.agent as usize) else { continue };
            for (u, unit) in agent.units.iter().enumerate() {
                let Some(number) = unit.timing.core else { continue };
                let mut nanoseconds = |e: &Expr| nanoseconds(&mut known, e, &binding.arguments);
                let t = &unit.timing;
                let mut time = |e: &Option<Expr>| e.as_ref().and_then(&mut nanoseconds);
                let (worst, budget) = (time(&t.worst_case).unwrap_or(0), time(&t.budget).unwrap_or(0));
                if worst + budget == 0 {
                    continue;
                }
                let (declared, jitter) = (time(&t.deadline), time(&t.jitter).unwrap_or(0));
                let periodic = matches!(unit.trigger, Trigger::Every { .. } | Trigger::Step { .. });
                let period = match &unit.trigger {
                    Trigger::Every { period, .. } => nanoseconds(period),
                    Trigger::Step { .. } => g.step.as_ref().and_then(&mut nanoseconds),
                    Trigger::Reading(port) => {
                        let gap = time(&t.at_most_every);
                        let sensor = agent.sensors.get(*port as usize);
                        let own = sensor.and_then(|s| sensor_times(g, group, &s.name));
                        gap.or(own.and_then(|o| o.period).and_then(&mut nanoseconds))
                    }
                    _ => time(&t.at_most_every),
                };
                let mut sections = Vec::new();
                for s in &t.shares {
                    let number = resources.iter().position(|r| *r == s.resource).unwrap_or_else(|| {
                        resources.push(s.resource.clone());
                        resources.len() - 1
                    });
                    sections.push((number, nanoseconds(&s.time).unwrap_or(0)));
                }
                let task = Task {
                    agent: agent.name.clone(),
                    unit: unit.name.clone(),
                    index: (binding.agent, u as u32),
                    priority: t.priority.unwrap_or(0),
                    period,
                    periodic,
                    worst,
                    budget,
                    jitter,
                    deadline: declared.or(period),
                    misses: t.misses,
                    blocking: 0,
                    response: None,
                    full_response: None,
                    span: unit.span,
                };
                let load = Load { period: period.unwrap_or(0), worst, optional: budget, jitter, sections };
                by_number.entry(number).or_default().push((task, load));
            }
        }
        for (number, list) in by_number {
            cores.push(core(&group.name, number, list));
        }
    }
    let chains = chains::chains(g, &cores, &mut known);
    Timing { cores, chains }
}

/// A core, with everything that can be told about it.
fn core(robot: &Name, number: i64, mut list: Vec<(Task, Load)>) -> Core {
    // Of equals the first declared is the more urgent, as in a run.
    list.sort_by_key(|(t, _)| std::cmp::Reverse(t.priority));
    let (mut tasks, loads): (Vec<Task>, Vec<Load>) = list.into_iter().unzip();
    let complete = tasks.iter().all(|t| t.period.is_some());
    for (i, task) in tasks.iter_mut().enumerate() {
        task.blocking = analysis::blocking(&loads, i);
        // What is above it must be known; what is below it need not.
        if loads[..=i].iter().all(|l| l.period > 0) {
            task.response = analysis::response(&loads, i);
            task.full_response = match loads[i].optional {
                0 => task.response,
                budget => {
                    let mut all = loads.clone();
                    (all[i].worst, all[i].optional) = (all[i].worst + budget, 0);
                    analysis::response(&all, i)
                }
            };
        }
    }
    let monotonic = tasks.is_sorted_by_key(|t| t.period);
    let implicit = tasks.iter().all(|t| t.deadline == t.period);
    Core {
        robot: robot.clone(),
        number,
        utilization: complete.then(|| analysis::utilization(&loads)),
        bound: analysis::bound(tasks.len()),
        rate_monotonic: complete && monotonic && implicit,
        tasks,
    }
}

/// A duration for an agent with these arguments, in nanoseconds.
fn nanoseconds(known: &mut Constants<'_>, e: &Expr, arguments: &[Expr]) -> Option<i64> {
    let given = e.replaced(&|op| match op {
        Op::Argument(i) => arguments.get(*i as usize).cloned(),
        _ => None,
    });
    let seconds = known.number(&given, 0)?;
    let ns = (seconds * 1e9).round();
    (ns.is_finite() && ns.abs() < 9e18).then_some(ns as i64)
}

/// When a sensor captures and how long its readings are under way.
struct SensorTimes<'g> {
    period: Option<&'g Expr>,
    latency: Option<&'g Expr>,
}

fn sensor_times<'g>(g: &'g Graph, group: &RobotGroup, name: &str) -> Option<SensorTimes<'g>> {
    let platform = g.platforms.get(group.platform as usize)?;
    let sensor = platform.of_role("sensor").find(|c| *c.name == *name)?;
    let arg = |name: &str| sensor.args.iter().find(|(n, _)| **n == *name).map(|(_, e)| e);
    let inner = |e: &'g Expr| match e.op {
        Op::MakeSome => e.args.first(),
        Op::Const(soifra_graph::Value::None(_)) => None,
        _ => Some(e),
    };
    let period = arg("period").and_then(inner).or(g.step.as_ref());
    Some(SensorTimes { period, latency: arg("latency") })
}

/// What one round of an anytime service costs.
pub fn round_cost(kind: &UnitKind) -> Option<&Expr> {
    let UnitKind::Service(body) = kind else { return None };
    body.iter().find_map(|s| match &s.kind {
        StmtKind::Refine(r) => Some(&r.cost),
        _ => None,
    })
}
