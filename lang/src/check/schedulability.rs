//! Is every unit on a core done by its deadline, whatever happens? Exact response times, core by core.

use crate::{
    code,
    schedule::{self, Core, Task},
};
use soifra_graph::{Diagnostic, Graph, Misses};

/// Checks every core of every robot.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    for core in &schedule::timing(g).cores {
        let found = match core.tasks.iter().any(|t| t.period.is_none()) {
            true => unlimited(g, core),
            false => late(core),
        };
        for d in found {
            if !out.contains(&d) {
                out.push(d);
            }
        }
    }
    out.extend(lonely_shares(g));
    out
}

/// Units that may be released as often as something happens.
fn unlimited(g: &Graph, core: &Core) -> Vec<Diagnostic> {
    let wants = core.tasks.iter().any(|t| t.misses == Misses::Hard && t.deadline.is_some());
    let open = core.tasks.iter().filter(|t| wants && t.period.is_none());
    open.map(|t| {
        Diagnostic::error(
            code::UNLIMITED,
            format!(
                "nothing tells how often `{}` may be released on core {} of `{}`",
                t.unit, core.number, core.robot
            ),
        )
        .at(t.span, format!("takes {} of the core each time", time(t.worst + t.budget)))
        .hint(match g.agents.get(t.index.0 as usize).and_then(|a| a.units.get(t.index.1 as usize)) {
            Some(u) if u.timing.at_most_every.is_some() => "make its `at most every` a constant",
            _ => "add `at most every …`: releases that come sooner then wait",
        })
    })
    .collect()
}

/// Units that may be late, with those that make them wait.
fn late(core: &Core) -> Vec<Diagnostic> {
    // Who may miss some pays for those who may miss none.
    let hard = |t: &Task| t.misses == Misses::Hard;
    let used = core.utilization.unwrap_or(0.0);
    if used > 1.0 && core.tasks.iter().any(|t| hard(t) && !t.is_met()) {
        let mut d = Diagnostic::error(
            code::OVERLOAD,
            format!("core {} of `{}` is asked for {used:.4} of its time", core.number, core.robot),
        );
        for t in &core.tasks {
            let every = t.period.map_or_else(String::new, |p| format!(" every {}", time(p)));
            d = d.at(t.span, format!("{}{every}", time(t.worst)));
        }
        return vec![d.hint("make periods longer or work shorter, or put a unit on another core")];
    }
    let mut out = Vec::new();
    for (i, t) in core.tasks.iter().enumerate() {
        if t.is_met() || !hard(t) {
            continue;
        }
        let (Some(deadline), title) = (t.deadline, format!("`{}` can miss its deadline", t.unit)) else {
            continue;
        };
        let response = match t.response {
            Some(r) => format!("done after up to {}, wanted within {}", time(r), time(deadline)),
            None => format!("may never be done, wanted within {}", time(deadline)),
        };
        let mut d = Diagnostic::error(code::LATE, title).at(t.span, response);
        for above in &core.tasks[..i] {
            let every = above.period.map_or_else(String::new, |p| format!(" every {}", time(p)));
            d = d.at(above.span, format!("goes first: {}{every}", time(above.worst + above.budget)));
        }
        let blocked = t.response.is_some_and(|r| r - t.blocking <= deadline);
        if blocked {
            d = d.hint(format!(
                "it waits up to {} for a resource; hold that for a shorter time, or see `soifra check --timing`",
                time(t.blocking)
            ));
        } else {
            d = d.hint(
                "give it a higher priority or a longer deadline, or move work to another `core`; a late result that does no harm is `deadline … soft`",
            );
        }
        out.push(d);
    }
    out
}

/// Resources that a single unit holds: perhaps another one misspells the name.
fn lonely_shares(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let shares: Vec<_> = g.agents.iter().flat_map(|a| &a.units).flat_map(|u| &u.timing.shares).collect();
    for s in &shares {
        if shares.iter().filter(|o| o.resource == s.resource).count() == 1 {
            let names = shares.iter().map(|o| &*o.resource).filter(|n| **n != *s.resource);
            let hint = match soifra_graph::did_you_mean(&s.resource, names) {
                Some(near) => format!("did you mean `{near}`?"),
                None => "leave it out, or let the units share it that use the same thing".into(),
            };
            out.push(
                Diagnostic::warning(code::TIMING, format!("only one unit shares `{}`", s.resource))
                    .at(s.at, "shared with nobody")
                    .hint(hint),
            );
        }
    }
    out
}

/// A time in a unit that suits it.
fn time(ns: i64) -> String {
    let (unit, scale) = match ns.abs() {
        0..1_000_000 => ("us", 1e3),
        1_000_000..10_000_000_000 => ("ms", 1e6),
        _ => ("s", 1e9),
    };
    format!("{} {unit}", ns as f64 / scale)
}
