//! The simulator: a scene whose robots are driven through the port contract.
//!
//! Motion is planned in pieces of constant velocity (`body.rs`), so the world can be asked about any instant
//! up to now. A sensor captures at multiples of its period and delivers a latency later. What a poll
//! returns depends on the commands and the instant alone, not on earlier polls.

pub(crate) mod args;
mod body;
pub mod camera;
mod cargo;
mod collision;
mod flight;
mod geometry;
mod index;
mod motion;
mod movers;
mod noise;
mod power;
mod scene;
mod schedule;
mod sensors;
mod truth;

use body::Body;
use camera::{Cameraman, Studio};
use cargo::Cargo;
use collision::Collisions;
use motion::{Drive, Stride};
use movers::Mover;
use power::Battery;
use scene::Things;
pub(crate) use scene::{Endings, endings};
use schedule::Schedule;
use soifra_runtime::{Platform, Readings, Report, Scene, Time, WorldTruth};

/// Motion is planned that far ahead at a time (ns), and past motion looked at: where much of it has piled up,
/// contacts are checked, so that it can be forgotten.
const AHEAD: i64 = 100_000_000;

/// Contacts are checked at least that often (ns).
const CHECK: i64 = 1_000_000_000;

/// Commands are limited to this in size: beyond it arithmetic overflows.
const LARGEST: f64 = 1e12;

/// A simulated world.
#[derive(Debug)]
pub struct Simulator {
    now: i64,
    /// All motion is planned up to here, at least.
    planned: i64,
    /// Past motion was looked at last.
    looked: i64,
    /// Robots, then movers.
    bodies: Vec<Body>,
    drives: Vec<Box<dyn Drive>>,
    /// Robots that take twists: their motion is planned as time goes on.
    continuous: Vec<u32>,
    movers: Vec<Mover>,
    things: Things,
    cargo: Cargo,
    collisions: Collisions,
    schedule: Schedule,
    /// By platform.
    actuators: Vec<Vec<Actuator>>,
    /// Platform of each robot.
    platforms: Vec<u32>,
    /// By platform.
    batteries: Vec<Option<Battery>>,
    /// By platform.
    endings: Vec<Endings>,
    /// Where somebody reads a camera.
    cameraman: Option<Cameraman>,
}

/// What an actuator does with a command.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Actuator {
    /// Registers: vx vy vz, wx wy wz in base_link.
    Twist,
    /// Registers: heading in map, length.
    Strides {
        /// How long a stride takes (ns).
        duration: i64,
    },
    /// Register: whether it is closed.
    Gripper {
        /// How far it reaches from the rim of the robot.
        reach: f64,
    },
}

impl Simulator {
    /// Builds the simulation of a scene. The error says which part of the scene cannot be simulated and why.
    pub fn new(scene: &Scene) -> Result<Simulator, String> {
        Simulator::with_threads(scene, 1)
    }

    /// As [`Simulator::new`], with so many threads at most. They change nothing but the speed.
    pub fn with_threads(scene: &Scene, threads: usize) -> Result<Simulator, String> {
        // The platform of hosts has no parts, and comes last.
        let bodied = scene.platforms.iter().take_while(|p| !p.parts.is_empty());
        let chassis = bodied.map(scene::chassis).collect::<Result<Vec<_>, _>>()?;
        let actuators = scene::actuators(scene, &chassis)?;
        let things = scene::things(scene)?;
        let batteries = chassis.iter().map(|c| c.battery).collect();
        let population = scene::population(scene, &chassis)?;
        let platforms: Vec<u32> = scene.bodies().iter().map(|r| r.platform).collect();
        let endings = scene::endings(&scene.platforms);
        let studio = Studio::of(scene, &population.bodies)?;
        let twists = |i: &u32| {
            let platform = platforms[*i as usize] as usize;
            actuators[platform].contains(&Actuator::Twist) || chassis[platform].drive.leaves_ground()
        };
        let mut simulator = Simulator {
            now: 0,
            planned: -1,
            looked: 0,
            continuous: (0..platforms.len() as u32).filter(twists).collect(),
            collisions: Collisions::new(platforms.len(), &population.bodies),
            schedule: Schedule::new(scene, &chassis)?,
            bodies: population.bodies,
            drives: population.drives,
            movers: population.movers,
            things,
            cargo: Cargo::new(scene)?,
            batteries,
            actuators,
            platforms,
            endings,
            cameraman: studio.map(|s| Cameraman::new(s, threads)),
        };
        simulator.prepare();
        Ok(simulator)
    }

    /// What leaves the ground takes off at once.
    fn prepare(&mut self) {
        let checked = self.collisions.checked();
        for (drive, body) in self.drives.iter_mut().zip(&mut self.bodies) {
            drive.prepare(body, 0, checked);
        }
    }

    /// Does what a robot of a platform has for a case.
    fn act(&mut self, now: Time, robot: u32, which: fn(&Endings) -> &'static str) -> &'static str {
        self.advance(now.0.max(self.now));
        let platform = self.platforms.get(robot as usize).and_then(|p| self.endings.get(*p as usize));
        let action = platform.map_or("stop", which);
        if action != "land" {
            self.stop(robot);
            return action;
        }
        let (now, checked) = (self.now, self.collisions.checked());
        if let Some((drive, body)) = self.robot(robot) {
            drive.land(body, now, checked);
            self.planned = now;
        }
        action
    }

    /// Plans all motion up to `t`.
    fn extend(&mut self, t: i64) {
        if t <= self.planned {
            return;
        }
        self.planned = i64::MAX;
        let checked = self.collisions.checked();
        for i in &self.continuous {
            let body = &mut self.bodies[*i as usize];
            self.drives[*i as usize].extend(body, t, checked);
            self.planned = self.planned.min(body.planned());
        }
        let movers = &mut self.bodies[self.drives.len()..];
        for (mover, body) in self.movers.iter_mut().zip(movers) {
            mover.extend(body, t, checked);
            self.planned = self.planned.min(body.planned());
        }
    }

    /// When past motion is looked at next.
    fn look(&self) -> i64 {
        let ahead = if self.continuous.is_empty() { CHECK } else { AHEAD };
        self.looked.max(self.collisions.checked()).saturating_add(ahead)
    }

    /// Goes on to `now`: plans, captures, and keeps the search for contacts up to date.
    #[inline]
    fn advance(&mut self, now: i64) {
        let there = now == self.now && now <= self.planned && now < self.schedule.next_capture();
        if !there {
            self.go_on(now);
        }
    }

    fn go_on(&mut self, now: i64) {
        loop {
            let (capture, look) = (self.schedule.next_capture(), self.look());
            let t = capture.min(look);
            if t > now || t == i64::MAX {
                break;
            }
            self.extend(t);
            if t == capture {
                let cameraman = self.cameraman.as_ref();
                self.schedule.capture(
                    Time(t),
                    &self.bodies,
                    &self.drives,
                    &self.things,
                    &self.cargo,
                    cameraman,
                );
            }
            if t == look {
                self.looked = t;
                let long = t - self.collisions.checked().max(0) >= CHECK;
                if long || self.continuous.iter().any(|i| self.bodies[*i as usize].is_long()) {
                    self.collisions.sweep(&self.bodies, &self.things, t);
                }
            }
        }
        self.extend(now);
        self.now = now;
    }

    /// The robot's drive and body, when there is such a robot.
    fn robot(&mut self, robot: u32) -> Option<(&mut dyn Drive, &mut Body)> {
        let drive = self.drives.get_mut(robot as usize)?;
        Some((drive.as_mut(), self.bodies.get_mut(robot as usize)?))
    }

    /// Whether the battery of a robot is empty.
    fn is_empty(&self, robot: u32) -> bool {
        let platform = self.platforms.get(robot as usize);
        let battery = platform.and_then(|p| self.batteries.get(*p as usize)).copied().flatten();
        let body = self.bodies.get(robot as usize);
        battery.zip(body).is_some_and(|(b, body)| b.charge(body, self.now) <= 0.0)
    }

    fn stop(&mut self, robot: u32) {
        let (now, checked) = (self.now, self.collisions.checked());
        let empty = self.is_empty(robot);
        if let Some((drive, body)) = self.robot(robot) {
            match empty {
                true => drive.power_off(body, now, checked),
                false => drive.stop(body, now, checked),
            }
            self.planned = now;
        }
    }
}

impl Platform for Simulator {
    /// Deliveries of readings. A contact makes no instant due: the first poll at or after it reports it,
    /// with its exact time.
    fn next_due(&self) -> Option<Time> {
        self.schedule.next_delivery()
    }

    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>) {
        let now = now.0.max(self.now);
        self.advance(now);
        self.collisions.sweep(&self.bodies, &self.things, now);
        self.collisions.take(reports);
        self.schedule.deliver(Time(now), readings, &mut self.cameraman);
    }

    fn advance(&mut self, now: Time) {
        Simulator::advance(self, now.0.max(self.now));
    }

    /// A command of the wrong width, or with a number that is not finite, stops the robot.
    fn send(&mut self, now: Time, robot: u32, actuator: u32, command: &[f64], expires: Time) {
        self.advance(now.0.max(self.now));
        let (now, checked) = (self.now, self.collisions.checked());
        let platform = self.platforms.get(robot as usize).and_then(|p| self.actuators.get(*p as usize));
        let actuator = platform.and_then(|a| a.get(actuator as usize)).copied();
        if !command.iter().all(|x| x.is_finite()) || expires.0 <= now {
            return self.stop(robot);
        }
        if let (Some(Actuator::Gripper { reach }), [closed]) = (actuator, command) {
            if let Some(body) = self.bodies.get(robot as usize) {
                match *closed != 0.0 {
                    true => self.cargo.close(robot, body, reach, now),
                    false => self.cargo.open(robot, body, now),
                }
            }
            return;
        }
        if self.is_empty(robot) {
            return self.stop(robot);
        }
        let limited = |x: f64| x.clamp(-LARGEST, LARGEST);
        match (actuator, command) {
            (Some(Actuator::Twist), [a, b, c, d, e, f]) => {
                let twist = [limited(*a), limited(*b), limited(*c), limited(*d), limited(*e), limited(*f)];
                if let Some((drive, body)) = self.robot(robot) {
                    drive.twist(body, now, twist, expires.0, checked);
                    let planned = body.planned();
                    self.planned = self.planned.min(planned);
                }
            }
            (Some(Actuator::Strides { duration }), [heading, length]) => {
                let stride = Stride { heading: limited(*heading), length: limited(*length), duration };
                if let Some((drive, body)) = self.robot(robot) {
                    drive.stride(body, now, stride, expires.0, checked);
                    let planned = body.planned();
                    self.planned = self.planned.min(planned);
                }
            }
            _ => self.stop(robot),
        }
    }

    fn safe_action(&mut self, now: Time, robot: u32) -> &'static str {
        self.act(now, robot, |e| e.safe)
    }

    fn finish(&mut self, now: Time, robot: u32) -> &'static str {
        self.act(now, robot, |e| e.finish)
    }

    fn truth(&self) -> Option<&dyn WorldTruth> {
        Some(self)
    }
}
