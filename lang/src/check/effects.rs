//! Does every unit do anything that somebody could notice?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Graph, StmtKind, UnitKind};

/// Checks every unit.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for u in g.agents.iter().flat_map(|a| &a.units) {
        let pursues = matches!(&u.kind, UnitKind::Plan { subgoal: Some(_), .. });
        let acts = walk::statements(u).into_iter().any(|s| {
            !matches!(
                s.kind,
                StmtKind::Let(..)
                    | StmtKind::Refine(_)
                    | StmtKind::Use(..)
                    | StmtKind::Each(_)
                    | StmtKind::If(..)
                    | StmtKind::IfSome { .. }
                    | StmtKind::Switch { .. }
                    | StmtKind::Rules(_)
            )
        });
        if !pursues && !acts {
            out.push(
                Diagnostic::warning(code::NO_EFFECT, format!("`{}` has no effect", u.name))
                    .at(u.span, "commands, sets, sends and notes nothing")
                    .hint("let it do something with what it works out, or remove it"),
            );
        }
    }
    out
}
