//! Two driven wheels on one axle.

use super::{Drive, DriveModel, Lag, Stride, Travel, chord, next_substep, span, stream};
use crate::sim::{
    args::Args,
    body::{Body, Piece, Place, seconds},
    geometry::Vec2,
    noise::{self, Stream},
};
use soifra_graph::Distribution;
use std::{f64::consts::TAU, sync::Arc};

/// A commanded turn rate below this (rad/s) is no turn.
const NO_TURN: f64 = 1e-9;

/// Parameters, by platform.
#[derive(Debug, Clone)]
pub struct Model(Arc<Parameters>);

#[derive(Debug)]
struct Parameters {
    wheel_radius: f64,
    wheel_base: f64,
    max_speed: f64,
    lag: Lag,
    wheel_error: Distribution,
    rotation_error: Distribution,
}

impl Model {
    /// From `differential(…)`.
    pub fn new(args: Args<'_>) -> Result<Model, String> {
        let wheel_radius = args.positive("wheel_radius")?;
        Ok(Model(Arc::new(Parameters {
            wheel_radius,
            wheel_base: args.positive("wheel_base")?,
            max_speed: args.positive("max_speed")?,
            lag: Lag::new(args.at_least_zero("lag")?, args.positive("wheel_acceleration")? * wheel_radius),
            wheel_error: args.distribution("wheel_error")?,
            rotation_error: args.distribution("rotation_error")?,
        })))
    }
}

impl DriveModel for Model {
    fn drive(&self, seed: u64, source: &str, _: Vec2) -> Box<dyn Drive> {
        let noisy = !noise::is_none(self.0.wheel_error) || !noise::is_none(self.0.rotation_error);
        let mut noise = stream(noisy, seed, source);
        let factor = std::array::from_fn(|_| noise.as_mut().map_or(1.0, |n| n.factor(self.0.wheel_error)));
        Box::new(Differential {
            model: Arc::clone(&self.0),
            since: 0,
            speed: [0.0; 2],
            travel: [0.0; 2],
            target: [0.0; 2],
            expires: i64::MAX,
            factor,
            turning: 0.0,
            turn_factor: 1.0,
            planned: None,
            noise,
        })
    }

    fn strides(&self) -> bool {
        false
    }
    fn wheels(&self) -> bool {
        true
    }
}

/// One robot's wheels, left and right. Speeds are those of the rim, as the motor sees them; on the ground
/// a wheel covers `factor` times that (drawn anew at every revolution of the wheel), and the body turns
/// `turn_factor` times what the wheels say (drawn once a turn).
#[derive(Debug)]
pub struct Differential {
    model: Arc<Parameters>,
    /// Speeds and travel are those of this instant (ns).
    since: i64,
    speed: [f64; 2],
    travel: [f64; 2],
    target: [f64; 2],
    expires: i64,
    factor: [f64; 2],
    /// Sign of the turn under way; 0 when going straight.
    turning: f64,
    turn_factor: f64,
    /// Speeds and travel at the end of the planned piece, once worked out.
    planned: Option<(i64, [(f64, f64); 2])>,
    noise: Option<Box<Stream>>,
}

impl Differential {
    /// Speeds and travel at `t`.
    fn wheels(&self, t: i64) -> [(f64, f64); 2] {
        if let Some((end, wheels)) = self.planned
            && end == t
        {
            return wheels;
        }
        let dt = seconds(self.since, t);
        std::array::from_fn(|i| {
            let (v, d) = self.model.lag.follow(self.speed[i], self.target[i], dt);
            (v, self.travel[i] + d)
        })
    }

    /// New speeds to follow. A turn begins when the wheels are told to differ, or to differ the other way.
    fn aim(&mut self, target: [f64; 2], expires: i64) {
        (self.target, self.expires, self.planned) = (target, expires, None);
        let rate = (target[1] - target[0]) / self.model.wheel_base;
        let turning = if rate.abs() < NO_TURN { 0.0 } else { rate.signum() };
        if turning != self.turning {
            self.turning = turning;
            if turning != 0.0
                && let Some(noise) = &mut self.noise
            {
                self.turn_factor = noise.factor(self.model.rotation_error);
            }
        }
    }
}

impl Drive for Differential {
    /// Goes on to `t`.
    fn advance(&mut self, t: i64) {
        let wheels = self.wheels(t);
        let circumference = TAU * self.model.wheel_radius;
        for (i, (v, d)) in wheels.into_iter().enumerate() {
            let turned = (d / circumference).floor() != (self.travel[i] / circumference).floor();
            (self.speed[i], self.travel[i]) = (v, d);
            if turned && let Some(noise) = &mut self.noise {
                self.factor[i] = noise.factor(self.model.wheel_error);
            }
        }
        (self.since, self.planned) = (t, None);
    }

    /// Plans one piece from `t`, the instant of the speeds, on.
    fn plan(&mut self, body: &mut Body, t: i64, from: Place, checked: i64) {
        if t >= self.expires {
            self.aim([0.0; 2], i64::MAX);
        }
        let steady = self.speed == self.target;
        if steady && self.target == [0.0; 2] {
            return body.push(Piece::rest(t, from), checked);
        }
        let straight = self.target[0] * self.factor[0] == self.target[1] * self.factor[1];
        if steady && straight && noise::is_none(self.model.wheel_error) {
            let speed = self.target[0] * self.factor[0];
            return body.push(Piece::sliding(t, self.expires, from, [speed, 0.0], speed.abs()), checked);
        }
        let end = next_substep(t).min(self.expires);
        let dt = span(t, end);
        let wheels = self.wheels(end);
        self.planned = Some((end, wheels));
        let ground: [f64; 2] = std::array::from_fn(|i| (wheels[i].1 - self.travel[i]) * self.factor[i]);
        let ahead = 0.5 * (ground[0] + ground[1]);
        let turn = (ground[1] - ground[0]) / self.model.wheel_base * self.turn_factor;
        let velocity = chord(from.heading, ahead, 0.0, turn, dt);
        body.push(Piece::turning(t, end, from, velocity, turn / dt, ahead.abs() / dt), checked);
    }

    /// Only ahead and turn count. A twist that asks too much of a wheel is slowed down along its arc.
    fn twist(&mut self, body: &mut Body, now: i64, twist: [f64; 6], expires: i64, checked: i64) {
        self.extend(body, now, checked);
        self.advance(now);
        let (ahead, half) = (twist[0], 0.5 * twist[5] * self.model.wheel_base);
        let scale = (self.model.max_speed / (ahead.abs() + half.abs())).min(1.0);
        self.aim([(ahead - half) * scale, (ahead + half) * scale], expires);
        let from = body.place(now);
        self.plan(body, now, from, checked);
    }

    /// Scenes with strides on wheels are refused; stops.
    fn stride(&mut self, body: &mut Body, now: i64, _: Stride, _: i64, checked: i64) {
        self.stop(body, now, checked);
    }

    fn travel(&self, t: i64) -> Travel {
        let [(_, left), (_, right)] = self.wheels(t);
        Travel::Wheels { left, right, base: self.model.wheel_base }
    }
}
