//! Arbiters. Sources are resolved when all agents are known.

use crate::{
    ast::{self, Strategy as S},
    code,
    decls::unknown,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Arbiter, Diagnostic, Dim, Layer, Name, Source, Strategy, Type};

impl<'a> Checker<'a> {
    /// Lowers an arbiter of the current agent.
    pub fn arbiter(&mut self, a: &'a ast::Arbiter) -> Option<Arbiter> {
        let Some(actuator) = self.agent.actuators.iter().position(|(n, _)| *n == a.actuator.name) else {
            let names: Vec<Name> = self.agent.actuators.iter().map(|(n, _)| n.clone()).collect();
            let d = unknown(
                code::UNKNOWN_NAME,
                "actuator",
                &a.actuator.name,
                a.actuator.span,
                names.iter().map(|n| &**n),
            );
            self.report(d);
            return None;
        };
        let (lowered, body) =
            self.in_body(Body::new(Place::Behaviour), |c| c.strategy(&a.strategy, actuator));
        let (sources, strategy) = lowered?;
        for (i, s) in sources.iter().enumerate() {
            if let Some(first) = sources[..i].iter().find(|o| (o.agent, o.unit) == (s.agent, s.unit)) {
                self.report(
                    Diagnostic::error(code::DUPLICATE, "a source is listed twice")
                        .at(s.at, "the second")
                        .at(first.at, "the first")
                        .hint("remove one"),
                );
                return None;
            }
        }
        Some(Arbiter {
            actuator: actuator as u32,
            sources,
            strategy,
            locals: body.locals,
            prelude: body.prelude,
            at: a.actuator.span,
        })
    }

    fn strategy(&mut self, s: &'a S, actuator: usize) -> Option<(Vec<Source>, Strategy)> {
        match s {
            S::Switch(list) => Some((self.sources(list.iter())?, Strategy::Switch)),
            S::Priority(list) => {
                let sources = self.sources(list.iter().map(|(s, _)| s))?;
                let values = list.iter().map(|(_, e)| self.typed(e, &Type::Int)).collect::<Vec<_>>();
                Some((sources, Strategy::Priority(values.into_iter().collect::<Option<_>>()?)))
            }
            S::Blend(list) => {
                let ty = self.agent.actuators[actuator].1.clone();
                if !matches!(ty, Type::Twist | Type::Vector(..) | Type::Quantity(_)) {
                    let (name, at) = (
                        self.agent.actuators[actuator].0.clone(),
                        list.first().map(|(s, _)| s.unit.span).unwrap_or_default(),
                    );
                    self.report(Diagnostic::error(code::ARBITER_SOURCE, format!("commands of `{name}` cannot be blended")).at(at, format!("they are {ty}")).hint("blend twists, vectors or quantities; choose between others with `priority` or `switch`"));
                    return None;
                }
                let sources = self.sources(list.iter().map(|(s, _)| s))?;
                let values = list.iter().map(|(_, e)| self.typed(e, &Type::NUMBER)).collect::<Vec<_>>();
                Some((sources, Strategy::Blend(values.into_iter().collect::<Option<_>>()?)))
            }
            S::Layers(list) => {
                let sources = self.sources(list.iter().map(|l| &l.source))?;
                let mut layers = Vec::new();
                for (i, l) in list.iter().enumerate() {
                    let suppresses = match &l.suppresses {
                        None => (i as u32 + 1..list.len() as u32).collect(),
                        Some(names) => {
                            let mut out = Vec::new();
                            for s in self.sources(names.iter())? {
                                match sources.iter().position(|o| (o.agent, o.unit) == (s.agent, s.unit)) {
                                    Some(k) => out.push(k as u32),
                                    None => {
                                        self.report(
                                            Diagnostic::error(
                                                code::ARBITER_SOURCE,
                                                "only layers of this arbiter can be suppressed",
                                            )
                                            .at(s.at, "not one of them")
                                            .hint("list it as a `layer` too"),
                                        );
                                        return None;
                                    }
                                }
                            }
                            out
                        }
                    };
                    let hold = match &l.hold {
                        Some(e) => Some(self.typed(e, &Type::Quantity(Dim::TIME))?),
                        None => None,
                    };
                    let inhibited = match &l.inhibited {
                        Some(e) => Some(self.typed(e, &Type::Bool)?),
                        None => None,
                    };
                    layers.push(Layer { suppresses, hold, inhibited });
                }
                Some((sources, Strategy::Layers(layers)))
            }
        }
    }

    fn sources(&mut self, list: impl Iterator<Item = &'a ast::Source>) -> Option<Vec<Source>> {
        let mut out = Vec::new();
        for s in list {
            let agent_name = s.agent.as_ref().map_or_else(|| self.agent.name.clone(), |a| a.name.clone());
            let Some(agent) = self.decls.agents.iter().position(|a| a.name.name == agent_name) else {
                let at = s.agent.as_ref().map_or(s.unit.span, |a| a.span);
                let d = unknown(
                    code::UNKNOWN_NAME,
                    "agent",
                    &agent_name,
                    at,
                    self.decls.agents.iter().map(|a| &*a.name.name),
                );
                self.report(d);
                return None;
            };
            let units: Vec<Name> = self.decls.agents[agent]
                .members
                .iter()
                .filter_map(
                    |m| if let ast::AgentMember::Unit(u) = m { Some(u.name.name.clone()) } else { None },
                )
                .collect();
            let Some(unit) = units.iter().position(|u| *u == s.unit.name) else {
                let d = unknown(
                    code::UNKNOWN_NAME,
                    &format!("service, machine or plan of `{agent_name}`"),
                    &s.unit.name,
                    s.unit.span,
                    units.iter().map(|n| &**n),
                );
                self.report(d);
                return None;
            };
            let at = s.agent.as_ref().map_or(s.unit.span, |a| a.span.to(s.unit.span));
            out.push(Source { agent: agent as u32, unit: unit as u32, at });
        }
        Some(out)
    }
}
