//! Is every message read by somebody, and every one that is awaited sent by somebody?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Graph, Name, Op, Span, StmtKind, Trigger, Type};

/// Checks topics and told messages of the agents that robots run.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let used = super::used_agents(g);
    let agents: Vec<_> = g.agents.iter().zip(&used).filter(|(_, u)| **u).map(|(a, _)| a).collect();
    let mut published: Vec<Option<Span>> = vec![None; g.topics.len()];
    let mut read = published.clone();
    let mut told: Vec<(Name, Name, Name, Span)> = Vec::new();
    for a in &agents {
        for s in a.units.iter().flat_map(walk::statements) {
            match &s.kind {
                StmtKind::Publish(t, _) => {
                    if let Some(slot) = published.get_mut(*t as usize) {
                        slot.get_or_insert(s.at);
                    }
                }
                StmtKind::Tell { performative, to, content } => {
                    if let Type::Record(r) = &content.ty {
                        told.push((to.clone(), performative.clone(), r.clone(), s.at));
                    }
                }
                _ => {}
            }
        }
        walk::agent(a, &mut |e| {
            if let Op::Heard(t) = e.op
                && let Some(slot) = read.get_mut(t as usize)
            {
                slot.get_or_insert(e.span);
            }
        });
        for u in &a.units {
            if let Trigger::Message { topic, .. } = u.trigger
                && let Some(slot) = read.get_mut(topic as usize)
            {
                slot.get_or_insert(u.span);
            }
        }
    }
    for ((t, published), read) in g.topics.iter().zip(&published).zip(&read) {
        let name = &t.channel.name;
        match (published, read) {
            (Some(at), None) => out.push(
                Diagnostic::error(code::UNREAD_TOPIC, format!("nobody reads topic `{name}`"))
                    .at(*at, "published here")
                    .hint(format!(
                        "read it with `heard({name})` or a unit `on {name}(m)`, or do not publish it"
                    )),
            ),
            (None, Some(at)) => out.push(
                Diagnostic::error(code::UNPUBLISHED_TOPIC, format!("nobody publishes on topic `{name}`"))
                    .at(*at, "waited for here")
                    .hint(format!("add `publish {name} …` to the agent that knows it")),
            ),
            _ => {}
        }
    }
    for (to, performative, content, at) in &told {
        let Some(a) = agents.iter().find(|a| a.name == *to) else {
            out.push(
                Diagnostic::error(code::UNREAD_TOPIC, format!("no robot runs `{to}`"))
                    .at(*at, "told here")
                    .hint("let the robot run it too"),
            );
            continue;
        };
        let heard = a.units.iter().any(|u| matches!(&u.trigger, Trigger::Told { performative: p, content: c, .. } if p == performative && c == content));
        if !heard {
            out.push(
                Diagnostic::error(
                    code::UNREAD_TOPIC,
                    format!("`{to}` does not listen to {performative} {content}"),
                )
                .at(*at, "told here")
                .at(a.span, "has no unit for it")
                .hint(format!("add a unit `on {performative} {content}(m)` to it")),
            );
        }
    }
    for a in &agents {
        for u in &a.units {
            let Trigger::Told { performative, content, from, .. } = &u.trigger else { continue };
            let sent = told.iter().any(|(to, p, c, _)| *to == a.name && p == performative && c == content);
            if !sent {
                let by = from.as_ref().map_or_else(|| "anybody".to_string(), |f| format!("`{f}`"));
                out.push(
                    Diagnostic::error(
                        code::UNPUBLISHED_TOPIC,
                        format!("nobody tells `{}` {performative} {content}", a.name),
                    )
                    .at(u.span, format!("waits for it from {by}"))
                    .hint(format!(
                        "add `tell {} {performative} {content}(…)` to the agent that knows it",
                        a.name
                    )),
                );
            }
        }
    }
    out
}
