//! A mission: members in the order in which later ones may refer to earlier ones.

use crate::{
    ast::{self, MissionMember as M},
    code,
    decls::{Decls, unknown},
    modules::{EDITION, Program},
    typed::{Body, Checker, Place},
};
use soifra_graph::{
    Component, Diagnostic, Expr, Graph, Metric, Name, Param, RobotGroup, SCHEMA, Span, Type, Value,
    component::{FAULT_ROLES, NAMED_ROLES, WORLD_ROLES},
    typing,
};
use std::collections::BTreeMap;

/// What the user chose at the command line.
#[derive(Debug, Clone, Default)]
pub struct Choice {
    /// Platform for every robot.
    pub platform: Option<String>,
    /// Which platform of `any of […]`, counted from 0; robots that name fewer keep their first.
    pub alternative: usize,
    /// Mission, when a file has several; the first otherwise.
    pub mission: Option<String>,
    /// Test whose faults are the mission's too.
    pub test: Option<String>,
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
    c.conversations(program);
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
            conversations: Default::default(),
            topic_capacity: Vec::new(),
            agent: Default::default(),
            agents: Default::default(),
            robots: Default::default(),
            goals: Default::default(),
            pursuable: None,
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

    pub(super) fn lower_agents(&mut self) {
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
        let faults = self.faults(m, choice);
        self.pursuable = Some(
            m.members
                .iter()
                .filter_map(|x| match x {
                    M::Goal(g) => Some((g.name.clone(), g.on_request)),
                    _ => None,
                })
                .collect(),
        );
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
        self.distinct(m.members.iter().filter_map(|x| match x {
            M::Robot(r) => Some(&r.name),
            M::Host(h) => Some(&h.name),
            _ => None,
        }));
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
                self.known_robot(&g);
                robots.push(g);
            }
        }
        // Those without a body come after all that have one.
        for member in &m.members {
            if let M::Host(h) = member {
                let Some(g) = self.host(h, &index, &mut platforms) else {
                    self.poison(&h.name.name);
                    continue;
                };
                self.known_robot(&g);
                robots.push(g);
            }
        }
        let step =
            self.single(m, "clock step", |x| if let M::Clock(e) = x { Some((e, e.span)) } else { None });
        let step = step.and_then(|e| self.start_duration(e));
        let (goals, plans) = self.goals(m, &index);
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
                    let value = match &k.value {
                        Some(value) => self.truth_expr(value, None, false),
                        None => Some(Expr::constant(Value::Int(1), Type::Int, k.name.span)),
                    };
                    let samples = k.samples.as_ref().map(|s| self.samples(s));
                    let (Some(value), false) = (value, matches!(samples, Some(None))) else { continue };
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
                    metrics.push(Metric {
                        name: k.name.name.clone(),
                        value,
                        samples: samples.flatten(),
                        at: k.name.span,
                    });
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
            conversations: std::mem::take(&mut self.conversations).into_items(),
            agents: std::mem::take(&mut self.agents).into_items(),
            robots,
            step,
            goals,
            plans,
            faults,
            done: done?,
            within,
            expects,
            metrics,
        })
    }

    /// What goes wrong on purpose: in the mission, and in the test that is chosen.
    fn faults(&mut self, m: &'a ast::Mission, choice: &Choice) -> Vec<Component> {
        let of_mission = m.members.iter().filter_map(|x| match x {
            M::Entry(e) if FAULT_ROLES.contains(&&*e.role.name) => Some(e),
            _ => None,
        });
        let test = self.decls.tests.iter().find(|t| choice.test.as_deref() == Some(&*t.name.name));
        let of_test = test.into_iter().flat_map(|t| &t.faults);
        let all: Vec<&ast::Entry> = of_mission.chain(of_test).collect();
        all.into_iter().filter_map(|e| self.component(e, FAULT_ROLES)).collect()
    }

    /// Conditions may ask for it by name.
    fn known_robot(&mut self, g: &RobotGroup) {
        let agents = g.agents.iter().map(|b| b.agent).collect();
        self.robots.push((g.name.clone(), g.count.is_some(), agents));
    }

    /// The one member that `pick` finds; a second one is reported.
    pub(super) fn single<T: Copy>(
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
                    .hint(match what {
                        "within" => {
                            "remove one of them; of expectations, only `eventually` and `leads to` have a time limit"
                        }
                        _ => "remove one of them",
                    }),
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
                M::Entry(e) if !FAULT_ROLES.contains(&&*e.role.name) => entries.push(e),
                _ => {}
            }
        }
        self.distinct(entries.iter().filter_map(|e| e.name.as_ref()));
        self.alone(&entries);
        let mut out = Vec::new();
        for e in entries {
            match (self.component(e, &[WORLD_ROLES, FAULT_ROLES].concat()), &e.name) {
                (Some(c), _) => out.push(c),
                (None, Some(n)) => self.poison(&n.name),
                (None, None) => {}
            }
        }
        out
    }
}

impl Checker<'_> {
    /// Entries without a name are there once: a mission that takes a world cannot have a second light or current.
    fn alone(&mut self, entries: &[&ast::Entry]) {
        let nameless = |e: &&&ast::Entry| {
            let role = &*e.role.name;
            WORLD_ROLES.contains(&role) && !NAMED_ROLES.contains(&role)
        };
        let mut seen: BTreeMap<&str, Span> = BTreeMap::new();
        for e in entries.iter().filter(nameless) {
            let Some(first) = seen.insert(&e.role.name, e.span) else { continue };
            let title = format!("the world of a mission has one `{}`", e.role.name);
            self.report(
                Diagnostic::error(code::DUPLICATE, title)
                    .at(e.span, "the second")
                    .at(first, "the first")
                    .hint("remove one, or write `world … extends …`, whose entries take the place of those of the other"),
            );
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
