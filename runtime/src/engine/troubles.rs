//! Faults that a mission or test declares: agents that die, messages that are lost, late, doubled or unreadable,
//! sensors that fall silent or are off, goals that somebody asks for.

use super::{Engine, queue::Scheduled};
use crate::{
    Event, Mission, Scene, Time,
    mission::START_VALUE,
    scene::Part,
    seed::{Stream, chance},
};
use soifra_graph::{Diagnostic, Dim, Type, TypeTable, Value};

/// What is to go wrong with messages and readings. Fixed at the start.
#[derive(Debug, Default)]
pub(super) struct Troubles {
    messages: Vec<MessageTrouble>,
    sensors: Vec<SensorTrouble>,
}

/// What messages travel on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Route {
    Topic(u32),
    Talk(u32),
}

#[derive(Debug)]
struct MessageTrouble {
    route: Route,
    kind: Kind,
    when: When,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Drop,
    Delay(Time),
    Duplicate,
    Corrupt,
}

#[derive(Debug)]
struct SensorTrouble {
    robot: u32,
    sensor: u32,
    /// Added to distances; without it readings are dropped.
    bias: Option<f64>,
    when: When,
}

/// Between which instants, with what probability, and which random numbers.
#[derive(Debug, Clone, Copy)]
struct When {
    from: Time,
    until: Time,
    chance: f64,
    number: u64,
}

/// What becomes of a message.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Fate {
    pub lost: bool,
    pub late: Time,
    pub twice: bool,
    pub unreadable: bool,
}

/// Marks random numbers of faults among those of `chance`.
const FAULTS: u64 = 2 << 40;

impl When {
    fn of(part: &Part, number: u64) -> Result<When, Diagnostic> {
        let chance = part.args.get("chance").and_then(Value::number).unwrap_or(1.0);
        if !(0.0..=1.0).contains(&chance) {
            return Err(wrong(&format!("a chance of {chance}")));
        }
        let from = time(part.number("from"))?;
        let until = part.optional("until").map_or(Ok(Time::MAX), time)?;
        Ok(When { from, until, chance, number })
    }

    fn is(&self, seed: u64, now: Time, who: u64, which: u64) -> bool {
        (self.from..self.until).contains(&now)
            && (self.chance >= 1.0
                || chance(seed, FAULTS | self.number, who, now.0 as u64, which) < self.chance)
    }
}

fn time(s: f64) -> Result<Time, Diagnostic> {
    Time::from_seconds(s).filter(|t| *t >= Time::ZERO).ok_or_else(|| wrong(&format!("a time of {s} s")))
}

fn wrong(what: &str) -> Diagnostic {
    Diagnostic::error(START_VALUE, format!("a fault cannot have {what}"))
}

fn text<'p>(part: &'p Part, name: &str) -> &'p str {
    match part.args.get(name) {
        Some(Value::Text(t)) => t,
        _ => "",
    }
}

impl Troubles {
    /// What the scene declares.
    ///
    /// # Errors
    /// A time or chance that is none.
    pub fn new(mission: &Mission, scene: &Scene) -> Result<Self, Diagnostic> {
        let mut out = Troubles::default();
        let g = &mission.graph;
        for (number, part) in (0..).zip(&scene.faults) {
            match &*part.model {
                "dropout" | "bias" => {
                    let name = text(part, "sensor");
                    let (robot, sensor) = name.split_once('.').unwrap_or((name, ""));
                    let Some(r) = scene.robots.iter().position(|r| r.name == robot) else { continue };
                    let platform = scene.platforms.get(scene.robots[r].platform as usize);
                    let mut sensors = platform.into_iter().flat_map(|p| p.of_role("sensor"));
                    let Some(s) = sensors.position(|p| p.name == sensor) else { continue };
                    let bias = (&*part.model == "bias").then(|| part.number("by"));
                    let when = When::of(part, number)?;
                    out.sensors.push(SensorTrouble { robot: r as u32, sensor: s as u32, bias, when });
                }
                "drop" | "delay" | "duplicate" | "corrupt" => {
                    let name = text(part, "of");
                    let topic = g.topics.iter().position(|t| *t.channel.name == *name);
                    let talk = g.conversations.iter().position(|c| *c.name == *name);
                    let topic = topic.map(|t| Route::Topic(t as u32));
                    let Some(route) = topic.or(talk.map(|t| Route::Talk(t as u32))) else { continue };
                    let kind = match &*part.model {
                        "drop" => Kind::Drop,
                        "delay" => Kind::Delay(time(part.number("by"))?),
                        "duplicate" => Kind::Duplicate,
                        _ => Kind::Corrupt,
                    };
                    out.messages.push(MessageTrouble { route, kind, when: When::of(part, number)? });
                }
                _ => {}
            }
        }
        Ok(out)
    }

    /// What becomes of a message that is sent now; `which` tells those of one instant apart.
    pub fn fate(&self, route: Route, seed: u64, now: Time, sender: u32, which: u64) -> Fate {
        let mut fate = Fate::default();
        for t in self.messages.iter().filter(|t| t.route == route) {
            if t.when.is(seed, now, u64::from(sender), which) {
                match t.kind {
                    Kind::Drop => fate.lost = true,
                    Kind::Delay(by) => fate.late = fate.late + by,
                    Kind::Duplicate => fate.twice = true,
                    Kind::Corrupt => fate.unreadable = true,
                }
            }
        }
        fate
    }
}

impl Engine<'_> {
    /// Puts the instants of declared faults into the queue.
    ///
    /// # Errors
    /// A time that is none.
    pub(super) fn schedule_faults(&mut self) -> Result<(), Diagnostic> {
        let scene = self.scene;
        for (number, part) in scene.faults.iter().enumerate() {
            match &*part.model {
                "kill" => {
                    let at = time(part.number("at"))?;
                    if let Some(instance) = self.victim(text(part, "agent"), number) {
                        self.schedule_kill(at, instance);
                    }
                }
                "post" => {
                    let at = time(part.number("at"))?;
                    self.queue.put(at, Scheduled::Post(text(part, "goal").to_string()));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The agent of a name, or one of those with it.
    fn victim(&self, name: &str, number: usize) -> Option<u32> {
        let all = 0..self.cast.instances.len() as u32;
        if name.contains('@') {
            return all.into_iter().find(|i| self.agent_name(*i) == name);
        }
        let named = |i: &u32| {
            let kind = self.cast.instances[*i as usize].agent;
            *self.mission.graph.agents[kind as usize].name == *name
        };
        let candidates: Vec<u32> = all.filter(named).collect();
        let draw = Stream::new(self.seed, &format!("fault/{number}/victim")).bits();
        let index = (u128::from(draw) * candidates.len() as u128) >> 64;
        candidates.get(index as usize).copied()
    }

    /// A reading as the faults of its sensor leave it; none when they take it away.
    pub(super) fn troubled(
        &mut self,
        robot: u32,
        sensor: u32,
        registers: &[f64],
        record: Option<u64>,
    ) -> Option<Vec<f64>> {
        let here = |t: &&SensorTrouble| (t.robot, t.sensor) == (robot, sensor);
        let (now, seed) = (self.now, self.seed);
        let struck: Vec<Option<f64>> = self
            .troubles
            .sensors
            .iter()
            .filter(here)
            .filter(|t| t.when.is(seed, now, u64::from(robot), u64::from(sensor)))
            .map(|t| t.bias)
            .collect();
        if struck.is_empty() {
            return Some(registers.to_vec());
        }
        let scene = self.scene;
        let platform = &scene.platforms[scene.robots[robot as usize].platform as usize];
        let part = platform.of_role("sensor").nth(sensor as usize)?;
        let target = format!("{}.{}", scene.robots[robot as usize].name, part.name);
        let lost = struck.iter().any(Option::is_none);
        let text = if lost { "the reading is lost" } else { "the reading is off" };
        self.recorder.record(now, record, || Event::Trouble { target, text: text.to_string() });
        if lost {
            return None;
        }
        let mut out = registers.to_vec();
        let by: f64 = struck.into_iter().flatten().sum();
        if let Some(ty) = &part.ty {
            let mut at = 0;
            shift(ty, &self.mission.graph.types, &mut out, &mut at, by);
        }
        Some(out)
    }

    /// Whether any sensor is troubled at some time.
    pub(super) fn troubles_sensors(&self) -> bool {
        !self.troubles.sensors.is_empty()
    }
}

/// Adds to the distances and positions in a value.
fn shift(ty: &Type, types: &TypeTable, registers: &mut [f64], at: &mut usize, by: f64) {
    let width = types.width(ty);
    let here = *at..*at + width;
    match ty {
        Type::Quantity(Dim::LENGTH) => {
            if let Some(x) = registers.get_mut(*at) {
                *x += by;
            }
        }
        Type::Point(_) | Type::Pose(_) => {
            for x in registers.get_mut(*at..*at + 2).into_iter().flatten() {
                *x += by;
            }
        }
        Type::Option(inner) => {
            let present = registers.get(*at) == Some(&0.0);
            *at += 1;
            if present {
                shift(inner, types, registers, at, by);
            }
        }
        Type::List(item, capacity) => {
            let count = registers.get(*at).copied().unwrap_or(0.0) as usize;
            *at += 1;
            for _ in 0..count.min(*capacity as usize) {
                shift(item, types, registers, at, by);
            }
        }
        Type::Record(name) => {
            for (_, field) in types.records.get(name).into_iter().flat_map(|r| &r.fields) {
                shift(field, types, registers, at, by);
            }
        }
        _ => {}
    }
    *at = here.end;
}
