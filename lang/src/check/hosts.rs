//! Do agents of hosts ask for nothing that only a body has?

use super::walk;
use crate::code;
use soifra_graph::{Agent, Diagnostic, Expr, Graph, Op, Own, Span, StmtKind, Trigger, Unit};

/// Checks every host.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out: Vec<Diagnostic> = Vec::new();
    for r in g.robots.iter().filter(|r| r.host) {
        for a in r.agents.iter().filter_map(|b| g.agents.get(b.agent as usize)) {
            for (at, what) in bodily(g, a) {
                let d = Diagnostic::error(code::NO_PLACE, format!("the host `{}` is nowhere", r.name))
                    .at(at, what)
                    .at(r.at, format!("runs `{}`", a.name))
                    .hint("let a robot run this agent, or let it do without");
                if !out.iter().any(|o| o.position() == d.position()) {
                    out.push(d);
                }
            }
        }
    }
    out
}

/// What an agent asks for that has to do with a body.
fn bodily(g: &Graph, a: &Agent) -> Vec<(Span, &'static str)> {
    let mut out = Vec::new();
    let ranged = |topic: u32| {
        let args = g.topics.get(topic as usize).map(|t| t.channel.args.as_slice()).unwrap_or_default();
        args.iter().any(|(n, e)| &**n == "range" && e.op == Op::MakeSome)
    };
    let radio = "a topic with a range, which is counted from somewhere";
    walk::agent(a, &mut |e: &Expr| match e.op {
        Op::Own(Own::Start | Own::Target | Own::Radius | Own::Height | Own::CruiseSpeed) => {
            out.push((e.span, "asks for what only a body has"));
        }
        Op::Heard(t) if ranged(t) => out.push((e.span, radio)),
        _ => {}
    });
    let heard = |u: &Unit| matches!(u.trigger, Trigger::Message { topic, .. } if ranged(topic));
    out.extend(a.units.iter().filter(|u| heard(u)).map(|u| (u.span, radio)));
    for s in a.units.iter().flat_map(walk::statements) {
        if let StmtKind::Publish(t, _) = s.kind
            && ranged(t)
        {
            out.push((s.at, radio));
        }
    }
    out
}
