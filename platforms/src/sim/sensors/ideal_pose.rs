//! The true pose. For abstract robots: a profile must declare it.

use super::{Sensor, View};

/// Registers: x y z qx qy qz qw in `map`.
#[derive(Debug)]
pub struct IdealPose;

impl Sensor for IdealPose {
    fn capture(&mut self, _: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        out.extend_from_slice(&view.bodies[robot].pose(view.at));
    }
}
