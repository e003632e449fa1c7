//! Do the graph's parts fit together? Types, frames and indices are derived again from what is declared,
//! never believed. A graph that came from sources passes by construction; one from a file may hold anything.

use super::walk;
use crate::code;
use soifra_graph::{
    Agent, Diagnostic, Dim, ExpectKind, Expr, Frame, Govern, Graph, ListOp, Op, Own, Quantifier, Run, Span,
    Stmt, StmtKind, Strategy, Trigger, Truth, Type, UnitKind, Value, pattern::Bindings, typing,
};

/// Checks everything the other checks take for granted.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut c = Types { g, agent: None, locals: Vec::new(), out: Vec::new() };
    c.graph();
    c.out.truncate(20);
    c.out
}

struct Types<'a> {
    g: &'a Graph,
    agent: Option<&'a Agent>,
    locals: Vec<Type>,
    out: Vec<Diagnostic>,
}

impl<'a> Types<'a> {
    fn bad(&mut self, at: Span, why: impl Into<String>) {
        self.out.push(
            Diagnostic::error(code::GRAPH, format!("the graph does not fit together: {}", why.into()))
                .at(at, "here")
                .hint("make the graph anew from its sources: `soifra graph FILE.soi`"),
        );
    }

    fn graph(&mut self) {
        let g = self.g;
        for p in &g.params {
            if !is_a(&p.default, &p.ty, g) {
                self.bad(p.at, format!("the default of `{}` is no {}", p.name, p.ty));
            }
        }
        for f in &g.functions {
            if f.parameters.len() > f.locals.len()
                || f.parameters.iter().zip(&f.locals).any(|((_, t), l)| t != l)
            {
                self.bad(f.span, format!("function `{}` has other locals than parameters", f.name));
                continue;
            }
            self.locals = f.locals.clone();
            self.expr(&f.body);
        }
        let parts = g
            .world
            .iter()
            .chain(g.platforms.iter().flat_map(|p| &p.components))
            .chain(g.topics.iter().map(|t| &t.channel));
        for c in parts {
            for (name, e) in &c.args {
                let known = soifra_graph::component::model(&c.role, &c.model);
                if !known.is_some_and(|m| {
                    m.signature
                        .parameters
                        .iter()
                        .any(|p| p.name == *name && p.pattern.matches(&e.ty, &mut Bindings::default()))
                }) {
                    self.bad(c.at, format!("`{name}` is no argument of {} {}", c.role, c.model));
                }
                self.lone(e, &[Type::Int]);
            }
        }
        for c in &g.conversations {
            let n = c.states.len();
            for s in &c.states {
                let known = |m: &soifra_graph::ProtocolMove| {
                    (m.target as usize) < n
                        && m.content.as_ref().is_none_or(|r| g.types.records.contains_key(r))
                };
                if !s.moves.iter().all(known) || s.timeout.as_ref().is_some_and(|t| t.1 as usize >= n) {
                    self.bad(s.at, "a protocol leads nowhere");
                }
                if let Some((after, _)) = &s.timeout {
                    self.want(after, &Type::Quantity(Dim::TIME));
                    self.lone(after, &[]);
                }
            }
        }
        for a in &g.agents {
            self.agent(a);
        }
        self.agent = None;
        if !g.robots.is_sorted_by_key(|r| r.host) {
            self.bad(Span::default(), "a robot behind a host");
        }
        for r in &g.robots {
            self.robot(r);
        }
        self.mission();
    }

    fn robot(&mut self, r: &'a soifra_graph::RobotGroup) {
        match self.g.platforms.get(r.platform as usize) {
            Some(p) if r.host && !p.components.is_empty() => self.bad(r.at, "a host with a body"),
            Some(_) => {}
            None => self.bad(r.at, "a robot without a platform"),
        }
        self.want(&r.start, &Type::Pose(Frame::map()));
        r.scatter.iter().for_each(|e| self.want(e, &Type::Distribution(Dim::LENGTH)));
        r.target.iter().for_each(|e| self.want(e, &Type::Point(Frame::map())));
        let scene = [Some(&r.start), r.scatter.as_ref(), r.target.as_ref()];
        scene.into_iter().flatten().for_each(|e| self.lone(e, &[Type::Int]));
        for b in &r.agents {
            match self.g.agents.get(b.agent as usize) {
                Some(a) if a.parameters.len() == b.arguments.len() => {
                    for (e, (_, t)) in b.arguments.iter().zip(&a.parameters) {
                        self.want(e, t);
                        self.lone(e, &[Type::Int]);
                    }
                }
                _ => self.bad(b.at, "an agent's arguments do not fit its parameters"),
            }
        }
    }

    fn mission(&mut self) {
        let g = self.g;
        self.want(&g.done, &Type::Bool);
        self.lone(&g.done, &[]);
        for e in g.step.iter() {
            self.want(e, &Type::Quantity(Dim::TIME));
            self.lone(e, &[]);
        }
        for e in &g.expects {
            let (conditions, limit): (Vec<&Expr>, _) = match &e.kind {
                ExpectKind::Always(a) | ExpectKind::Never(a) | ExpectKind::Finally(a) => (vec![a], None),
                ExpectKind::Eventually(a, w) => (vec![a], w.as_ref()),
                ExpectKind::Until(a, b) => (vec![a, b], None),
                ExpectKind::LeadsTo(a, b, w) => (vec![a, b], w.as_ref()),
            };
            for c in conditions {
                self.want(c, &Type::Bool);
                self.lone(c, &[]);
            }
            limit.into_iter().for_each(|w| self.limit(w));
        }
        g.within.iter().for_each(|w| self.limit(w));
        for m in &g.metrics {
            m.exprs().for_each(|e| self.lone(e, &[]));
            if let Some(when) = m.samples.as_ref().and_then(|s| s.when.as_ref()) {
                self.want(when, &Type::Bool);
            }
        }
        for s in g.goals.iter().flat_map(|goal| &goal.subgoals) {
            match s.agent.map(|a| g.agents.get(a as usize)) {
                Some(Some(a)) => self.agent = Some(a),
                Some(None) => self.bad(s.at, "a sub-goal without an agent"),
                None if s.achieved.is_some() => self.bad(s.at, "a condition of nobody"),
                None => {}
            }
            if s.plan.is_some_and(|p| p as usize >= g.plans.len()) {
                self.bad(s.at, "a sub-goal of no plan");
            }
            if let Some(e) = &s.achieved {
                self.want(e, &Type::Bool);
                self.lone(e, &[]);
            }
            self.agent = None;
        }
        self.plans();
    }

    /// The plan library, and what is left of agents that are not capable.
    fn plans(&mut self) {
        let g = self.g;
        for e in g.plans.iter().filter_map(|p| p.when.as_ref()) {
            self.want(e, &Type::Bool);
            self.lone(e, &[]);
        }
        for u in g.robots.iter().flat_map(|r| &r.unfit) {
            if u.agent as usize >= g.agents.len() {
                self.bad(u.at, "an agent that is not there");
            }
        }
    }

    fn limit(&mut self, e: &Expr) {
        if !matches!(e.ty, Type::Quantity(Dim::TIME | Dim::STEP)) {
            self.bad(e.span, "a time limit is a duration or a number of steps");
        }
        self.lone(e, &[]);
    }

    fn agent(&mut self, a: &'a Agent) {
        self.agent = Some(a);
        for s in &a.states {
            self.want(&s.initial, &s.ty);
            self.lone(&s.initial, &[]);
        }
        for o in &a.offers {
            if o.unit.is_some_and(|u| u as usize >= a.units.len()) {
                self.bad(o.span, "an offer of no unit");
            }
            if let Some(e) = &o.when {
                self.want(e, &Type::Bool);
                self.lone(e, &[]);
            }
        }
        if let Some(r) = &a.restart {
            self.want(&r.within, &Type::Quantity(Dim::TIME));
            self.lone(&r.within, &[]);
        }
        for u in &a.units {
            self.locals = u.locals.clone();
            match &u.trigger {
                Trigger::Message { topic, local } => {
                    match (self.g.topics.get(*topic as usize), u.locals.get(*local as usize)) {
                        (Some(t), Some(l)) if t.ty == *l => {}
                        _ => self.bad(u.span, "a message of another type"),
                    }
                }
                Trigger::Told { content, local, .. }
                    if u.locals.get(*local as usize) != Some(&Type::Record(content.clone())) =>
                {
                    self.bad(u.span, "a message of another type");
                }
                Trigger::Talk { conversation, what, sender, thread } => {
                    let local = |l: u32| u.locals.get(l as usize);
                    let c = self.g.conversations.get(*conversation as usize);
                    let names = local(*sender) == Some(&Type::Agent)
                        && c.is_some_and(|c| local(*thread) == Some(&Type::Conversation(c.name.clone())));
                    let content = match what {
                        soifra_graph::Talk::Message { performative, content: Some(l) } => {
                            c.is_some_and(|c| {
                                let mut moves = c.states.iter().flat_map(|s| &s.moves);
                                let m = moves.find(|m| m.performative == *performative);
                                m.and_then(|m| m.content.clone()).map(Type::Record).as_ref() == local(*l)
                            })
                        }
                        _ => true,
                    };
                    if !names || !content {
                        self.bad(u.span, "a conversation of another type");
                    }
                }
                Trigger::Reading(p) if *p as usize >= a.sensors.len() => self.bad(u.span, "no such sensor"),
                Trigger::Param(p) if *p as usize >= self.g.params.len() => {
                    self.bad(u.span, "no such parameter");
                }
                Trigger::Event(e) if *e as usize >= a.events.len() => self.bad(u.span, "no such event"),
                _ => {}
            }
            let refines = |s: &&Stmt| matches!(s.kind, StmtKind::Refine(_));
            let here = match &u.kind {
                UnitKind::Service(body) if u.timing.budget.is_some() => body.iter().filter(refines).count(),
                _ => 0,
            };
            if walk::statements(u).into_iter().filter(refines).count() > here.min(1) {
                self.bad(u.span, "something is refined where nothing pays for it");
            }
            if let UnitKind::Machine(states) = &u.kind {
                self.machine(a, states);
            }
            if let UnitKind::Plan { nodes, .. } = &u.kind {
                let tree = nodes
                    .iter()
                    .enumerate()
                    .all(|(i, n)| n.children.iter().all(|c| (*c as usize) < nodes.len() && *c as usize > i));
                let children: usize = nodes.iter().map(|n| n.children.len()).sum();
                if nodes.is_empty() || !tree || children + 1 != nodes.len() {
                    self.bad(u.span, "a plan is a tree, parents before children");
                }
            }
            for s in walk::statements(u) {
                self.stmt(a, s);
            }
            let mut exprs = Vec::new();
            walk::unit(u, &mut |e| exprs.push(e));
            exprs.into_iter().for_each(|e| self.node(e));
        }
        for x in &a.arbiters {
            self.locals = x.locals.clone();
            let mut exprs = Vec::new();
            walk::arbiter(x, &mut |e| exprs.push(e));
            exprs.into_iter().for_each(|e| self.node(e));
            let n = x.sources.len();
            let fits = match &x.strategy {
                Strategy::Priority(list) => list.len() == n && list.iter().all(|e| e.ty == Type::Int),
                Strategy::Blend(list) => list.len() == n && list.iter().all(|e| e.ty.fits(&Type::NUMBER)),
                Strategy::Layers(list) => {
                    list.len() == n && list.iter().all(|l| l.suppresses.iter().all(|s| (*s as usize) < n))
                }
                Strategy::Switch => true,
            };
            let known = x.sources.iter().all(|s| {
                self.g.agents.get(s.agent as usize).is_some_and(|a| (s.unit as usize) < a.units.len())
            });
            if !fits || !known || x.actuator as usize >= a.actuators.len() {
                self.bad(x.at, "an arbiter that does not fit its sources");
            }
        }
    }

    fn machine(&mut self, a: &Agent, states: &[soifra_graph::MachineState]) {
        for s in states {
            if s.data.iter().any(|d| *d as usize >= a.states.len()) {
                self.bad(s.at, "a machine state carries what the agent does not have");
            }
            for t in &s.transitions {
                let fits = states.get(t.target as usize).is_some_and(|to| {
                    to.data.len() == t.arguments.len()
                        && to
                            .data
                            .iter()
                            .zip(&t.arguments)
                            .all(|(d, e)| a.states.get(*d as usize).is_some_and(|s| s.ty == e.ty))
                });
                if !fits {
                    self.bad(t.at, "a transition does not fit the data of its target");
                }
            }
        }
    }

    fn stmt(&mut self, a: &Agent, s: &Stmt) {
        let wanted = match &s.kind {
            StmtKind::Let(l, e) => (self.locals.get(*l as usize).cloned(), e),
            StmtKind::Set(i, e) => (a.states.get(*i as usize).map(|s| s.ty.clone()), e),
            StmtKind::Command(i, e) => (a.actuators.get(*i as usize).map(|p| p.ty.clone()), e),
            StmtKind::Publish(i, e) => (self.g.topics.get(*i as usize).map(|t| t.ty.clone()), e),
            StmtKind::SetParam(i, e) => (self.g.params.get(*i as usize).map(|p| p.ty.clone()), e),
            StmtKind::If(e, _, _) => (Some(Type::Bool), e),
            StmtKind::Each(each) => {
                let item = self.locals.get(each.local as usize);
                if !matches!((&each.list.ty, item), (Type::List(t, n), Some(l)) if *n == 0 || **t == *l) {
                    self.bad(s.at, "a loop over something else than its list");
                }
                return;
            }
            StmtKind::Open(o) => {
                return self.message(s.at, o.conversation, &o.performative, o.content.as_ref());
            }
            StmtKind::Reply(r) => {
                let name = self.g.conversations.get(r.conversation as usize).map(|c| c.name.clone());
                if name.is_none_or(|n| r.thread.ty != Type::Conversation(n)) {
                    self.bad(s.at, "a reply in another conversation");
                }
                return self.message(s.at, r.conversation, &r.performative, r.content.as_ref());
            }
            StmtKind::Refine(r) => {
                self.want(&r.cost, &Type::Quantity(Dim::TIME));
                r.until.iter().for_each(|u| self.want(u, &Type::Bool));
                self.want(&r.step, &r.first.ty);
                (self.locals.get(r.local as usize).cloned(), &r.first)
            }
            StmtKind::Use(i, e) => (a.devices.get(*i as usize).map(|_| Type::Quantity(Dim::TIME)), e),
            StmtKind::Raise(i) if *i as usize >= a.events.len() => return self.bad(s.at, "no such event"),
            StmtKind::Govern(what) => {
                let there = match what {
                    Govern::Start(u) | Govern::Stop(u) => (*u as usize) < a.units.len(),
                    Govern::Offer(o) | Govern::Withdraw(o) => (*o as usize) < a.offers.len(),
                    Govern::Pursue(goal) => (*goal as usize) < self.g.goals.len(),
                    Govern::Achieve | Govern::Fail(_) => true,
                };
                if !there {
                    self.bad(s.at, "a unit or goal that is not there");
                }
                return;
            }
            _ => return,
        };
        match wanted {
            (Some(t), e) => self.want(e, &t),
            (None, _) => self.bad(s.at, "a statement about something that is not declared"),
        }
    }

    /// A message that its conversation must have, with what it carries.
    fn message(&mut self, at: Span, conversation: u32, performative: &str, content: Option<&Expr>) {
        let c = self.g.conversations.get(conversation as usize);
        let mut moves = c.into_iter().flat_map(|c| &c.states).flat_map(|s| &s.moves);
        let wanted = moves.find(|m| &*m.performative == performative).map(|m| m.content.clone());
        let given = content.map(|e| e.ty.clone());
        if wanted.is_none_or(|w| w.map(Type::Record) != given) {
            self.bad(at, "a message that its conversation does not have");
        }
    }

    fn want(&mut self, e: &Expr, t: &Type) {
        if e.ty != *t {
            self.bad(e.span, format!("{} where {t} is wanted", e.ty));
        }
    }

    /// An expression outside any unit: it brings its own locals.
    fn lone(&mut self, e: &Expr, known: &[Type]) {
        self.locals = e.local_types(known);
        self.expr(e);
    }

    fn expr(&mut self, e: &Expr) {
        e.walk(&mut |e| self.node(e));
    }

    /// One node, its arguments taken as typed.
    fn node(&mut self, e: &Expr) {
        if !self.fits(e) {
            self.bad(e.span, format!("{} is no {}", name(&e.op), e.ty));
        }
    }

    fn fits(&self, e: &Expr) -> bool {
        let args: Vec<&Type> = e.args.iter().map(|a| &a.ty).collect();
        let is = |t: Option<&Type>| t == Some(&e.ty);
        let body = |i: usize| args.get(i).is_some_and(|t| **t == e.ty);
        let quantity = |d| e.ty == Type::Quantity(d);
        match &e.op {
            Op::Const(v) => is_a(v, &e.ty, self.g),
            Op::Local(l) => is(self.locals.get(*l as usize)),
            Op::State(i) => is(self.agent.and_then(|a| a.states.get(*i as usize)).map(|s| &s.ty)),
            Op::Argument(i) => is(self.agent.and_then(|a| a.parameters.get(*i as usize)).map(|(_, t)| t)),
            Op::Reading(i) => match self.agent.and_then(|a| a.sensors.get(*i as usize)) {
                Some(p) if p.optional => e.ty == p.ty.clone().optional(),
                Some(p) => e.ty == p.ty,
                None => false,
            },
            Op::Param(i) => is(self.g.params.get(*i as usize).map(|p| &p.ty)),
            Op::Heard(i) => {
                matches!(&e.ty, Type::List(t, _) if self.g.topics.get(*i as usize).is_some_and(|topic| topic.ty == **t))
            }
            Op::Now | Op::Elapsed => quantity(Dim::TIME),
            Op::StepCount => quantity(Dim::STEP),
            Op::Own(Own::Index) => e.ty == Type::Int,
            Op::Own(Own::Start) => e.ty == Type::Pose(Frame::map()),
            Op::Own(Own::Target) => e.ty == Type::Point(Frame::map()),
            Op::Own(Own::Radius | Own::Height) => quantity(Dim::LENGTH),
            Op::Own(Own::CruiseSpeed) => quantity(Dim::VELOCITY),
            Op::Truth(Truth::Pose) => e.ty == Type::Pose(Frame::map()),
            Op::Truth(Truth::PathLength) => quantity(Dim::LENGTH),
            Op::Truth(Truth::Collisions) | Op::Run(Run::Collisions) => e.ty == Type::Int,
            Op::Truth(Truth::InCollision) | Op::Run(Run::InCollision) => e.ty == Type::Bool,
            Op::Believed(a, s) => {
                is(self.g.agents.get(*a as usize).and_then(|a| a.states.get(*s as usize)).map(|s| &s.ty))
            }
            Op::Offering(_) => matches!(&e.ty, Type::List(t, _) if **t == Type::Agent),
            Op::Executed(a, u, which) => {
                let unit = self.g.agents.get(*a as usize).and_then(|a| a.units.get(*u as usize));
                unit.is_some() && e.ty == typing::execution(*which)
            }
            Op::Achieved(i) => e.ty == Type::Bool && (*i as usize) < self.g.goals.len(),
            Op::Quantified(q) => match q {
                Quantifier::Each | Quantifier::Some => e.ty == Type::Bool && body(0),
                Quantifier::Count => e.ty == Type::Int && args == [&Type::Bool],
                _ => args.first().and_then(|t| typing::number(t)).is_some_and(quantity),
            },
            Op::OfRobot(i) => (*i as usize) < self.g.robots.len() && body(0),
            Op::Call(i) => self.g.functions.get(*i as usize).is_some_and(|f| {
                f.body.ty == e.ty
                    && f.parameters.len() == args.len()
                    && f.parameters.iter().zip(&args).all(|((_, t), a)| t == *a)
            }),
            Op::Builtin(f) => {
                let (s, mut b) = (f.signature(), Bindings::default());
                s.parameters.len() == args.len()
                    && s.parameters.iter().zip(&args).all(|(p, t)| p.pattern.matches(t, &mut b))
                    && s.result.instantiate(&b).is_some_and(|t| t == e.ty)
            }
            Op::Sqrt => args.first().and_then(|t| typing::sqrt(t)).is_some_and(|t| t == e.ty),
            Op::Dot => args.len() == 2 && typing::dot(args[0], args[1]).is_some_and(|t| t == e.ty),
            Op::Binary(op) => {
                args.len() == 2
                    && typing::binary(*op, args[0], args[1]).is_some_and(|t| t == e.ty || t.fits(&e.ty))
            }
            Op::Power(n) => args.first().and_then(|t| typing::power(t, *n)).is_some_and(|t| t.fits(&e.ty)),
            Op::Neg => args.first().and_then(|t| typing::negate(t)).is_some_and(|t| t.fits(&e.ty)),
            Op::Not => args == [&Type::Bool] && e.ty == Type::Bool,
            Op::If => args.len() == 3 && *args[0] == Type::Bool && body(1) && body(2),
            Op::Let(l) => args.len() == 2 && self.locals.get(*l as usize) == Some(args[0]) && body(1),
            Op::IfSome { local, .. } => {
                args.len() == 3
                    && matches!(args[0], Type::Option(t) if self.locals.get(*local as usize) == Some(t))
                    && body(1)
                    && body(2)
            }
            Op::Switch { variants, rest } => {
                let known = matches!(args.first(), Some(Type::Enum(n)) if self.g.types.enums.get(n).is_some_and(|d| variants.iter().all(|v| (*v as usize) < d.variants.len())));
                known && args.len() == 1 + variants.len() + usize::from(*rest) && (1..args.len()).all(body)
            }
            Op::MakeRecord => {
                matches!(&e.ty, Type::Record(n) if self.g.types.records.get(n).is_some_and(|r| r.fields.len() == args.len() && r.fields.iter().zip(&args).all(|((_, t), a)| t == *a)))
            }
            Op::Field(i) => {
                matches!(args.first(), Some(Type::Record(n)) if is(self.g.types.records.get(n).and_then(|r| r.fields.get(*i as usize)).map(|(_, t)| t)))
            }
            Op::MakeList => {
                matches!(&e.ty, Type::List(t, n) if args.len() <= *n as usize && args.iter().all(|a| **a == **t))
            }
            Op::MakeVector => {
                args.len() == 3
                    && match &e.ty {
                        Type::Point(_) => args.iter().all(|a| typing::number(a) == Some(Dim::LENGTH)),
                        Type::Vector(_, d) => args.iter().all(|a| typing::number(a) == Some(*d)),
                        _ => false,
                    }
            }
            Op::MakeRange => {
                matches!(&e.ty, Type::Range(d) if args.len() == 2 && args.iter().all(|a| typing::number(a) == Some(*d)))
            }
            Op::MakeMatrix => {
                matches!(&e.ty, Type::Matrix(r, c) if args.len() == usize::from(*r) * usize::from(*c) && args.iter().all(|a| **a == Type::NUMBER))
            }
            Op::MakeSome => matches!(&e.ty, Type::Option(t) if args == [&**t]),
            Op::MakeNone(_) => matches!(e.ty, Type::Option(_)),
            Op::Part(p) => args.first().is_some_and(|t| {
                typing::parts_of(t)
                    .iter()
                    .filter_map(|n| typing::part(t, n))
                    .any(|(q, ty)| q == *p && ty == e.ty)
            }),
            Op::List(op, l) => self.list(*op, *l, &args, &e.ty),
            Op::Fold(a, l) => {
                args.len() == 3
                    && matches!(args[0], Type::List(t, _) if self.locals.get(*l as usize) == Some(t))
                    && self.locals.get(*a as usize) == Some(args[1])
                    && body(1)
                    && body(2)
            }
            Op::Transpose => {
                matches!((args.first(), &e.ty), (Some(Type::Matrix(r, c)), Type::Matrix(x, y)) if r == y && c == x)
            }
            Op::Inverse => args.first().is_some_and(|t| {
                matches!(t, Type::Matrix(r, c) if r == c) && e.ty == (*t).clone().optional()
            }),
            Op::Item(r, c) => {
                matches!(args.first(), Some(Type::Matrix(x, y)) if r < x && c < y) && e.ty == Type::NUMBER
            }
        }
    }

    fn list(&self, op: ListOp, local: u32, args: &[&Type], ty: &Type) -> bool {
        let [Type::List(item, n), body] = args else { return false };
        if self.locals.get(local as usize) != Some(item) {
            return false;
        }
        match op {
            ListOp::Map => *ty == Type::List(Box::new((*body).clone()), *n),
            ListOp::Filter => **body == Type::Bool && ty == args[0],
            ListOp::Any | ListOp::All => **body == Type::Bool && *ty == Type::Bool,
            ListOp::Count => **body == Type::Bool && *ty == Type::Int,
            ListOp::Find => **body == Type::Bool && *ty == Type::Option(item.clone()),
            ListOp::MinBy | ListOp::MaxBy => {
                typing::number(body).is_some() && *ty == Type::Option(item.clone())
            }
        }
    }
}

fn name(op: &Op) -> String {
    let text = format!("{op:?}");
    text.split(['(', ' ', '{']).next().unwrap_or_default().to_lowercase()
}

/// Whether a value is one of type `t`.
fn is_a(v: &Value, t: &Type, g: &Graph) -> bool {
    match (v, t) {
        (Value::Int(i), Type::Handle(_) | Type::Agent | Type::Conversation(_)) => *i >= 0,
        (Value::Text(_), Type::Text) => true,
        (Value::Bool(_), Type::Bool) | (Value::Int(_), Type::Int) => true,
        (Value::Number(x), Type::Quantity(_) | Type::Heading(_)) => x.is_finite(),
        (Value::Variant(n), Type::Enum(e)) => g.types.enums.get(e).is_some_and(|e| e.variants.contains(n)),
        (Value::None(_), Type::Option(_)) => true,
        (Value::Some(v), Type::Option(t)) => is_a(v, t, g),
        (Value::List(items), Type::List(t, n)) => {
            items.len() <= *n as usize && items.iter().all(|v| is_a(v, t, g))
        }
        (Value::Record(items), Type::Record(n)) => g.types.records.get(n).is_some_and(|r| {
            r.fields.len() == items.len() && items.iter().zip(&r.fields).all(|(v, (_, t))| is_a(v, t, g))
        }),
        (Value::Vector(v), Type::Point(_) | Type::Vector(..)) => v.iter().all(|x| x.is_finite()),
        (Value::Pose(v), Type::Pose(_)) => v.iter().all(|x| x.is_finite()),
        (Value::Twist(v), Type::Twist) => v.iter().all(|x| x.is_finite()),
        (Value::Range(a, b), Type::Range(_)) => a.is_finite() && b.is_finite(),
        (Value::Distribution(_), Type::Distribution(_)) => true,
        (Value::Matrix(m), Type::Matrix(r, c)) => m.len() == usize::from(*r) * usize::from(*c),
        _ => false,
    }
}
