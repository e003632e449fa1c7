//! What a bare name means.

use super::{Body, Checker, Place};
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{
    Diagnostic, Dim, Execution, Expr as GExpr, Name, Op, Own, Run, Span, Stmt as GStmt,
    StmtKind as GStmtKind, Truth, Type, Value,
};

/// What a robot knows of itself.
const OWN: [&str; 6] = ["index", "start", "target", "radius", "height", "cruise_speed"];

/// Most expression nodes that the constants of a program may be written out to.
const MAX_WRITTEN_OUT: usize = 4_000_000;

impl<'a> Checker<'a> {
    /// The value of a bare name.
    pub fn name(&mut self, name: &Name, span: Span, want: Option<&Type>) -> Option<GExpr> {
        let make = |op, ty| Some(GExpr::new(op, Vec::new(), ty, span));
        if let Some((_, local, ty)) = self.body.scope.iter().rev().find(|(n, _, _)| n == name) {
            return make(Op::Local(*local), ty.clone());
        }
        if let Some((_, slot, ty)) = self.body.data.iter().find(|(n, _, _)| n == name) {
            return make(Op::State(*slot), ty.clone());
        }
        if let Some(e) = self.agent_name(name, span) {
            return e;
        }
        if let Some(i) = self.params.position(name) {
            let ty = self.params[i].1.clone();
            if self.body.place == Place::Constant {
                self.report(
                    Diagnostic::error(
                        code::NOT_CONSTANT,
                        format!("`{name}` is a parameter, a constant is needed"),
                    )
                    .at(span, "may differ from run to run")
                    .hint("write the value itself, or use a `let`"),
                );
                return None;
            }
            return make(Op::Param(i as u32), ty);
        }
        if let Some(c) =
            self.mission_lets.get(name).copied().or_else(|| self.decls.constants.get(name).copied())
        {
            return self.constant(name, c, span, want);
        }
        if let Some(e) = self.variant(name, span, want) {
            return e;
        }
        if let Some(e) = self.fact(name, span) {
            return e;
        }
        if self.robots.position(name).is_some() {
            self.report(
                Diagnostic::error(code::UNKNOWN_NAME, format!("the robot `{name}` is no value"))
                    .at(span, "what of it?")
                    .hint(match self.body.place {
                        Place::Truth => {
                            format!("write `{name}.truth.position`, or a state `{name}.AGENT.STATE`")
                        }
                        _ => "an agent knows other robots by what they publish on a topic".to_string(),
                    }),
            );
            return None;
        }
        let known = self.known_names();
        let d = unknown(code::UNKNOWN_NAME, "value", name, span, known.iter().map(String::as_str));
        self.report(d);
        None
    }

    /// States, arguments, readings and `let`s of the agent.
    fn agent_name(&mut self, name: &Name, span: Span) -> Option<Option<GExpr>> {
        if !matches!(self.body.place, Place::Behaviour | Place::Belief) {
            if let (Place::Start, Some(i)) =
                (self.body.place, self.agent.params.iter().position(|(n, _)| n == name))
            {
                return Some(Some(GExpr::new(
                    Op::Argument(i as u32),
                    Vec::new(),
                    self.agent.params[i].1.clone(),
                    span,
                )));
            }
            return None;
        }
        let make = |op, ty| Some(Some(GExpr::new(op, Vec::new(), ty, span)));
        if let Some(i) = self.agent.states.iter().position(|(n, _, _)| n == name) {
            return make(Op::State(i as u32), self.agent.states[i].1.clone());
        }
        if let Some(i) = self.agent.params.iter().position(|(n, _)| n == name) {
            return make(Op::Argument(i as u32), self.agent.params[i].1.clone());
        }
        if let Some(i) = self.agent.sensors.iter().position(|(n, _, _)| n == name) {
            if self.body.place == Place::Belief {
                self.report(
                    Diagnostic::error(code::BELIEF, "a sub-goal is judged by the agent's states")
                        .at(span, "a reading is gone by then")
                        .hint("keep what matters in a `state` and name that"),
                );
                return Some(None);
            }
            let (_, ty, optional) = &self.agent.sensors[i];
            let ty = if *optional { ty.clone().optional() } else { ty.clone() };
            return make(Op::Reading(i as u32), ty);
        }
        if let Some(c) = self.agent.lets.get(name).copied() {
            if self.body.place == Place::Belief {
                return Some(self.constant(name, c, span, None));
            }
            return Some(self.agent_let(name, c, span));
        }
        None
    }

    /// An agent-level `let`: evaluated once an activation, in the prelude of the body that uses it.
    fn agent_let(&mut self, name: &Name, c: &'a Constant, span: Span) -> Option<GExpr> {
        if let Some((local, ty)) = self.body.lets.get(name) {
            return Some(GExpr::new(Op::Local(*local), Vec::new(), ty.clone(), span));
        }
        if self.broken_let(name) || self.ring(name, span) {
            return None;
        }
        self.expanding.push(name.clone());
        // Seen from the agent: no locals of the place that uses it.
        let scope = std::mem::take(&mut self.body.scope);
        let data = std::mem::take(&mut self.body.data);
        let in_machine = std::mem::replace(&mut self.body.in_machine, false);
        let value = self.expr(&c.value, None);
        self.body.scope = scope;
        self.body.data = data;
        self.body.in_machine = in_machine;
        self.expanding.pop();
        let Some(value) = value else {
            self.poison(name);
            return None;
        };
        let ty = value.ty.clone();
        let local = self.body.local(&ty);
        self.body.prelude.push(GStmt { kind: GStmtKind::Let(local, value), at: c.name.span });
        self.body.lets.insert(name.clone(), (local, ty.clone()));
        Some(GExpr::new(Op::Local(local), Vec::new(), ty, span))
    }

    /// A `let` of the mission or file: written out where it is used.
    fn constant(&mut self, name: &Name, c: &'a Constant, span: Span, want: Option<&Type>) -> Option<GExpr> {
        self.used_constants.insert(name.clone());
        if self.broken_let(name) || self.ring(name, span) {
            return None;
        }
        self.expanding.push(name.clone());
        let scope = std::mem::take(&mut self.body.scope);
        let value = self.expr(&c.value, want);
        self.body.scope = scope;
        self.expanding.pop();
        let Some(value) = value else {
            self.poison(name);
            return None;
        };
        value.walk(&mut |_| self.written_out += 1);
        if self.written_out > MAX_WRITTEN_OUT {
            if !std::mem::replace(&mut self.too_much, true) {
                self.report(
                    Diagnostic::error(code::UNBOUNDED, "constants grow beyond all measure")
                        .at(span, "written out here once more")
                        .hint("make one of the constants in it a `param`, or shorten the chain of constants that use others twice"),
                );
            }
            self.poison(name);
            return None;
        }
        Some(GExpr { span, ..value })
    }

    /// Whether a `let` has been found wrong before: once is enough.
    fn broken_let(&self, name: &Name) -> bool {
        !self.expanding.contains(name) && self.poisoned.contains_key(name)
    }

    fn ring(&mut self, name: &Name, span: Span) -> bool {
        if !self.expanding.contains(name) {
            return false;
        }
        if self.poisoned.contains_key(name) {
            return true;
        }
        let from = self.expanding.iter().position(|n| n == name).unwrap_or(0);
        self.expanding[from..].to_vec().iter().for_each(|n| self.poison(n));
        let ring: Vec<&str> = self.expanding.iter().map(|n| &**n).chain([&**name]).collect();
        let ring = ring.join(" → ");
        self.report(
            Diagnostic::error(code::RECURSION, format!("`{name}` is defined by itself"))
                .at(span, ring)
                .hint("break the ring: one of these must be written without the others"),
        );
        true
    }

    /// A variant of an enum: of the wanted one, else of the only one that has it.
    fn variant(&mut self, name: &Name, span: Span, want: Option<&Type>) -> Option<Option<GExpr>> {
        let make =
            |e: &Name| Some(Some(GExpr::constant(Value::Variant(name.clone()), Type::Enum(e.clone()), span)));
        let want = match want {
            Some(Type::Option(t)) => Some(&**t),
            w => w,
        };
        if let Some(Type::Enum(e)) = want
            && self.types.enums.get(e).is_some_and(|e| e.variants.contains(name))
        {
            return make(e);
        }
        let of = |e: &Name| self.types.enums.get(e).is_some_and(|e| e.variants.contains(name));
        let with: Vec<Name> =
            self.variants.get(name).into_iter().flatten().filter(|e| of(e)).cloned().collect();
        match with.as_slice() {
            [] => None,
            [one] => make(one),
            many => {
                let list: Vec<String> = many.iter().map(|e| format!("`{e}.{name}`")).collect();
                self.report(
                    Diagnostic::error(code::AMBIGUOUS, format!("`{name}` is a variant of several enums"))
                        .at(span, "which one?")
                        .hint(format!("write {}", list.join(" or "))),
                );
                Some(None)
            }
        }
    }

    /// Names the language itself gives a meaning.
    fn fact(&mut self, name: &Name, span: Span) -> Option<Option<GExpr>> {
        let make = |op, ty| Some(Some(GExpr::new(op, Vec::new(), ty, span)));
        let place = self.body.place;
        match &**name {
            "pi" => Some(Some(GExpr::constant(Value::Number(std::f64::consts::PI), Type::NUMBER, span))),
            "now" if matches!(place, Place::Behaviour | Place::Truth) => {
                make(Op::Now, Type::Quantity(Dim::TIME))
            }
            "steps" if matches!(place, Place::Behaviour | Place::Truth) => {
                make(Op::StepCount, Type::Quantity(Dim::STEP))
            }
            "elapsed" if self.body.in_machine => make(Op::Elapsed, Type::Quantity(Dim::TIME)),
            "collisions" if place == Place::Truth => make(Op::Run(Run::Collisions), Type::Int),
            "collision" if place == Place::Truth => make(Op::Run(Run::InCollision), Type::Bool),
            "collisions" | "collision" | "truth" if matches!(place, Place::Behaviour | Place::Belief) => {
                self.truth_refused(span);
                Some(None)
            }
            _ => {
                let i = self.regions.position(name)?;
                Some(Some(GExpr::constant(Value::Int(i as i64), Type::Handle("Region".into()), span)))
            }
        }
    }

    /// The error for truth where only a robot's knowledge counts.
    pub fn truth_refused(&mut self, span: Span) {
        self.report(
            Diagnostic::error(code::TRUTH, "a behaviour cannot know the world's truth")
                .at(span, "truth is for `done`, `expect` and `metric`")
                .hint("read a sensor the platform declares, or let others publish what they know on a topic"),
        );
    }

    /// Whether something nearer than the mission's robots and agents has this name.
    fn is_bound(&self, name: &Name) -> bool {
        let b = &self.body;
        let a = &self.agent;
        b.scope.iter().any(|(n, _, _)| n == name)
            || b.data.iter().any(|(n, _, _)| n == name)
            || (matches!(b.place, Place::Behaviour | Place::Belief)
                && (a.states.iter().any(|(n, _, _)| n == name)
                    || a.params.iter().any(|(n, _)| n == name)
                    || a.sensors.iter().any(|(n, _, _)| n == name)
                    || a.lets.contains_key(name)))
    }

    /// `robot.field`, `truth.field`, `r1.truth.field`, `agent.state`, `Enum.variant`; `None` when `on` is
    /// none of these.
    pub fn qualified(&mut self, on: &Expr, field: &Ident, span: Span) -> Option<Option<GExpr>> {
        if let Some(e) = self.executed(on, field, span) {
            return Some(e);
        }
        if let ExprKind::Field(robot, middle) = &*on.kind {
            let ExprKind::Name(robot) = &*robot.kind else { return None };
            if self.is_bound(robot) {
                return None;
            }
            let subject = self.subject(robot, on.span)?;
            // A part of a fact, as `robot.target.x`: the fact is a value of its own.
            if OWN.contains(&&*middle.name) && self.agents.position(&middle.name).is_none() {
                return None;
            }
            return Some(self.of_subject(subject, &middle.name, field, span));
        }
        let ExprKind::Name(first) = &*on.kind else { return None };
        if self.is_bound(first) {
            return None;
        }
        if let Some(e) = self.types.enums.get(first) {
            if e.variants.contains(&field.name) {
                return Some(Some(GExpr::constant(
                    Value::Variant(field.name.clone()),
                    Type::Enum(first.clone()),
                    span,
                )));
            }
            let names: Vec<String> = e.variants.iter().map(|v| v.to_string()).collect();
            let d = unknown(
                code::UNKNOWN_NAME,
                &format!("variant of {first}"),
                &field.name,
                field.span,
                names.iter().map(String::as_str),
            );
            self.report(d);
            return Some(None);
        }
        match &**first {
            "robot" => Some(self.own(field, span)),
            "truth" => Some(self.truth(None, field, span)),
            _ => {
                if self.body.place != Place::Truth {
                    return None;
                }
                if let Some(subject) = self.subject(first, on.span) {
                    let name = Ident { name: "robot".into(), span: on.span };
                    return Some(self.of_subject(subject, &name.name, field, span));
                }
                let agent = self.agents.position(first)?;
                Some(self.believed(None, agent, field, span))
            }
        }
    }

    /// The robot group called `name`.
    fn subject(&mut self, name: &Name, _span: Span) -> Option<Option<u32>> {
        if &**name == "robot" {
            return Some(None);
        }
        self.robots.position(name).map(|i| Some(i as u32))
    }

    fn of_subject(&mut self, subject: Option<u32>, middle: &str, field: &Ident, span: Span) -> Option<GExpr> {
        if !self.is_one(subject, span) {
            return None;
        }
        match middle {
            "truth" => self.truth(subject, field, span),
            "robot" => {
                let e = self.own(field, span)?;
                Some(self.for_robot(subject, e))
            }
            agent => match self.agents.position(agent) {
                Some(agent) => self.believed(subject, agent, field, span),
                None => {
                    let names: Vec<String> =
                        self.agents.iter().map(|a| a.name.to_string()).chain(["truth".into()]).collect();
                    let d =
                        unknown(code::UNKNOWN_FIELD, "agent", agent, span, names.iter().map(String::as_str));
                    self.report(d);
                    None
                }
            },
        }
    }

    fn for_robot(&self, subject: Option<u32>, e: GExpr) -> GExpr {
        match subject {
            Some(group) => {
                let (ty, span) = (e.ty.clone(), e.span);
                GExpr::new(Op::OfRobot(group), vec![e], ty, span)
            }
            None => e,
        }
    }

    /// What a robot knows of itself.
    fn own(&mut self, field: &Ident, span: Span) -> Option<GExpr> {
        let map = soifra_graph::Frame::map;
        let (own, ty) = match &*field.name {
            "index" => (Own::Index, Type::Int),
            "start" => (Own::Start, Type::Pose(map())),
            "target" => (Own::Target, Type::Point(map())),
            "radius" => (Own::Radius, Type::Quantity(Dim::LENGTH)),
            "height" => (Own::Height, Type::Quantity(Dim::LENGTH)),
            "cruise_speed" => (Own::CruiseSpeed, Type::Quantity(Dim::VELOCITY)),
            other => {
                let d = unknown(code::UNKNOWN_FIELD, "fact about a robot", other, field.span, OWN);
                self.report(d);
                return None;
            }
        };
        Some(GExpr::new(Op::Own(own), Vec::new(), ty, span))
    }

    fn truth(&mut self, subject: Option<u32>, field: &Ident, span: Span) -> Option<GExpr> {
        if self.body.place != Place::Truth {
            self.truth_refused(span);
            return None;
        }
        if subject.is_none() && !self.body.of_robot {
            self.report(
                Diagnostic::error(code::UNKNOWN_NAME, "whose truth?")
                    .at(span, "no robot is meant here")
                    .hint("write `NAME.truth.…` or quantify: `each robot: …`"),
            );
            return None;
        }
        let length = Type::Quantity(Dim::LENGTH);
        let map = soifra_graph::Frame::map;
        let pose = || GExpr::new(Op::Truth(Truth::Pose), Vec::new(), Type::Pose(map()), span);
        let e = match &*field.name {
            "pose" => pose(),
            "position" => {
                GExpr::new(Op::Part(soifra_graph::Part::Position), vec![pose()], Type::Point(map()), span)
            }
            "heading" => {
                GExpr::new(Op::Part(soifra_graph::Part::Heading), vec![pose()], Type::Heading(map()), span)
            }
            "path_length" => GExpr::new(Op::Truth(Truth::PathLength), Vec::new(), length, span),
            "collisions" => GExpr::new(Op::Truth(Truth::Collisions), Vec::new(), Type::Int, span),
            "collision" => GExpr::new(Op::Truth(Truth::InCollision), Vec::new(), Type::Bool, span),
            other => {
                let d = unknown(
                    code::UNKNOWN_FIELD,
                    "truth",
                    other,
                    field.span,
                    ["pose", "position", "heading", "path_length", "collisions", "collision"],
                );
                self.report(d);
                return None;
            }
        };
        Some(self.for_robot(subject, e))
    }

    fn believed(&mut self, subject: Option<u32>, agent: usize, field: &Ident, span: Span) -> Option<GExpr> {
        let name = self.agents[agent].name.clone();
        if !self.is_meant(subject, &name, span) {
            return None;
        }
        let a = &self.agents[agent];
        let Some(i) = a.states.iter().position(|s| s.name == field.name) else {
            let names: Vec<String> = a.states.iter().map(|s| s.name.to_string()).collect();
            let d = unknown(
                code::UNKNOWN_FIELD,
                &format!("state of `{}`", a.name),
                &field.name,
                field.span,
                names.iter().map(String::as_str),
            );
            self.report(d);
            return None;
        };
        let ty = a.states[i].ty.clone();
        let e = GExpr::new(Op::Believed(agent as u32, i as u32), Vec::new(), ty, span);
        Some(self.for_robot(subject, e))
    }

    /// `agent.unit.misses`, `robot.agent.unit.misses`: what is known of the executions of a unit.
    fn executed(&mut self, on: &Expr, field: &Ident, span: Span) -> Option<Option<GExpr>> {
        let ExprKind::Field(of, unit) = &*on.kind else { return None };
        if self.body.place != Place::Truth {
            return None;
        }
        let (robot, agent) = match &*of.kind {
            ExprKind::Name(agent) => (None, agent),
            ExprKind::Field(robot, agent) => match &*robot.kind {
                ExprKind::Name(robot) => (Some(robot), &agent.name),
                _ => return None,
            },
            _ => return None,
        };
        if self.is_bound(robot.unwrap_or(agent)) {
            return None;
        }
        let a = self.agents.position(agent)?;
        let is_state = self.agents[a].states.iter().any(|s| s.name == unit.name);
        let u = self.agents[a].units.iter().position(|x| x.name == unit.name).filter(|_| !is_state)?;
        let subject = match robot {
            Some(robot) => self.subject(robot, on.span)?,
            None => None,
        };
        let which = match &*field.name {
            "activations" => Execution::Activations,
            "misses" => Execution::Misses,
            "response" => Execution::Response,
            other => {
                let known = ["activations", "misses", "response"];
                let d = unknown(code::UNKNOWN_FIELD, "fact about a unit", other, field.span, known);
                self.report(d);
                return Some(None);
            }
        };
        if !self.is_one(subject, span) || !self.is_meant(subject, agent, span) {
            return Some(None);
        }
        let op = Op::Executed(a as u32, u as u32, which);
        let e = GExpr::new(op, Vec::new(), soifra_graph::typing::execution(which), span);
        Some(Some(self.for_robot(subject, e)))
    }

    /// Whether a single robot is named, or none.
    fn is_one(&mut self, subject: Option<u32>, span: Span) -> bool {
        let array = subject.is_some_and(|group| self.robots[group as usize].1);
        if array {
            self.report(
                Diagnostic::error(code::UNKNOWN_FIELD, "an array of robots has no single value")
                    .at(span, "which one of them?")
                    .hint("quantify: `each robot: …`, `mean robot: …`"),
            );
        }
        !array
    }

    /// Whether it is told whose agent is meant.
    fn is_meant(&mut self, subject: Option<u32>, agent: &Name, span: Span) -> bool {
        let meant = subject.is_some() || self.body.of_robot;
        if !meant {
            self.report(
                Diagnostic::error(code::UNKNOWN_NAME, format!("which robot's `{agent}`?"))
                    .at(span, "no robot is meant here")
                    .hint(format!("write `ROBOT.{agent}.…` or quantify: `each robot: …`")),
            );
        }
        meant
    }

    fn known_names(&self) -> Vec<String> {
        let b: &Body = &self.body;
        let mut v: Vec<String> = b.scope.iter().map(|(n, _, _)| n.to_string()).collect();
        v.extend(b.data.iter().map(|(n, _, _)| n.to_string()));
        if matches!(b.place, Place::Behaviour | Place::Belief) {
            v.extend(self.agent.states.iter().map(|(n, _, _)| n.to_string()));
            v.extend(self.agent.params.iter().map(|(n, _)| n.to_string()));
            v.extend(self.agent.sensors.iter().map(|(n, _, _)| n.to_string()));
            v.extend(self.agent.lets.keys().map(|n| n.to_string()));
            v.extend(["now".into(), "steps".into()]);
        }
        v.extend(self.params.iter().map(|(n, _, _)| n.to_string()));
        v.extend(self.mission_lets.keys().chain(self.decls.constants.keys()).map(|n| n.to_string()));
        v.extend(self.types.enums.values().flat_map(|e| e.variants.iter().map(|v| v.to_string())));
        if b.place == Place::Truth {
            v.extend(["collisions".into(), "collision".into(), "now".into(), "steps".into()]);
            v.extend(self.robots.iter().map(|r| r.0.to_string()));
        }
        v
    }
}
