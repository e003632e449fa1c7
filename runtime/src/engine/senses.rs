//! The latest reading of every sensor that somebody reads.
//!
//! A reading counts until two periods of its sensor and its declared latency have passed since it was
//! captured; afterwards it is absent. A reading with a number that is not finite is absent too.

use super::cast::sensor_period;
use crate::{Reading, Scene, Time};
use serde::{Deserialize, Serialize};
use soifra_graph::{Type, TypeTable, eval::copy_registers, reason};

/// A sensor of a robot.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Slot {
    at: u32,
    width: u32,
    grace: Time,
    captured: Time,
    record: u64,
    state: State,
    /// It is the number of an object.
    #[serde(default)]
    opaque: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum State {
    Never,
    Valid,
    Invalid,
}

/// The latest readings.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Senses {
    /// First slot of each robot, and the end.
    first: Vec<u32>,
    slots: Vec<Slot>,
    registers: Vec<f64>,
}

impl Senses {
    pub fn new(scene: &Scene, types: &TypeTable) -> Self {
        let mut s = Senses::default();
        for r in &scene.robots {
            s.first.push(s.slots.len() as u32);
            let Some(platform) = scene.platforms.get(r.platform as usize) else { continue };
            for (i, part) in platform.of_role("sensor").enumerate() {
                let consumed = r.consumed.get(i).copied().unwrap_or(false);
                let width = part.ty.as_ref().filter(|_| consumed).map_or(0, |t: &Type| types.width(t));
                let period = sensor_period(scene, r.platform, i as u32);
                let latency = Time::from_seconds(part.number("latency")).unwrap_or_default();
                let grace = period.map_or(Time::MAX, |p| p + p + latency);
                let at = s.registers.len() as u32;
                let (captured, record, state) = (Time::ZERO, 0, State::Never);
                let opaque = matches!(part.ty, Some(Type::Handle(_)));
                s.slots.push(Slot { at, width: width as u32, grace, captured, record, state, opaque });
                s.registers.resize(s.registers.len() + width, 0.0);
            }
        }
        s.first.push(s.slots.len() as u32);
        s
    }

    /// Whether these are readings of the same sensors.
    pub fn fits(&self, other: &Senses) -> bool {
        let place = |s: &Slot| (s.at, s.width, s.grace);
        self.first == other.first
            && self.registers.len() == other.registers.len()
            && self.slots.iter().map(place).eq(other.slots.iter().map(place))
    }

    fn slot(&self, robot: u32, sensor: u32) -> Option<usize> {
        let from = *self.first.get(robot as usize)?;
        let to = *self.first.get(robot as usize + 1)?;
        (sensor < to - from).then_some((from + sensor) as usize)
    }

    /// Takes a reading; false when nobody reads that sensor, or the reading has the wrong width.
    pub fn take(&mut self, reading: &Reading, registers: &[f64], record: u64) -> bool {
        let Some(i) = self.slot(reading.robot, reading.sensor) else { return false };
        let slot = &mut self.slots[i];
        if slot.width == 0 || registers.len() != slot.width as usize {
            return false;
        }
        let valid = registers.iter().all(|x| x.is_finite());
        slot.state = if valid { State::Valid } else { State::Invalid };
        slot.captured = reading.captured;
        slot.record = record;
        if valid {
            let at = slot.at as usize;
            copy_registers(registers, &mut self.registers[at..at + registers.len()]);
        }
        true
    }

    /// The reading, or the index of the reason why there is none.
    pub fn get(&self, robot: u32, sensor: u32, now: Time) -> Result<&[f64], usize> {
        let slot = self.slot(robot, sensor).map(|i| self.slots[i]).ok_or(reason::NO_READING)?;
        match slot.state {
            State::Never => Err(reason::NO_READING),
            _ if now - slot.captured > slot.grace => Err(reason::EXPIRED),
            State::Invalid => Err(reason::INVALID),
            State::Valid => Ok(&self.registers[slot.at as usize..(slot.at + slot.width) as usize]),
        }
    }

    /// Objects that are readings.
    pub fn opaque(&self) -> impl Iterator<Item = f64> {
        self.slots.iter().filter(|s| s.opaque).filter_map(|s| self.registers.get(s.at as usize).copied())
    }

    /// The record of the reading that counts now.
    pub fn record(&self, robot: u32, sensor: u32, now: Time) -> Option<u64> {
        let slot = self.slots[self.slot(robot, sensor)?];
        (slot.state != State::Never && now - slot.captured <= slot.grace).then_some(slot.record)
    }
}
