//! The latest readings of the sensors that help to understand an image.

use crate::{services::Readings, trace_file::Header};
use soifra_graph::Type;
use std::collections::BTreeMap;

/// What robots had last read while a trace is gone through.
pub struct Latest {
    /// By robot.
    robots: Vec<Robot>,
}

struct Robot {
    /// Which sensors they are.
    imu: Option<usize>,
    odometry: Option<usize>,
    readings: Readings,
}

impl Latest {
    /// Before the first record.
    pub fn new(header: &Header) -> Latest {
        let radii: BTreeMap<usize, f64> = header.robots().map(|r| r.radius).enumerate().collect();
        let robot = |(i, r): (usize, &soifra_runtime::scene::RobotScene)| {
            let platform = header.scene.platforms.get(r.platform as usize);
            // The first that somebody reads.
            let find = |name: &str| {
                let sensors = platform?.of_role("sensor").enumerate();
                let is = |ty: &Option<Type>| matches!(ty, Some(Type::Record(n)) if &**n == name);
                let mut found = sensors.filter(|(k, p)| is(&p.ty) && r.consumed.get(*k) == Some(&true));
                found.next().map(|(k, _)| k)
            };
            let half_width = radii.get(&i).copied().unwrap_or(0.0);
            let readings = Readings { half_width, ..Readings::default() };
            Robot { imu: find("Imu"), odometry: find("Odometry"), readings }
        };
        Latest { robots: header.scene.robots.iter().enumerate().map(robot).collect() }
    }

    /// A reading came.
    pub fn note(&mut self, (robot, sensor): (u32, u32), registers: &[f64]) {
        let Some(robot) = self.robots.get_mut(robot as usize) else { return };
        if robot.imu == Some(sensor as usize) {
            robot.readings.imu = registers.try_into().ok();
        }
        if robot.odometry == Some(sensor as usize) {
            robot.readings.odometry = registers.try_into().ok();
        }
    }

    /// What a robot has read so far.
    pub fn of(&self, robot: u32) -> Readings {
        self.robots.get(robot as usize).map(|r| r.readings).unwrap_or_default()
    }
}
