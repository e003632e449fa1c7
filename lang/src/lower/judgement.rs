//! How a mission is judged: its end, its time limit, its expectations.

use crate::{
    ast::{self, ExpectKind as E, MissionMember as M},
    code,
    modules::Program,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Diagnostic, Dim, ExpectKind, Expectation, Expr, Goal, Op, Samples, Type, Value, typing};

impl<'a> Checker<'a> {
    /// Makes an agent's states and parameters nameable.
    pub(super) fn enter_agent(&mut self, i: u32) {
        let a = &self.agents[i as usize];
        self.agent = crate::typed::AgentScope {
            name: a.name.clone(),
            params: a.parameters.clone(),
            states: a.states.iter().map(|s| (s.name.clone(), s.ty.clone(), s.span)).collect(),
            sensors: a.sensors.iter().map(|p| (p.name.clone(), p.ty.clone(), p.optional)).collect(),
            ..Default::default()
        };
    }

    /// An expression over the world's truth; `each` when it is about one robot at a time.
    pub(super) fn truth_expr(&mut self, e: &ast::Expr, want: Option<&Type>, each: bool) -> Option<Expr> {
        self.agent = Default::default();
        let mut body = Body::new(Place::Truth);
        body.of_robot = each;
        self.in_body(body, |c| match want {
            Some(t) => c.typed(e, t),
            None => c.expr(e, None),
        })
        .0
    }

    /// When a metric is sampled: upon a change of something that can be compared.
    pub(super) fn samples(&mut self, s: &ast::Samples) -> Option<Samples> {
        let upon = self.truth_expr(&s.upon, None, false);
        let when = s.when.as_ref().map(|w| self.truth_expr(w, Some(&Type::Bool), false));
        let upon = upon?;
        if typing::number(&upon.ty).is_none() && upon.ty != Type::Bool {
            self.report(
                Diagnostic::error(code::MISMATCH, format!("{} changes cannot be told", upon.ty))
                    .at(upon.span, upon.ty.to_string())
                    .hint("name a number or a Bool, such as a count that the agent keeps"),
            );
            return None;
        }
        let when = match when {
            Some(when) => Some(when?),
            None => None,
        };
        Some(Samples { keep: s.keep, upon, when })
    }

    pub(super) fn done(&mut self, m: &'a ast::Mission, goals: &[Goal]) -> Option<Expr> {
        if let Some(e) =
            self.single(m, "done when", |x| if let M::Done(e, s) = x { Some((e, *s)) } else { None })
        {
            return self.truth_expr(e, Some(&Type::Bool), false);
        }
        // Nothing said: done when every goal is achieved that nobody has to ask for.
        let span = m.name.span;
        let needed = (0..).zip(goals).filter(|(_, g)| !g.on_request).map(|(i, _)| i);
        let all = needed.map(|i: u32| Expr::new(Op::Achieved(i), Vec::new(), Type::Bool, span));
        Some(
            all.reduce(|a, b| Expr::new(Op::Binary(soifra_graph::Binary::And), vec![a, b], Type::Bool, span))
                .unwrap_or_else(|| Expr::constant(Value::Bool(false), Type::Bool, span)),
        )
    }

    /// A time limit: a duration or a number of steps.
    pub(super) fn limit(&mut self, e: &ast::Expr) -> Option<Expr> {
        let (value, _) = self.in_body(Body::new(Place::Start), |c| c.expr(e, None));
        let value = value?;
        match value.ty {
            Type::Quantity(Dim::TIME | Dim::STEP) => Some(value),
            _ => {
                self.report(
                    Diagnostic::error(
                        code::MISMATCH,
                        format!("a time limit is wanted, this is {}", value.ty),
                    )
                    .at(value.span, value.ty.to_string())
                    .hint("write a duration such as `180 s`, or `200 steps`"),
                );
                None
            }
        }
    }

    pub(super) fn expectation(&mut self, program: &Program, e: &ast::Expect) -> Option<Expectation> {
        let each = e.each_robot;
        let cond = |c: &mut Self, x: &ast::Expr| c.truth_expr(x, Some(&Type::Bool), each);
        let kind = match &e.kind {
            E::Always(x) => ExpectKind::Always(cond(self, x)?),
            E::Never(x) => ExpectKind::Never(cond(self, x)?),
            E::Finally(x) => ExpectKind::Finally(cond(self, x)?),
            E::Until(a, b) => {
                let (a, b) = (cond(self, a), cond(self, b));
                ExpectKind::Until(a?, b?)
            }
            E::Eventually(x, within) => {
                let x = cond(self, x);
                ExpectKind::Eventually(x?, self.optional_limit(within.as_ref())?)
            }
            E::LeadsTo(a, b, within) => {
                let (a, b) = (cond(self, a), cond(self, b));
                ExpectKind::LeadsTo(a?, b?, self.optional_limit(within.as_ref())?)
            }
        };
        let text: String = program.text(e.span).split_whitespace().collect::<Vec<_>>().join(" ");
        let text = text.strip_prefix("expect ").unwrap_or(&text).to_string();
        Some(Expectation { text, each_robot: each, kind, at: e.span })
    }

    #[allow(
        clippy::option_option,
        reason = "outer: whether it could be lowered, inner: whether it is there; 2026-11"
    )]
    pub(super) fn optional_limit(&mut self, e: Option<&ast::Expr>) -> Option<Option<Expr>> {
        match e {
            Some(e) => Some(Some(self.limit(e)?)),
            None => Some(None),
        }
    }
}
