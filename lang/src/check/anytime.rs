//! Can anytime work be paid for, and does it know everything before it begins?

use super::{constants::Constants, walk};
use crate::{code, schedule};
use soifra_graph::{Diagnostic, Expr, Graph, Op, Stmt, StmtKind, Unit, UnitKind};

/// The most rounds of one activation.
pub const MOST_ROUNDS: f64 = 100_000.0;

/// Checks every unit with a budget.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut known = Constants::new(g);
    let mut out = Vec::new();
    for u in g.agents.iter().flat_map(|a| &a.units) {
        let Some(budget) = &u.timing.budget else { continue };
        let Some(cost) = schedule::round_cost(&u.kind) else {
            out.push(
                Diagnostic::error(code::ANYTIME, format!("`{}` has a budget and nothing to spend it on", u.name))
                    .at(budget.span, "for what?")
                    .hint("improve a value with `refine x = first by better(x) cost 1 ms`, or declare `worst` instead"),
            );
            continue;
        };
        if let (Some(b), Some(c)) = (known.number(budget, 0), known.number(cost, 0)) {
            let rounds = b / c;
            if rounds < 1.0 || rounds.is_nan() || rounds > MOST_ROUNDS {
                let (what, hint) = match rounds < 1.0 {
                    true => ("does not pay for one round", "a larger budget, or cheaper rounds"),
                    false => (
                        "pays for too many rounds",
                        "at most 100,000 rounds are possible: let a round cost more",
                    ),
                };
                out.push(
                    Diagnostic::error(code::ANYTIME, format!("the budget of `{}` {what}", u.name))
                        .at(budget.span, format!("budget of {b} s"))
                        .at(cost.span, format!("a round costs {c} s"))
                        .hint(hint),
                );
            }
        }
        late_questions(u, &mut out);
    }
    out
}

/// What is asked of sensors and topics when the time is over would be newer than the answer.
fn late_questions(u: &Unit, out: &mut Vec<Diagnostic>) {
    let UnitKind::Service(body) = &u.kind else { return };
    let Some(at) = body.iter().position(|s| matches!(s.kind, StmtKind::Refine(_))) else { return };
    let mut asked: Vec<&Expr> = Vec::new();
    let ask = |e: &Expr| matches!(e.op, Op::Reading(_) | Op::Heard(_));
    let StmtKind::Refine(refine) = &body[at].kind else { return };
    for e in std::iter::once(&refine.step).chain(&refine.until) {
        e.walk(&mut |e| {
            if ask(e) {
                asked.push(e);
            }
        });
    }
    let after: &[Stmt] = &body[at + 1..];
    walk::block(after, &mut |e| {
        if ask(e) {
            asked.push(e);
        }
    });
    for e in asked {
        out.push(
            Diagnostic::error(code::ANYTIME, format!("`{}` asks too late", u.name))
                .at(e.span, "asked when the rounds begin or are over")
                .at(body[at].at, "the answer is to be about what was known before")
                .hint("name it with `let` before `refine`"),
        );
    }
}
