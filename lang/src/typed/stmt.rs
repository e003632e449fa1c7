//! Statements.

use super::Checker;
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{
    Conjunct, Diagnostic, Each, Expr as GExpr, Name, Op, Refine, Rule, Span, Stmt as GStmt,
    StmtKind as GStmtKind, Type,
};

/// Deepest nesting of blocks.
const MAX_BLOCKS: usize = 24;
/// Most statements that the actions of a program may be written out to.
const MAX_STATEMENTS: usize = 200_000;

/// Performatives of FIPA-ACL that can be told, lower case.
pub const PERFORMATIVES: &[&str] = &[
    "accept_proposal",
    "agree",
    "cancel",
    "cfp",
    "confirm",
    "disconfirm",
    "failure",
    "inform",
    "not_understood",
    "propose",
    "query_if",
    "query_ref",
    "refuse",
    "reject_proposal",
    "request",
    "subscribe",
];

impl<'a> Checker<'a> {
    /// A block: its `let`s end with it.
    pub fn block(&mut self, stmts: &[Stmt], depth: usize) -> Vec<GStmt> {
        let mark = self.body.scope.len();
        let out = self.stmts(stmts, depth);
        self.body.scope.truncate(mark);
        out
    }

    /// Statements whose `let`s stay in scope.
    pub fn stmts(&mut self, stmts: &[Stmt], depth: usize) -> Vec<GStmt> {
        if depth > MAX_BLOCKS {
            if let Some(s) = stmts.first() {
                self.report(
                    Diagnostic::error(code::NESTING, format!("blocks nest deeper than {MAX_BLOCKS}"))
                        .at(s.span, "too deep")
                        .hint("move the inner part into an `action`"),
                );
            }
            return Vec::new();
        }
        let mut out = Vec::new();
        for s in stmts {
            if let Some(kind) = self.stmt(s, depth) {
                out.extend(kind.into_iter().map(|kind| GStmt { kind, at: s.span }));
            }
        }
        out
    }

    fn stmt(&mut self, s: &Stmt, depth: usize) -> Option<Vec<GStmtKind>> {
        Some(vec![match &s.kind {
            StmtKind::Let(name, value) => {
                let Some(value) = self.expr(value, None) else {
                    self.poison(&name.name);
                    return None;
                };
                let local = self.body.bind(name, &value.ty.clone());
                GStmtKind::Let(local, value)
            }
            StmtKind::Open { conversation, performative, content, to, within } => {
                self.open(conversation, performative, [content.as_ref(), Some(to), within.as_ref()])?
            }
            StmtKind::Reply { performative, content, reason, thread } => {
                self.reply(performative, content.as_ref(), reason.clone(), thread.as_ref())?
            }
            StmtKind::For(item, list, body) => self.each(item, list, body, depth)?,
            StmtKind::Refine { name, first, step, cost, until } => {
                self.refine(name, [first, step, cost], until.as_ref(), s.span, depth)?
            }
            StmtKind::Set(name, value) => self.set(name, value)?,
            StmtKind::Command(name, value) => {
                let Some(i) = self.agent.actuators.iter().position(|(n, _)| *n == name.name) else {
                    let names: Vec<Name> = self.agent.actuators.iter().map(|(n, _)| n.clone()).collect();
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "actuator",
                        &name.name,
                        name.span,
                        names.iter().map(|n| &**n),
                    );
                    self.report(d);
                    return None;
                };
                let ty = self.agent.actuators[i].1.clone();
                GStmtKind::Command(i as u32, self.typed(value, &ty)?)
            }
            StmtKind::Publish(topic, value) => {
                let Some(i) = self.topics.position(&topic.name) else {
                    let names: Vec<Name> = self.topics.iter().map(|t| t.channel.name.clone()).collect();
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "topic",
                        &topic.name,
                        topic.span,
                        names.iter().map(|n| &**n),
                    );
                    self.report(d);
                    return None;
                };
                let ty = self.topics[i].ty.clone();
                GStmtKind::Publish(i as u32, self.typed(value, &ty)?)
            }
            StmtKind::Tell(to, performative, content) => {
                if !self.decls.agents.iter().any(|a| a.name.name == to.name) {
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "agent",
                        &to.name,
                        to.span,
                        self.decls.agents.iter().map(|a| &*a.name.name),
                    );
                    self.report(d);
                    return None;
                }
                self.performative(performative)?;
                let content = self.expr(content, None)?;
                if !matches!(content.ty, Type::Record(_)) {
                    self.report(
                        Diagnostic::error(
                            code::MISMATCH,
                            format!("messages carry records, this is {}", content.ty),
                        )
                        .at(content.span, content.ty.to_string())
                        .hint("declare a `record` for it"),
                    );
                    return None;
                }
                GStmtKind::Tell { performative: performative.name.clone(), to: to.name.clone(), content }
            }
            StmtKind::Note(text, value) => {
                self.texts.intern(text);
                let value = match value {
                    Some(v) => Some(self.expr(v, None)?),
                    None => None,
                };
                GStmtKind::Note(text.clone(), value)
            }
            StmtKind::Use(device, time) => {
                let Some(i) = self.agent.devices.iter().position(|d| *d == device.name) else {
                    let names = self.agent.devices.clone();
                    let known = names.iter().map(|n| &**n);
                    let d = unknown(code::UNKNOWN_NAME, "device", &device.name, device.span, known);
                    self.report(d);
                    return None;
                };
                let time = self.typed(time, &Type::Quantity(soifra_graph::Dim::TIME))?;
                GStmtKind::Use(i as u32, time)
            }
            StmtKind::Raise(event) => {
                let Some(i) = self.agent.events.iter().position(|e| *e == event.name) else {
                    let names = self.agent.events.clone();
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "event",
                        &event.name,
                        event.span,
                        names.iter().map(|n| &**n),
                    );
                    self.report(d);
                    return None;
                };
                GStmtKind::Raise(i as u32)
            }
            StmtKind::Govern(what) => GStmtKind::Govern(self.govern(what)?),
            StmtKind::If(arms, otherwise) => self.if_stmt(arms, otherwise, depth)?,
            StmtKind::Match(x, arms) => self.match_stmt(x, arms, depth)?,
            StmtKind::Rules(rules) => self.rules(rules, depth),
            StmtKind::When(guard, body) => {
                let rule = self.rule(Some(guard), body, guard.span, depth)?;
                GStmtKind::Rules(vec![rule])
            }
            StmtKind::Do(action, args) => return self.do_action(action, args, s.span, depth),
        }])
    }

    /// `for item in list { … }`
    fn each(&mut self, item: &Ident, list: &Expr, body: &[Stmt], depth: usize) -> Option<GStmtKind> {
        let Some(list) = self.expr(list, None) else {
            self.poison(&item.name);
            return None;
        };
        let Type::List(of, _) = list.ty.clone() else {
            self.poison(&item.name);
            self.report(
                Diagnostic::error(code::MISMATCH, format!("a list is wanted, this is {}", list.ty))
                    .at(list.span, list.ty.to_string())
                    .hint("`for` goes through a list, whose length is bounded; what is repeated in time is a plan or a service"),
            );
            return None;
        };
        let mark = self.body.scope.len();
        let local = self.body.bind(item, &of);
        let body = self.block(body, depth + 1);
        self.body.scope.truncate(mark);
        Some(GStmtKind::Each(Box::new(Each { list, local, body })))
    }

    /// `refine x = first by step cost c until u`: the value that as many rounds as are paid for come to.
    fn refine(
        &mut self,
        name: &Ident,
        [first, step, cost]: [&Expr; 3],
        until: Option<&Expr>,
        at: Span,
        depth: usize,
    ) -> Option<GStmtKind> {
        let refines = std::mem::take(&mut self.body.refines);
        if !refines || depth > 0 {
            self.poison(&name.name);
            self.report(
                Diagnostic::error(code::ANYTIME, "`refine` cannot stand here")
                    .at(at, "not directly in a service with a budget, or not the first")
                    .hint("write it once, outside of any `if`, in a `service … budget 50 ms { … }`"),
            );
            return None;
        }
        let cost = self.start_duration(cost);
        let Some(first) = self.expr(first, None) else {
            self.poison(&name.name);
            return None;
        };
        let ty = first.ty.clone();
        let local = self.body.bind(name, &ty);
        let step = self.expr(step, Some(&ty))?;
        if ty == Type::Int && step.ty == Type::NUMBER {
            self.report(
                Diagnostic::error(code::MISMATCH, "a round makes another type of it")
                    .at(step.span, "Number")
                    .at(first.span, "Int")
                    .hint("begin with a number that has a fraction, such as `2.0`"),
            );
            return None;
        }
        let step = self.coerce(step, &ty);
        let until = match until {
            Some(u) => Some(self.typed(u, &Type::Bool)?),
            None => None,
        };
        Some(GStmtKind::Refine(Box::new(Refine { local, first, step: step?, cost: cost?, until })))
    }

    /// Checks a performative's name.
    pub fn performative(&mut self, p: &Ident) -> Option<()> {
        if PERFORMATIVES.contains(&&*p.name) {
            return Some(());
        }
        let d = unknown(code::UNKNOWN_NAME, "performative", &p.name, p.span, PERFORMATIVES.iter().copied());
        self.report(d);
        None
    }

    fn set(&mut self, name: &Ident, value: &Expr) -> Option<GStmtKind> {
        if let Some((_, slot, ty)) = self.body.data.iter().find(|(n, _, _)| *n == name.name).cloned() {
            return Some(GStmtKind::Set(slot, self.typed(value, &ty)?));
        }
        if let Some(i) = self.agent.states.iter().position(|(n, _, _)| *n == name.name) {
            let ty = self.agent.states[i].1.clone();
            return Some(GStmtKind::Set(i as u32, self.typed(value, &ty)?));
        }
        if let Some(i) = self.params.position(&name.name) {
            let ty = self.params[i].1.clone();
            return Some(GStmtKind::SetParam(i as u32, self.typed(value, &ty)?));
        }
        let is_local = self.body.scope.iter().any(|(n, _, _)| *n == name.name)
            || self.agent.lets.contains_key(&name.name);
        let names: Vec<String> = self
            .agent
            .states
            .iter()
            .map(|(n, _, _)| n.to_string())
            .chain(self.params.iter().map(|(n, _, _)| n.to_string()))
            .collect();
        let d = if is_local {
            Diagnostic::error(code::UNKNOWN_NAME, format!("`{}` cannot be set", name.name))
                .at(name.span, "bound by `let`, for good")
                .hint("declare it as a `state` of the agent")
        } else {
            unknown(
                code::UNKNOWN_NAME,
                "state or parameter",
                &name.name,
                name.span,
                names.iter().map(String::as_str),
            )
        };
        self.report(d);
        None
    }

    fn if_stmt(&mut self, arms: &[(Expr, Vec<Stmt>)], otherwise: &[Stmt], depth: usize) -> Option<GStmtKind> {
        // Arms that bind become rules: first that holds.
        let mut rules = Vec::new();
        for (cond, body) in arms {
            rules.push(self.rule(Some(cond), body, cond.span, depth)?);
        }
        let last = self.block(otherwise, depth + 1);
        let plain = rules.iter().all(|r| matches!(r.guard.as_slice(), [Conjunct::Holds(_)]));
        if !plain {
            if !last.is_empty() {
                let at = last[0].at;
                rules.push(Rule { guard: Vec::new(), body: last, at });
            }
            return Some(GStmtKind::Rules(rules));
        }
        let mut result = last;
        for r in rules.into_iter().rev() {
            let Some(Conjunct::Holds(cond)) = r.guard.into_iter().next() else { continue };
            let at = cond.span;
            result = vec![GStmt { kind: GStmtKind::If(cond, r.body, result), at }];
        }
        result.pop().map(|s| s.kind)
    }

    fn rules(&mut self, rules: &[(Option<Expr>, Vec<Stmt>, Span)], depth: usize) -> GStmtKind {
        let mut out = Vec::new();
        let mut open: Option<Span> = None;
        for (guard, body, at) in rules {
            if let Some(first) = open {
                self.report(
                    Diagnostic::error(code::UNREACHABLE_RULE, "this rule can never fire")
                        .at(*at, "never reached")
                        .at(first, "always fires before it")
                        .hint("put it before the rule that always fires, or remove it"),
                );
                continue;
            }
            let Some(rule) = self.rule(guard.as_ref(), body, *at, depth) else { continue };
            if always(&rule.guard) {
                open = Some(*at);
            }
            out.push(rule);
        }
        GStmtKind::Rules(out)
    }

    fn rule(&mut self, guard: Option<&Expr>, body: &[Stmt], at: Span, depth: usize) -> Option<Rule> {
        let mark = self.body.scope.len();
        let guard = match guard {
            Some(g) => self.guard(g),
            None => Some(Vec::new()),
        };
        let body = self.block(body, depth + 1);
        self.body.scope.truncate(mark);
        Some(Rule { guard: guard?, body, at })
    }

    fn match_stmt(&mut self, x: &Expr, arms: &[(Pattern, Vec<Stmt>)], depth: usize) -> Option<GStmtKind> {
        let value = self.expr(x, None)?;
        match value.ty.clone() {
            Type::Option(inner) => {
                self.cover_optional(arms.iter().map(|(p, _)| p), value.span)?;
                let (local, reason) = (self.body.local(&inner), self.body.local(&Type::Text));
                let (mut then, mut otherwise) = (None, None);
                for (p, body) in arms {
                    let mark = self.body.scope.len();
                    self.bind_pattern(p, local, &inner, reason);
                    let body = self.block(body, depth + 1);
                    self.body.scope.truncate(mark);
                    let (is_some, is_none) = super::choice::sides(p);
                    if is_some && is_none && then.is_none() && otherwise.is_none() {
                        // `otherwise` alone: the same whatever it is.
                        return Some(GStmtKind::Rules(vec![Rule { guard: Vec::new(), body, at: p.span }]));
                    }
                    if is_some && then.is_none() {
                        then = Some(body.clone());
                    }
                    if is_none && otherwise.is_none() {
                        otherwise = Some(body);
                    }
                }
                Some(GStmtKind::IfSome {
                    value,
                    local,
                    reason: Some(reason),
                    then: then?,
                    otherwise: otherwise?,
                })
            }
            Type::Enum(name) => {
                let cover = self.cover_enum(&name, arms.iter().map(|(p, _)| p), value.span)?;
                let (mut out, mut rest) = (Vec::new(), None);
                for (p, body) in arms {
                    let body = self.block(body, depth + 1);
                    match &p.kind {
                        PatternKind::Variants(list) => {
                            let indices = list
                                .iter()
                                .filter_map(|i| {
                                    cover.variants.iter().find(|(n, _)| n.span == i.span).map(|(_, k)| *k)
                                })
                                .collect();
                            out.push((indices, body));
                        }
                        _ => rest = Some(body),
                    }
                }
                Some(GStmtKind::Switch { value, arms: out, rest })
            }
            other => self.no_match(&other, value.span),
        }
    }

    /// `do action(args)`: the action's statements, written out with its parameters bound.
    fn do_action(&mut self, name: &Ident, args: &[Arg], span: Span, depth: usize) -> Option<Vec<GStmtKind>> {
        let action = self.find_action(name)?;
        if let Some(until) = action.until.as_ref().or(action.fails.as_ref()) {
            self.report(
                Diagnostic::error(
                    code::ARGUMENTS,
                    format!("`{}` takes time, a statement takes none", name.name),
                )
                .at(span, "done at once here")
                .at(until.span, "lasts until then")
                .hint("use it as a node of a plan, or write an action without `until`"),
            );
            return None;
        }
        if self.too_much {
            return None;
        }
        self.enter_action(name, span)?;
        let body = self.action_body(action, name, args, span, depth);
        self.expanding.pop();
        body
    }

    /// Marks an action as being written out; reports one that does itself.
    pub fn enter_action(&mut self, name: &Ident, span: Span) -> Option<()> {
        if self.expanding.contains(&name.name) {
            self.report(
                Diagnostic::error(code::RECURSION, format!("`{}` does itself", name.name))
                    .at(span, "done again here")
                    .hint("an action cannot do itself; repeat it in a plan"),
            );
            return None;
        }
        self.expanding.push(name.name.clone());
        Some(())
    }

    fn action_body(
        &mut self,
        action: &'a Action,
        name: &Ident,
        args: &[Arg],
        span: Span,
        depth: usize,
    ) -> Option<Vec<GStmtKind>> {
        let bound = self.bind_action(action, name, args, span)?;
        // Seen from the agent and its own parameters: no locals of the place that does it.
        let (lets, scope): (Vec<GStmt>, Vec<_>) = bound;
        let outer = std::mem::replace(&mut self.body.scope, scope);
        let body = self.block(&action.body, depth + 1);
        self.body.scope = outer;
        self.written_statements += body.len() + 1;
        if self.written_statements > MAX_STATEMENTS {
            if !std::mem::replace(&mut self.too_much, true) {
                self.report(
                    Diagnostic::error(code::UNBOUNDED, "actions grow beyond all measure")
                        .at(span, "written out here once more")
                        .hint("actions that do others twice double with every level: use fewer levels, or a plan"),
                );
            }
            return None;
        }
        Some(lets.into_iter().chain(body).map(|s| s.kind).collect())
    }

    /// Arguments of an action as `let`s, and the scope its body sees.
    #[allow(clippy::type_complexity, reason = "two lists that belong together, used twice; 2026-11")]
    pub fn bind_action(
        &mut self,
        action: &'a Action,
        name: &Ident,
        args: &[Arg],
        span: Span,
    ) -> Option<(Vec<GStmt>, Vec<(Name, u32, Type)>)> {
        let mut params = Vec::new();
        for (n, t) in &action.params {
            let Some(ty) = self.resolve_type(t, None) else {
                self.poison(&n.name);
                return None;
            };
            params.push((n.name.clone(), ty));
        }
        let values = self.arguments(name, &params, args, span)?;
        let (mut lets, mut scope) = (Vec::new(), Vec::new());
        for ((n, ty), value) in params.into_iter().zip(values) {
            let local = self.body.local(&ty);
            lets.push(GStmt { kind: GStmtKind::Let(local, value), at: span });
            scope.push((n, local, ty));
        }
        Some((lets, scope))
    }

    /// The action called `name`.
    pub fn find_action(&mut self, name: &Ident) -> Option<&'a Action> {
        let found = self.agent.actions.get(&name.name).copied();
        if found.is_none() {
            let names: Vec<Name> = self.agent.actions.keys().cloned().collect();
            let d = unknown(code::UNKNOWN_NAME, "action", &name.name, name.span, names.iter().map(|n| &**n));
            self.report(d);
        }
        found
    }
}

/// Whether a guard holds whatever happens.
fn always(guard: &[Conjunct]) -> bool {
    guard
        .iter()
        .all(|c| matches!(c, Conjunct::Holds(GExpr { op: Op::Const(soifra_graph::Value::Bool(true)), .. })))
}
