//! What a picture shows, without a form: things, units with their insides, and who is linked to whom.

use super::reach::{self, Reach};
use soifra_graph::{
    Agent, Conjunct, Expr, Graph, MachineState, PlanKind, PlanNode, Span, Strategy, Talk, Trigger, Unit,
    UnitKind,
};
use std::collections::BTreeMap;

/// Longest text of a guard or condition, in characters.
const TEXT: usize = 44;

/// What stands alone in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Sensor,
    Actuator,
    Topic,
    Arbiter,
    Goal,
    Mission,
    Subgoal,
    Plan,
    Agent,
    Service,
    Action,
}

/// A thing outside of agents.
#[derive(Debug)]
pub struct Thing {
    pub id: String,
    pub kind: Kind,
    pub lines: Vec<String>,
}

/// An agent with its units.
#[derive(Debug)]
pub struct AgentBox {
    pub id: String,
    pub title: String,
    pub units: Vec<UnitBox>,
}

/// A service, machine or plan.
#[derive(Debug)]
pub struct UnitBox {
    pub id: String,
    pub title: String,
    pub inside: Inside,
}

/// What a unit is made of.
#[derive(Debug)]
pub enum Inside {
    /// Rules or remarks, one a line.
    Lines(Vec<String>),
    /// States or plan nodes; edges are (from, to, label). The first node is the initial state or the root.
    Nodes { round: bool, nodes: Vec<String>, edges: Vec<(usize, usize, String)> },
}

/// A link between two ids.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Link {
    pub from: String,
    pub to: String,
    pub label: String,
}

/// The whole picture.
#[derive(Debug)]
pub struct View {
    pub title: String,
    pub things: Vec<Thing>,
    pub agents: Vec<AgentBox>,
    pub links: Vec<Link>,
}

impl View {
    /// What a picture of `graph` shows.
    pub fn of(graph: &Graph) -> View {
        let mut b = Builder { graph, things: BTreeMap::new(), links: Vec::new() };
        let agents = graph.agents.iter().enumerate().map(|(i, a)| b.agent(i, a)).collect();
        b.goals();
        b.links.sort();
        b.links.dedup();
        let title = if graph.title.is_empty() {
            graph.name.to_string()
        } else {
            format!("{} – {}", graph.name, graph.title)
        };
        View { title, things: b.things.into_values().collect(), agents, links: b.links }
    }
}

pub(super) struct Builder<'g> {
    pub graph: &'g Graph,
    pub things: BTreeMap<(Kind, String), Thing>,
    pub links: Vec<Link>,
}

impl Builder<'_> {
    /// The id of a thing, made when it is new.
    pub fn thing(&mut self, kind: Kind, name: &str, lines: Vec<String>) -> String {
        let n = self.things.len();
        let thing = self.things.entry((kind, name.to_string())).or_insert_with(|| Thing {
            id: format!("t{n}"),
            kind,
            lines,
        });
        thing.id.clone()
    }

    pub fn link(&mut self, from: &str, to: &str, label: &str) {
        self.links.push(Link { from: from.into(), to: to.into(), label: label.into() });
    }

    fn agent(&mut self, i: usize, agent: &Agent) -> AgentBox {
        let robots: Vec<String> = self
            .graph
            .robots
            .iter()
            .filter(|r| r.agents.iter().any(|b| b.agent as usize == i))
            .map(|r| if r.count.is_some() { format!("{}[]", r.name) } else { r.name.to_string() })
            .collect();
        let on = match robots.len() {
            0 => String::new(),
            1..=4 => format!(" on {}", robots.join(", ")),
            n => format!(" on {n} robots"),
        };
        let units: Vec<UnitBox> =
            agent.units.iter().enumerate().map(|(j, u)| self.unit(i, j, agent, u)).collect();
        for (k, arbiter) in agent.arbiters.iter().enumerate() {
            let actuator = reach::port(agent, false, arbiter.actuator);
            let strategy = match &arbiter.strategy {
                Strategy::Priority(_) => "priority index",
                Strategy::Layers(_) => "layers",
                Strategy::Switch => "switch",
                Strategy::Blend(_) => "blend",
            };
            let id = self.thing(
                Kind::Arbiter,
                &format!("{i}.{k}"),
                vec![format!("{}.{actuator}", agent.name), strategy.into()],
            );
            for (rank, s) in arbiter.sources.iter().enumerate() {
                self.link(&unit_id(s.agent as usize, s.unit as usize), &id, &format!("{}", rank + 1));
            }
            let to = self.thing(Kind::Actuator, &actuator, vec![actuator.clone()]);
            self.link(&id, &to, "");
        }
        AgentBox { id: format!("a{i}"), title: format!("{}{on}", agent.name), units }
    }

    fn unit(&mut self, i: usize, j: usize, agent: &Agent, unit: &Unit) -> UnitBox {
        let (id, r) = (unit_id(i, j), Reach::of(unit));
        for p in &r.readings {
            let name = reach::port(agent, true, *p);
            let sensor = self.thing(Kind::Sensor, &name, vec![name.clone()]);
            self.link(&sensor, &id, "");
        }
        for t in &r.heard {
            let topic = self.topic(*t);
            self.link(&topic, &id, "");
        }
        for t in &r.publishes {
            let topic = self.topic(*t);
            self.link(&id, &topic, "");
        }
        for p in r.commands.iter().filter(|p| !self.arbitrated(i, j, agent, **p)).copied().collect::<Vec<_>>()
        {
            let name = reach::port(agent, false, p);
            let actuator = self.thing(Kind::Actuator, &name, vec![name.clone()]);
            self.link(&id, &actuator, "");
        }
        for e in &r.raises {
            for (k, other) in agent.units.iter().enumerate().filter(|(_, u)| Reach::of(u).waits.contains(e)) {
                let _ = other;
                self.link(&id, &unit_id(i, k), agent.events.get(*e as usize).map_or("event", |n| n));
            }
        }
        for (c, performative) in &r.opens {
            let talk = self.conversation(*c);
            self.link(&id, &talk, performative);
        }
        if let Trigger::Talk { conversation, what, .. } = &unit.trigger {
            let talk = self.conversation(*conversation);
            let what = match what {
                Talk::Message { performative, .. } => performative.to_string(),
                Talk::Timeout => "timeout".into(),
                Talk::Settled => "settled".into(),
            };
            self.link(&talk, &id, &what);
        }
        for (performative, to, content) in &r.tells {
            for (k, l) in self.told(performative, to, content) {
                self.link(&id, &unit_id(k, l), &format!("{performative} {content}"));
            }
        }
        UnitBox {
            id,
            title: format!("{} {}", unit.name, self.trigger(agent, unit)),
            inside: self.inside(unit),
        }
    }

    fn topic(&mut self, index: u32) -> String {
        let graph = self.graph;
        match graph.topics.get(index as usize) {
            Some(t) => {
                self.thing(Kind::Topic, &t.channel.name, vec![t.channel.name.to_string(), t.ty.to_string()])
            }
            None => self.thing(Kind::Topic, "?", vec!["?".into()]),
        }
    }

    fn conversation(&mut self, index: u32) -> String {
        let (name, protocol) = match self.graph.conversations.get(index as usize) {
            Some(c) => (c.name.to_string(), c.protocol.to_string()),
            None => ("?".into(), String::new()),
        };
        self.thing(
            Kind::Topic,
            &format!("conversation {name}"),
            vec![format!("conversation {name}"), protocol],
        )
    }

    /// Whether an arbiter of any agent listens to the unit for the actuator it commands by `port`.
    fn arbitrated(&self, i: usize, j: usize, agent: &Agent, port: u32) -> bool {
        let name = reach::port(agent, false, port);
        self.graph.agents.iter().any(|owner| {
            owner.arbiters.iter().any(|a| {
                reach::port(owner, false, a.actuator) == name
                    && a.sources.iter().any(|s| (s.agent as usize, s.unit as usize) == (i, j))
            })
        })
    }

    /// Units that a message told to agent `to` sets off.
    fn told(&self, performative: &str, to: &str, content: &str) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        for (k, agent) in self.graph.agents.iter().enumerate().filter(|(_, a)| &*a.name == to) {
            for (l, unit) in agent.units.iter().enumerate() {
                if matches!(&unit.trigger, Trigger::Told { performative: p, content: c, .. } if &**p == performative && &**c == content)
                {
                    out.push((k, l));
                }
            }
        }
        out
    }

    fn trigger(&self, agent: &Agent, unit: &Unit) -> String {
        match &unit.trigger {
            Trigger::Every { period, .. } => format!("every {}", self.text(period.span, "period")),
            Trigger::Step { .. } => "every step".into(),
            Trigger::Message { topic, .. } => {
                format!("on {}", self.graph.topics.get(*topic as usize).map_or("?", |t| &t.channel.name))
            }
            Trigger::Told { performative, content, .. } => format!("on {performative} {content}"),
            Trigger::Talk { conversation, what, .. } => {
                let of = self.graph.conversations.get(*conversation as usize).map_or("?", |c| &c.name);
                match what {
                    Talk::Message { performative, .. } => format!("on {of} {performative}"),
                    Talk::Timeout => format!("on {of} timeout"),
                    Talk::Settled => format!("on {of} settled"),
                }
            }
            Trigger::Reading(p) => format!("on {}", reach::port(agent, true, *p)),
            Trigger::Event(e) => format!("on {}", agent.events.get(*e as usize).map_or("?", |n| n)),
            Trigger::Param(p) => {
                format!("on {}", self.graph.params.get(*p as usize).map_or("?", |p| &*p.name))
            }
        }
    }

    fn inside(&self, unit: &Unit) -> Inside {
        match &unit.kind {
            UnitKind::Service(body) => {
                Inside::Lines(reach::rules(body).iter().map(|r| self.guard(&r.guard, r.at)).collect())
            }
            UnitKind::Machine(states) => self.machine(states),
            UnitKind::Plan { nodes, .. } => self.plan(nodes),
        }
    }

    fn machine(&self, states: &[MachineState]) -> Inside {
        let mut edges = Vec::new();
        for (i, s) in states.iter().enumerate() {
            for t in s.transitions.iter().filter(|t| (t.target as usize) < states.len()) {
                edges.push((i, t.target as usize, self.guard(&t.guard, t.at)));
            }
        }
        Inside::Nodes { round: true, nodes: states.iter().map(|s| s.name.to_string()).collect(), edges }
    }

    fn plan(&self, nodes: &[PlanNode]) -> Inside {
        let mut edges = Vec::new();
        for (i, n) in nodes.iter().enumerate() {
            edges.extend(
                n.children
                    .iter()
                    .filter(|c| (**c as usize) < nodes.len())
                    .map(|c| (i, *c as usize, String::new())),
            );
        }
        Inside::Nodes { round: false, nodes: nodes.iter().map(|n| cut(&self.plan_label(n))).collect(), edges }
    }

    /// A guard as written; `otherwise` when it is empty.
    fn guard(&self, guard: &[Conjunct], at: Span) -> String {
        if guard.is_empty() { "otherwise".into() } else { self.text(at, "guard") }
    }

    /// The source text of a span, on one line, without the word that introduces it.
    pub(super) fn text(&self, at: Span, otherwise: &str) -> String {
        let text = self
            .graph
            .sources
            .get(at.file as usize)
            .and_then(|s| s.text.get(at.start as usize..at.end as usize));
        let line = text.unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
        let line = line.strip_prefix("when ").unwrap_or(&line);
        if line.is_empty() { otherwise.into() } else { cut(line) }
    }

    fn plan_label(&self, n: &PlanNode) -> String {
        let (kind, expression) = plan_kind(n);
        let label = n.label.split_whitespace().collect::<Vec<_>>().join(" ");
        match expression.map(|e| self.text(e.span, "")).filter(|t| !t.is_empty()) {
            Some(text) if label.is_empty() || label == kind => format!("{kind} {text}"),
            _ if label.is_empty() => kind.into(),
            _ if label.starts_with(kind) => label,
            _ => format!("{kind}: {label}"),
        }
    }

    fn goals(&mut self) {
        for goal in &self.graph.goals {
            let name = goal.name.to_string();
            let id = self.thing(Kind::Goal, &name, vec![format!("goal {name}")]);
            for s in &goal.subgoals {
                let Some(agent) = s.agent.map(|a| a as usize) else {
                    self.allocated(&id, &s.name);
                    continue;
                };
                let plan = self.graph.agents.get(agent).and_then(|a| {
                    a.units.iter().position(
                        |u| matches!(&u.kind, UnitKind::Plan { subgoal: Some(g), .. } if *g == s.name),
                    )
                });
                let from = plan.map_or_else(|| format!("a{agent}"), |j| unit_id(agent, j));
                self.link(&from, &id, &s.name);
            }
        }
    }
}

/// Those who offer what the plans for a sub-goal need.
impl Builder<'_> {
    fn allocated(&mut self, goal: &str, subgoal: &str) {
        let graph = self.graph;
        for plan in graph.plans.iter().filter(|p| *p.target == *subgoal) {
            for (service, _) in &plan.needs {
                for (a, agent) in graph.agents.iter().enumerate() {
                    let offer = agent.offers.iter().find(|o| o.name == *service);
                    if let Some(unit) = offer.and_then(|o| o.unit) {
                        self.link(&unit_id(a, unit as usize), goal, &format!("{subgoal} by {}", plan.name));
                    }
                }
            }
        }
    }
}

fn unit_id(agent: usize, unit: usize) -> String {
    format!("a{agent}u{unit}")
}

/// What a plan node is called, and the expression that belongs to it.
fn plan_kind(n: &PlanNode) -> (&'static str, Option<&Expr>) {
    let kind = match &n.kind {
        PlanKind::Sequence { memory: true } => "sequence",
        PlanKind::Sequence { memory: false } => "reactive sequence",
        PlanKind::Fallback { memory: true } => "fallback",
        PlanKind::Fallback { memory: false } => "reactive fallback",
        PlanKind::Parallel { .. } => "parallel",
        PlanKind::Retry(_) => "retry",
        PlanKind::Timeout(_) => "timeout",
        PlanKind::Repeat { .. } => "repeat",
        PlanKind::Invert => "invert",
        PlanKind::Succeed => "succeed",
        PlanKind::Check(_) => "check",
        PlanKind::Wait(_) => "wait",
        PlanKind::WaitUntil(_) => "wait until",
        PlanKind::Act { .. } => "do",
    };
    let expression = match &n.kind {
        PlanKind::Timeout(e) | PlanKind::Check(e) | PlanKind::Wait(e) | PlanKind::WaitUntil(e) => Some(e),
        PlanKind::Repeat { condition, .. } => condition.as_ref(),
        _ => None,
    };
    (kind, expression)
}

fn cut(text: &str) -> String {
    if text.chars().count() <= TEXT {
        return text.into();
    }
    text.chars().take(TEXT - 1).chain(['…']).collect()
}
