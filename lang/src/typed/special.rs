//! Calls that are no functions: what is heard, what is achieved, and forms with rules of their own.

use super::{Checker, Place, arguments::Given};
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{Diagnostic, Expr as GExpr, Op, Span, Type, Value, typing};

/// The most agents that the directory names for a service.
const OFFERERS: u32 = 64;

impl Checker<'_> {
    pub(super) fn heard(&mut self, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let topic = match given.as_slice() {
            [Given::Written(Arg { name: None, lambda: None, value })] => match &*value.kind {
                ExprKind::Name(n) => Some((n.clone(), value.span)),
                _ => None,
            },
            _ => None,
        };
        let Some((name, at)) = topic else {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "`heard` takes a topic")
                    .at(span, "here")
                    .hint("write `heard(TOPIC)`"),
            );
            return None;
        };
        let Some(i) = self.topics.position(&name) else {
            let names: Vec<String> = self.topics.iter().map(|t| t.channel.name.to_string()).collect();
            let d = unknown(code::UNKNOWN_NAME, "topic", &name, at, names.iter().map(String::as_str));
            self.report(d);
            return None;
        };
        if self.body.place != Place::Behaviour {
            self.report(
                Diagnostic::error(code::BELIEF, "only a behaviour hears messages")
                    .at(span, "nobody listens here")
                    .hint("use it in a service, machine, plan or agent-level `let`"),
            );
            return None;
        }
        let ty = Type::List(Box::new(self.topics[i].ty.clone()), self.topic_capacity[i]);
        Some(GExpr::new(Op::Heard(i as u32), Vec::new(), ty, span))
    }

    /// `offering(SERVICE)`: the agents that offer it.
    pub(super) fn offering(&mut self, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let [Given::Written(Arg { name: None, lambda: None, value })] = given.as_slice() else {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "`offering` takes a service")
                    .at(span, "here")
                    .hint("write `offering(SERVICE)`, with the name that agents offer"),
            );
            return None;
        };
        let name = match &*value.kind {
            ExprKind::Name(n) => n.clone(),
            _ => "?".into(),
        };
        let offers = |m: &AgentMember| matches!(m, AgentMember::Offers(n, _) if n.name == name);
        if !self.decls.agents.iter().any(|a| a.members.iter().any(offers)) {
            let names: Vec<String> = self
                .decls
                .agents
                .iter()
                .flat_map(|a| &a.members)
                .filter_map(
                    |m| if let AgentMember::Offers(n, _) = m { Some(n.name.to_string()) } else { None },
                )
                .collect();
            let mut d = unknown(code::NOBODY, "service", &name, value.span, names.iter().map(String::as_str));
            d.title = format!("nobody offers `{name}`");
            if names.is_empty() {
                d.hint = Some(format!("add `offers {name}` to the agent that does it"));
            }
            self.report(d);
            return None;
        }
        if self.body.place != Place::Behaviour {
            self.report(
                Diagnostic::error(code::BELIEF, "only a behaviour asks the directory")
                    .at(span, "nobody asks here")
                    .hint("use it in a service, machine, plan or agent-level `let`"),
            );
            return None;
        }
        let ty = Type::List(Box::new(Type::Agent), OFFERERS);
        Some(GExpr::new(Op::Offering(name), Vec::new(), ty, span))
    }

    pub(super) fn achieved(&mut self, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let [Given::Written(Arg { name: None, lambda: None, value })] = given.as_slice() else {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "`achieved` takes a goal")
                    .at(span, "here")
                    .hint("write `achieved(GOAL)`"),
            );
            return None;
        };
        let name = match &*value.kind {
            ExprKind::Name(n) => n.clone(),
            _ => "?".into(),
        };
        if self.body.place != Place::Truth {
            self.report(
                Diagnostic::error(code::BELIEF, "only the mission judges goals")
                    .at(span, "an agent knows its own states")
                    .hint("keep what the agent knows in a `state`"),
            );
            return None;
        }
        let Some(i) = self.goals.position(&name) else {
            let names = self.goals.to_vec();
            let d = unknown(code::UNKNOWN_NAME, "goal", &name, value.span, names.iter().map(|n| &**n));
            self.report(d);
            return None;
        };
        Some(GExpr::new(Op::Achieved(i as u32), Vec::new(), Type::Bool, span))
    }

    pub(super) fn special(&mut self, f: &Ident, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let mut args = Vec::new();
        for g in given {
            args.push(self.value(g, None)?);
        }
        let matrix = |t: &Type| match t {
            Type::Matrix(r, c) => Some((*r, *c)),
            _ => None,
        };
        let (op, ty, form) = match (&*f.name, args.as_slice()) {
            ("sqrt", [x]) => {
                (Op::Sqrt, typing::sqrt(&x.ty), "`sqrt(x)`: the dimension of x must be a square, such as m2")
            }
            ("dot", [a, b]) => (Op::Dot, typing::dot(&a.ty, &b.ty), "`dot(a, b)`: two vectors of one frame"),
            ("transpose", [m]) => {
                (Op::Transpose, matrix(&m.ty).map(|(r, c)| Type::Matrix(c, r)), "`transpose(m)`: a matrix")
            }
            ("inverse", [m]) => (
                Op::Inverse,
                matrix(&m.ty).filter(|(r, c)| r == c).map(|(r, c)| Type::Matrix(r, c).optional()),
                "`inverse(m)`: a square matrix",
            ),
            ("item", [m, r, c]) => {
                let index = |e: &GExpr, n: u8| match e.as_const() {
                    Some(Value::Int(i)) if (0..i64::from(n)).contains(i) => Some(*i as u8),
                    _ => None,
                };
                let at =
                    matrix(&m.ty).and_then(|(rows, columns)| Some((index(r, rows)?, index(c, columns)?)));
                match at {
                    Some((r, c)) => {
                        let m = args.swap_remove(0);
                        return Some(GExpr::new(Op::Item(r, c), vec![m], Type::NUMBER, span));
                    }
                    None => (
                        Op::Transpose,
                        None,
                        "`item(m, row, column)`: a matrix and two constants, counted from 0",
                    ),
                }
            }
            ("matrix", [rows]) if matches!(rows.op, Op::MakeList) => {
                let width = rows.args.first().map_or(0, |r| r.args.len());
                let square = rows.args.iter().all(|r| r.op == Op::MakeList && r.args.len() == width);
                let (r, c) = (rows.args.len(), width);
                if square && (1..=8).contains(&r) && (1..=8).contains(&c) {
                    let mut items = Vec::new();
                    for row in args.swap_remove(0).args {
                        for e in row.args {
                            items.push(self.coerce(e, &Type::NUMBER)?);
                        }
                    }
                    return Some(GExpr::new(Op::MakeMatrix, items, Type::Matrix(r as u8, c as u8), span));
                }
                (Op::Transpose, None, "`matrix([[a, b], [c, d]])`: rows of equal length, at most 8 × 8")
            }
            (name, _) => {
                let form = match name {
                    "sqrt" => "sqrt(x)",
                    "dot" => "dot(a, b)",
                    "item" => "item(m, row, column)",
                    "matrix" => "matrix([[a, b], [c, d]])",
                    other => &format!("{other}(m)"),
                };
                self.report(
                    Diagnostic::error(code::ARGUMENTS, format!("wrong arguments for `{name}`"))
                        .at(span, "in this call")
                        .hint(format!("write `{form}`")),
                );
                return None;
            }
        };
        match ty {
            Some(ty) => Some(GExpr::new(op, args, ty, span)),
            None => {
                let mut d = Diagnostic::error(code::OPERANDS, format!("`{}` does not work on this", f.name));
                for a in &args {
                    d = d.at(a.span, a.ty.to_string());
                }
                self.report(d.hint(format!("write {form}")));
                None
            }
        }
    }
}
