//! Does every activation end in acceptable time? Nothing loops but over lists, whose lengths are bounded by
//! their types, so the most operations an activation can take are known.

use super::{anytime::MOST_ROUNDS, constants::Constants};
use crate::code;
use soifra_graph::{Conjunct, Diagnostic, Expr, Graph, Op, PlanKind, Stmt, StmtKind, Type, Unit, UnitKind};

/// Most operations of one activation: about a second.
const MOST: u64 = 100_000_000;

/// Checks every unit.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut c = Costs { g, functions: vec![None; g.functions.len()], rounds: 0, known: Constants::new(g) };
    let mut out = Vec::new();
    for u in g.agents.iter().flat_map(|a| &a.units) {
        let cost = c.unit(u);
        if cost > MOST {
            let amount = match cost {
                u64::MAX => "more than can be counted".to_string(),
                n => format!("up to {n}"),
            };
            out.push(
                Diagnostic::error(code::UNBOUNDED, format!("an activation of `{}` may take too long", u.name))
                    .at(u.span, format!("{amount} operations; at most {MOST} are possible"))
                    .hint("lists inside lists multiply: declare smaller capacities, or name what is the same for all items with a `let` before"),
            );
        }
    }
    out
}

struct Costs<'g> {
    g: &'g Graph,
    /// Cost of each function; [`u64::MAX`] while it is being worked out, so that a ring has no bound.
    functions: Vec<Option<u64>>,
    /// Rounds of the anytime service at hand.
    rounds: u64,
    known: Constants<'g>,
}

impl Costs<'_> {
    fn unit(&mut self, u: &Unit) -> u64 {
        // A budget that is not known yet is held to the most that is possible, when the run begins.
        let paid = u.timing.budget.as_ref().zip(crate::schedule::round_cost(&u.kind));
        let rounds = paid.and_then(|(b, c)| Some(self.known.number(b, 0)? / self.known.number(c, 0)?));
        self.rounds = rounds.map_or(MOST_ROUNDS as u64, |r| r.min(MOST_ROUNDS) as u64);
        let mut sum = self.block(&u.prelude);
        match &u.kind {
            UnitKind::Service(body) => sum = sum.saturating_add(self.block(body)),
            UnitKind::Machine(states) => {
                for s in states {
                    for b in [&s.entry, &s.body, &s.exit] {
                        sum = sum.saturating_add(self.block(b));
                    }
                    for t in &s.transitions {
                        let parts = [self.guard(&t.guard), self.all(&t.arguments), self.block(&t.body)];
                        sum = parts.into_iter().fold(sum, u64::saturating_add);
                    }
                }
            }
            UnitKind::Plan { nodes, .. } => {
                for n in nodes {
                    let cost = match &n.kind {
                        PlanKind::Timeout(e)
                        | PlanKind::Check(e)
                        | PlanKind::Wait(e)
                        | PlanKind::WaitUntil(e) => self.expr(e),
                        PlanKind::Repeat { condition: Some(e), .. } => self.expr(e),
                        PlanKind::Act { prelude, body, until, fails, halt } => {
                            let blocks = [self.block(prelude), self.block(body), self.block(halt)];
                            let ends =
                                until.iter().chain(fails).map(|e| self.expr(e)).fold(0, u64::saturating_add);
                            blocks.into_iter().fold(ends, u64::saturating_add)
                        }
                        _ => 1,
                    };
                    sum = sum.saturating_add(cost);
                }
            }
        }
        sum
    }

    fn block(&mut self, stmts: &[Stmt]) -> u64 {
        stmts.iter().map(|s| self.stmt(s)).fold(0, u64::saturating_add)
    }

    fn stmt(&mut self, s: &Stmt) -> u64 {
        let cost = match &s.kind {
            StmtKind::Let(_, e)
            | StmtKind::Set(_, e)
            | StmtKind::Command(_, e)
            | StmtKind::Publish(_, e)
            | StmtKind::Use(_, e)
            | StmtKind::SetParam(_, e) => self.expr(e),
            StmtKind::Open(o) => o
                .content
                .iter()
                .chain([&o.to])
                .chain(&o.within)
                .map(|e| self.expr(e))
                .fold(0, u64::saturating_add),
            StmtKind::Reply(r) => {
                self.expr(&r.thread).saturating_add(r.content.as_ref().map_or(0, |e| self.expr(e)))
            }
            StmtKind::Each(each) => {
                let n = match &each.list.ty {
                    Type::List(_, n) => u64::from(*n),
                    _ => 0,
                };
                self.expr(&each.list).saturating_add(n.saturating_mul(self.block(&each.body)))
            }
            StmtKind::Refine(r) => {
                let round =
                    r.until.iter().chain([&r.step]).map(|e| self.expr(e)).fold(1, u64::saturating_add);
                self.expr(&r.first).saturating_add(self.rounds.saturating_mul(round))
            }
            StmtKind::Tell { content, .. } => self.expr(content),
            StmtKind::Note(_, e) => e.as_ref().map_or(0, |e| self.expr(e)),
            StmtKind::If(e, a, b) => self.expr(e).saturating_add(self.block(a).max(self.block(b))),
            StmtKind::IfSome { value, then, otherwise, .. } => {
                self.expr(value).saturating_add(self.block(then).max(self.block(otherwise)))
            }
            StmtKind::Switch { value, arms, rest } => {
                let longest = arms.iter().map(|(_, b)| b).chain(rest).map(|b| self.block(b)).max();
                self.expr(value).saturating_add(longest.unwrap_or(0))
            }
            StmtKind::Rules(rules) => {
                let guards = rules.iter().map(|r| self.guard(&r.guard)).fold(0, u64::saturating_add);
                guards.saturating_add(rules.iter().map(|r| self.block(&r.body)).max().unwrap_or(0))
            }
            StmtKind::Raise(_) | StmtKind::Govern(_) => 0,
        };
        cost.saturating_add(1)
    }

    fn guard(&mut self, g: &[Conjunct]) -> u64 {
        let one = |c: &Conjunct| match c {
            Conjunct::Holds(e) | Conjunct::Binds(_, e) => self.expr(e),
        };
        g.iter().map(one).fold(0, u64::saturating_add)
    }

    fn all(&mut self, list: &[Expr]) -> u64 {
        list.iter().map(|e| self.expr(e)).fold(0, u64::saturating_add)
    }

    fn expr(&mut self, e: &Expr) -> u64 {
        let capacity = match e.args.first().map(|a| &a.ty) {
            Some(Type::List(_, n)) => u64::from(*n),
            _ => 1,
        };
        let inside = match (&e.op, e.args.as_slice()) {
            (Op::List(..), [list, body]) => {
                self.expr(list).saturating_add(capacity.saturating_mul(self.expr(body)))
            }
            (Op::Fold(..), [list, start, body]) => {
                let before = self.expr(list).saturating_add(self.expr(start));
                before.saturating_add(capacity.saturating_mul(self.expr(body)))
            }
            (Op::If | Op::IfSome { .. } | Op::Switch { .. }, [first, ways @ ..]) => {
                let longest = ways.iter().map(|w| self.expr(w)).max().unwrap_or(0);
                self.expr(first).saturating_add(longest)
            }
            (Op::Call(i), args) => self.all(args).saturating_add(self.function(*i as usize)),
            (_, args) => self.all(args),
        };
        inside.saturating_add(1)
    }

    fn function(&mut self, i: usize) -> u64 {
        match self.functions.get(i) {
            Some(Some(cost)) => *cost,
            Some(None) => {
                self.functions[i] = Some(u64::MAX);
                let g = self.g;
                let cost = self.expr(&g.functions[i].body);
                self.functions[i] = Some(cost);
                cost
            }
            None => 0,
        }
    }
}
