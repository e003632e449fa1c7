//! Pulses counted at the wheels.

use super::{Mount, Sensor, View};
use crate::sim::motion::Travel;

/// Registers: pulses of the left and of the right wheel since the start; backwards counts down.
#[derive(Debug)]
pub struct Encoders {
    pulse: f64,
}

impl Encoders {
    /// From `encoders(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Encoders, String> {
        if !mount.chassis.drive.wheels() {
            return Err(mount.args.wrong("this drive has no two wheels to count pulses at"));
        }
        Ok(Encoders { pulse: mount.args.positive("pulse")? })
    }
}

impl Sensor for Encoders {
    fn capture(&mut self, _: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let counts = match view.drives[robot].travel(view.at.0) {
            Travel::Wheels { left, right, .. } => [left, right].map(|d| pulses(d, self.pulse)),
            Travel::Pose { .. } => [0.0; 2],
        };
        out.extend_from_slice(&counts);
    }
}

/// Whole pulses in a distance; within ±2^53, as an `Int` must be.
pub fn pulses(distance: f64, pulse: f64) -> f64 {
    let most = (1u64 << 53) as f64;
    (distance / pulse).floor().clamp(-most, most)
}
