//! Is everything that is asked of a robot known of it?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Expr, Graph, Op, RobotGroup};

/// Checks `done`, expectations and metrics: a state of an agent is asked of robots that run the agent.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    whole(g, &g.done, &mut out);
    g.metrics.iter().flat_map(|m| m.exprs()).for_each(|e| whole(g, e, &mut out));
    for x in &g.expects {
        for e in walk::conditions(&x.kind) {
            if x.each_robot { asked_of_all(g, e, &mut out) } else { whole(g, e, &mut out) }
        }
    }
    out
}

/// An expression about the mission as a whole.
fn whole(g: &Graph, e: &Expr, out: &mut Vec<Diagnostic>) {
    e.walk(&mut |e| {
        if let Op::Quantified(_) = e.op {
            e.args.iter().for_each(|a| asked_of_all(g, a, out));
        }
    });
}

fn asked_of_all(g: &Graph, e: &Expr, out: &mut Vec<Diagnostic>) {
    e.walk(&mut |e| {
        let (Op::Believed(agent, _) | Op::Executed(agent, _, _)) = e.op else { return };
        let Some(a) = g.agents.get(agent as usize) else { return };
        let lacks = |r: &&RobotGroup| r.agents.iter().all(|b| b.agent != agent);
        if let Some(r) = g.bodies().find(lacks) {
            out.push(
                Diagnostic::error(code::NO_AGENT, format!("not every robot runs `{}`", a.name))
                    .at(e.span, "asked of every robot")
                    .at(r.at, "runs other agents")
                    .hint(format!(
                        "name the robot that is meant, or let `{}` run an agent that answers",
                        r.name
                    )),
            );
        }
    });
}
