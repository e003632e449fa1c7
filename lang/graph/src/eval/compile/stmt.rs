//! Code for statements and guards.

use super::Place;
use super::emit::error;
use super::expr::gives;
use super::{Compiled, Compiler, MAX_DEPTH};
use crate::eval::code::{EffectCode, Instr, Recipients};
use crate::{Conjunct, Expr, Govern, Open, Reply, Rule, Span, Stmt, StmtKind, Type};

/// Every expression of some statements.
pub(super) fn walk<'s>(stmts: &'s [Stmt], visit: &mut dyn FnMut(&'s Expr)) {
    for s in stmts {
        match &s.kind {
            StmtKind::Let(_, e)
            | StmtKind::Set(_, e)
            | StmtKind::Command(_, e)
            | StmtKind::Publish(_, e)
            | StmtKind::Tell { content: e, .. }
            | StmtKind::Note(_, Some(e))
            | StmtKind::Use(_, e)
            | StmtKind::SetParam(_, e) => e.walk(visit),
            StmtKind::Open(o) => {
                o.content.iter().chain([&o.to]).chain(&o.within).for_each(|e| e.walk(visit));
            }
            StmtKind::Reply(r) => r.content.iter().chain([&r.thread]).for_each(|e| e.walk(visit)),
            StmtKind::Each(each) => {
                each.list.walk(visit);
                walk(&each.body, visit);
            }
            StmtKind::Refine(r) => {
                r.first.walk(visit);
                r.step.walk(visit);
                r.until.iter().for_each(|e| e.walk(visit));
            }
            StmtKind::Note(_, None) | StmtKind::Raise(_) | StmtKind::Govern(_) => {}
            StmtKind::If(e, then, otherwise) | StmtKind::IfSome { value: e, then, otherwise, .. } => {
                e.walk(visit);
                walk(then, visit);
                walk(otherwise, visit);
            }
            StmtKind::Switch { value, arms, rest } => {
                value.walk(visit);
                for (_, body) in arms {
                    walk(body, visit);
                }
                walk(rest.as_deref().unwrap_or_default(), visit);
            }
            StmtKind::Rules(rules) => {
                for r in rules {
                    for c in &r.guard {
                        c.expr().walk(visit);
                    }
                    walk(&r.body, visit);
                }
            }
        }
    }
}

impl Compiler<'_> {
    pub(super) fn gen_stmts(&mut self, stmts: &[Stmt]) -> Compiled<()> {
        for s in stmts {
            if self.body.depth >= MAX_DEPTH {
                return error(s.at, "this nests too deep");
            }
            self.body.depth += 1;
            let top = self.body.top;
            self.gen_stmt(s)?;
            self.body.top = top;
            self.body.depth -= 1;
        }
        Ok(())
    }

    pub(super) fn gen_stmt(&mut self, s: &Stmt) -> Compiled<()> {
        match &s.kind {
            StmtKind::Let(local, e) => {
                let (register, t) = self.local(*local, s.at)?;
                self.gen_as(e, &t, Some(register))?;
            }
            StmtKind::If(condition, then, otherwise) => {
                let mut fails = Vec::new();
                self.branch(condition, false, &mut fails)?;
                self.two_ways(&fails, s.at, |c| c.gen_stmts(then), |c| c.gen_stmts(otherwise))?;
            }
            StmtKind::IfSome { value, local, reason, then, otherwise } => {
                self.gen_if_some_stmt(value, *local, *reason, then, otherwise)?;
            }
            StmtKind::Switch { value, arms, rest } => {
                self.gen_switch_stmt(value, arms, rest.as_deref(), s.at)?;
            }
            // Whoever runs a service takes its rounds apart.
            StmtKind::Refine(_) => return error(s.at, "nothing can be refined here"),
            StmtKind::Rules(rules) => self.perhaps(|c| c.gen_rules(rules))?,
            StmtKind::Each(each) => self.gen_each(&each.list, each.local, &each.body)?,
            StmtKind::Set(..)
            | StmtKind::Open(_)
            | StmtKind::Use(..)
            | StmtKind::Reply(_)
            | StmtKind::Command(..)
            | StmtKind::Publish(..)
            | StmtKind::Tell { .. }
            | StmtKind::Note(..)
            | StmtKind::Raise(_)
            | StmtKind::Govern(_)
            | StmtKind::SetParam(..) => self.gen_effect(s)?,
        }
        Ok(())
    }

    /// Code of two ways of which one is gone; `fails` are the jumps to the second.
    fn two_ways(
        &mut self,
        fails: &[u32],
        at: Span,
        first: impl FnOnce(&mut Self) -> Compiled<()>,
        second: impl FnOnce(&mut Self) -> Compiled<()>,
    ) -> Compiled<()> {
        let (mut end, before) = (Vec::new(), self.body.cost);
        self.perhaps(first)?;
        self.jump(Instr::Jump { to: 0 }, &mut end, at);
        let cost = std::mem::replace(&mut self.body.cost, before);
        self.land(fails);
        self.perhaps(second)?;
        self.body.cost = self.body.cost.max(cost);
        self.land(&end);
        Ok(())
    }

    pub(super) fn gen_if_some_stmt(
        &mut self,
        value: &Expr,
        local: u32,
        reason: Option<u32>,
        then: &[Stmt],
        otherwise: &[Stmt],
    ) -> Compiled<()> {
        let mut absent = Vec::new();
        let tag = self.bind_or_jump(value, local, &mut absent)?;
        self.two_ways(
            &absent,
            value.span,
            |c| c.gen_stmts(then),
            |c| {
                if let Some(r) = reason {
                    let text = c.reason(r, tag, value.span)?;
                    let (register, _) = c.local(r, value.span)?;
                    c.emit(Instr::Move { d: register, a: text }, value.span);
                }
                c.gen_stmts(otherwise)
            },
        )
    }

    /// Code that binds a local to the value of an optional, and jumps when there is none. Statements may
    /// change the state the value comes from, so it is copied. Returns the register of the tag.
    fn bind_or_jump(&mut self, value: &Expr, local: u32, absent: &mut Vec<u32>) -> Compiled<u32> {
        let (place, tag) = self.optional(value, local)?;
        self.jump(Instr::JumpIf { a: tag, to: 0 }, absent, value.span);
        let (register, t) = self.local(local, value.span)?;
        let n = self.width(&t, value.span)?;
        self.copy(place.plus(1), register, n, value.span);
        Ok(tag)
    }

    pub(super) fn gen_switch_stmt(
        &mut self,
        value: &Expr,
        arms: &[(Vec<u32>, Vec<Stmt>)],
        rest: Option<&[Stmt]>,
        at: Span,
    ) -> Compiled<()> {
        let a = self.scalar(value)?;
        let mut end = Vec::new();
        let mut most = self.body.cost;
        for (variants, body) in arms {
            self.check_variants(value, variants)?;
            let (mut chosen, mut other) = (Vec::new(), Vec::new());
            for v in variants {
                let k = self.pooled(f64::from(*v));
                self.jump(Instr::JumpEqK { a, k, to: 0 }, &mut chosen, at);
            }
            self.jump(Instr::Jump { to: 0 }, &mut other, at);
            let before = self.body.cost;
            self.land(&chosen);
            self.perhaps(|c| c.gen_stmts(body))?;
            self.jump(Instr::Jump { to: 0 }, &mut end, at);
            most = most.max(self.body.cost);
            self.body.cost = before;
            self.land(&other);
        }
        match rest {
            Some(body) => self.perhaps(|c| c.gen_stmts(body))?,
            None => self.emit(Instr::Fail, at),
        }
        self.body.cost = self.body.cost.max(most);
        self.land(&end);
        Ok(())
    }

    pub(super) fn gen_rules(&mut self, rules: &[Rule]) -> Compiled<()> {
        let mut end = Vec::new();
        let mut most = self.body.cost;
        for (i, r) in rules.iter().enumerate() {
            let mut fails = Vec::new();
            let top = self.body.top;
            let fetched = self.gen_guard(&r.guard, &mut fails)?;
            let before = self.body.cost;
            self.effect(EffectCode::Rule { rule: i as u32, at: r.at }, 0, r.at);
            self.perhaps(|c| c.gen_stmts(&r.body))?;
            self.jump(Instr::Jump { to: 0 }, &mut end, r.at);
            most = most.max(self.body.cost);
            self.body.cost = before;
            self.body.top = top;
            self.set_fetched(fetched);
            self.land(&fails);
        }
        self.body.cost = self.body.cost.max(most);
        self.land(&end);
        Ok(())
    }

    /// Code of a guard: binds locals, jumps when it does not hold. Returns what has been fetched wherever
    /// it jumps from.
    pub(super) fn gen_guard(&mut self, guard: &[Conjunct], fails: &mut Vec<u32>) -> Compiled<Vec<bool>> {
        let mut fetched = self.fetched();
        for (i, c) in guard.iter().enumerate() {
            match c {
                Conjunct::Holds(e) => {
                    gives(e, &Type::Bool)?;
                    self.branch(e, false, fails)?;
                }
                Conjunct::Binds(local, e) => {
                    self.bind_or_jump(e, *local, fails)?;
                }
            }
            // Where a conjunct fails, those after it are not evaluated; the first one is always.
            if i == 0 {
                fetched = self.fetched();
            }
        }
        Ok(fetched)
    }

    fn effect(&mut self, effect: EffectCode, a: u32, at: Span) {
        self.program.effects.push(effect);
        self.emit(Instr::Do { effect: (self.program.effects.len() - 1) as u32, a }, at);
    }

    /// Code for the value of an effect, in the layout of `t`: first register, width.
    fn effect_value(&mut self, e: &Expr, t: &Type) -> Compiled<(u32, u32)> {
        let n = self.width(t, e.span)?;
        let place = self.gen_as(e, t, None)?;
        let a = self.in_frame(place, n, e.span)?;
        self.tidy(a, t, e.span)?;
        Ok((a, n))
    }

    /// Values one behind the other, as effects with several take them; the first register.
    fn effect_values(&mut self, values: &[&Expr], at: Span) -> Compiled<(u32, Vec<u32>)> {
        let mut widths = Vec::new();
        for e in values {
            widths.push(self.width(&e.ty, e.span)?);
        }
        let first = self.alloc(widths.iter().sum(), at)?;
        let mut to = first;
        for (e, n) in values.iter().zip(&widths) {
            let place = self.gen_as(e, &e.ty, Some(to))?;
            if place != Place::frame(to) {
                self.copy(place, to, *n, e.span);
            }
            self.tidy(to, &e.ty, e.span)?;
            to += n;
        }
        Ok((first, widths))
    }

    fn content_width(&mut self, content: Option<&Expr>) -> Compiled<u32> {
        match content {
            Some(e) if matches!(e.ty, Type::Record(_)) => self.width(&e.ty, e.span),
            Some(e) => error(e.span, format!("a message carries a record, not {}", e.ty)),
            None => Ok(0),
        }
    }

    fn open_effect(&mut self, o: &Open) -> Compiled<(EffectCode, u32)> {
        let n = self.content_width(o.content.as_ref())?;
        let to = match &o.to.ty {
            Type::Agent => Recipients::One,
            Type::List(item, c) if **item == Type::Agent => Recipients::List(*c),
            t => return error(o.to.span, format!("a conversation is opened with agents, not {t}")),
        };
        if let Some(w) = o.within.as_ref().filter(|w| w.ty != Type::Quantity(crate::Dim::TIME)) {
            return error(w.span, format!("a duration is wanted here, not {}", w.ty));
        }
        let values: Vec<&Expr> = o.content.iter().chain([&o.to]).chain(&o.within).collect();
        let (a, _) = self.effect_values(&values, o.to.span)?;
        let (conversation, performative) = (o.conversation, o.performative.clone());
        Ok((EffectCode::Open { conversation, performative, n, to, within: o.within.is_some() }, a))
    }

    fn reply_effect(&mut self, r: &Reply) -> Compiled<(EffectCode, u32)> {
        let n = self.content_width(r.content.as_ref())?;
        if !matches!(r.thread.ty, Type::Conversation(_)) {
            return error(r.thread.span, format!("{} is no conversation", r.thread.ty));
        }
        let values: Vec<&Expr> = r.content.iter().chain([&r.thread]).collect();
        let (a, _) = self.effect_values(&values, r.thread.span)?;
        let (conversation, performative) = (r.conversation, r.performative.clone());
        Ok((EffectCode::Reply { conversation, performative, reason: r.reason.clone(), n }, a))
    }

    pub(super) fn gen_effect(&mut self, s: &Stmt) -> Compiled<()> {
        let Some(agent) = &self.agent else {
            return error(s.at, "there is no agent here that could do this");
        };
        let port = |p: &crate::Port| p.ty.clone();
        let (effect, a) = match &s.kind {
            StmtKind::Set(i, e) => {
                let slot = agent.states.range(*i as usize).map(|r| r.start as u32);
                let (Some(at), Some(t)) = (slot, agent.states.ty(*i as usize).cloned()) else {
                    return error(s.at, format!("the agent has no state {i}"));
                };
                let (a, n) = self.effect_value(e, &t)?;
                self.emit(Instr::StoreState { at, a, n }, s.at);
                return Ok(());
            }
            StmtKind::Command(i, e) => {
                let Some(t) = agent.actuators.get(*i as usize).map(port) else {
                    return error(s.at, format!("the agent has no actuator {i}"));
                };
                let (a, n) = self.effect_value(e, &t)?;
                self.emit(Instr::Command { port: *i, a, n }, s.at);
                return Ok(());
            }
            StmtKind::Publish(i, e) => {
                let Some(t) = self.topics.get(*i as usize).map(|t| t.ty.clone()) else {
                    return error(s.at, format!("there is no topic {i}"));
                };
                let (a, n) = self.effect_value(e, &t)?;
                self.emit(Instr::Publish { topic: *i, a, n }, s.at);
                return Ok(());
            }
            StmtKind::Tell { performative, to, content } => {
                let Type::Record(name) = &content.ty else {
                    return error(content.span, format!("a record is told, not {}", content.ty));
                };
                let (a, n) = self.effect_value(content, &content.ty)?;
                let (performative, to, content) = (performative.clone(), to.clone(), name.clone());
                (EffectCode::Tell { performative, to, content, n }, a)
            }
            StmtKind::Use(i, e) if *i < agent.devices && e.ty == Type::Quantity(crate::Dim::TIME) => {
                let (a, _) = self.effect_value(e, &e.ty)?;
                (EffectCode::Use(*i), a)
            }
            StmtKind::Use(..) => return error(s.at, "the agent has no such device, or not for this"),
            StmtKind::Open(o) => self.open_effect(o)?,
            StmtKind::Reply(r) => self.reply_effect(r)?,
            StmtKind::Note(text, None) => (EffectCode::Note { text: text.clone(), value: None }, 0),
            StmtKind::Note(text, Some(e)) => {
                let (a, n) = self.effect_value(e, &e.ty)?;
                (EffectCode::Note { text: text.clone(), value: Some((e.ty.clone(), n)) }, a)
            }
            StmtKind::Raise(i) if (*i as usize) < agent.events => (EffectCode::Raise(*i), 0),
            StmtKind::Raise(i) => return error(s.at, format!("the agent has no event {i}")),
            StmtKind::Govern(what) => {
                if let Govern::Start(u) | Govern::Stop(u) = what
                    && *u as usize >= agent.units
                {
                    return error(s.at, format!("the agent has no unit {u}"));
                }
                (EffectCode::Govern(what.clone()), 0)
            }
            StmtKind::SetParam(i, e) => {
                let Some(t) = self.params.ty(*i as usize).cloned() else {
                    return error(s.at, format!("there is no parameter {i}"));
                };
                let (a, n) = self.effect_value(e, &t)?;
                (EffectCode::SetParam { param: *i, n }, a)
            }
            _ => return error(s.at, "no effect"),
        };
        self.effect(effect, a, s.at);
        Ok(())
    }
}
