//! Visits every expression and statement of behaviour.

use soifra_graph::{
    Agent, Arbiter, Conjunct, ExpectKind, Expr, PlanKind, Stmt, StmtKind, Strategy, Unit, UnitKind,
};

/// Every expression of an agent, parents first.
pub fn agent<'a>(a: &'a Agent, visit: &mut dyn FnMut(&'a Expr)) {
    for s in &a.states {
        s.initial.walk(visit);
    }
    a.offers.iter().filter_map(|o| o.when.as_ref()).for_each(|e| e.walk(visit));
    for u in &a.units {
        unit(u, visit);
    }
    for x in &a.arbiters {
        arbiter(x, visit);
    }
}

/// Every expression of a unit.
pub fn unit<'a>(u: &'a Unit, visit: &mut dyn FnMut(&'a Expr)) {
    for s in statements(u) {
        expressions_of(s, visit);
    }
    match &u.kind {
        UnitKind::Service(_) => {}
        UnitKind::Machine(states) => {
            for t in states.iter().flat_map(|s| &s.transitions) {
                guard(&t.guard, visit);
                t.arguments.iter().for_each(|e| e.walk(visit));
            }
        }
        UnitKind::Plan { nodes, .. } => {
            for n in nodes {
                match &n.kind {
                    PlanKind::Timeout(e)
                    | PlanKind::Check(e)
                    | PlanKind::Wait(e)
                    | PlanKind::WaitUntil(e) => e.walk(visit),
                    PlanKind::Repeat { condition: Some(e), .. } => e.walk(visit),
                    PlanKind::Act { until, fails, .. } => {
                        until.iter().chain(fails).for_each(|e| e.walk(visit))
                    }
                    _ => {}
                }
            }
        }
    }
}

/// Every expression of some statements and of those in them.
pub fn block<'a>(stmts: &'a [Stmt], visit: &mut dyn FnMut(&'a Expr)) {
    let mut list = Vec::new();
    stmts.iter().for_each(|s| nested(s, &mut list));
    list.into_iter().for_each(|s| expressions_of(s, visit));
}

/// Every expression of an arbiter.
pub fn arbiter<'a>(a: &'a Arbiter, visit: &mut dyn FnMut(&'a Expr)) {
    block(&a.prelude, visit);
    match &a.strategy {
        Strategy::Priority(list) | Strategy::Blend(list) => list.iter().for_each(|e| e.walk(visit)),
        Strategy::Layers(layers) => {
            layers.iter().flat_map(|l| l.hold.iter().chain(&l.inhibited)).for_each(|e| e.walk(visit))
        }
        Strategy::Switch => {}
    }
}

/// The conditions and time limits of an expectation.
pub fn conditions(kind: &ExpectKind) -> Vec<&Expr> {
    match kind {
        ExpectKind::Always(a) | ExpectKind::Never(a) | ExpectKind::Finally(a) => vec![a],
        ExpectKind::Eventually(a, b) => std::iter::once(a).chain(b).collect(),
        ExpectKind::Until(a, b) => vec![a, b],
        ExpectKind::LeadsTo(a, b, c) => [a, b].into_iter().chain(c).collect(),
    }
}

fn guard<'a>(g: &'a [Conjunct], visit: &mut dyn FnMut(&'a Expr)) {
    for c in g {
        match c {
            Conjunct::Holds(e) | Conjunct::Binds(_, e) => e.walk(visit),
        }
    }
}

/// Every statement of a unit, outer ones first.
pub fn statements(u: &Unit) -> Vec<&Stmt> {
    let mut out = Vec::new();
    u.prelude.iter().for_each(|s| nested(s, &mut out));
    match &u.kind {
        UnitKind::Service(body) => body.iter().for_each(|s| nested(s, &mut out)),
        UnitKind::Machine(states) => {
            for s in states {
                let blocks =
                    [&s.entry, &s.body, &s.exit].into_iter().chain(s.transitions.iter().map(|t| &t.body));
                blocks.flatten().for_each(|s| nested(s, &mut out));
            }
        }
        UnitKind::Plan { nodes, .. } => {
            for n in nodes {
                if let PlanKind::Act { prelude, body, halt, .. } = &n.kind {
                    prelude.iter().chain(body).chain(halt).for_each(|s| nested(s, &mut out));
                }
            }
        }
    }
    out
}

fn nested<'a>(s: &'a Stmt, out: &mut Vec<&'a Stmt>) {
    out.push(s);
    match &s.kind {
        StmtKind::If(_, a, b) => a.iter().chain(b).for_each(|s| nested(s, out)),
        StmtKind::IfSome { then, otherwise, .. } => then.iter().chain(otherwise).for_each(|s| nested(s, out)),
        StmtKind::Switch { arms, rest, .. } => {
            arms.iter().map(|(_, b)| b).chain(rest).flatten().for_each(|s| nested(s, out))
        }
        StmtKind::Rules(rules) => rules.iter().flat_map(|r| &r.body).for_each(|s| nested(s, out)),
        StmtKind::Each(each) => each.body.iter().for_each(|s| nested(s, out)),
        _ => {}
    }
}

/// The expressions of a statement itself, without those of the statements in it.
fn expressions_of<'a>(s: &'a Stmt, visit: &mut dyn FnMut(&'a Expr)) {
    match &s.kind {
        StmtKind::Let(_, e)
        | StmtKind::Set(_, e)
        | StmtKind::Command(_, e)
        | StmtKind::Publish(_, e)
        | StmtKind::Use(_, e)
        | StmtKind::SetParam(_, e) => e.walk(visit),
        StmtKind::Open(o) => o.content.iter().chain([&o.to]).chain(&o.within).for_each(|e| e.walk(visit)),
        StmtKind::Reply(r) => r.content.iter().chain([&r.thread]).for_each(|e| e.walk(visit)),
        StmtKind::Each(each) => each.list.walk(visit),
        StmtKind::Refine(r) => {
            [&r.first, &r.step, &r.cost].into_iter().chain(&r.until).for_each(|e| e.walk(visit));
        }
        StmtKind::Tell { content, .. } => content.walk(visit),
        StmtKind::Note(_, e) => e.iter().for_each(|e| e.walk(visit)),
        StmtKind::If(e, _, _) => e.walk(visit),
        StmtKind::IfSome { value, .. } | StmtKind::Switch { value, .. } => value.walk(visit),
        StmtKind::Rules(rules) => rules.iter().for_each(|r| guard(&r.guard, visit)),
        StmtKind::Raise(_) | StmtKind::Govern(_) => {}
    }
}
