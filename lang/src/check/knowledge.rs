//! Do behaviours use only what a robot can know, and are draws only where they are reproducible?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Expr, Function, Graph, Op};

/// Where an expression stands, for what it may use.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Start,
    Scene,
    Behaviour,
    Belief,
}

/// Checks every expression outside `done`, `expect` and `metric`.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for a in &g.agents {
        for s in &a.states {
            look(&s.initial, Kind::Start, &mut out);
        }
        for u in &a.units {
            walk::unit(u, &mut |e| one(e, Kind::Behaviour, &mut out));
        }
        for x in &a.arbiters {
            walk::arbiter(x, &mut |e| one(e, Kind::Behaviour, &mut out));
        }
    }
    for s in g.goals.iter().flat_map(|goal| &goal.subgoals) {
        s.achieved.iter().for_each(|e| look(e, Kind::Belief, &mut out));
    }
    let parts = g.world.iter().chain(g.platforms.iter().flat_map(|p| &p.components));
    for (_, e) in parts.flat_map(|c| &c.args) {
        look(e, Kind::Scene, &mut out);
    }
    for (_, e) in g.topics.iter().flat_map(|t| &t.channel.args) {
        look(e, Kind::Start, &mut out);
    }
    for r in &g.robots {
        let scene = [Some(&r.start), r.scatter.as_ref(), r.target.as_ref()];
        scene
            .into_iter()
            .flatten()
            .chain(r.agents.iter().flat_map(|b| &b.arguments))
            .for_each(|e| look(e, Kind::Scene, &mut out));
    }
    out
}

fn look(e: &Expr, kind: Kind, out: &mut Vec<Diagnostic>) {
    e.walk(&mut |e| one(e, kind, out));
}

fn truth(e: &Expr) -> Diagnostic {
    Diagnostic::error(code::TRUTH, "a behaviour cannot know the world's truth")
        .at(e.span, "truth is for `done`, `expect` and `metric`")
        .hint("read a sensor the platform declares, or let others publish what they know on a topic")
}

fn one(e: &Expr, kind: Kind, out: &mut Vec<Diagnostic>) {
    match &e.op {
        Op::Truth(_)
        | Op::Run(_)
        | Op::Believed(..)
        | Op::Executed(..)
        | Op::Achieved(_)
        | Op::Quantified(_)
        | Op::OfRobot(_) => out.push(truth(e)),
        Op::Builtin(f) if f.is_truth() => out.push(truth(e)),
        Op::Builtin(Function::Draw) if matches!(kind, Kind::Start | Kind::Belief) => out.push(
            Diagnostic::error(code::RANDOM, "nothing can be drawn here")
                .at(e.span, "would differ from evaluation to evaluation")
                .hint("draws belong to worlds, robots and behaviours"),
        ),
        Op::Reading(_) | Op::Heard(_) | Op::Offering(_) if kind != Kind::Behaviour => out.push(
            Diagnostic::error(code::BELIEF, "there is nothing to read here")
                .at(e.span, "no robot is running yet, or none is meant")
                .hint("keep what matters in a `state` and name that"),
        ),
        Op::State(_) if matches!(kind, Kind::Start | Kind::Scene) => out.push(
            Diagnostic::error(code::BELIEF, "a state has no value yet")
                .at(e.span, "before the run")
                .hint("use a constant or a parameter"),
        ),
        _ => {}
    }
}
