//! Sensors: what a robot can know of the world. One file for each model.

pub mod camera;
pub mod charge;
pub mod discs;
pub mod encoders;
pub mod flow_odometry;
pub mod holding;
pub mod ideal_pose;
pub mod imu;
pub mod infrared;
pub mod laser;
pub mod odometry;
mod ranging;
pub mod ultrasonic;

use super::{
    args::Args,
    body::Body,
    cargo::Cargo,
    geometry::{Aabb, Vec2},
    index::Grid,
    motion::Drive,
    noise::Stream,
    scene::{Chassis, Things},
};
use soifra_graph::Distribution;
use soifra_runtime::Time;
use std::fmt;

/// The world at the instant of a capture.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The instant.
    pub at: Time,
    /// Robots, then movers.
    pub bodies: &'a [Body],
    /// One for each robot.
    pub drives: &'a [Box<dyn Drive>],
    /// Walls and obstacles.
    pub things: &'a Things,
    /// Parcels.
    pub cargo: &'a Cargo,
    /// Where robots and movers are; filled as far as [`Sensor::needs`] says.
    pub nearby: &'a Nearby,
}

/// Which bodies a sensor looks for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Other robots.
    pub robots: bool,
    /// Movers.
    pub movers: bool,
}

/// Indices over the bodies at one instant.
#[derive(Debug, Default)]
pub struct Nearby {
    /// Number of robots: movers are counted on from there.
    pub count: u32,
    /// Over robots.
    pub robots: Grid,
    /// Over movers.
    pub movers: Grid,
    filled: Needs,
}

impl Nearby {
    /// A new instant: nothing is filled.
    pub fn reset(&mut self, robots: usize) {
        self.count = robots as u32;
        self.filled = Needs::default();
    }

    /// Fills what is needed and not yet filled at this instant.
    pub fn fill(&mut self, needs: Needs, bodies: &[Body], at: Time) {
        let (robots, movers) = bodies.split_at(self.count as usize);
        let area = |b: &Body| Aabb::around(b.place(at.0).at, b.radius);
        if needs.robots && !self.filled.robots {
            self.robots.fill(robots.iter().map(area));
            self.filled.robots = true;
        }
        if needs.movers && !self.filled.movers {
            self.movers.fill(movers.iter().map(area));
            self.filled.movers = true;
        }
    }
}

/// A sensor of a platform, on all robots that use it. Robots are numbered twice: `robot` in the scene,
/// `seat` among those that use the sensor.
pub trait Sensor: fmt::Debug + Send {
    /// Which bodies it looks for.
    fn needs(&self) -> Needs {
        Needs::default()
    }
    /// Whether its readings are images.
    fn takes_images(&self) -> bool {
        false
    }
    /// Appends the registers of one reading: always the same number of them.
    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>);
}

/// What a sensor is built from.
#[derive(Debug, Clone, Copy)]
pub struct Mount<'a> {
    /// Its arguments.
    pub args: Args<'a>,
    /// What it stands on.
    pub chassis: &'a Chassis,
    /// The run's seed.
    pub seed: u64,
    /// Names of the robots, by seat.
    pub robots: &'a [&'a str],
}

impl Mount<'_> {
    /// A stream of noise for each seat; none when there is nothing to draw.
    pub fn streams(&self, needed: bool) -> Vec<Stream> {
        let source = |robot: &&str| Stream::new(self.seed, &format!("{robot}/{}", self.args.part.name));
        if needed { self.robots.iter().map(source).collect() } else { Vec::new() }
    }
}

/// Builds a sensor.
pub fn build(mount: Mount<'_>) -> Result<Box<dyn Sensor>, String> {
    Ok(match &*mount.args.part.model {
        "ideal_pose" => Box::new(ideal_pose::IdealPose),
        "camera" => Box::new(camera::Camera),
        "charge" => Box::new(charge::Charge::new(mount)?),
        "holding" => Box::new(holding::Holding),
        "discs" => Box::new(discs::Discs::new(mount)?),
        "infrared" => Box::new(infrared::Infrared::new(mount)?),
        "ultrasonic" => Box::new(ultrasonic::Ultrasonic::new(mount)?),
        "laser" => Box::new(laser::Laser::new(mount)?),
        "encoders" => Box::new(encoders::Encoders::new(mount)?),
        "imu" => Box::new(imu::Imu::new(mount)?),
        "flow_odometry" => Box::new(flow_odometry::FlowOdometry::new(mount)?),
        "odometry" => Box::new(odometry::Odometry::new(mount)?),
        "gyro_odometry" => Box::new(odometry::Odometry::with_gyroscope(mount)?),
        _ => return Err(mount.args.wrong("the simulator has no such sensor")),
    })
}

/// A draw from the seat's stream, or the exact value of a distribution without one.
fn draw(streams: &mut [Stream], seat: usize, from: Distribution) -> f64 {
    match (from, streams.get_mut(seat)) {
        (Distribution::Exact(x), _) => x,
        (_, Some(s)) => s.draw(from),
        (_, None) => 0.0,
    }
}

/// A bearing's unit vector in the frame of the body.
fn unit(bearing: f64) -> Vec2 {
    let (s, c) = libm::sincos(bearing);
    [c, s]
}
