//! Does declared timing agree with itself? (Schedulability is a question of its own.)

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Expr, Graph, Op, StmtKind, Trigger, Unit};

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
        if t.budget.is_some() {
            let hint = "end it before the next release: a shorter deadline";
            longer("deadline", t.deadline.as_ref(), "period", period, hint, false);
        }
        longer("offset", offset, "period", period, "an offset is shorter than the period", true);
        clauses(u, &mut out);
    }
    out.extend(expired_commands(g));
    out
}

/// Clauses that mean nothing without another one.
fn clauses(u: &Unit, out: &mut Vec<Diagnostic>) {
    let t = &u.timing;
    if let (Some(jitter), false) = (&t.jitter, is_periodic(u)) {
        out.push(
            Diagnostic::error(code::TIMING, format!("`{}` has jitter and no period", u.name))
                .at(jitter.span, "later than what?")
                .hint("jitter is for units that are released `every …`"),
        );
    }
    if let (Some(takes), None) = (&t.takes, &t.worst_case) {
        out.push(
            Diagnostic::error(code::TIMING, format!("nothing tells how long `{}` takes at most", u.name))
                .at(takes.span, "a distribution of the execution time")
                .hint("declare its end as well: `worst …`"),
        );
    }
    if let Some(first) = t.shares.first()
        && let Some(worst) = t.worst_case.as_ref().map_or(Some(0.0), seconds)
    {
        let held: Option<f64> = t.shares.iter().map(|s| seconds(&s.time)).sum();
        if let Some(held) = held.filter(|h| *h > worst) {
            let mut d = Diagnostic::error(
                code::TIMING,
                format!("`{}` holds what it shares longer than it runs", u.name),
            )
            .at(first.at, format!("held for {held} s"));
            if let Some(w) = &t.worst_case {
                d = d.at(w.span, format!("runs for {worst} s at most"));
            }
            out.push(d.hint("hold it for a shorter time, or declare a longer `worst`"));
        }
    }
}

/// Warns of commands that expire before their only giver can renew them: the robot would move by jerks, each
/// ended by its safe action.
fn expired_commands(g: &Graph) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    for r in &g.robots {
        let Some(platform) = g.platforms.get(r.platform as usize) else { continue };
        for a in r.agents.iter().filter_map(|b| g.agents.get(b.agent as usize)) {
            for (i, port) in a.actuators.iter().enumerate() {
                let lifetime = platform
                    .of_role("actuator")
                    .find(|c| c.name == port.name)
                    .and_then(|c| c.args.iter().find(|(n, _)| &**n == "lifetime"))
                    .map(|(_, e)| if e.op == Op::MakeSome { &e.args[0] } else { e });
                let commands = |u: &Unit| {
                    walk::statements(u)
                        .into_iter()
                        .any(|s| matches!(s.kind, StmtKind::Command(n, _) if n as usize == i))
                };
                let mut givers = a.units.iter().filter(|u| commands(u));
                let (Some(lifetime), Some(unit), None) = (lifetime, givers.next(), givers.next()) else {
                    continue;
                };
                let Trigger::Every { period, .. } = &unit.trigger else { continue };
                let (Some(lives), Some(waits)) = (seconds(lifetime), seconds(period)) else { continue };
                if lives < waits && !out.iter().any(|d| d.labels[0].span == period.span) {
                    out.push(
                        Diagnostic::warning(
                            code::TIMING,
                            format!("commands of `{}` expire before `{}` renews them", port.name, unit.name),
                        )
                        .at(period.span, format!("every {waits} s"))
                        .at(lifetime.span, format!("a command lives for {lives} s"))
                        .hint("a shorter period, or a longer `lifetime` of the actuator"),
                    );
                }
            }
        }
    }
    out
}

fn is_periodic(u: &Unit) -> bool {
    matches!(u.trigger, Trigger::Every { .. } | Trigger::Step { .. })
}

fn seconds(e: &Expr) -> Option<f64> {
    e.as_const().and_then(soifra_graph::Value::number)
}
