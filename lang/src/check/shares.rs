//! Is what units share shared on one core? The priority ceiling of a resource keeps units of its core apart, and
//! nobody else.

use crate::code;
use soifra_graph::{Diagnostic, Graph, Name, Span};
use std::collections::BTreeMap;

/// Checks the resources of every robot.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    for r in &g.robots {
        let mut first: BTreeMap<&Name, (Option<i64>, Span, &Name)> = BTreeMap::new();
        let agents = r.agents.iter().filter_map(|b| g.agents.get(b.agent as usize));
        for u in agents.flat_map(|a| &a.units) {
            for share in &u.timing.shares {
                let known = first.entry(&share.resource).or_insert((u.timing.core, share.at, &u.name));
                if known.0 == u.timing.core {
                    continue;
                }
                let core = |c: Option<i64>| c.map_or("no core".to_string(), |c| format!("core {c}"));
                let title = format!("`{}` is shared by units of two cores", share.resource);
                let d = Diagnostic::error(code::TIMING, title)
                    .at(share.at, format!("`{}` is on {}", u.name, core(u.timing.core)))
                    .at(known.1, format!("`{}` is on {}", known.2, core(known.0)))
                    .hint("put both on one core, or let one of them own the resource and tell the other");
                if !out.iter().any(|o| o.position() == d.position()) {
                    out.push(d);
                }
            }
        }
    }
    out
}
