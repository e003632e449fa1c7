//! The ontology of a mission: mission, goal, sub-goal, plan, agent, service, action (SOIFRA, fig. 7), with the
//! allocation at the start of a run.

use super::{
    model::{Builder, Kind, View},
    reach::{self, Reach},
};
use soifra_graph::{Agent, Graph};
use std::collections::BTreeMap;

/// What the picture shows.
pub fn view(graph: &Graph) -> View {
    let mut b = Builder { graph, things: BTreeMap::new(), links: Vec::new() };
    let title = if graph.title.is_empty() {
        graph.name.to_string()
    } else {
        format!("{} – {}", graph.name, graph.title)
    };
    let mission = b.thing(Kind::Mission, &graph.name, vec![format!("mission {}", graph.name)]);
    let allotted = soifra_lang::allocation(graph);
    for (g, goal) in (0..).zip(&graph.goals) {
        let request = if goal.on_request { vec!["on request".to_string()] } else { Vec::new() };
        let lines = [vec![format!("goal {}", goal.name)], request].concat();
        let id = b.thing(Kind::Goal, &goal.name, lines);
        b.link(&mission, &id, "");
        for (i, s) in (0..).zip(&goal.subgoals) {
            let key = format!("{}/{}", goal.name, s.name);
            let lines = vec![format!("sub-goal {}", s.name)];
            let sub = b.thing(Kind::Subgoal, &key, lines);
            let by = s.plan.and_then(|p| graph.plans.get(p as usize)).map_or("", |p| &*p.name);
            b.link(&id, &sub, by);
            if let Some(a) = s.agent {
                for (name, robot) in running(graph, a) {
                    let agent = agent(&mut b, graph, a, &name, robot);
                    b.link(&sub, &agent, "by name");
                }
            }
            for (p, plan) in
                (0..).zip(&graph.plans).filter(|(_, p)| p.target == s.name && !p.needs.is_empty())
            {
                let needs: Vec<&str> = plan.needs.iter().map(|(n, _)| &**n).collect();
                let mut lines = vec![format!("plan {}", plan.name), format!("needs {}", needs.join(", "))];
                lines.extend(
                    plan.when.as_ref().map(|w| format!("when {}", b.text(w.span, "its condition holds"))),
                );
                let id = b.thing(Kind::Plan, &plan.name, lines);
                b.link(&sub, &id, "");
                for (service, _) in &plan.needs {
                    for (a, kind) in (0..).zip(&graph.agents) {
                        if !kind.offers.iter().any(|o| o.name == *service) {
                            continue;
                        }
                        for (name, robot) in running(graph, a) {
                            let agent = agent(&mut b, graph, a, &name, robot);
                            let taken = allotted.iter().any(|x| {
                                x.goal == (g, i)
                                    && x.plan == p
                                    && x.agents.iter().any(|(s, n)| s == service && is_of(n, &name))
                            });
                            b.link(
                                &id,
                                &agent,
                                &if taken { format!("{service}: allocated") } else { service.to_string() },
                            );
                        }
                    }
                }
            }
        }
    }
    // Those that no sub-goal leads to serve the others.
    for a in 0..graph.agents.len() as u32 {
        for (name, robot) in running(graph, a) {
            if !b.things.contains_key(&(Kind::Agent, name.clone())) {
                let agent = agent(&mut b, graph, a, &name, robot);
                b.link(&mission, &agent, "serves no sub-goal");
            }
        }
    }
    b.links.sort();
    b.links.dedup();
    View { title, things: b.things.into_values().collect(), agents: Vec::new(), links: b.links }
}

/// Whether an agent on a robot is, or is one of, what is called so: `scout@swarm[2]` is one of `scout@swarm[]`.
fn is_of(identifier: &str, name: &str) -> bool {
    identifier == name
        || name.strip_suffix("[]").is_some_and(|array| identifier.starts_with(&format!("{array}[")))
}

/// An agent type on the robots that run it: `agent@robot`, arrays as one; with whether it is there.
fn running(graph: &Graph, agent: u32) -> Vec<(String, bool)> {
    let kind = graph.agents.get(agent as usize).map_or("?", |a| &*a.name);
    let name = |r: &soifra_graph::RobotGroup| match r.count {
        Some(_) => format!("{kind}@{}[]", r.name),
        None => format!("{kind}@{}", r.name),
    };
    let runs =
        graph.robots.iter().filter(|r| r.agents.iter().any(|b| b.agent == agent)).map(|r| (name(r), true));
    let unfit =
        graph.robots.iter().filter(|r| r.unfit.iter().any(|u| u.agent == agent)).map(|r| (name(r), false));
    runs.chain(unfit).collect()
}

/// An agent with its services and what they do to the world.
fn agent(b: &mut Builder<'_>, graph: &Graph, index: u32, name: &str, fit: bool) -> String {
    let Some(kind) = graph.agents.get(index as usize) else { return String::new() };
    let known = b.things.contains_key(&(Kind::Agent, name.to_string()));
    let nature = match (fit, kind.collaborative) {
        (false, _) => "not capable on this platform",
        (true, true) => "collaborative",
        (true, false) => "exclusive",
    };
    let id = b.thing(Kind::Agent, name, vec![name.to_string(), nature.to_string()]);
    if !known && fit {
        for (u, unit) in kind.units.iter().enumerate() {
            let key = format!("{}.{}", kind.name, unit.name);
            let offered = kind.offers.iter().any(|o| o.unit == Some(u as u32));
            let word = if offered { "offered service" } else { "service" };
            let service = b.thing(Kind::Service, &key, vec![format!("{word} {}", unit.name)]);
            b.link(&id, &service, "");
            for action in actions(graph, kind, &Reach::of(unit)) {
                let action = b.thing(Kind::Action, &action, vec![action.clone()]);
                b.link(&service, &action, "");
            }
        }
    }
    id
}

/// What a unit does to the world and to others.
fn actions(graph: &Graph, agent: &Agent, reach: &Reach) -> Vec<String> {
    let commands = reach.commands.iter().map(|p| format!("command {}", reach::port(agent, false, *p)));
    let topic = |t: &u32| graph.topics.get(*t as usize).map_or("?", |t| &*t.channel.name);
    let publishes = reach.publishes.iter().map(|t| format!("publish {}", topic(t)));
    let tells = reach.tells.iter().map(|(p, to, what)| format!("{p} {to} {what}"));
    commands.chain(publishes).chain(tells).collect()
}
