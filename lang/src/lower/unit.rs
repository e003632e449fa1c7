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
        let names =
            matches!(u.trigger.kind, TriggerKind::Topic(..) | TriggerKind::Told(..) | TriggerKind::Talk(..));
        if trigger.is_none() && names {
            // Without what it names, all of the body would be unknown.
            return None;
        }
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
            stopped: u.timing.iter().any(|t| matches!(t, ast::Timing::Stopped)),
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
            TriggerKind::Param(p) => match self.params.position(&p.name) {
                Some(i) => Trigger::Param(i as u32),
                None => {
                    let names: Vec<Name> = self.params.iter().map(|(n, _, _)| n.clone()).collect();
                    return self.unknown_trigger("parameter", p, &names);
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
            TriggerKind::Talk(conversation, what) => return self.talk(conversation, what, None, body),
            TriggerKind::Told(conversation, what, content, from)
                if self.conversations.position(&conversation.name).is_some() =>
            {
                if let Some(f) = from {
                    self.report(
                        Diagnostic::error(code::SYNTAX, "a conversation has one partner")
                            .at(f.span, "nobody else speaks in it")
                            .hint("leave out `from`; the partner is `sender`"),
                    );
                }
                return self.talk(conversation, what, Some(content), body);
            }
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

    /// `on conversation performative(content)`, `on conversation timeout`, `on conversation settled`.
    fn talk(
        &mut self,
        name: &ast::Ident,
        what: &ast::Ident,
        content: Option<&ast::Ident>,
        body: &mut Body,
    ) -> Option<Trigger> {
        let Some(i) = self.conversations.position(&name.name) else {
            let names: Vec<Name> = self.conversations.iter().map(|c| c.name.clone()).collect();
            return self.unknown_trigger("conversation", name, &names);
        };
        let whole = ["timeout", "settled"].contains(&&*what.name);
        if let (true, Some(c)) = (whole, content) {
            self.report(
                Diagnostic::error(code::MESSAGE, format!("`{}` is no message", what.name))
                    .at(c.span, "there is nothing to name")
                    .hint(format!("write `on {} {}`", name.name, what.name)),
            );
            return None;
        }
        // What is settled is said of all together: there is no one sender, and no one conversation.
        let one = &*what.name != "settled";
        let mut local = |n: &str, ty: Type| match one {
            true => body.bind(&ast::Ident { name: n.into(), span: what.span }, &ty),
            false => body.local(&ty),
        };
        let sender = local("sender", Type::Agent);
        let thread = local("conversation", Type::Conversation(name.name.clone()));
        body.thread = one.then_some((i as u32, thread));
        let event = match &*what.name {
            "timeout" => soifra_graph::Talk::Timeout,
            "settled" => soifra_graph::Talk::Settled,
            _ => {
                let carried = self.carried(i, what);
                if let (None, Some(c)) = (&carried, content) {
                    self.poison(&c.name);
                }
                let carried = carried?;
                let content = match (content, carried) {
                    (Some(n), Some(record)) => Some(body.bind(n, &Type::Record(record))),
                    (None, _) => None,
                    (Some(n), None) => {
                        self.report(
                            Diagnostic::error(code::MESSAGE, format!("`{}` carries nothing here", what.name))
                                .at(n.span, "no content")
                                .hint(format!("write `on {} {}`", name.name, what.name)),
                        );
                        return None;
                    }
                };
                soifra_graph::Talk::Message { performative: what.name.clone(), content }
            }
        };
        Some(Trigger::Talk { conversation: i as u32, what: event, sender, thread })
    }

    /// What a message of a conversation carries; reports one that the protocol does not have.
    #[allow(
        clippy::option_option,
        reason = "outer: whether there is such a message, inner: whether it carries something; 2026-11"
    )]
    pub fn carried(&mut self, conversation: usize, what: &ast::Ident) -> Option<Option<Name>> {
        let c = &self.conversations[conversation];
        let moves = || c.states.iter().flat_map(|s| &s.moves);
        if let Some(m) = moves().find(|m| m.performative == what.name) {
            return Some(m.content.clone());
        }
        let mut known: Vec<String> = moves().map(|m| m.performative.to_string()).collect();
        known.dedup();
        let mut d = unknown(
            code::MESSAGE,
            &format!("message of `{}`", c.name),
            &what.name,
            what.span,
            known.iter().map(String::as_str),
        );
        d.title = format!("protocol `{}` has no `{}`", c.protocol, what.name);
        self.report(d.at(self.conversations[conversation].at, "this conversation"));
        None
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
                ast::Timing::Stopped => {}
            }
        }
        t
    }
}
