//! What the gripper holds.

use super::{Sensor, View};
use soifra_graph::reason;

/// Registers: tag, number of the parcel.
#[derive(Debug)]
pub struct Holding;

impl Sensor for Holding {
    fn capture(&mut self, _: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        match view.cargo.held_by(robot as u32) {
            Some(n) => out.extend_from_slice(&[0.0, n as f64]),
            None => out.extend_from_slice(&[reason::tag(reason::NONE_FOUND), 0.0]),
        }
    }
}
