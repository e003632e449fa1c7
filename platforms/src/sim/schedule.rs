//! When sensors capture, and when what they captured is delivered.

use super::{
    args::Args,
    body::Body,
    camera::{Cameraman, Order, Taking},
    cargo::Cargo,
    motion::Drive,
    scene::{Chassis, Things},
    sensors::{self, Mount, Nearby, Sensor, View},
};
use soifra_runtime::{Reading, Readings, Scene, Time};
use std::{collections::VecDeque, sync::Arc};

/// All sensors that somebody reads. Robots of one platform capture at the same instants, so there are no
/// more entries here than platforms have sensors, whatever the number of robots.
#[derive(Debug)]
pub struct Schedule {
    groups: Vec<Group>,
    nearby: Nearby,
    robots: usize,
}

/// A sensor of a platform on the robots that use it.
#[derive(Debug)]
struct Group {
    sensor: Box<dyn Sensor>,
    /// Index among the sensors of the platform.
    index: u32,
    /// Robots, by seat.
    robots: Vec<u32>,
    period: i64,
    latency: i64,
    /// Next capture.
    next: i64,
    /// Captured, not delivered yet.
    flights: VecDeque<Flight>,
    /// Registers for later flights.
    spare: Vec<Vec<f64>>,
}

/// The readings of all seats at one capture.
#[derive(Debug)]
struct Flight {
    captured: i64,
    registers: Vec<f64>,
    /// Images, by seat; none where readings are numbers.
    images: Vec<Taking>,
}

impl Schedule {
    /// Of the sensors that the scene says are read.
    pub fn new(scene: &Scene, chassis: &[Chassis]) -> Result<Schedule, String> {
        let mut groups = Vec::new();
        for (p, (platform, chassis)) in scene.platforms.iter().zip(chassis).enumerate() {
            let of = format!("platform `{}`", platform.name);
            for (index, part) in platform.of_role("sensor").enumerate() {
                let reads = |i: &usize| {
                    let r = &scene.bodies()[*i];
                    r.platform as usize == p && r.consumed.get(index).copied().unwrap_or(false)
                };
                let seats: Vec<usize> = (0..scene.bodies().len()).filter(reads).collect();
                if seats.is_empty() {
                    continue;
                }
                let args = Args { part, of: &of };
                let period = match (args.has("period"), scene.step) {
                    (true, _) => args.period("period")?,
                    (false, Some(step)) if step.0 > 0 => step,
                    _ => return Err(args.wrong("it has no `period`, and the mission has no step clock")),
                };
                let names: Vec<&str> = seats.iter().map(|i| scene.bodies()[*i].name.as_str()).collect();
                groups.push(Group {
                    sensor: sensors::build(Mount { args, chassis, seed: scene.seed, robots: &names })?,
                    index: index as u32,
                    robots: seats.iter().map(|i| *i as u32).collect(),
                    period: period.0,
                    latency: args.duration("latency")?.0,
                    next: 0,
                    flights: VecDeque::new(),
                    spare: Vec::new(),
                });
            }
        }
        Ok(Schedule { groups, nearby: Nearby::default(), robots: scene.bodies().len() })
    }

    /// The next instant of a capture; [`i64::MAX`] without sensors.
    pub fn next_capture(&self) -> i64 {
        self.groups.iter().map(|g| g.next).min().unwrap_or(i64::MAX)
    }

    /// The next instant of a delivery.
    pub fn next_delivery(&self) -> Option<Time> {
        self.groups.iter().map(|g| Time(g.due())).min()
    }

    /// Captures what is to be captured at `t`. All motion up to then must be planned.
    pub fn capture(
        &mut self,
        t: Time,
        bodies: &[Body],
        drives: &[Box<dyn Drive>],
        things: &Things,
        cargo: &Cargo,
        cameraman: Option<&Cameraman>,
    ) {
        self.nearby.reset(self.robots);
        for group in self.groups.iter_mut().filter(|g| g.next == t.0) {
            self.nearby.fill(group.sensor.needs(), bodies, t);
            let view = View { at: t, bodies, drives, things, cargo, nearby: &self.nearby };
            let mut registers = group.spare.pop().unwrap_or_default();
            registers.clear();
            for (seat, robot) in group.robots.iter().enumerate() {
                group.sensor.capture(seat, *robot as usize, &view, &mut registers);
            }
            let mut images = Vec::new();
            if let Some(cameraman) = cameraman.filter(|_| group.sensor.takes_images()) {
                let order = |robot: &u32| Order {
                    robot: *robot,
                    sensor: group.index,
                    captured: t,
                    view: cameraman.studio().view(*robot, group.index, bodies, t),
                };
                images.extend(group.robots.iter().map(order).map(|o| cameraman.order(o)));
            }
            group.flights.push_back(Flight { captured: t.0, registers, images });
            group.next = group.next.saturating_add(group.period);
        }
    }

    /// Hands over what is due by `now`, in order of delivery, robot, sensor.
    pub fn deliver(&mut self, now: Time, readings: &mut Readings, cameraman: &mut Option<Cameraman>) {
        let from = readings.items.len();
        let mut flights = 0;
        for group in &mut self.groups {
            while let Some(flight) = group.flights.front()
                && flight.captured.saturating_add(group.latency) <= now.0
                && let Some(mut flight) = group.flights.pop_front()
            {
                let delivered = Time(flight.captured.saturating_add(group.latency));
                let width = flight.registers.len() / group.robots.len();
                let captured = Time(flight.captured);
                // The first are handed over as they are.
                let from = match readings.registers.is_empty() {
                    true => {
                        std::mem::swap(&mut readings.registers, &mut flight.registers);
                        0
                    }
                    false => {
                        readings.registers.extend_from_slice(&flight.registers);
                        readings.registers.len() - flight.registers.len()
                    }
                };
                let taken: Vec<Option<u32>> = flight
                    .images
                    .drain(..)
                    .map(|taking| {
                        let image = cameraman.as_mut()?.deliver(taking)?;
                        readings.images.push(Arc::new(image));
                        Some(readings.images.len() as u32 - 1)
                    })
                    .collect();
                let reading = |(seat, robot): (usize, &u32)| {
                    let from = (from + seat * width) as u32;
                    let (robot, sensor, to) = (*robot, group.index, from + width as u32);
                    let image = taken.get(seat).copied().flatten();
                    Reading { robot, sensor, captured, delivered, from, to, image }
                };
                readings.items.extend(group.robots.iter().enumerate().map(reading));
                group.spare.push(flight.registers);
                flights += 1;
            }
        }
        if flights > 1 {
            readings.items[from..].sort_by_key(|r| (r.delivered, r.robot, r.sensor));
        }
    }
}

impl Group {
    /// When its next reading is delivered.
    fn due(&self) -> i64 {
        self.flights.front().map_or(self.next, |f| f.captured).saturating_add(self.latency)
    }
}
