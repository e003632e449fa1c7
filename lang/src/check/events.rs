//! Is every event raised by somebody and awaited by somebody?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Graph, StmtKind, Trigger};

/// Checks the events of every agent.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for a in &g.agents {
        for (i, name) in a.events.iter().enumerate() {
            let raised = a
                .units
                .iter()
                .flat_map(walk::statements)
                .find_map(|s| matches!(s.kind, StmtKind::Raise(e) if e as usize == i).then_some(s.at));
            let awaited = a.units.iter().find(|u| u.trigger == Trigger::Event(i as u32)).map(|u| u.span);
            match (raised, awaited) {
                (Some(at), None) => out.push(
                    Diagnostic::error(code::UNRAISED_EVENT, format!("nobody waits for event `{name}`"))
                        .at(at, "raised here")
                        .hint(format!("add a unit `on event {name}`, or do not raise it")),
                ),
                (None, Some(at)) => out.push(
                    Diagnostic::error(code::UNRAISED_EVENT, format!("nobody raises event `{name}`"))
                        .at(at, "waits for it")
                        .hint(format!("add `raise {name}` where it happens")),
                ),
                (None, None) => out.push(
                    Diagnostic::warning(
                        code::UNRAISED_EVENT,
                        format!("event `{name}` is neither raised nor awaited"),
                    )
                    .at(a.span, "in this agent")
                    .hint("remove it"),
                ),
                _ => {}
            }
        }
    }
    out
}
