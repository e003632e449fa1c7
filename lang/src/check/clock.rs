//! Is there a step clock where something counts in steps?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Dim, ExpectKind, Graph, Op, Span, Trigger, Type};

/// Checks that what needs a step clock has one.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    if g.step.is_some() {
        return Vec::new();
    }
    let mut found: Vec<(Span, String)> = Vec::new();
    let used = super::used_agents(g);
    for (a, _) in g.agents.iter().zip(&used).filter(|(_, u)| **u) {
        for u in &a.units {
            if let Trigger::Step { .. } = u.trigger {
                found.push((u.span, format!("`{}` runs every step", u.name)));
            }
        }
        walk::agent(a, &mut |e| {
            if e.op == Op::StepCount {
                found.push((e.span, "counts steps".into()));
            }
        });
    }
    for r in &g.robots {
        let Some(p) = g.platforms.get(r.platform as usize) else { continue };
        for s in p.of_role("sensor") {
            let by_step = s.args.iter().any(|(n, e)| {
                &**n == "period" && matches!(e.ty, Type::Option(_)) && !matches!(e.op, Op::MakeSome)
            });
            let consumed = r
                .agents
                .iter()
                .filter_map(|b| g.agents.get(b.agent as usize))
                .any(|a| a.sensors.iter().any(|q| q.name == s.name));
            if by_step && consumed {
                found.push((r.at, format!("sensor `{}` of `{}` is read once a step", s.name, p.name)));
            }
        }
    }
    let limits = g.expects.iter().filter_map(|e| match &e.kind {
        ExpectKind::Eventually(_, w) | ExpectKind::LeadsTo(_, _, w) => w.as_ref(),
        _ => None,
    });
    for w in g.within.iter().chain(limits) {
        if w.ty == Type::Quantity(Dim::STEP) {
            found.push((w.span, "a number of steps".into()));
        }
    }
    // One clock is missing, however many things wait for it.
    found.sort();
    found.dedup();
    let Some(((at, why), more)) = found.split_first() else { return Vec::new() };
    let d = Diagnostic::error(code::NO_STEP_CLOCK, "this needs a step clock").at(*at, why.clone());
    let d = more.iter().take(3).fold(d, |d, (at, why)| d.at(*at, why.clone()));
    vec![d.hint("add `clock step 1 s` to the mission")]
}
