//! What code asks for: sensor ports, topics, truth. Read off the graph before it is compiled.

use soifra_graph::{Conjunct, Expr, Op, PlanKind, Run, Stmt, StmtKind, Truth, Unit, UnitKind};

/// What a piece of code asks for.
#[derive(Debug, Default)]
pub(crate) struct Uses {
    /// Sensor ports, in order.
    pub readings: Vec<u32>,
    /// Topics heard, in order.
    pub heard: Vec<u32>,
    /// Topics published on, in order.
    pub publishes: Vec<u32>,
    /// Actuator ports commanded, in order.
    pub commands: Vec<u32>,
    /// Asks for contacts.
    pub contacts: bool,
    /// Asks for poses or path lengths.
    pub truth: bool,
}

fn add(list: &mut Vec<u32>, x: u32) {
    if let Err(i) = list.binary_search(&x) {
        list.insert(i, x);
    }
}

impl Uses {
    pub(crate) fn expr(&mut self, e: &Expr) {
        e.walk(&mut |e| match &e.op {
            Op::Reading(p) => add(&mut self.readings, *p),
            Op::Heard(t) => add(&mut self.heard, *t),
            Op::Truth(Truth::Collisions | Truth::InCollision)
            | Op::Run(Run::Collisions | Run::InCollision) => {
                self.contacts = true;
            }
            Op::Truth(Truth::Pose | Truth::PathLength) => self.truth = true,
            _ => {}
        });
    }

    fn exprs<'e>(&mut self, list: impl IntoIterator<Item = &'e Expr>) {
        for e in list {
            self.expr(e);
        }
    }

    fn guard(&mut self, guard: &[Conjunct]) {
        for c in guard {
            match c {
                Conjunct::Holds(e) | Conjunct::Binds(_, e) => self.expr(e),
            }
        }
    }

    pub(crate) fn stmts(&mut self, stmts: &[Stmt]) {
        for s in stmts {
            match &s.kind {
                StmtKind::Let(_, e)
                | StmtKind::Set(_, e)
                | StmtKind::Use(_, e)
                | StmtKind::SetParam(_, e) => self.expr(e),
                StmtKind::Command(port, e) => {
                    add(&mut self.commands, *port);
                    self.expr(e);
                }
                StmtKind::Publish(topic, e) => {
                    add(&mut self.publishes, *topic);
                    self.expr(e);
                }
                StmtKind::Open(o) => self.exprs(o.content.iter().chain([&o.to]).chain(&o.within)),
                StmtKind::Reply(r) => self.exprs(r.content.iter().chain([&r.thread])),
                StmtKind::Each(each) => {
                    self.expr(&each.list);
                    self.stmts(&each.body);
                }
                StmtKind::Refine(r) => {
                    self.exprs([&r.first, &r.step].into_iter().chain(&r.until));
                }
                StmtKind::Tell { content, .. } => self.expr(content),
                StmtKind::Note(_, e) => self.exprs(e),
                StmtKind::Raise(_) | StmtKind::Govern(_) => {}
                StmtKind::If(c, a, b) => {
                    self.expr(c);
                    self.stmts(a);
                    self.stmts(b);
                }
                StmtKind::IfSome { value, then, otherwise, .. } => {
                    self.expr(value);
                    self.stmts(then);
                    self.stmts(otherwise);
                }
                StmtKind::Switch { value, arms, rest } => {
                    self.expr(value);
                    for (_, body) in arms {
                        self.stmts(body);
                    }
                    self.stmts(rest.as_deref().unwrap_or_default());
                }
                StmtKind::Rules(rules) => {
                    for r in rules {
                        self.guard(&r.guard);
                        self.stmts(&r.body);
                    }
                }
            }
        }
    }

    /// Everything a unit asks for when it is activated.
    pub(crate) fn of_unit(unit: &Unit) -> Uses {
        let mut u = Uses::default();
        u.stmts(&unit.prelude);
        match &unit.kind {
            UnitKind::Service(body) => u.stmts(body),
            UnitKind::Machine(states) => {
                for s in states {
                    u.stmts(&s.entry);
                    u.stmts(&s.body);
                    u.stmts(&s.exit);
                    for t in &s.transitions {
                        u.guard(&t.guard);
                        u.exprs(&t.arguments);
                        u.stmts(&t.body);
                    }
                }
            }
            UnitKind::Plan { nodes, .. } => {
                for n in nodes {
                    match &n.kind {
                        PlanKind::Timeout(e)
                        | PlanKind::Check(e)
                        | PlanKind::Wait(e)
                        | PlanKind::WaitUntil(e) => {
                            u.expr(e);
                        }
                        PlanKind::Repeat { condition, .. } => u.exprs(condition),
                        PlanKind::Act { prelude, body, until, fails, halt } => {
                            u.stmts(prelude);
                            u.stmts(body);
                            u.exprs(until);
                            u.exprs(fails);
                            u.stmts(halt);
                        }
                        _ => {}
                    }
                }
            }
        }
        u
    }
}
