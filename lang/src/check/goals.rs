//! Has the mission robots, goals, and somebody who pursues them?

use crate::{code, decls::unknown};
use soifra_graph::{Diagnostic, ExpectKind, Graph, Span, UnitKind};

/// Checks the mission's frame.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let here = mission_span(g);
    if g.robots.is_empty() {
        out.push(
            Diagnostic::error(code::NO_ROBOT, format!("mission `{}` has no robot", g.name))
                .at(here, "nobody to carry it out")
                .hint("add `robot NAME: PLATFORM at (x, y) runs AGENT`"),
        );
    }
    if g.goals.is_empty() {
        out.push(
            Diagnostic::error(code::NO_GOAL, format!("mission `{}` has no goal", g.name))
                .at(here, "nothing to achieve")
                .hint("add `goal NAME { subgoal NAME by AGENT achieved when … }`"),
        );
    }
    if g.within.is_none() {
        let d = Diagnostic::error(code::MISSING_MEMBER, format!("mission `{}` has no time limit", g.name))
            .at(here, "may never end");
        let taken = g.expects.iter().find_map(|e| match &e.kind {
            ExpectKind::Eventually(_, Some(limit)) | ExpectKind::LeadsTo(_, _, Some(limit)) => Some(limit),
            _ => None,
        });
        out.push(match taken {
            Some(limit) => d
                .at(limit.span, "this `within` is the one of the expectation before it")
                .hint("write the `within` of the mission before its expectations"),
            None => d.hint("add `within 180 s`, or `within 200 steps`"),
        });
    }
    let used = super::used_agents(g);
    for goal in &g.goals {
        if goal.subgoals.is_empty() {
            out.push(
                Diagnostic::error(code::NO_PLAN, format!("goal `{}` has no sub-goal", goal.name))
                    .at(goal.at, "nothing leads to it")
                    .hint("add `subgoal NAME by AGENT achieved when …`"),
            );
        }
        for s in &goal.subgoals {
            let Some(by) = s.agent else { continue };
            let Some(a) = g.agents.get(by as usize) else { continue };
            if !used.get(by as usize).is_some_and(|u| *u) && !g.robots.is_empty() {
                out.push(
                    Diagnostic::error(
                        code::NO_AGENT,
                        format!("no robot runs `{}`, which pursues `{}`", a.name, s.name),
                    )
                    .at(s.at, "wanted here")
                    .hint(format!("let a robot run it: `robot … runs {}`", a.name)),
                );
            }
            let plan = a
                .units
                .iter()
                .any(|u| matches!(&u.kind, UnitKind::Plan { subgoal: Some(n), .. } if *n == s.name));
            if s.achieved.is_none() && !plan {
                out.push(
                    Diagnostic::error(code::NO_PLAN, format!("nothing tells when `{}` is achieved", s.name))
                        .at(s.at, "neither a condition nor a plan")
                        .at(a.span, format!("has no `plan … for {}`", s.name))
                        .hint("add `achieved when STATE`, or a plan for it to the agent"),
                );
            }
        }
    }
    for (i, a) in g.agents.iter().enumerate() {
        for u in &a.units {
            let UnitKind::Plan { subgoal: Some(n), .. } = &u.kind else { continue };
            let known: Vec<&str> = g
                .goals
                .iter()
                .flat_map(|g| &g.subgoals)
                .filter(|s| s.agent == Some(i as u32))
                .map(|s| &*s.name)
                .collect();
            if used[i] && !known.contains(&&**n) {
                out.push(unknown(code::NO_PLAN, &format!("sub-goal of `{}`", a.name), n, u.span, known));
            }
        }
    }
    for r in &g.robots {
        if r.agents.is_empty() {
            out.push(
                Diagnostic::error(code::NO_AGENT, format!("`{}` runs no agent", r.name))
                    .at(r.at, "nobody drives it")
                    .hint("add `runs AGENT`; for something that only moves along, use a `mover`"),
            );
        }
    }
    out
}

/// Where the mission is declared: its name in the root source, else the start.
fn mission_span(g: &Graph) -> Span {
    let text = g.sources.first().map_or("", |s| s.text.as_str());
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if let Some(rest) = line.trim_start().strip_prefix("mission ") {
            let from =
                at + (line.len() - line.trim_start().len()) + 8 + (rest.len() - rest.trim_start().len());
            if rest.trim_start().starts_with(&*g.name) {
                return Span::new(0, from, from + g.name.len());
            }
        }
        at += line.len();
    }
    Span::default()
}
