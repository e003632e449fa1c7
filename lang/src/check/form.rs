//! Has a graph the form that every graph of a source has? A graph file may hold what no source can say.

use crate::code;
use soifra_graph::{Diagnostic, Graph, Name, PlanKind, Span, UnitKind};
use std::collections::BTreeMap;

/// Checks names and counts.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    distinct(g.robots.iter().map(|r| (&r.name, r.at)), &mut out);
    distinct(g.agents.iter().map(|a| (&a.name, a.span)), &mut out);
    for a in &g.agents {
        distinct(a.units.iter().map(|u| (&u.name, u.span)), &mut out);
        for u in &a.units {
            let UnitKind::Plan { nodes, .. } = &u.kind else { continue };
            for n in nodes {
                let times = match &n.kind {
                    PlanKind::Retry(n) => Some(*n),
                    PlanKind::Repeat { times, .. } => *times,
                    _ => None,
                };
                if let Some(k) = times.filter(|k| !(1..=1_000_000).contains(k)) {
                    out.push(
                        Diagnostic::error(code::RANGE, format!("{k} times is not possible"))
                            .at(n.at, "from 1 to 1000000")
                            .hint("to go on for ever write `repeat while true`"),
                    );
                }
            }
        }
    }
    out
}

fn distinct<'g>(names: impl Iterator<Item = (&'g Name, Span)>, out: &mut Vec<Diagnostic>) {
    let mut first: BTreeMap<&Name, Span> = BTreeMap::new();
    for (name, at) in names {
        if let Some(before) = first.insert(name, at) {
            out.push(
                Diagnostic::error(code::DUPLICATE, format!("`{name}` is declared twice"))
                    .at(before, "the first")
                    .at(at, "the second")
                    .hint("give one of them another name"),
            );
        }
    }
}
