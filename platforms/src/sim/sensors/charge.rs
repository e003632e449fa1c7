//! How full the battery is.

use super::{Mount, Sensor, View};
use crate::sim::power::Battery;

/// Registers: the charge, 0 to 1.
#[derive(Debug)]
pub struct Charge(Battery);

impl Charge {
    /// For a platform with a battery.
    pub fn new(mount: Mount<'_>) -> Result<Charge, String> {
        let none = || mount.args.wrong("the platform has no `power`");
        mount.chassis.battery.map(Charge).ok_or_else(none)
    }
}

impl Sensor for Charge {
    fn capture(&mut self, _: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        out.push(self.0.charge(&view.bodies[robot], view.at.0));
    }
}
