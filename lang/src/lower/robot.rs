//! Robots and the platforms they are instances of.

use crate::{
    ast, code,
    decls::unknown,
    typed::{Body, Checker, Place},
};
use soifra_graph::{
    AgentBinding, Diagnostic, Dim, Expr, Frame, Name, Op, Own, Platform, RobotGroup, Type, Unfit, Value,
    component::PLATFORM_ROLES,
};
use std::collections::BTreeMap;

/// What the platform without parts is called.
const HOST: &str = "host";

impl<'a> Checker<'a> {
    /// Lowers a platform profile by name, once.
    pub fn platform(&mut self, name: &ast::Ident, done: &mut Vec<Platform>) -> Option<u32> {
        if let Some(i) = done.iter().position(|p| p.name == name.name) {
            return Some(i as u32);
        }
        let Some(profile) = self.decls.platforms.get(&name.name).copied() else {
            let d = unknown(
                code::UNKNOWN_PLATFORM,
                "platform",
                &name.name,
                name.span,
                self.decls.platforms.keys().map(|k| &**k),
            );
            self.report(d);
            return None;
        };
        let p = self.profile(profile);
        done.push(p);
        Some((done.len() - 1) as u32)
    }

    /// Lowers a profile.
    pub fn profile(&mut self, profile: &'a ast::Profile) -> Platform {
        let entries = self.extended(profile, false);
        let components = entries.into_iter().filter_map(|e| self.component(e, PLATFORM_ROLES)).collect();
        Platform { name: profile.name.name.clone(), components, at: profile.name.span }
    }

    /// Lowers a robot on the platform `chosen`.
    pub fn robot(
        &mut self,
        r: &'a ast::Robot,
        chosen: Option<&ast::Ident>,
        agents: &BTreeMap<Name, u32>,
        done: &mut Vec<Platform>,
    ) -> Option<RobotGroup> {
        let count = self.array_size(r.count.as_ref())?;
        let chosen = chosen?;
        let index = self.platform(chosen, done);
        for other in &r.platforms {
            if other.name != chosen.name && !self.decls.platforms.contains_key(&other.name) {
                let d = unknown(
                    code::UNKNOWN_PLATFORM,
                    "platform",
                    &other.name,
                    other.span,
                    self.decls.platforms.keys().map(|k| &**k),
                );
                self.report(d);
            }
        }
        let start = self.scene(&r.name, r.count.is_some(), |c| c.start_pose(&r.at));
        let target = match &r.target {
            Some(t) => {
                Some(self.scene(&r.name, r.count.is_some(), |c| c.typed(t, &Type::Point(Frame::map())))?)
            }
            None => None,
        };
        let scatter = match &r.scatter {
            Some(s) => Some(
                self.scene(&r.name, r.count.is_some(), |c| c.typed(s, &Type::Distribution(Dim::LENGTH)))?,
            ),
            None => None,
        };
        let mut bindings = self.bindings(&r.name, r.count.is_some(), &r.runs, agents)?;
        let unfit = match index.and_then(|i| done.get(i as usize)) {
            Some(p) => self.unfit(p, &mut bindings),
            None => Vec::new(),
        };
        Some(RobotGroup {
            name: r.name.name.clone(),
            count,
            platform: index?,
            alternatives: r
                .platforms
                .iter()
                .filter(|p| p.name != chosen.name)
                .map(|p| p.name.clone())
                .collect(),
            start: start?,
            scatter,
            target,
            agents: bindings,
            unfit,
            host: false,
            at: r.name.span,
        })
    }

    /// Lowers a host: a place for agents without a body.
    pub fn host(
        &mut self,
        h: &'a ast::Host,
        agents: &BTreeMap<Name, u32>,
        done: &mut Vec<Platform>,
    ) -> Option<RobotGroup> {
        let count = self.array_size(h.count.as_ref())?;
        let bindings = self.bindings(&h.name, count.is_some(), &h.runs, agents)?;
        let bare = done.iter().position(|p| *p.name == *HOST && p.components.is_empty());
        let platform = bare.unwrap_or_else(|| {
            done.push(Platform { name: HOST.into(), components: Vec::new(), at: h.name.span });
            done.len() - 1
        });
        let nowhere = Value::Pose([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        Some(RobotGroup {
            name: h.name.name.clone(),
            count,
            platform: platform as u32,
            alternatives: Vec::new(),
            start: Expr::constant(nowhere, Type::Pose(Frame::map()), h.name.span),
            scatter: None,
            target: None,
            agents: bindings,
            unfit: Vec::new(),
            host: true,
            at: h.name.span,
        })
    }

    #[allow(
        clippy::option_option,
        reason = "outer: whether it could be lowered, inner: whether it is there; 2026-11"
    )]
    fn array_size(&mut self, count: Option<&ast::Expr>) -> Option<Option<Expr>> {
        match count {
            Some(c) => Some(Some(self.in_body(Body::new(Place::Start), |s| s.typed(c, &Type::Int)).0?)),
            None => Some(None),
        }
    }

    /// Something said of each robot of an array, or of a single one.
    fn scene<T>(&mut self, robot: &ast::Ident, array: bool, f: impl FnOnce(&mut Self) -> T) -> T {
        let mut body = Body::new(Place::Scene);
        if array {
            body.bind(&ast::Ident { name: "index".into(), span: robot.span }, &Type::Int);
        } else {
            // Local 0 is the index in every scene expression; a single robot has no name for it.
            body.local(&Type::Int);
        }
        self.in_body(body, f).0
    }

    /// The agents that a robot or host runs.
    fn bindings(
        &mut self,
        robot: &ast::Ident,
        array: bool,
        runs: &'a [(ast::Ident, Vec<ast::Arg>)],
        agents: &BTreeMap<Name, u32>,
    ) -> Option<Vec<AgentBinding>> {
        let mut bindings: Vec<AgentBinding> = Vec::new();
        for (agent, args) in runs {
            let Some(i) = agents.get(&agent.name) else {
                let known = agents.keys().map(|k| &**k);
                let d = unknown(code::UNKNOWN_NAME, "agent", &agent.name, agent.span, known);
                self.report(d);
                continue;
            };
            if let Some(first) = bindings.iter().find(|b| b.agent == *i) {
                self.report(
                    Diagnostic::error(
                        code::EXCLUSIVE,
                        format!("`{}` runs `{}` twice", robot.name, agent.name),
                    )
                    .at(agent.span, "the second")
                    .at(first.at, "the first")
                    .hint("an agent runs once on a robot; give the second another agent"),
                );
                continue;
            }
            let params = self.agents[*i as usize].parameters.clone();
            let arguments = self.scene(robot, array, |c| c.arguments(agent, &params, args, agent.span))?;
            bindings.push(AgentBinding { agent: *i, arguments, at: agent.span });
        }
        Some(bindings)
    }

    /// Takes out the agents that are allocated and whose ports the platform does not have: they cannot be.
    fn unfit(&self, p: &Platform, bindings: &mut Vec<AgentBinding>) -> Vec<Unfit> {
        let mut out = Vec::new();
        bindings.retain(|b| {
            let a = &self.agents[b.agent as usize];
            if a.offers.iter().all(|o| o.unit.is_none()) {
                return true;
            }
            let ports = a.sensors.iter().map(|s| ("sensor", s));
            let ports = ports.chain(a.actuators.iter().map(|s| ("actuator", s)));
            let lacks = ports.into_iter().find(|(role, port)| {
                let has = p.of_role(role).find(|c| c.name == port.name);
                !has.and_then(|c| c.ty.as_ref()).is_some_and(|t| t.serves(&port.ty))
            });
            if let Some((role, port)) = lacks {
                out.push(Unfit { agent: b.agent, role: role.into(), port: port.name.clone(), at: b.at });
            }
            lacks.is_none()
        });
        out
    }

    /// A pose, or a point with the heading to the east.
    fn start_pose(&mut self, e: &ast::Expr) -> Option<Expr> {
        let pose = Type::Pose(Frame::map());
        let value = self.expr(e, Some(&pose))?;
        if value.ty == Type::Point(Frame::map()) {
            let span = value.span;
            let east = Expr::constant(Value::Number(0.0), Type::Heading(Frame::map()), span);
            return Some(Expr::new(
                Op::Builtin(soifra_graph::Function::PoseAt),
                vec![value, east],
                pose,
                span,
            ));
        }
        self.coerce(value, &pose)
    }

    /// The robot's target must exist where something asks for it.
    pub fn needs_target(&mut self, robots: &[RobotGroup]) {
        let mut asked = None;
        let mut look = |e: &Expr| {
            if e.op == Op::Own(Own::Target) && asked.is_none() {
                asked = Some(e.span);
            }
        };
        for a in self.agents.iter() {
            crate::check::walk::agent(a, &mut look);
        }
        let Some(at) = asked else { return };
        for r in robots.iter().filter(|r| r.target.is_none() && !r.host) {
            let runs = r.agents.iter().any(|b| {
                let mut uses = false;
                if let Some(a) = self.agents.get(b.agent as usize) {
                    crate::check::walk::agent(a, &mut |e| uses |= e.op == Op::Own(Own::Target));
                }
                uses
            });
            if runs {
                self.errors.push(
                    Diagnostic::error(code::MISSING_MEMBER, format!("`{}` has no target", r.name))
                        .at(r.at, "no `to` here")
                        .at(at, "asked for here")
                        .hint("write where it is going: `at START to TARGET`"),
                );
            }
        }
    }
}
