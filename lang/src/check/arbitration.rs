//! Does every actuator have one writer, or an arbiter that all its writers go through?

use super::walk;
use crate::code;
use soifra_graph::{Arbiter, Diagnostic, Graph, Name, RobotGroup, Span, StmtKind};
use std::collections::{BTreeMap, BTreeSet};

/// A unit that commands an actuator: agent, unit, place of its first command.
type Writer = (u32, u32, Span);

/// Checks every robot, and every agent that no robot runs, by itself.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let mut seen: BTreeSet<Vec<u32>> = BTreeSet::new();
    for r in &g.robots {
        let agents: Vec<u32> = r.agents.iter().map(|b| b.agent).collect();
        if seen.insert(agents.clone()) {
            together(g, &agents, Some(r), &mut out);
        }
    }
    let used = super::used_agents(g);
    for (i, _) in used.iter().enumerate().filter(|(_, u)| !**u) {
        let own = &g.agents[i];
        let foreign = own.arbiters.iter().any(|a| a.sources.iter().any(|s| s.agent as usize != i));
        if !foreign {
            together(g, &[i as u32], None, &mut out);
        }
    }
    out
}

/// Checks agents that share a robot.
fn together(g: &Graph, agents: &[u32], robot: Option<&RobotGroup>, out: &mut Vec<Diagnostic>) {
    let mut writers: BTreeMap<Name, Vec<Writer>> = BTreeMap::new();
    let mut arbiters: BTreeMap<Name, Vec<(u32, &Arbiter)>> = BTreeMap::new();
    for &i in agents {
        let Some(a) = g.agents.get(i as usize) else { continue };
        for (k, u) in a.units.iter().enumerate() {
            for s in walk::statements(u) {
                let StmtKind::Command(port, _) = &s.kind else { continue };
                let Some(p) = a.actuators.get(*port as usize) else { continue };
                let list = writers.entry(p.name.clone()).or_default();
                if !list.iter().any(|w| (w.0, w.1) == (i, k as u32)) {
                    list.push((i, k as u32, s.at));
                }
            }
        }
        for x in &a.arbiters {
            if let Some(p) = a.actuators.get(x.actuator as usize) {
                arbiters.entry(p.name.clone()).or_default().push((i, x));
            }
        }
        for p in &a.actuators {
            writers.entry(p.name.clone()).or_default();
        }
    }
    let unit = |a: u32, u: u32| {
        let agent = &g.agents[a as usize];
        let unit = agent.units.get(u as usize).map_or("?", |u| &*u.name);
        if agents.len() > 1 { format!("{}.{unit}", agent.name) } else { unit.to_string() }
    };
    for (actuator, list) in &writers {
        match arbiters.get(actuator).map(Vec::as_slice).unwrap_or_default() {
            [] if list.len() > 1 => {
                let mut d = Diagnostic::error(
                    code::SEVERAL_WRITERS,
                    format!("{} units command `{actuator}` and nobody decides between them", list.len()),
                );
                for (a, u, at) in list {
                    d = d.at(*at, format!("`{}` commands it", unit(*a, *u)));
                }
                let names: Vec<String> = list.iter().map(|(a, u, _)| unit(*a, *u)).collect();
                out.push(d.hint(format!(
                    "say who wins: `arbitrate {actuator} by switch [{}]`, or by priority, layers or blend",
                    names.join(", ")
                )));
            }
            [] => {}
            [(_, x)] => through(g, actuator, list, x, agents, &unit, out),
            [(_, first), rest @ ..] => {
                let mut d =
                    Diagnostic::error(code::ARBITER_SOURCE, format!("`{actuator}` has several arbiters"));
                for (_, x) in rest {
                    d = d.at(x.at, "one more");
                }
                out.push(
                    d.at(first.at, "the first")
                        .hint("one arbiter decides for one actuator: put all sources into it"),
                );
            }
        }
        if list.is_empty() {
            let port = agents
                .iter()
                .filter_map(|i| g.agents.get(*i as usize))
                .flat_map(|a| &a.actuators)
                .find(|p| p.name == *actuator);
            if let (Some(p), Some(_)) = (port, robot) {
                out.push(
                    Diagnostic::warning(code::UNUSED_ACTUATOR, format!("nobody commands `{actuator}`"))
                        .at(p.span, "declared here")
                        .hint("remove the declaration, or command it"),
                );
            }
        }
    }
}

/// Checks that an arbiter's sources are exactly the actuator's writers.
fn through(
    g: &Graph,
    actuator: &Name,
    list: &[Writer],
    x: &Arbiter,
    agents: &[u32],
    unit: &dyn Fn(u32, u32) -> String,
    out: &mut Vec<Diagnostic>,
) {
    for (a, u, at) in list {
        if !x.sources.iter().any(|s| (s.agent, s.unit) == (*a, *u)) {
            out.push(
                Diagnostic::error(
                    code::ARBITER_SOURCE,
                    format!("`{}` commands `{actuator}` past its arbiter", unit(*a, *u)),
                )
                .at(*at, "commands it here")
                .at(x.at, "decides between others only")
                .hint(format!("add `{}` to the arbiter's sources", unit(*a, *u))),
            );
        }
    }
    for s in &x.sources {
        if !agents.contains(&s.agent) {
            out.push(
                Diagnostic::error(
                    code::ARBITER_SOURCE,
                    format!("`{}` does not run on this robot", g.source_name(s)),
                )
                .at(s.at, "listed here")
                .hint("let the robot run that agent too, or take it out of the arbiter"),
            );
        } else if !list.iter().any(|(a, u, _)| (s.agent, s.unit) == (*a, *u)) {
            out.push(
                Diagnostic::error(
                    code::ARBITER_SOURCE,
                    format!("`{}` never commands `{actuator}`", g.source_name(s)),
                )
                .at(s.at, "listed here")
                .hint("take it out of the arbiter, or let it command the actuator"),
            );
        }
    }
}
