//! Agents.

use crate::{
    ast::{Agent, AgentMember},
    code,
    decls::unknown,
    typed::{AgentScope, Body, Checker, Place},
};
use soifra_graph::{Agent as GAgent, Device, Diagnostic, Expr, Name, Offer, Port, Restart, State, Type};

impl<'a> Checker<'a> {
    /// Lowers an agent; parts with errors are left out.
    pub fn agent(&mut self, a: &'a Agent) -> GAgent {
        let mut out = GAgent {
            name: a.name.name.clone(),
            collaborative: a.collaborative,
            parameters: Vec::new(),
            offers: Vec::new(),
            sensors: Vec::new(),
            actuators: Vec::new(),
            states: Vec::new(),
            events: Vec::new(),
            devices: Vec::new(),
            units: Vec::new(),
            arbiters: Vec::new(),
            restart: None,
            span: a.name.span,
        };
        self.agent = AgentScope { name: a.name.name.clone(), ..AgentScope::default() };
        self.agent_names(a);
        for (n, t) in &a.params {
            match self.resolve_type(t, None) {
                Some(ty) => out.parameters.push((n.name.clone(), ty)),
                None => self.poison(&n.name),
            }
        }
        self.agent.params = out.parameters.clone();
        self.ports(a, &mut out);
        self.states(a, &mut out);
        for m in &a.members {
            match m {
                AgentMember::Offers(n, _) => {
                    self.agent.offers.push(n.name.clone());
                    if self.conversations.position(&n.name).is_none() {
                        self.agent.offered.push(n.name.clone());
                    }
                }
                AgentMember::Unit(u) => self.agent.units.push(u.name.name.clone()),
                AgentMember::Constant(c) => drop(self.agent.lets.insert(c.name.name.clone(), c)),
                AgentMember::Action(x) => drop(self.agent.actions.insert(x.name.name.clone(), x)),
                _ => {}
            }
        }
        for m in &a.members {
            if let AgentMember::Unit(u) = m
                && let Some(unit) = self.unit(u, &mut out.states)
            {
                out.units.push(unit);
            }
        }
        self.offers(a, &mut out);
        if let Some((times, within)) = &a.restart
            && let Some(within) = self.start_duration(within)
        {
            let times = u32::try_from(*times).unwrap_or(u32::MAX);
            out.restart = Some(Restart { times, within });
        }
        self.unused_parts(a);
        for m in &a.members {
            if let AgentMember::Arbiter(x) = m
                && let Some(arbiter) = self.arbiter(x)
            {
                out.arbiters.push(arbiter);
            }
        }
        out
    }

    /// What it offers: units and conversations.
    fn offers(&mut self, a: &'a Agent, out: &mut GAgent) {
        for m in &a.members {
            let AgentMember::Offers(n, when) = m else { continue };
            // A conversation may have a service of its own name.
            let spoken = self.conversations.position(&n.name).is_some();
            let unit = self.agent.units.iter().position(|u| *u == n.name && !spoken).map(|u| u as u32);
            if unit.is_none() && !spoken {
                let units = self.agent.units.iter().cloned();
                let known: Vec<Name> =
                    units.chain(self.conversations.iter().map(|c| c.name.clone())).collect();
                let what = "service, machine, plan or conversation";
                let d = unknown(code::UNKNOWN_NAME, what, &n.name, n.span, known.iter().map(|k| &**k));
                self.report(d);
                continue;
            }
            let when = match when {
                Some(e) => match self.in_body(Body::new(Place::Belief), |c| c.typed(e, &Type::Bool)).0 {
                    Some(e) => Some(e),
                    None => continue,
                },
                None => None,
            };
            out.offers.push(Offer { name: n.name.clone(), unit, when, span: n.span });
        }
    }

    /// Every name an agent declares means one thing in it.
    fn agent_names(&mut self, a: &Agent) {
        let mut names = Vec::new();
        names.extend(a.params.iter().map(|(n, _)| n));
        let mut units = Vec::new();
        for m in &a.members {
            match m {
                AgentMember::Sensor(n, _) | AgentMember::State(n, _, _) => names.push(n),
                AgentMember::Constant(c) => names.push(&c.name),
                AgentMember::Unit(u) => units.push(&u.name),
                _ => {}
            }
        }
        self.distinct(
            a.members.iter().filter_map(|m| if let AgentMember::Offers(n, _) = m { Some(n) } else { None }),
        );
        self.distinct(names);
        self.distinct(units);
        self.distinct(
            a.members.iter().filter_map(|m| if let AgentMember::Actuator(n, _) = m { Some(n) } else { None }),
        );
        self.distinct(
            a.members
                .iter()
                .filter_map(|m| if let AgentMember::Action(x) = m { Some(&x.name) } else { None }),
        );
        self.distinct(
            a.members.iter().filter_map(|m| if let AgentMember::Event(n) = m { Some(n) } else { None }),
        );
        self.distinct(
            a.members.iter().filter_map(|m| if let AgentMember::Device(n, _) = m { Some(n) } else { None }),
        );
    }

    fn ports(&mut self, a: &Agent, out: &mut GAgent) {
        for m in &a.members {
            match m {
                AgentMember::Sensor(n, t) => {
                    let Some(ty) = self.resolve_type(t, None) else {
                        self.poison(&n.name);
                        continue;
                    };
                    let (ty, optional) = match ty {
                        Type::Option(inner) => (*inner, true),
                        ty => (ty, false),
                    };
                    self.agent.sensors.push((n.name.clone(), ty.clone(), optional));
                    out.sensors.push(Port { name: n.name.clone(), ty, optional, span: n.span });
                }
                AgentMember::Actuator(n, t) => {
                    let Some(ty) = self.resolve_type(t, None) else {
                        self.poison(&n.name);
                        continue;
                    };
                    self.agent.actuators.push((n.name.clone(), ty.clone()));
                    out.actuators.push(Port { name: n.name.clone(), ty, optional: false, span: n.span });
                }
                AgentMember::Device(n, capacity) => {
                    let Some(capacity) = u32::try_from(*capacity).ok().filter(|c| (1..=1024).contains(c))
                    else {
                        self.report(
                            Diagnostic::error(code::RANGE, "a capacity out of range")
                                .at(n.span, "1 to 1024 are possible")
                                .hint("how many can use it at a time?"),
                        );
                        continue;
                    };
                    self.agent.devices.push(n.name.clone());
                    out.devices.push(Device { name: n.name.clone(), capacity, span: n.span });
                }
                AgentMember::Event(n) => {
                    self.agent.events.push(n.name.clone());
                    out.events.push(n.name.clone());
                }
                _ => {}
            }
        }
    }

    fn states(&mut self, a: &'a Agent, out: &mut GAgent) {
        for m in &a.members {
            let AgentMember::State(n, t, value) = m else { continue };
            let want = match t {
                Some(t) => match self.resolve_type(t, None) {
                    Some(ty) => Some(ty),
                    None => {
                        self.poison(&n.name);
                        continue;
                    }
                },
                None => None,
            };
            let (value, _) = self.in_body(Body::new(Place::Start), |c| match &want {
                Some(ty) => c.typed(value, ty),
                None => c.expr(value, None),
            });
            let Some(initial) = value else {
                // Keep the name, so that its uses do not become errors of their own.
                match want {
                    Some(ty) => {
                        let none = Expr::constant(soifra_graph::Value::Bool(false), ty.clone(), n.span);
                        self.slot(&mut out.states, n.name.clone(), ty, none);
                    }
                    None => self.poison(&n.name),
                }
                continue;
            };
            let ty = initial.ty.clone();
            self.slot(&mut out.states, n.name.clone(), ty, initial);
        }
    }

    /// Adds a state slot.
    pub fn slot(&mut self, states: &mut Vec<State>, name: Name, ty: Type, initial: Expr) -> u32 {
        let span = initial.span;
        self.agent.states.push((name.clone(), ty.clone(), span));
        states.push(State { name, ty, initial, span });
        (states.len() - 1) as u32
    }

    /// Parts that nothing used are still checked: a mistake in them should not wait for their first use.
    fn unused_parts(&mut self, a: &'a Agent) {
        for m in &a.members {
            match m {
                AgentMember::Constant(c) => {
                    let before = self.errors.len();
                    let (_, _) = self.in_body(Body::new(Place::Behaviour), |s| s.expr(&c.value, None));
                    self.forget_repeated(before);
                }
                AgentMember::Action(x) => {
                    let before = self.errors.len();
                    self.in_body(Body::new(Place::Behaviour), |s| {
                        for (n, t) in &x.params {
                            match s.resolve_type(t, None) {
                                Some(ty) => drop(s.body.bind(n, &ty)),
                                None => s.poison(&n.name),
                            }
                        }
                        for c in x.until.iter().chain(&x.fails) {
                            s.typed(c, &Type::Bool);
                        }
                        s.expanding.push(x.name.name.clone());
                        s.block(&x.body, 0);
                        s.block(&x.halt, 0);
                        s.expanding.pop();
                    });
                    self.forget_repeated(before);
                }
                _ => {}
            }
        }
    }

    /// Drops errors from index `from` that have been reported before.
    pub fn forget_repeated(&mut self, from: usize) {
        let new: Vec<Diagnostic> = self.errors.drain(from..).collect();
        // How many were there before each of them, counted among those that stay.
        let mut stay = vec![from];
        for d in new {
            if !self.errors.iter().any(|e| e.code == d.code && e.position() == d.position()) {
                self.errors.push(d);
            }
            stay.push(self.errors.len());
        }
        for before in self.poisoned.values_mut().filter(|b| **b > from) {
            *before = stay.get(*before - from).copied().unwrap_or(self.errors.len());
        }
    }

    /// A duration that is known at the start of a run.
    pub fn start_duration(&mut self, e: &crate::ast::Expr) -> Option<Expr> {
        let (value, _) =
            self.in_body(Body::new(Place::Start), |c| c.typed(e, &Type::Quantity(soifra_graph::Dim::TIME)));
        let value = value?;
        if let Some(soifra_graph::Value::Number(s)) = value.as_const()
            && (*s < 0.0 || *s > 9e8)
        {
            self.report(
                Diagnostic::error(code::RANGE, "a duration out of range")
                    .at(value.span, format!("{s} s"))
                    .hint("durations are from 0 s to 9e8 s"),
            );
            return None;
        }
        Some(value)
    }
}
