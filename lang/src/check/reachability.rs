//! Can every state, transition, rule and plan node be reached?

use super::walk;
use crate::code;
use soifra_graph::{
    Conjunct, Diagnostic, Expr, Graph, MachineState, Name, PlanKind, PlanNode, StmtKind, UnitKind, Value,
};

/// Checks every unit.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for u in g.agents.iter().flat_map(|a| &a.units) {
        match &u.kind {
            UnitKind::Machine(states) => machine(&u.name, states, &mut out),
            UnitKind::Plan { nodes, .. } => plan(nodes, &mut out),
            UnitKind::Service(_) => {}
        }
        for s in walk::statements(u) {
            let StmtKind::Rules(rules) = &s.kind else { continue };
            let always = rules.iter().position(|r| holds(&r.guard) == Some(true));
            for r in rules.iter().skip(always.map_or(rules.len(), |i| i + 1)) {
                out.push(
                    Diagnostic::error(code::UNREACHABLE_RULE, "this rule can never fire")
                        .at(r.at, "a rule before it always fires")
                        .hint("put it before that rule, or remove it"),
                );
            }
            for r in rules.iter().filter(|r| holds(&r.guard) == Some(false)) {
                out.push(
                    Diagnostic::error(code::UNREACHABLE_RULE, "this rule can never fire")
                        .at(r.at, "never true")
                        .hint("change the guard, or remove the rule"),
                );
            }
        }
    }
    out
}

/// What a guard always is, if it is constant.
fn holds(guard: &[Conjunct]) -> Option<bool> {
    let mut all = Some(true);
    for c in guard {
        match c {
            Conjunct::Holds(e) => match truth(e) {
                Some(false) => return Some(false),
                Some(true) => {}
                None => all = None,
            },
            Conjunct::Binds(..) => all = None,
        }
    }
    all
}

fn truth(e: &Expr) -> Option<bool> {
    match e.as_const() {
        Some(Value::Bool(b)) => Some(*b),
        _ => None,
    }
}

fn machine(name: &Name, states: &[MachineState], out: &mut Vec<Diagnostic>) {
    let mut reached = vec![false; states.len()];
    let mut open = vec![0usize];
    while let Some(i) = open.pop() {
        let Some(s) = states.get(i) else { continue };
        if std::mem::replace(&mut reached[i], true) {
            continue;
        }
        for t in &s.transitions {
            match holds(&t.guard) {
                Some(false) => {}
                Some(true) => {
                    open.push(t.target as usize);
                    break;
                }
                None => open.push(t.target as usize),
            }
        }
    }
    for (s, _) in states.iter().zip(&reached).filter(|(_, r)| !**r) {
        out.push(
            Diagnostic::error(
                code::UNREACHABLE_STATE,
                format!("state `{}` of `{name}` cannot be reached", s.name),
            )
            .at(s.at, "no transition leads here")
            .hint(format!("add `when … -> {}` to a state that can be reached, or remove it", s.name)),
        );
    }
    for s in states {
        if let Some(i) = s.transitions.iter().position(|t| holds(&t.guard) == Some(true)) {
            for t in &s.transitions[i + 1..] {
                out.push(
                    Diagnostic::error(code::UNREACHABLE_STATE, "this transition is never taken")
                        .at(t.at, "one before it is always taken")
                        .hint("put it first, or remove it"),
                );
            }
        }
    }
}

/// What a node can ever answer, besides running: success, failure.
#[derive(Clone, Copy)]
struct Can {
    succeed: bool,
    fail: bool,
}

fn plan(nodes: &[PlanNode], out: &mut Vec<Diagnostic>) {
    answer(nodes, 0, out);
}

fn answer(nodes: &[PlanNode], at: usize, out: &mut Vec<Diagnostic>) -> Can {
    let Some(n) = nodes.get(at) else { return Can { succeed: true, fail: true } };
    let children: Vec<Can> = n
        .children
        .iter()
        .map(|c| {
            if *c as usize > at { answer(nodes, *c as usize, out) } else { Can { succeed: true, fail: true } }
        })
        .collect();
    let first = children.first().copied().unwrap_or(Can { succeed: true, fail: true });
    let mut dead = |why: &str, from: usize| {
        if let Some(c) = n.children.get(from).and_then(|c| nodes.get(*c as usize)) {
            out.push(
                Diagnostic::error(code::UNREACHABLE_NODE, "this node can never be ticked")
                    .at(c.at, why.to_string())
                    .hint("put it before the node that never lets it come to this, or remove it"),
            );
        }
    };
    match &n.kind {
        PlanKind::Sequence { .. } => {
            if let Some(i) = children.iter().position(|c| !c.succeed) {
                dead("the one before it never succeeds", i + 1);
            }
            Can { succeed: children.iter().all(|c| c.succeed), fail: children.iter().any(|c| c.fail) }
        }
        PlanKind::Fallback { .. } => {
            if let Some(i) = children.iter().position(|c| !c.fail) {
                dead("the one before it never fails", i + 1);
            }
            Can { succeed: children.iter().any(|c| c.succeed), fail: children.iter().all(|c| c.fail) }
        }
        PlanKind::Parallel { .. } => {
            Can { succeed: children.iter().any(|c| c.succeed), fail: children.iter().any(|c| c.fail) }
        }
        PlanKind::Retry(_) => first,
        PlanKind::Timeout(_) => Can { succeed: first.succeed, fail: true },
        PlanKind::Repeat { times: Some(_), .. } => first,
        PlanKind::Repeat { condition, .. } => {
            Can { succeed: condition.as_ref().and_then(truth) != Some(true), fail: first.fail }
        }
        PlanKind::Invert => Can { succeed: first.fail, fail: first.succeed },
        PlanKind::Succeed => Can { succeed: first.succeed || first.fail, fail: false },
        PlanKind::Check(e) => Can { succeed: truth(e) != Some(false), fail: truth(e) != Some(true) },
        PlanKind::Wait(_) => Can { succeed: true, fail: false },
        PlanKind::WaitUntil(e) => Can { succeed: truth(e) != Some(false), fail: false },
        PlanKind::Act { until, fails, .. } => Can {
            succeed: until.as_ref().and_then(truth) != Some(false),
            fail: fails.as_ref().is_some_and(|f| truth(f) != Some(false)),
        },
    }
}
