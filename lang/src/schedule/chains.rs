//! How long it takes at most from the capture of a reading to the first command that takes it into account.
//!
//! A unit that a reading, event or message releases adds its response time. A periodic unit that looks for
//! news by itself adds its period before: the news may come just after it looked. What a unit leaves in a
//! state, topic, event or parameter, tells another agent of the robot or says in a conversation is taken up by the
//! units that read or await it.

use super::{Core, nanoseconds, sensor_times};
use crate::check::{Constants, walk};
use soifra_graph::{
    Agent, Component, Expr, Graph, Name, Op, RobotGroup, StmtKind, Talk, Trigger, Type, Unit,
};

/// A chain of units between a sensor and an actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Robot, or array of robots.
    pub robot: Name,
    /// Sensor.
    pub sensor: Name,
    /// Units on the way, in order.
    pub links: Vec<Link>,
    /// Actuator.
    pub actuator: Name,
    /// From capture to delivery, in nanoseconds.
    pub sensor_latency: i64,
    /// The whole, in nanoseconds; absent when a part has no bound.
    pub latency: Option<i64>,
}

/// A unit of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Agent.
    pub agent: Name,
    /// Unit.
    pub unit: Name,
    /// Longest time until it looks.
    pub wait: i64,
    /// Longest time until it is done; absent without bound.
    pub response: Option<i64>,
}

/// The most units of a chain.
const LONGEST: usize = 12;
/// The most chains that are followed on a robot.
const MOST: usize = 20_000;

/// What passes from unit to unit.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum News {
    Sensor(Name),
    State(u32, u32),
    Event(u32, u32),
    Topic(u32),
    Param(u32),
    /// Told by an agent, any when absent, to another: performative and record.
    Told {
        from: Option<Name>,
        to: Name,
        performative: Name,
        content: Name,
    },
    /// Said in a conversation.
    Said {
        conversation: u32,
        performative: Name,
    },
}

impl News {
    /// Whether it is what somebody waits for.
    fn is(&self, awaited: &News) -> bool {
        match (self, awaited) {
            (
                News::Told { to, performative, content, .. },
                News::Told { from: None, to: t, performative: p, content: c },
            ) => (to, performative, content) == (t, p, c),
            _ => self == awaited,
        }
    }
}

/// What a message takes on a told way or a channel that says nothing else (ns).
const SHORTEST: i64 = 1_000;

struct Node<'g> {
    agent: &'g Agent,
    unit: &'g Unit,
    /// What releases it.
    released_by: Option<News>,
    /// What it looks at.
    reads: Vec<News>,
    /// What it leaves, and after which delay.
    leaves: Vec<(News, i64)>,
    actuators: Vec<Name>,
    period: Option<i64>,
    response: Option<i64>,
}

/// The longest chain for each sensor and actuator of each robot.
pub fn chains(g: &Graph, cores: &[Core], known: &mut Constants<'_>) -> Vec<Chain> {
    let mut out: Vec<Chain> = Vec::new();
    for group in &g.robots {
        let nodes = nodes(g, group, cores, known);
        let timed = nodes.iter().any(|n| n.unit.timing.worst_case.is_some());
        if !timed {
            continue;
        }
        let mut sensors: Vec<Name> = Vec::new();
        for n in nodes.iter().flat_map(|n| n.reads.iter().chain(&n.released_by)) {
            if let News::Sensor(s) = n
                && !sensors.contains(s)
            {
                sensors.push(s.clone());
            }
        }
        for sensor in sensors {
            let times = sensor_times(g, group, &sensor);
            let latency = times.and_then(|t| t.latency).and_then(|e| nanoseconds(known, e, &[])).unwrap_or(0);
            let mut search = Search { nodes: &nodes, path: Vec::new(), found: Vec::new(), steps: 0 };
            search.follow(&News::Sensor(sensor.clone()), 0);
            for (actuator, path, rest) in search.found {
                let links = path.iter().map(|(i, wait)| nodes[*i].link(*wait)).collect();
                let latency_all = rest.map(|r| r + latency);
                out.push(Chain {
                    robot: group.name.clone(),
                    sensor: sensor.clone(),
                    links,
                    actuator,
                    sensor_latency: latency,
                    latency: latency_all,
                });
            }
        }
    }
    out
}

impl Node<'_> {
    fn link(&self, wait: i64) -> Link {
        let (agent, unit) = (self.agent.name.clone(), self.unit.name.clone());
        Link { agent, unit, wait, response: self.response }
    }
}

/// A path: nodes and how long each waits.
type Path = Vec<(usize, i64)>;

struct Search<'n, 'g> {
    nodes: &'n [Node<'g>],
    path: Path,
    /// Longest path so far for each actuator; `None` without bound.
    found: Vec<(Name, Path, Option<i64>)>,
    steps: usize,
}

impl Search<'_, '_> {
    fn follow(&mut self, news: &News, delay: i64) {
        for i in 0..self.nodes.len() {
            let n = &self.nodes[i];
            let released = n.released_by.as_ref().is_some_and(|awaited| news.is(awaited));
            if (!released && !n.reads.contains(news)) || self.path.iter().any(|(j, _)| *j == i) {
                continue;
            }
            self.steps += 1;
            if self.path.len() >= LONGEST || self.steps > MOST {
                return;
            }
            // Who is released by something else looks when that happens: when is not known.
            let wait = match (released, n.period) {
                (true, _) => 0,
                (false, Some(p)) => p,
                (false, None) => continue,
            };
            self.path.push((i, wait + delay));
            for a in n.actuators.clone() {
                self.arrive(a);
            }
            for (next, delay) in n.leaves.clone() {
                self.follow(&next, delay);
            }
            self.path.pop();
        }
    }

    fn arrive(&mut self, actuator: Name) {
        let mut whole = Some(0i64);
        for (i, wait) in &self.path {
            let part = self.nodes[*i].response.and_then(|r| r.checked_add(*wait));
            whole = whole.zip(part).and_then(|(a, b)| a.checked_add(b));
        }
        let path = self.path.clone();
        match self.found.iter_mut().find(|f| f.0 == actuator) {
            Some(f) if f.2.is_some() && (whole.is_none() || whole > f.2) => (f.1, f.2) = (path, whole),
            Some(_) => {}
            None => self.found.push((actuator, path, whole)),
        }
    }
}

/// How long a message travels.
fn delay(channel: Option<&Component>, known: &mut Constants<'_>) -> i64 {
    let delay = channel.and_then(|c| c.args.iter().find(|(n, _)| &**n == "delay"));
    delay.and_then(|(_, e)| nanoseconds(known, e, &[])).unwrap_or(SHORTEST).max(SHORTEST)
}

fn said(g: &Graph, conversation: u32, performative: &Name, known: &mut Constants<'_>) -> (News, i64) {
    let channel = g.conversations.get(conversation as usize).map(|c| &c.channel);
    (News::Said { conversation, performative: performative.clone() }, delay(channel, known))
}

fn nodes<'g>(
    g: &'g Graph,
    group: &'g RobotGroup,
    cores: &[Core],
    known: &mut Constants<'_>,
) -> Vec<Node<'g>> {
    let mut out = Vec::new();
    for binding in &group.agents {
        let Some(agent) = g.agents.get(binding.agent as usize) else { continue };
        let a = binding.agent;
        for (u, unit) in agent.units.iter().enumerate() {
            let sensor = |p: u32| agent.sensors.get(p as usize).map(|s| News::Sensor(s.name.clone()));
            let released_by = match &unit.trigger {
                Trigger::Reading(p) => sensor(*p),
                Trigger::Event(e) => Some(News::Event(a, *e)),
                Trigger::Message { topic, .. } => Some(News::Topic(*topic)),
                Trigger::Param(p) => Some(News::Param(*p)),
                Trigger::Told { performative, content, from, .. } => Some(News::Told {
                    from: from.clone(),
                    to: agent.name.clone(),
                    performative: performative.clone(),
                    content: content.clone(),
                }),
                Trigger::Talk { conversation, what: Talk::Message { performative, .. }, .. } => {
                    Some(News::Said { conversation: *conversation, performative: performative.clone() })
                }
                _ => None,
            };
            let period = match &unit.trigger {
                Trigger::Every { period, .. } => nanoseconds(known, period, &binding.arguments),
                Trigger::Step { .. } => g.step.as_ref().and_then(|s| nanoseconds(known, s, &[])),
                _ => None,
            };
            let mut reads = Vec::new();
            walk::unit(unit, &mut |e: &Expr| match e.op {
                Op::Reading(p) => reads.extend(sensor(p)),
                Op::State(s) => reads.push(News::State(a, s)),
                Op::Heard(t) => reads.push(News::Topic(t)),
                Op::Param(p) => reads.push(News::Param(p)),
                _ => {}
            });
            reads.sort();
            reads.dedup();
            let (mut leaves, mut actuators) = (Vec::new(), Vec::new());
            for s in walk::statements(unit) {
                match &s.kind {
                    StmtKind::Set(s, _) => leaves.push((News::State(a, *s), 0)),
                    StmtKind::Raise(e) => leaves.push((News::Event(a, *e), 0)),
                    StmtKind::Publish(t, _) => {
                        let channel = g.topics.get(*t as usize).map(|t| &t.channel);
                        leaves.push((News::Topic(*t), delay(channel, known)));
                    }
                    StmtKind::SetParam(p, _) => leaves.push((News::Param(*p), SHORTEST)),
                    StmtKind::Tell { performative, to, content } => {
                        let Type::Record(content) = &content.ty else { continue };
                        let told = News::Told {
                            from: Some(agent.name.clone()),
                            to: to.clone(),
                            performative: performative.clone(),
                            content: content.clone(),
                        };
                        leaves.push((told, SHORTEST));
                    }
                    StmtKind::Open(o) => leaves.push(said(g, o.conversation, &o.performative, known)),
                    StmtKind::Reply(r) => leaves.push(said(g, r.conversation, &r.performative, known)),
                    StmtKind::Command(p, _) => {
                        actuators.extend(agent.actuators.get(*p as usize).map(|p| p.name.clone()));
                    }
                    _ => {}
                }
            }
            leaves.sort();
            leaves.dedup();
            actuators.sort();
            actuators.dedup();
            let on_core = unit.timing.core.and_then(|n| {
                let core = cores.iter().find(|c| c.robot == group.name && c.number == n)?;
                core.tasks.iter().find(|t| t.index == (a, u as u32))
            });
            let response = match on_core {
                Some(t) if t.budget > 0 => {
                    t.full_response.max(t.response).min(t.deadline.or(t.full_response))
                }
                Some(t) => t.response,
                None => {
                    let mut time = |e: &Option<Expr>| {
                        e.as_ref().and_then(|e| nanoseconds(known, e, &binding.arguments)).unwrap_or(0)
                    };
                    Some(time(&unit.timing.worst_case) + time(&unit.timing.budget))
                }
            };
            out.push(Node { agent, unit, released_by, reads, leaves, actuators, period, response });
        }
    }
    out
}
