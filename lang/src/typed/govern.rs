//! What an agent decides about its units, and tells the planner-matcher.

use super::Checker;
use crate::{ast, code, decls::unknown};
use soifra_graph::{Diagnostic, Govern, Name};

impl Checker<'_> {
    /// `start UNIT`, `stop UNIT`, `achieve`, `fail "why"`, `pursue GOAL`, `offer NAME`, `withdraw NAME`
    pub(super) fn govern(&mut self, what: &ast::Govern) -> Option<Govern> {
        Some(match what {
            ast::Govern::Offer(name) => Govern::Offer(self.offered(name)?),
            ast::Govern::Withdraw(name) => Govern::Withdraw(self.offered(name)?),
            ast::Govern::Start(unit) => Govern::Start(self.governed(unit)?),
            ast::Govern::Stop(unit) => Govern::Stop(self.governed(unit)?),
            ast::Govern::Achieve => Govern::Achieve,
            ast::Govern::Fail(why) => Govern::Fail(why.clone()),
            ast::Govern::Pursue(goal) => Govern::Pursue(self.pursued(goal)?),
        })
    }

    /// A unit that the agent starts and stops itself.
    fn governed(&mut self, unit: &ast::Ident) -> Option<u32> {
        if self.agent.offered.contains(&unit.name) {
            self.report(
                Diagnostic::error(code::NO_EFFECT, format!("`{}` is offered", unit.name))
                    .at(unit.span, "the planner-matcher starts and stops it")
                    .hint("say `achieve` or `fail` when its sub-goal is over, or do not offer it"),
            );
            return None;
        }
        if let Some(i) = self.agent.units.iter().position(|n| *n == unit.name) {
            return Some(i as u32);
        }
        let known: Vec<Name> = self.agent.units.clone();
        let d = unknown(
            code::UNKNOWN_NAME,
            "service, machine or plan",
            &unit.name,
            unit.span,
            known.iter().map(|n| &**n),
        );
        self.report(d);
        None
    }

    /// Something that the agent offers.
    fn offered(&mut self, name: &ast::Ident) -> Option<u32> {
        if let Some(i) = self.agent.offers.iter().position(|n| *n == name.name) {
            return Some(i as u32);
        }
        let known: Vec<Name> = self.agent.offers.clone();
        let known = known.iter().map(|n| &**n);
        let d = unknown(code::UNKNOWN_NAME, "offer of the agent:", &name.name, name.span, known);
        self.report(d);
        None
    }

    /// A goal that is pursued on request.
    fn pursued(&mut self, goal: &ast::Ident) -> Option<u32> {
        // Without a mission nobody knows what its goals are.
        let goals = self.pursuable.clone()?;
        let Some(i) = goals.iter().position(|(g, _)| g.name == goal.name) else {
            let known = goals.iter().map(|(g, _)| &*g.name);
            let d = unknown(code::UNKNOWN_NAME, "goal", &goal.name, goal.span, known);
            self.report(d);
            return None;
        };
        let (declared, on_request) = &goals[i];
        if !on_request {
            self.report(
                Diagnostic::error(code::NO_EFFECT, format!("`{}` is pursued anyway", goal.name))
                    .at(goal.span, "asked for once more")
                    .at(declared.span, "pursued from the start")
                    .hint(format!("write `goal {} on request`, or leave this out", goal.name)),
            );
            return None;
        }
        Some(i as u32)
    }
}
