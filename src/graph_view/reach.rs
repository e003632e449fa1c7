//! What a unit touches: ports, topics, events and agents, found in its statements and expressions.

use soifra_graph::{Agent, Conjunct, Expr, Op, PlanKind, Rule, Stmt, StmtKind, Trigger, Unit, UnitKind};
use std::collections::BTreeSet;

/// Everything a unit reads, commands, publishes and tells, by index or name.
#[derive(Debug, Default)]
pub struct Reach {
    pub readings: BTreeSet<u32>,
    pub heard: BTreeSet<u32>,
    pub commands: BTreeSet<u32>,
    pub publishes: BTreeSet<u32>,
    pub raises: BTreeSet<u32>,
    pub waits: BTreeSet<u32>,
    /// Conversations it opens, with what, and those whose messages it answers.
    pub opens: BTreeSet<(u32, String)>,
    /// Performative, receiver, record.
    pub tells: BTreeSet<(String, String, String)>,
}

impl Reach {
    /// What `unit` of `agent` touches.
    pub fn of(unit: &Unit) -> Reach {
        let mut r = Reach::default();
        match &unit.trigger {
            Trigger::Message { topic, .. } => _ = r.heard.insert(*topic),
            Trigger::Reading(port) => _ = r.readings.insert(*port),
            Trigger::Event(e) => _ = r.waits.insert(*e),
            Trigger::Every { .. }
            | Trigger::Step { .. }
            | Trigger::Told { .. }
            | Trigger::Talk { .. }
            | Trigger::Param(_) => {}
        }
        r.block(&unit.prelude);
        match &unit.kind {
            UnitKind::Service(body) => r.block(body),
            UnitKind::Machine(states) => {
                for s in states {
                    r.block(&s.entry);
                    r.block(&s.body);
                    r.block(&s.exit);
                    for t in &s.transitions {
                        r.guard(&t.guard);
                        t.arguments.iter().for_each(|e| r.expr(e));
                        r.block(&t.body);
                    }
                }
            }
            UnitKind::Plan { nodes, .. } => nodes.iter().for_each(|n| r.plan(&n.kind)),
        }
        r
    }

    fn plan(&mut self, kind: &PlanKind) {
        match kind {
            PlanKind::Timeout(e) | PlanKind::Check(e) | PlanKind::Wait(e) | PlanKind::WaitUntil(e) => {
                self.expr(e)
            }
            PlanKind::Repeat { condition, .. } => condition.iter().for_each(|e| self.expr(e)),
            PlanKind::Act { prelude, body, until, fails, halt } => {
                self.block(prelude);
                self.block(body);
                self.block(halt);
                until.iter().chain(fails).for_each(|e| self.expr(e));
            }
            PlanKind::Sequence { .. }
            | PlanKind::Fallback { .. }
            | PlanKind::Parallel { .. }
            | PlanKind::Retry(_)
            | PlanKind::Invert
            | PlanKind::Succeed => {}
        }
    }

    fn block(&mut self, body: &[Stmt]) {
        body.iter().for_each(|s| self.stmt(s));
    }

    fn stmt(&mut self, s: &Stmt) {
        match &s.kind {
            StmtKind::Let(_, e) | StmtKind::Set(_, e) | StmtKind::Use(_, e) | StmtKind::SetParam(_, e) => {
                self.expr(e)
            }
            StmtKind::Command(port, e) => {
                self.commands.insert(*port);
                self.expr(e);
            }
            StmtKind::Publish(topic, e) => {
                self.publishes.insert(*topic);
                self.expr(e);
            }
            StmtKind::Open(o) => {
                self.opens.insert((o.conversation, o.performative.to_string()));
                o.content.iter().chain([&o.to]).chain(&o.within).for_each(|e| self.expr(e));
            }
            StmtKind::Reply(r) => r.content.iter().chain([&r.thread]).for_each(|e| self.expr(e)),
            StmtKind::Each(each) => {
                self.expr(&each.list);
                self.block(&each.body);
            }
            StmtKind::Refine(r) => {
                [&r.first, &r.step].into_iter().chain(&r.until).for_each(|e| self.expr(e));
            }
            StmtKind::Tell { performative, to, content } => {
                self.tells.insert((performative.to_string(), to.to_string(), content.ty.to_string()));
                self.expr(content);
            }
            StmtKind::Note(_, e) => e.iter().for_each(|e| self.expr(e)),
            StmtKind::Raise(e) => _ = self.raises.insert(*e),
            StmtKind::Govern(_) => {}
            StmtKind::If(c, a, b) => {
                self.expr(c);
                self.block(a);
                self.block(b);
            }
            StmtKind::IfSome { value, then, otherwise, .. } => {
                self.expr(value);
                self.block(then);
                self.block(otherwise);
            }
            StmtKind::Switch { value, arms, rest } => {
                self.expr(value);
                arms.iter().for_each(|(_, b)| self.block(b));
                rest.iter().for_each(|b| self.block(b));
            }
            StmtKind::Rules(rules) => {
                for r in rules {
                    self.guard(&r.guard);
                    self.block(&r.body);
                }
            }
        }
    }

    fn guard(&mut self, guard: &[Conjunct]) {
        for c in guard {
            match c {
                Conjunct::Holds(e) | Conjunct::Binds(_, e) => self.expr(e),
            }
        }
    }

    fn expr(&mut self, e: &Expr) {
        e.walk(&mut |e| match e.op {
            Op::Reading(p) => _ = self.readings.insert(p),
            Op::Heard(t) => _ = self.heard.insert(t),
            _ => {}
        });
    }
}

/// All rules of a service, in order, also those inside branches.
pub fn rules(body: &[Stmt]) -> Vec<&Rule> {
    let mut out = Vec::new();
    for s in body {
        match &s.kind {
            StmtKind::Rules(r) => out.extend(r),
            StmtKind::If(_, a, b) => {
                out.extend(rules(a));
                out.extend(rules(b));
            }
            StmtKind::IfSome { then, otherwise, .. } => {
                out.extend(rules(then));
                out.extend(rules(otherwise));
            }
            StmtKind::Switch { arms, rest, .. } => {
                arms.iter().for_each(|(_, b)| out.extend(rules(b)));
                rest.iter().for_each(|b| out.extend(rules(b)));
            }
            _ => {}
        }
    }
    out
}

/// The name of a sensor or actuator port of an agent, by index.
pub fn port(agent: &Agent, sensor: bool, index: u32) -> String {
    let ports = if sensor { &agent.sensors } else { &agent.actuators };
    ports.get(index as usize).map_or_else(|| "?".into(), |p| p.name.to_string())
}
