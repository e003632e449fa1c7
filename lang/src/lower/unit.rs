//! Units: triggers, timing, and what they do.

use crate::{
    ast::{self, TriggerKind},
    check::wrong_period,
    code,
    decls::unknown,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Diagnostic, Name, Share, State, Timing, Trigger, Type, Unit, UnitKind};

impl<'a> Checker<'a> {
    /// Lowers a unit of the current agent; machine data become states of it.
    pub fn unit(&mut self, u: &'a ast::Unit, states: &mut Vec<State>) -> Option<Unit> {
        let mut body = Body::new(Place::Behaviour);
        let trigger = self.trigger(&u.name, &u.trigger, &mut body);
        let timing = self.timing(&u.timing, trigger.as_ref());
        body.refines = matches!(u.kind, ast::UnitKind::Service(_)) && timing.budget.is_some();
        let (kind, body) = self.in_body(body, |c| match &u.kind {
            ast::UnitKind::Service(stmts) => Some(UnitKind::Service(c.block(stmts, 0))),
            ast::UnitKind::Machine(list) => c.machine(&u.name, list, states),
            ast::UnitKind::Plan(subgoal, root) => {
                let nodes = c.plan(root);
                Some(UnitKind::Plan { nodes, subgoal: subgoal.as_ref().map(|s| s.name.clone()) })
            }
        });
        Some(Unit {
            name: u.name.name.clone(),
            trigger: trigger?,
            timing,
            locals: body.locals,
            prelude: body.prelude,
            kind: kind?,
            span: u.name.span,
        })
    }

    fn trigger(&mut self, unit: &ast::Ident, t: &ast::Trigger, body: &mut Body) -> Option<Trigger> {
        Some(match &t.kind {
            TriggerKind::Step(offset) => Trigger::Step { offset: self.offset(offset)? },
            TriggerKind::Every(period, offset) => {
                let period = self.start_duration(period)?;
                let what = format!("the period of `{}`", unit.name);
                if let Some(d) = period.as_const().and_then(|v| wrong_period(v, period.span, &what)) {
                    self.report(d);
                    return None;
                }
                Trigger::Every { period, offset: self.offset(offset)? }
            }
            TriggerKind::Event(e) => match self.agent.events.iter().position(|n| *n == e.name) {
                Some(i) => Trigger::Event(i as u32),
                None => {
                    let names = self.agent.events.clone();
                    return self.unknown_trigger("event", e, &names);
                }
            },
            TriggerKind::Sensor(s) => match self.agent.sensors.iter().position(|(n, _, _)| *n == s.name) {
                Some(i) => Trigger::Reading(i as u32),
                None => {
                    let names: Vec<Name> = self.agent.sensors.iter().map(|(n, _, _)| n.clone()).collect();
                    return self.unknown_trigger("sensor", s, &names);
                }
            },
            TriggerKind::Topic(topic, name) => match self.topics.position(&topic.name) {
                Some(i) => {
                    let ty = self.topics[i].ty.clone();
                    Trigger::Message { topic: i as u32, local: body.bind(name, &ty) }
                }
                None => {
                    let names: Vec<Name> = self.topics.iter().map(|t| t.channel.name.clone()).collect();
                    return self.unknown_trigger("topic", topic, &names);
                }
            },
            TriggerKind::Told(performative, content, name, from) => {
                self.performative(performative)?;
                if !self.types.records.contains_key(&content.name) {
                    let names: Vec<Name> = self.types.records.keys().cloned().collect();
                    return self.unknown_trigger("record", content, &names);
                }
                if let Some(f) = from
                    && !self.decls.agents.iter().any(|a| a.name.name == f.name)
                {
                    let names: Vec<Name> = self.decls.agents.iter().map(|a| a.name.name.clone()).collect();
                    return self.unknown_trigger("agent", f, &names);
                }
                let local = body.bind(name, &Type::Record(content.name.clone()));
                Trigger::Told {
                    performative: performative.name.clone(),
                    content: content.name.clone(),
                    from: from.as_ref().map(|f| f.name.clone()),
                    local,
                }
            }
        })
    }

    fn unknown_trigger<T>(&mut self, what: &str, name: &ast::Ident, known: &[Name]) -> Option<T> {
        let d = unknown(code::UNKNOWN_NAME, what, &name.name, name.span, known.iter().map(|n| &**n));
        self.report(d);
        None
    }

    #[allow(
        clippy::option_option,
        reason = "outer: whether it could be lowered, inner: whether it is there; 2026-11"
    )]
    fn offset(&mut self, offset: &Option<ast::Expr>) -> Option<Option<soifra_graph::Expr>> {
        match offset {
            Some(o) => Some(Some(self.start_duration(o)?)),
            None => Some(None),
        }
    }

    fn timing(&mut self, clauses: &[ast::Timing], trigger: Option<&Trigger>) -> Timing {
        let mut t = Timing::default();
        for c in clauses {
            match c {
                ast::Timing::Deadline(e, misses) => {
                    (t.deadline, t.misses) = (self.start_duration(e), *misses);
                }
                ast::Timing::Worst(e) => t.worst_case = self.start_duration(e),
                ast::Timing::Takes(e) => {
                    let ty = Type::Distribution(soifra_graph::Dim::TIME);
                    t.takes = self.in_body(Body::new(Place::Start), |c| c.typed(e, &ty)).0;
                }
                ast::Timing::Jitter(e) => t.jitter = self.start_duration(e),
                ast::Timing::Shares(resource, e) => {
                    if let Some(time) = self.start_duration(e) {
                        t.shares.push(Share { resource: resource.name.clone(), time, at: resource.span });
                    }
                }
                ast::Timing::Budget(e) => t.budget = self.start_duration(e),
                ast::Timing::AtMostEvery(e) => {
                    if matches!(trigger, Some(Trigger::Every { .. } | Trigger::Step { .. })) {
                        self.report(
                            Diagnostic::error(code::TIMING, "a periodic unit has its period")
                                .at(e.span, "says it a second time")
                                .hint("leave out `at most every`; it is for units that wait for something"),
                        );
                    }
                    t.at_most_every = self.start_duration(e);
                }
                ast::Timing::Priority(n) => t.priority = Some(*n),
                ast::Timing::Core(n) => t.core = Some(*n),
            }
        }
        t
    }
}
