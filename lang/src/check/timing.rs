//! Does declared timing agree with itself? (Schedulability is a question of its own.)

use crate::code;
use soifra_graph::{Diagnostic, Expr, Graph, Trigger};

/// Checks the timing clauses of every unit, where they are constants.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for u in g.agents.iter().flat_map(|a| &a.units) {
        let period = match &u.trigger {
            Trigger::Every { period, .. } => Some(period),
            Trigger::Step { .. } => g.step.as_ref(),
            _ => u.timing.at_most_every.as_ref(),
        };
        let offset = match &u.trigger {
            Trigger::Every { offset, .. } | Trigger::Step { offset } => offset.as_ref(),
            _ => None,
        };
        let mut longer =
            |what: &str, a: Option<&Expr>, than: &str, b: Option<&Expr>, hint: &str, equal_too: bool| {
                let (Some(a), Some(b)) = (a, b) else { return };
                let (Some(x), Some(y)) = (seconds(a), seconds(b)) else { return };
                if x > y || (equal_too && x == y) {
                    out.push(
                        Diagnostic::error(
                            code::TIMING,
                            format!("the {what} of `{}` is not within its {than}", u.name),
                        )
                        .at(a.span, format!("{what} of {x} s"))
                        .at(b.span, format!("{than} of {y} s"))
                        .hint(hint),
                    );
                }
            };
        let t = &u.timing;
        longer(
            "worst case",
            t.worst_case.as_ref(),
            "deadline",
            t.deadline.as_ref(),
            "it can never be on time: give it longer, or do less",
            false,
        );
        longer(
            "worst case",
            t.worst_case.as_ref(),
            "period",
            period,
            "it would still run at its next release: a longer period, or less to do",
            false,
        );
        longer(
            "budget",
            t.budget.as_ref(),
            "deadline",
            t.deadline.as_ref(),
            "end the budget before the deadline",
            false,
        );
        longer("offset", offset, "period", period, "an offset is shorter than the period", true);
    }
    out
}

fn seconds(e: &Expr) -> Option<f64> {
    e.as_const().and_then(soifra_graph::Value::number)
}
