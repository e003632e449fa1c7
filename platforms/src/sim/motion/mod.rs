//! Drives: how commands become motion. One file for each kinematic class.

pub mod differential;
pub mod holonomic;
mod lag;
mod phase;
pub mod quadrotor;
mod stride;
pub mod submersible;

use lag::Lag;
use phase::Phase;

use super::{
    args::Args,
    body::{Body, Place, seconds},
    geometry::Vec2,
    noise::Stream,
};
use std::fmt;

/// Motion that is not straight is planned in pieces that end at multiples of this (ns). Within one, wheel
/// speeds follow their closed form and the arc is replaced by its chord.
pub const SUBSTEP: i64 = 2_000_000;

/// What the wheels, or whatever carries the robot, say they did since the start: without slip and without
/// the errors of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Rim of the left and right wheel, and the distance between the wheels.
    Wheels {
        /// Left rim.
        left: f64,
        /// Right rim.
        right: f64,
        /// Distance between the wheels.
        base: f64,
    },
    /// Dead-reckoned pose since the start, for drives without wheels to count at.
    Pose {
        /// Position, in odom.
        at: [f64; 2],
        /// Heading, in odom.
        heading: f64,
    },
}

/// A drive moves one body. Times are in nanoseconds and never go back; `checked` is the last collision
/// check, before which a trajectory may be forgotten.
pub trait Drive: fmt::Debug + Send {
    /// Goes on to `t`, an instant of the planned piece.
    fn advance(&mut self, t: i64);
    /// Plans one piece from `t`, the instant that it has gone on to, where the body is then.
    fn plan(&mut self, body: &mut Body, t: i64, from: Place, checked: i64);
    /// Plans motion until `until` at least.
    fn extend(&mut self, body: &mut Body, until: i64, checked: i64) {
        while body.planned() < until {
            let t = body.planned();
            self.advance(t);
            self.plan(body, t, body.place(t), checked);
        }
    }
    /// Follows a twist (vx vy vz wx wy wz, base_link) until `expires`, then stops.
    fn twist(&mut self, body: &mut Body, now: i64, twist: [f64; 6], expires: i64, checked: i64);
    /// Walks a stride within `duration`, but stops at `expires`.
    fn stride(&mut self, body: &mut Body, now: i64, stride: Stride, expires: i64, checked: i64);
    /// Stops.
    fn stop(&mut self, body: &mut Body, now: i64, checked: i64) {
        self.twist(body, now, [0.0; 6], i64::MAX, checked);
    }
    /// Is without power from now on: what holds itself against a current drifts, all others stop.
    fn power_off(&mut self, body: &mut Body, now: i64, checked: i64) {
        self.stop(body, now, checked);
    }
    /// Makes ready what has to be: what leaves the ground takes off.
    fn prepare(&mut self, _body: &mut Body, _now: i64, _checked: i64) {}
    /// Comes down, where it has left the ground; else stops.
    fn land(&mut self, body: &mut Body, now: i64, checked: i64) {
        self.stop(body, now, checked);
    }
    /// What has been measured up to `t`, which lies in what is planned.
    fn travel(&self, t: i64) -> Travel;
}

/// A stride as commanded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stride {
    /// Direction in `map`; the robot faces it at once.
    pub heading: f64,
    /// How far, backwards when negative.
    pub length: f64,
    /// How long it takes (ns).
    pub duration: i64,
}

/// The parameters of a drive, shared by all robots of a platform.
pub trait DriveModel: fmt::Debug {
    /// The drive of one robot; `source` names its stream of noise. The water moves with `current` (m/s, in map).
    fn drive(&self, seed: u64, source: &str, current: Vec2) -> Box<dyn Drive>;
    /// Whether it can walk strides.
    fn strides(&self) -> bool;
    /// Whether it has two wheels to count pulses at.
    fn wheels(&self) -> bool;
    /// Whether it leaves the ground.
    fn leaves_ground(&self) -> bool {
        false
    }
}

/// Builds the drive model of a component, for a body of `mass` (kg). What leaves the ground takes off to `height` (m)
/// over its start.
pub fn build(args: Args<'_>, mass: f64, height: Option<f64>) -> Result<Box<dyn DriveModel>, String> {
    match &*args.part.model {
        "differential" => Ok(Box::new(differential::Model::new(args)?)),
        "holonomic" => Ok(Box::new(holonomic::Model::new(args)?)),
        "quadrotor" => Ok(Box::new(quadrotor::Model::new(args, height)?)),
        "submersible" => Ok(Box::new(submersible::Model::new(args, mass, height)?)),
        _ => Err(args.wrong("the simulator has no such drive")),
    }
}

/// The next multiple of [`SUBSTEP`] after `t`.
fn next_substep(t: i64) -> i64 {
    t.saturating_add(SUBSTEP - t.rem_euclid(SUBSTEP))
}

/// sin(x) / x
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { libm::sin(x) / x }
}

/// Chord velocity of an arc: displacement (ahead, left) and turn within `dt` seconds, from this heading.
/// Exact at the end of the arc when velocities are constant in the body's frame.
pub fn chord(heading: f64, ahead: f64, left: f64, turn: f64, dt: f64) -> [f64; 2] {
    let (s, c) = libm::sincos(heading + 0.5 * turn);
    let k = sinc(0.5 * turn) / dt;
    [(ahead * c - left * s) * k, (ahead * s + left * c) * k]
}

/// Seconds of a piece; at least a nanosecond.
fn span(from: i64, to: i64) -> f64 {
    seconds(from, to).max(1e-9)
}

/// A stream unless there is nothing to draw.
fn stream(needed: bool, seed: u64, source: &str) -> Option<Box<Stream>> {
    needed.then(|| Box::new(Stream::new(seed, source)))
}
