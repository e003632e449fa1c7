//! The surroundings of an activation: what an agent can know, and the log of what it does.

use super::{
    board::{Board, Near},
    cast::{Cast, Instance},
    directory::Directory,
    log::{Item, Log, Opened, Replied, Told},
    regions::Regions,
    senses::Senses,
    store::{AgentShelf, Store},
};
use crate::{
    Mission, Scene, Time,
    mission::{code::BindingCode, start},
    seed::Stream,
};
use soifra_graph::{
    Distribution, Function, Name, Own, Type, TypeTable, Value,
    eval::{Effect, Env, FaultKind, copy_registers},
    reason,
};

/// What all activations of an instant share; nothing in it changes before they are committed.
pub(crate) struct Instant<'a> {
    pub mission: &'a Mission,
    pub scene: &'a Scene,
    pub cast: &'a Cast,
    pub senses: &'a Senses,
    pub boards: &'a [Board],
    pub regions: &'a Regions,
    pub params: &'a [f64],
    pub texts: &'a soifra_graph::Texts,
    pub directory: &'a Directory,
    pub store: &'a Store,
    /// True positions of the robots, for the radio.
    pub places: &'a [[f64; 3]],
    pub now: Time,
    pub seed: u64,
    /// Whether a trace is kept.
    pub trace: bool,
    /// Threads that a service may make use of, the calling one included.
    pub threads: usize,
}

impl Instant<'_> {
    /// Steps since the run began.
    pub fn steps(&self) -> f64 {
        self.scene.step.map_or(0.0, |s| (self.now.0 / s.0.max(1)) as f64)
    }
}

/// The surroundings of one agent.
pub(crate) struct AgentEnv<'a, 'i> {
    pub instant: &'a Instant<'i>,
    pub instance: u32,
    pub who: &'a Instance,
    pub binding: &'a BindingCode,
    pub log: &'a mut Log,
    pub near: &'a mut Near,
    pub heard: &'a mut Vec<u64>,
    pub drawn: &'a mut u64,
    /// When the current state of the machine was entered.
    pub entered: Time,
}

impl Env for AgentEnv<'_, '_> {
    fn now(&self) -> Result<f64, FaultKind> {
        Ok(self.instant.now.seconds())
    }

    fn steps(&self) -> Result<f64, FaultKind> {
        Ok(self.instant.steps())
    }

    fn elapsed(&self) -> Result<f64, FaultKind> {
        Ok((self.instant.now - self.entered).seconds())
    }

    fn own(&self, which: Own, out: &mut [f64]) -> Result<(), FaultKind> {
        start::own(self.instant.scene, self.who.robot, which, out)
    }

    fn reading(&mut self, port: u32, optional: bool, out: &mut [f64]) -> Result<(), FaultKind> {
        let sensor = self.binding.sensors.get(port as usize).ok_or(FaultKind::Malformed)?;
        let reading = self.instant.senses.get(self.who.robot, *sensor, self.instant.now);
        let value = match (optional, reading) {
            (true, Err(reason)) => {
                out.fill(0.0);
                if let Some(tag) = out.first_mut() {
                    *tag = reason::tag(reason);
                }
                return Ok(());
            }
            (true, Ok(value)) => {
                let (tag, rest) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
                *tag = 0.0;
                return hand_over(rest, value);
            }
            (false, Ok(value)) => value,
            (false, Err(_)) => return Err(FaultKind::Unavailable("a reading")),
        };
        hand_over(out, value)
    }

    fn heard(&mut self, topic: u32, out: &mut [f64]) -> Result<(), FaultKind> {
        let board = self.instant.boards.get(topic as usize).ok_or(FaultKind::Malformed)?;
        let place = self.instant.places.get(self.who.robot as usize).copied().unwrap_or_default();
        self.heard.clear();
        let records = self.instant.trace.then_some(&mut *self.heard);
        board.hear(self.instant.now, self.instance, place, out, self.near, records);
        self.log.items.extend(self.heard.iter().map(|r| Item::Heard(*r)));
        Ok(())
    }

    fn offering(&mut self, service: &str, out: &mut [f64]) -> Result<(), FaultKind> {
        let (count, items) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
        items.fill(0.0);
        let mut found = 0;
        for (slot, agent) in items.iter_mut().zip(self.instant.directory.search(service)) {
            *slot = f64::from(agent);
            found += 1;
        }
        *count = f64::from(found);
        Ok(())
    }

    fn robot(&self) -> Option<u32> {
        Some(self.who.robot)
    }

    fn inside(&self, point: [f64; 3], region: u32) -> Result<bool, FaultKind> {
        self.instant.regions.inside(point, region)
    }

    fn service(&mut self, which: Function, args: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        let services = self.instant.mission.services().ok_or(FaultKind::Unavailable("a service"))?;
        let mut shelf = AgentShelf {
            store: self.instant.store,
            made: &mut self.log.made,
            instance: self.instance,
            scene: self.instant.scene,
            truth: false,
            threads: self.instant.threads,
        };
        services.call(which, args, &mut shelf, out)
    }

    fn draw(&mut self, from: Distribution) -> Result<f64, FaultKind> {
        let mut stream = Stream::at(self.instant.seed, self.who.stream, *self.drawn);
        let x = stream.draw(from);
        *self.drawn = stream.position();
        Ok(x)
    }

    fn command(&mut self, port: u32, registers: &[f64]) -> Result<(), FaultKind> {
        self.log.command(port, registers);
        Ok(())
    }

    fn publish(&mut self, topic: u32, registers: &[f64]) -> Result<(), FaultKind> {
        self.log.publish(topic, registers);
        Ok(())
    }

    fn effect(&mut self, effect: Effect<'_>) -> Result<(), FaultKind> {
        let trace = self.instant.trace;
        let log = &mut *self.log;
        match effect {
            Effect::Tell { performative, to, content, registers } => {
                let (performative, to, content) = (performative.into(), to.into(), content.clone());
                let registers = log.keep(registers);
                log.items.push(Item::Tell(Box::new(Told { performative, to, content, registers })));
            }
            Effect::Use { device, seconds } => log.items.push(Item::Use { device, seconds }),
            Effect::Open { conversation, performative, registers, to, within } => {
                let (registers, to) = (log.keep(registers), log.keep(to));
                let performative = performative.into();
                let opened = Opened { conversation, performative, registers, to, within };
                log.items.push(Item::Open(Box::new(opened)));
            }
            Effect::Reply { performative, reason, registers, thread, .. } => {
                let registers = log.keep(registers);
                let (performative, reason) = (performative.into(), reason.map(str::to_string));
                log.items.push(Item::Reply(Box::new(Replied { performative, reason, registers, thread })));
            }
            Effect::Raise(event) => log.items.push(Item::Raise(event)),
            Effect::Govern(what) => log.items.push(Item::Govern(Box::new(what.clone()))),
            Effect::SetParam { param, registers } => {
                let registers = log.keep(registers);
                log.items.push(Item::SetParam { param, registers });
            }
            Effect::Note { text, value } if trace => {
                let text = self.note(text, value).into();
                self.log.items.push(Item::Note(text));
            }
            Effect::RuleFired { rule, at } if trace => log.items.push(Item::Rule { rule, at }),
            Effect::Note { .. } | Effect::RuleFired { .. } => {}
        }
        Ok(())
    }
}

/// A reading for a port: the port's list may have room for more items than the sensor has.
fn hand_over(out: &mut [f64], value: &[f64]) -> Result<(), FaultKind> {
    let (front, rest) = out.split_at_mut_checked(value.len()).ok_or(FaultKind::Malformed)?;
    copy_registers(value, front);
    rest.fill(0.0);
    Ok(())
}

impl AgentEnv<'_, '_> {
    fn note(&self, text: &str, value: Option<(&Type, &[f64])>) -> String {
        let Some((ty, registers)) = value else { return text.to_string() };
        let types = &self.instant.mission.graph.types;
        let value = show(&Value::from_registers(registers, ty, types, self.instant.texts), ty, types);
        if text.is_empty() { value } else { format!("{text}: {value}") }
    }
}

/// A value as a remark shows it, in SI units.
fn show(value: &Value, ty: &Type, types: &TypeTable) -> String {
    let list = |items: &[f64]| items.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    match (value, ty) {
        (Value::Bool(b), _) => b.to_string(),
        (Value::Int(i), _) => i.to_string(),
        (Value::Number(x), Type::Quantity(d)) => match d.si_unit() {
            unit if unit.is_empty() => x.to_string(),
            unit => format!("{x} {unit}"),
        },
        (Value::Number(x), _) => format!("{x} rad"),
        (Value::Text(s), _) => s.clone(),
        (Value::Variant(v), _) => v.to_string(),
        (Value::Vector(v), _) => format!("({})", list(v)),
        (Value::Pose(v), _) => format!("({})", list(v)),
        (Value::Twist(v), _) => format!("({})", list(v)),
        (Value::Matrix(v), _) => format!("[{}]", list(v)),
        (Value::Some(v), Type::Option(t)) => show(v, t, types),
        (Value::None(why), _) => format!("none ({why})"),
        (Value::List(items), Type::List(t, _)) => {
            format!("[{}]", items.iter().map(|v| show(v, t, types)).collect::<Vec<_>>().join(", "))
        }
        (Value::Record(values), Type::Record(name)) => {
            let fields = types.records.get(name).map(|r| r.fields.as_slice()).unwrap_or_default();
            let field = |(v, (name, t)): (&Value, &(Name, Type))| format!("{name}: {}", show(v, t, types));
            format!("{name}({})", values.iter().zip(fields).map(field).collect::<Vec<_>>().join(", "))
        }
        (other, _) => format!("{other:?}"),
    }
}
