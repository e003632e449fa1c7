//! A mission: members in the order in which later ones may refer to earlier ones.

use crate::{
    ast::{self, ExpectKind as E, MissionMember as M},
    code,
    decls::{Decls, unknown},
    modules::{EDITION, Program},
    typed::{Body, Checker, Place},
};
use soifra_graph::{
    Component, Diagnostic, Dim, ExpectKind, Expectation, Expr, Goal, Graph, Metric, Name, Op, Param,
    RobotGroup, SCHEMA, Span, SubGoal, Topic, Type, Value, component::WORLD_ROLES, typing,
};
use std::collections::{BTreeMap, BTreeSet};

/// What the user chose at the command line.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Platform for every robot.
    pub platform: Option<String>,
    /// Which platform of `any of […]`, counted from 0; robots that name fewer keep their first.
    pub alternative: usize,
    /// Mission, when a file has several; the first otherwise.
    pub mission: Option<String>,
}

/// Lowers a mission, or, when there is none, checks every declaration by itself.
pub fn lower(
    program: &Program,
    decls: &Decls<'_>,
    choice: &Choice,
    errors: &mut Vec<Diagnostic>,
) -> Option<Graph> {
    let mut c = Checker::new(decls);
    c.types();
    let root = decls.missions.iter().filter(|(file, _)| *file == 0);
    let mission = match &choice.mission {
        Some(name) => decls.missions.iter().find(|(_, m)| *m.name.name == **name).map(|(_, m)| *m),
        None => root.clone().next().map(|(_, m)| *m),
    };
    let params = c.params(mission);
    c.interfaces_and_services(mission);
    c.topics();
    let graph = match mission {
        Some(m) => c.mission(program, m, choice, params),
        None => {
            c.lone_items();
            None
        }
    };
    c.unused_constants();
    let failed = !c.errors.is_empty();
    c.drop_consequences(program);
    errors.append(&mut c.errors);
    if failed { None } else { graph }
}

impl<'a> Checker<'a> {
    fn new(decls: &'a Decls<'a>) -> Self {
        Checker {
            decls,
            errors: Vec::new(),
            types: Default::default(),
            variants: BTreeMap::new(),
            texts: Default::default(),
            params: Default::default(),
            services: BTreeMap::new(),
            functions: Vec::new(),
            function_index: BTreeMap::new(),
            broken: Default::default(),
            topics: Default::default(),
            topic_capacity: Vec::new(),
            agent: Default::default(),
            agents: Default::default(),
            robots: Default::default(),
            goals: Default::default(),
            mission_lets: BTreeMap::new(),
            regions: Default::default(),
            body: Body::new(Place::Constant),
            used_constants: Default::default(),
            written_statements: 0,
            expanding: Vec::new(),
            depth: 0,
            poisoned: Default::default(),
            written_out: 0,
            too_much: false,
        }
    }

    /// Constants that nothing uses are still checked, as far as they can be without a place of use.
    fn unused_constants(&mut self) {
        for (name, c) in &self.decls.constants {
            if !self.used_constants.contains(name) && !self.poisoned.contains_key(name) {
                self.agent = Default::default();
                self.in_body(Body::new(Place::Scene), |s| s.expr(&c.value, None));
            }
        }
    }

    /// Drops errors about names whose declaration is wrong itself, when that has been reported.
    fn drop_consequences(&mut self, program: &Program) {
        let poisoned = &self.poisoned;
        let mut at = 0;
        self.errors.retain(|d| {
            at += 1;
            let by_name = matches!(
                d.code,
                code::UNKNOWN_NAME | code::UNKNOWN_FIELD | code::UNKNOWN_TYPE | code::ARGUMENTS
            );
            !(by_name && poisoned.get(program.text(d.position())).is_some_and(|before| at > *before))
        });
    }

    /// Enums, then records in an order that finds rings.
    fn types(&mut self) {
        for (name, e) in &self.decls.enums {
            self.distinct(e.variants.iter());
            let variants = e.variants.iter().map(|v| v.name.clone()).collect();
            self.add_enum(name, variants);
        }
        for name in self.decls.records.keys() {
            self.types
                .records
                .insert(name.clone(), soifra_graph::Record { name: name.clone(), fields: Vec::new() });
        }
        for (name, r) in &self.decls.records {
            self.distinct(r.fields.iter().map(|(n, _)| n));
            let mut fields = Vec::new();
            for (n, t) in &r.fields {
                match self.resolve_type(t, None) {
                    Some(ty) => fields.push((n.name.clone(), ty)),
                    None => self.poison(&n.name),
                }
            }
            self.types.records.insert(name.clone(), soifra_graph::Record { name: name.clone(), fields });
        }
        for (name, r) in &self.decls.records {
            if self.holds_itself(name) {
                let d = Diagnostic::error(code::RECURSION, format!("record `{name}` holds itself"))
                    .at(r.name.span, "its size would have no end")
                    .hint("take the field out that leads back");
                self.report(d);
                r.fields.iter().for_each(|(n, _)| self.poison(&n.name));
                self.types
                    .records
                    .insert(name.clone(), soifra_graph::Record { name: name.clone(), fields: Vec::new() });
            }
        }
    }

    /// Whether a record holds itself, directly or through others.
    fn holds_itself(&self, name: &Name) -> bool {
        fn inside(t: &Type, out: &mut Vec<Name>) {
            match t {
                Type::Record(n) => out.push(n.clone()),
                Type::List(t, _) | Type::Option(t) => inside(t, out),
                _ => {}
            }
        }
        let mut seen: BTreeSet<Name> = BTreeSet::new();
        let mut waiting = vec![name.clone()];
        while let Some(outer) = waiting.pop() {
            let mut parts = Vec::new();
            if let Some(r) = self.types.records.get(&outer) {
                r.fields.iter().for_each(|(_, t)| inside(t, &mut parts));
            }
            if parts.contains(name) {
                return true;
            }
            waiting.extend(parts.into_iter().filter(|p| seen.insert(p.clone())));
        }
        false
    }

    fn params(&mut self, mission: Option<&'a ast::Mission>) -> Vec<Param> {
        let own = mission
            .into_iter()
            .flat_map(|m| &m.members)
            .filter_map(|m| if let M::Param(p) = m { Some(p) } else { None });
        let list: Vec<&ast::Param> = self.decls.params.iter().copied().chain(own).collect();
        self.distinct(list.iter().map(|p| &p.name));
        if let Some(m) = mission {
            for member in &m.members {
                if let M::Constant(k) = member {
                    self.mission_lets.insert(k.name.name.clone(), k);
                }
            }
        }
        // Service parameters need the list of implementations before their default is looked up.
        for name in self.decls.interfaces.keys() {
            let variants = self
                .decls
                .function_order
                .iter()
                .filter(|f| self.decls.functions[*f].implements.as_ref().is_some_and(|i| i.name == *name))
                .cloned()
                .collect();
            self.add_enum(name, variants);
        }
        let mut out = Vec::new();
        for p in list {
            let ty = match &p.ty {
                Some(t) => match self.resolve_type(t, Some(&p.name)) {
                    Some(ty) => Some(ty),
                    None => {
                        self.poison(&p.name.name);
                        continue;
                    }
                },
                None => None,
            };
            let (value, _) = self.in_body(Body::new(Place::Constant), |c| match &ty {
                Some(t) => c.typed(&p.value, t),
                None => c.expr(&p.value, None),
            });
            let Some(value) = value else {
                // The name stays known, so that its uses are not errors of their own.
                match ty {
                    Some(ty) => self.params.push((p.name.name.clone(), ty, p.name.span)),
                    None => self.poison(&p.name.name),
                }
                continue;
            };
            let ty = value.ty.clone();
            let Some(default) = self.fold_constant(&value, "a parameter's default") else {
                self.params.push((p.name.name.clone(), ty, p.name.span));
                continue;
            };
            if let Some(ast::TypeRef { kind: ast::TypeKind::Service(i), .. }) = &p.ty {
                self.services.insert(self.params.len() as u32, i.name.clone());
            }
            self.params.push((p.name.name.clone(), ty.clone(), p.name.span));
            out.push(Param { name: p.name.name.clone(), ty, default, at: p.name.span });
        }
        out
    }

    fn interfaces_and_services(&mut self, _: Option<&'a ast::Mission>) {
        self.interfaces();
        // Every function is lowered, used or not: mistakes show at once.
        for (name, f) in &self.decls.functions {
            let before = self.errors.len();
            self.function(name, f.name.span);
            self.forget_repeated(before);
        }
    }

    fn topics(&mut self) {
        for t in self.decls.topics.clone() {
            let known = self.topics.len();
            self.topic(t);
            if self.topics.len() == known {
                self.poison(&t.name.name);
            }
        }
    }

    fn topic(&mut self, t: &'a ast::Topic) {
        let Some(ty) = self.resolve_type(&t.ty, None) else { return };
        if !matches!(ty, Type::Record(_)) {
            self.report(
                Diagnostic::error(code::MISMATCH, format!("messages are records, this is {ty}"))
                    .at(t.ty.span, ty.to_string())
                    .hint("declare a `record` with the fields of the message"),
            );
            return;
        }
        let channel: ast::Ident = ast::Ident { name: "channel".into(), span: t.name.span };
        let (model, args): (&ast::Ident, &[ast::Arg]) = match &t.channel {
            Some((m, a)) => (m, a),
            None => (&channel, &[]),
        };
        let Some(channel) =
            self.channel(&"topic".into(), t.name.name.clone(), None, model, args, t.name.span)
        else {
            return;
        };
        let capacity = match channel.args.iter().find(|(n, _)| &**n == "capacity") {
            Some((_, e)) => match self.fold_constant(e, "the capacity of a topic") {
                Some(Value::Int(n)) if (1..=1024).contains(&n) => n as u32,
                Some(_) => {
                    self.report(
                        Diagnostic::error(code::RANGE, "a capacity out of range")
                            .at(e.span, "1 to 1024 are possible")
                            .hint("how many senders are heard at most?"),
                    );
                    return;
                }
                None => return,
            },
            None => 16,
        };
        self.topics.push(Topic { ty, channel });
        self.topic_capacity.push(capacity);
    }

    /// Everything in files without a mission: agents, profiles and worlds stand by themselves.
    fn lone_items(&mut self) {
        self.lower_agents();
        for p in self.decls.platforms.values() {
            self.profile(p);
        }
        for w in self.decls.worlds.values() {
            for e in self.extended(w, true) {
                self.component(e, WORLD_ROLES);
            }
        }
    }

    fn lower_agents(&mut self) {
        for a in self.decls.agents.clone() {
            let lowered = self.agent(a);
            self.agents.push(lowered);
        }
    }

    fn mission(
        &mut self,
        program: &Program,
        m: &'a ast::Mission,
        choice: &Choice,
        params: Vec<Param>,
    ) -> Option<Graph> {
        let world = self.world(m);
        self.regions = world.iter().filter(|c| &*c.role == "region").map(|c| c.name.clone()).collect();
        self.lower_agents();
        let index: BTreeMap<Name, u32> =
            self.agents.iter().enumerate().map(|(i, a)| (a.name.clone(), i as u32)).collect();
        let replaced =
            choice.platform.as_ref().map(|p| ast::Ident { name: p.as_str().into(), span: m.name.span });
        if let Some(p) = &replaced
            && !self.decls.platforms.contains_key(&p.name)
        {
            let d = unknown(
                code::UNKNOWN_PLATFORM,
                "platform",
                &p.name,
                m.name.span,
                self.decls.platforms.keys().map(|k| &**k),
            );
            self.report(d);
            return None;
        }
        let mut platforms = Vec::new();
        let mut robots: Vec<RobotGroup> = Vec::new();
        self.distinct(
            m.members.iter().filter_map(|x| if let M::Robot(r) = x { Some(&r.name) } else { None }),
        );
        for member in &m.members {
            if let M::Robot(r) = member {
                let Some(g) = self.robot(
                    r,
                    choice_of(r, replaced.as_ref(), choice.alternative),
                    &index,
                    &mut platforms,
                ) else {
                    self.poison(&r.name.name);
                    continue;
                };
                {
                    self.robots.push((
                        g.name.clone(),
                        g.count.is_some(),
                        g.agents.iter().map(|b| b.agent).collect(),
                    ));
                    robots.push(g);
                }
            }
        }
        let step =
            self.single(m, "clock step", |x| if let M::Clock(e) = x { Some((e, e.span)) } else { None });
        let step = step.and_then(|e| self.start_duration(e));
        let goals = self.goals(m, &index);
        let done = self.done(m, &goals);
        let within = self.single(m, "within", |x| if let M::Within(e, s) = x { Some((e, *s)) } else { None });
        let within = within.and_then(|e| self.limit(e));
        let mut expects = Vec::new();
        let mut metrics: Vec<Metric> = Vec::new();
        self.distinct(
            m.members.iter().filter_map(|x| if let M::Metric(k) = x { Some(&k.name) } else { None }),
        );
        for member in &m.members {
            match member {
                M::Expect(e) => expects.extend(self.expectation(program, e)),
                M::Metric(k) => {
                    let Some(value) = self.truth_expr(&k.value, None, false) else { continue };
                    if typing::number(&value.ty).is_none() && value.ty != Type::Bool {
                        self.report(
                            Diagnostic::error(
                                code::MISMATCH,
                                format!("a metric is a number, this is {}", value.ty),
                            )
                            .at(value.span, value.ty.to_string())
                            .hint("take a part such as `.x`, or a norm; robots are combined with `mean robot: …`, `most robot: …`"),
                        );
                        continue;
                    }
                    metrics.push(Metric { name: k.name.name.clone(), value, at: k.name.span });
                }
                M::Constant(k) => {
                    let before = self.errors.len();
                    self.in_body(Body::new(Place::Truth), |c| c.expr(&k.value, None));
                    self.forget_repeated(before);
                }
                _ => {}
            }
        }
        self.needs_target(&robots);
        Some(Graph {
            schema: SCHEMA,
            edition: EDITION,
            name: m.name.name.clone(),
            title: m.title.clone().unwrap_or_default(),
            sources: program.sources.clone(),
            types: std::mem::take(&mut self.types),
            texts: std::mem::take(&mut self.texts),
            params,
            functions: std::mem::take(&mut self.functions),
            world,
            platforms,
            topics: std::mem::take(&mut self.topics).into_items(),
            agents: std::mem::take(&mut self.agents).into_items(),
            robots,
            step,
            goals,
            done: done?,
            within,
            expects,
            metrics,
        })
    }

    /// The one member that `pick` finds; a second one is reported.
    fn single<T: Copy>(
        &mut self,
        m: &'a ast::Mission,
        what: &str,
        pick: impl Fn(&'a M) -> Option<(T, Span)>,
    ) -> Option<T> {
        let mut found = m.members.iter().filter_map(pick);
        let (first, at) = found.next()?;
        if let Some((_, second)) = found.next() {
            self.report(
                Diagnostic::error(code::DUPLICATE, format!("a mission has one `{what}`"))
                    .at(second, "the second")
                    .at(at, "the first")
                    .hint("remove one of them"),
            );
        }
        Some(first)
    }

    fn world(&mut self, m: &'a ast::Mission) -> Vec<Component> {
        let mut entries: Vec<&ast::Entry> = Vec::new();
        for member in &m.members {
            match member {
                M::World(name) => match self.decls.worlds.get(&name.name).copied() {
                    Some(w) => entries.extend(self.extended(w, true)),
                    None => {
                        let d = unknown(
                            code::UNKNOWN_NAME,
                            "world",
                            &name.name,
                            name.span,
                            self.decls.worlds.keys().map(|k| &**k),
                        );
                        self.report(d);
                    }
                },
                M::Entry(e) => entries.push(e),
                _ => {}
            }
        }
        self.distinct(entries.iter().filter_map(|e| e.name.as_ref()));
        let mut out = Vec::new();
        for e in entries {
            match (self.component(e, WORLD_ROLES), &e.name) {
                (Some(c), _) => out.push(c),
                (None, Some(n)) => self.poison(&n.name),
                (None, None) => {}
            }
        }
        out
    }

    fn goals(&mut self, m: &'a ast::Mission, agents: &BTreeMap<Name, u32>) -> Vec<Goal> {
        self.distinct(m.members.iter().filter_map(|x| if let M::Goal(g) = x { Some(&g.name) } else { None }));
        let mut out = Vec::new();
        for member in &m.members {
            let M::Goal(g) = member else { continue };
            self.goals.push(g.name.name.clone());
            self.distinct(g.subgoals.iter().map(|s| &s.name));
            let mut subgoals = Vec::new();
            for s in &g.subgoals {
                let Some(i) = agents.get(&s.agent.name) else {
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        "agent",
                        &s.agent.name,
                        s.agent.span,
                        agents.keys().map(|k| &**k),
                    );
                    self.report(d);
                    continue;
                };
                let achieved = match &s.achieved {
                    Some(e) => {
                        self.enter_agent(*i);
                        let (value, _) = self.in_body(Body::new(Place::Belief), |c| c.typed(e, &Type::Bool));
                        match value {
                            Some(v) => Some(v),
                            None => continue,
                        }
                    }
                    None => None,
                };
                subgoals.push(SubGoal { name: s.name.name.clone(), agent: *i, achieved, at: s.name.span });
            }
            out.push(Goal { name: g.name.name.clone(), subgoals, at: g.name.span });
        }
        out
    }

    /// Makes an agent's states and parameters nameable.
    fn enter_agent(&mut self, i: u32) {
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
    fn truth_expr(&mut self, e: &ast::Expr, want: Option<&Type>, each: bool) -> Option<Expr> {
        self.agent = Default::default();
        let mut body = Body::new(Place::Truth);
        body.of_robot = each;
        self.in_body(body, |c| match want {
            Some(t) => c.typed(e, t),
            None => c.expr(e, None),
        })
        .0
    }

    fn done(&mut self, m: &'a ast::Mission, goals: &[Goal]) -> Option<Expr> {
        if let Some(e) =
            self.single(m, "done when", |x| if let M::Done(e, s) = x { Some((e, *s)) } else { None })
        {
            return self.truth_expr(e, Some(&Type::Bool), false);
        }
        // Nothing said: done when every goal is achieved.
        let span = m.name.span;
        let all = (0..goals.len() as u32).map(|i| Expr::new(Op::Achieved(i), Vec::new(), Type::Bool, span));
        Some(
            all.reduce(|a, b| Expr::new(Op::Binary(soifra_graph::Binary::And), vec![a, b], Type::Bool, span))
                .unwrap_or_else(|| Expr::constant(Value::Bool(false), Type::Bool, span)),
        )
    }

    /// A time limit: a duration or a number of steps.
    fn limit(&mut self, e: &ast::Expr) -> Option<Expr> {
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

    fn expectation(&mut self, program: &Program, e: &ast::Expect) -> Option<Expectation> {
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
    fn optional_limit(&mut self, e: Option<&ast::Expr>) -> Option<Option<Expr>> {
        match e {
            Some(e) => Some(Some(self.limit(e)?)),
            None => Some(None),
        }
    }
}

/// The platform a robot takes.
fn choice_of<'r>(
    r: &'r ast::Robot,
    replaced: Option<&'r ast::Ident>,
    alternative: usize,
) -> Option<&'r ast::Ident> {
    replaced.or_else(|| r.platforms.get(alternative).or_else(|| r.platforms.first()))
}
