//! Wires robots: which port of an agent is which sensor or actuator of the platform, and who decides
//! what an actuator gets.

use super::{
    code::*,
    compile::{Compiled, alone_as, damaged},
    uses::Uses,
};
use soifra_graph::{Component, Graph, RobotGroup, Type, eval::Compiler};

/// Robots of group `g`.
pub(super) fn group(c: &mut Compiler<'_>, graph: &Graph, g: &RobotGroup) -> Compiled<GroupCode> {
    let Some(platform) = graph.platforms.get(g.platform as usize) else {
        return damaged(g.at, "a robot has a platform that does not exist");
    };
    let sensors: Vec<&Component> = platform.of_role("sensor").collect();
    let actuators: Vec<&Component> = platform.of_role("actuator").collect();
    let mut code =
        GroupCode { agents: Vec::new(), channels: Vec::new(), consumed: vec![false; sensors.len()] };
    for b in &g.agents {
        let Some(agent) = graph.agents.get(b.agent as usize) else {
            return damaged(b.at, "a robot runs an agent that does not exist");
        };
        if code.agents.iter().any(|a| a.agent == b.agent) {
            return damaged(b.at, format!("a robot runs agent `{}` twice", agent.name));
        }
        if b.arguments.len() != agent.parameters.len() {
            return damaged(b.at, format!("agent `{}` is given the wrong number of arguments", agent.name));
        }
        let mut binding = BindingCode {
            agent: b.agent,
            arguments: Vec::new(),
            sensors: Vec::new(),
            routes: vec![None; agent.units.len() * agent.actuators.len()],
            actuators: agent.actuators.len(),
        };
        for (e, (_, ty)) in b.arguments.iter().zip(&agent.parameters) {
            binding.arguments.push(alone_as(c, e, &[Type::Int], ty)?);
        }
        for port in &agent.sensors {
            let fits =
                |s: &&Component| s.name == port.name && s.ty.as_ref().is_some_and(|t| t.serves(&port.ty));
            let Some(s) = sensors.iter().position(fits) else {
                return damaged(
                    port.span,
                    format!("platform `{}` has no such sensor `{}`", platform.name, port.name),
                );
            };
            code.consumed[s] = true;
            binding.sensors.push(s as u32);
        }
        code.agents.push(binding);
    }
    for (a, component) in actuators.iter().enumerate() {
        if let Some(channel) = channel(graph, g, &mut code, a as u32, component)? {
            code.channels.push(channel);
        }
    }
    for b in &g.agents {
        let ports = graph.agents.get(b.agent as usize).map(|a| a.actuators.as_slice()).unwrap_or_default();
        for port in ports {
            if !actuators.iter().any(|c| c.name == port.name && c.ty.as_ref() == Some(&port.ty)) {
                return damaged(
                    port.span,
                    format!("platform `{}` has no such actuator `{}`", platform.name, port.name),
                );
            }
        }
    }
    Ok(code)
}

/// Who commands actuator `a`, and who decides; `None` when nobody does.
fn channel(
    graph: &Graph,
    g: &RobotGroup,
    code: &mut GroupCode,
    a: u32,
    component: &Component,
) -> Compiled<Option<ChannelCode>> {
    let mut writers: Vec<(u32, u32, u32)> = Vec::new();
    let mut arbiter: Option<(u32, u32)> = None;
    for (b, binding) in g.agents.iter().enumerate() {
        let Some(agent) = graph.agents.get(binding.agent as usize) else { continue };
        for (p, port) in agent.actuators.iter().enumerate().filter(|(_, p)| p.name == component.name) {
            for (u, unit) in agent.units.iter().enumerate() {
                if Uses::of_unit(unit).commands.contains(&(p as u32)) {
                    writers.push((b as u32, u as u32, p as u32));
                }
            }
            for (i, arb) in agent.arbiters.iter().enumerate().filter(|(_, x)| x.actuator as usize == p) {
                if arbiter.replace((b as u32, i as u32)).is_some() {
                    return damaged(arb.at, format!("actuator `{}` has a second arbiter", port.name));
                }
            }
        }
    }
    if writers.is_empty() {
        return Ok(None);
    }
    let mut sources: Vec<Option<(u32, u32)>> = Vec::new();
    let mut names = Vec::new();
    if let Some((b, i)) = arbiter {
        let agent = g.agents.get(b as usize).and_then(|b| graph.agents.get(b.agent as usize));
        for s in
            agent.and_then(|a| a.arbiters.get(i as usize)).map(|a| a.sources.as_slice()).unwrap_or_default()
        {
            let binding = g.agents.iter().position(|x| x.agent == s.agent);
            sources.push(binding.map(|b| (b as u32, s.unit)));
            names.push(graph.source_name(s));
        }
    } else if let [(b, u, _)] = writers[..] {
        sources.push(Some((b, u)));
        let agent = g.agents[b as usize].agent;
        names.push(graph.source_name(&soifra_graph::Source { agent, unit: u, at: component.at }));
    } else {
        return damaged(
            g.at,
            format!("several units command actuator `{}` without an arbiter", component.name),
        );
    }
    let number = code.channels.len() as u32;
    for (b, u, p) in writers {
        let Some(source) = sources.iter().position(|s| *s == Some((b, u))) else {
            return damaged(g.at, format!("a unit commands actuator `{}` past its arbiter", component.name));
        };
        let binding = &mut code.agents[b as usize];
        let slot = u as usize * binding.actuators + p as usize;
        binding.routes[slot] = Some((number, source as u32));
    }
    let width = component.ty.as_ref().map_or(0, |t| graph.types.width(t));
    Ok(Some(ChannelCode { actuator: a, name: component.name.clone(), width, arbiter, sources, names }))
}
