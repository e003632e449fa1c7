//! Plan trees.

use crate::{
    ast::{self, PlanKind as K, StmtKind},
    code,
    typed::Checker,
};
use soifra_graph::{Diagnostic, Dim, PlanKind, PlanNode, Span, Type};

impl<'a> Checker<'a> {
    /// Lowers a tree; parents stand before children, the root first.
    pub fn plan(&mut self, root: &'a ast::PlanNode) -> Vec<PlanNode> {
        let mut nodes = Vec::new();
        self.plan_node(root, &mut nodes, 0);
        nodes
    }

    fn plan_node(&mut self, n: &'a ast::PlanNode, nodes: &mut Vec<PlanNode>, depth: usize) -> Option<u32> {
        if depth > 64 {
            self.report(
                Diagnostic::error(code::NESTING, "a plan nests deeper than 64")
                    .at(n.span, "too deep")
                    .hint("make a plan of the inner part, or an action"),
            );
            return None;
        }
        let (kind, label) = self.plan_kind(n)?;
        self.plan_arity(n, &kind)?;
        let at = nodes.len() as u32;
        nodes.push(PlanNode { kind, children: Vec::new(), label, at: Span { end: n.span.end, ..n.span } });
        let children: Vec<u32> =
            n.children.iter().filter_map(|c| self.plan_node(c, nodes, depth + 1)).collect();
        nodes[at as usize].children = children;
        Some(at)
    }

    fn plan_kind(&mut self, n: &'a ast::PlanNode) -> Option<(PlanKind, String)> {
        let duration = Type::Quantity(Dim::TIME);
        let simple = |kind, label: &str| Some((kind, label.to_string()));
        match &n.kind {
            K::Sequence(reactive) => simple(
                PlanKind::Sequence { memory: !reactive },
                if *reactive { "reactive sequence" } else { "sequence" },
            ),
            K::Fallback(reactive) => simple(
                PlanKind::Fallback { memory: !reactive },
                if *reactive { "reactive fallback" } else { "fallback" },
            ),
            K::Parallel(k) => {
                let count = n.children.len() as i64;
                if let Some(k) = k
                    && (*k < 1 || *k > count)
                {
                    self.report(
                        Diagnostic::error(code::RANGE, format!("{k} of {count} children cannot succeed"))
                            .at(n.span, "this parallel node")
                            .hint(format!("write a number from 1 to {count}, or none for all")),
                    );
                    return None;
                }
                simple(
                    PlanKind::Parallel { successes: k.map(|k| k as u32) },
                    &k.map_or("parallel".into(), |k| format!("parallel {k}")),
                )
            }
            K::Retry(k) => {
                self.times(*k, n.span).and_then(|k| simple(PlanKind::Retry(k), &format!("retry {k}")))
            }
            K::Repeat(k) => self.times(*k, n.span).and_then(|k| {
                simple(PlanKind::Repeat { times: Some(k), condition: None }, &format!("repeat {k}"))
            }),
            K::RepeatWhile(c) => {
                let c = self.typed(c, &Type::Bool)?;
                simple(PlanKind::Repeat { times: None, condition: Some(c) }, "repeat while")
            }
            K::Timeout(d) => {
                let d = self.typed(d, &duration)?;
                simple(PlanKind::Timeout(d), "timeout")
            }
            K::Invert => simple(PlanKind::Invert, "invert"),
            K::Succeed => simple(PlanKind::Succeed, "succeed"),
            K::Check(c) => {
                let c = self.typed(c, &Type::Bool)?;
                simple(PlanKind::Check(c), "check")
            }
            K::Wait(d) => {
                let d = self.typed(d, &duration)?;
                simple(PlanKind::Wait(d), "wait")
            }
            K::WaitUntil(c) => {
                let c = self.typed(c, &Type::Bool)?;
                simple(PlanKind::WaitUntil(c), "wait until")
            }
            K::Stmt(s) => match &s.kind {
                StmtKind::Do(name, args) => {
                    self.plan_action(name, args, s.span).map(|k| (k, name.name.to_string()))
                }
                _ => {
                    let body = self.block(std::slice::from_ref(s), 0);
                    let label = match &s.kind {
                        StmtKind::Command(a, _) => format!("command {}", a.name),
                        StmtKind::Set(a, _) => format!("set {}", a.name),
                        StmtKind::Publish(a, _) => format!("publish {}", a.name),
                        StmtKind::Note(t, _) => format!("note {t}"),
                        _ => "act".into(),
                    };
                    Some((
                        PlanKind::Act {
                            prelude: Vec::new(),
                            body,
                            until: None,
                            fails: None,
                            halt: Vec::new(),
                        },
                        label,
                    ))
                }
            },
        }
    }

    fn times(&mut self, k: i64, at: Span) -> Option<u32> {
        if (1..=1_000_000).contains(&k) {
            return Some(k as u32);
        }
        self.report(
            Diagnostic::error(code::RANGE, format!("{k} times is not possible"))
                .at(at, "from 1 to 1000000")
                .hint("to go on for ever write `repeat while true`"),
        );
        None
    }

    fn plan_arity(&mut self, n: &ast::PlanNode, kind: &PlanKind) -> Option<()> {
        let one = matches!(
            kind,
            PlanKind::Retry(_)
                | PlanKind::Timeout(_)
                | PlanKind::Repeat { .. }
                | PlanKind::Invert
                | PlanKind::Succeed
        );
        if one && n.children.len() != 1 {
            let second = n.children.get(1).map_or(n.span, |c| c.span);
            self.report(
                Diagnostic::error(code::ARGUMENTS, "this node has exactly one child")
                    .at(second, "a second one")
                    .hint("put the children into a `sequence`"),
            );
            return None;
        }
        Some(())
    }

    fn plan_action(&mut self, name: &ast::Ident, args: &'a [ast::Arg], span: Span) -> Option<PlanKind> {
        let action = self.find_action(name)?;
        self.enter_action(name, span)?;
        let bound = self.bind_action(action, name, args, span);
        let kind = bound.and_then(|(prelude, scope)| {
            let outer = std::mem::replace(&mut self.body.scope, scope);
            let until = action.until.as_ref().map(|c| self.typed(c, &Type::Bool));
            let fails = action.fails.as_ref().map(|c| self.typed(c, &Type::Bool));
            let body = self.block(&action.body, 0);
            let halt = self.block(&action.halt, 0);
            self.body.scope = outer;
            let until = match until {
                Some(c) => Some(c?),
                None => None,
            };
            let fails = match fails {
                Some(c) => Some(c?),
                None => None,
            };
            Some(PlanKind::Act { prelude, body, until, fails, halt })
        });
        self.expanding.pop();
        kind
    }
}
