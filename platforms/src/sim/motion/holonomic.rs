//! A body that moves in any direction and turns at will.

use super::{Drive, DriveModel, Lag, Stride, Travel, chord, next_substep, span, stream, stride};
use crate::sim::{
    args::Args,
    body::{Body, Piece, Place, seconds},
    geometry::{Vec2, along, norm, turned},
    noise::{self, Stream},
};
use soifra_graph::Distribution;
use soifra_runtime::Time;
use std::sync::Arc;

/// Parameters, by platform.
#[derive(Debug, Clone)]
pub struct Model(Arc<Parameters>);

#[derive(Debug)]
struct Parameters {
    max_speed: f64,
    max_turn: f64,
    lag: Lag,
    error: Distribution,
}

impl Model {
    /// From `holonomic(…)`.
    pub fn new(args: Args<'_>) -> Result<Model, String> {
        Ok(Model(Arc::new(Parameters {
            max_speed: args.positive("max_speed")?,
            max_turn: args.at_least_zero("max_turn")?,
            lag: Lag::new(args.at_least_zero("lag")?, f64::INFINITY),
            error: args.distribution("error")?,
        })))
    }
}

impl DriveModel for Model {
    fn drive(&self, seed: u64, source: &str, _: Vec2) -> Box<dyn Drive> {
        Box::new(Holonomic {
            model: Arc::clone(&self.0),
            since: 0,
            velocity: [0.0; 3],
            reckoned: Reckoned::default(),
            target: [0.0; 3],
            expires: i64::MAX,
            walking: false,
            factor: [1.0; 2],
            noise: stream(!noise::is_none(self.0.error), seed, source),
        })
    }

    fn strides(&self) -> bool {
        true
    }
    fn wheels(&self) -> bool {
        false
    }
}

/// One robot's motion in its own frame: ahead, left, turn. The ground sees `factor` times that, for way and
/// turn, drawn anew for every motion: every stride, and every twist that differs from the one before.
#[derive(Debug)]
pub struct Holonomic {
    model: Arc<Parameters>,
    /// Velocity and reckoning are those of this instant (ns).
    since: i64,
    velocity: [f64; 3],
    target: [f64; 3],
    expires: i64,
    /// A stride is under way until it expires: no lag, and rest after it.
    walking: bool,
    factor: [f64; 2],
    reckoned: Reckoned,
    noise: Option<Box<Stream>>,
}

/// Where the robot reckons it is: without the errors of the drive.
#[derive(Debug, Clone, Copy, Default)]
struct Reckoned {
    /// Since the start, along the axes of map.
    at: Vec2,
    /// In map.
    heading: f64,
    /// Heading at the start, known with the first command.
    origin: Option<f64>,
    /// Velocity in map, while it is constant.
    straight: Option<Vec2>,
}

impl Holonomic {
    /// Velocity at `t`, and the way ahead, to the left and turned since then.
    fn state(&self, t: i64) -> ([f64; 3], [f64; 3]) {
        if self.walking {
            let dt = seconds(self.since, t.min(self.expires)).max(0.0);
            let over = t >= self.expires;
            return (if over { [0.0; 3] } else { self.velocity }, self.velocity.map(|v| v * dt));
        }
        let (mut velocity, mut way) = ([0.0; 3], [0.0; 3]);
        let dt = seconds(self.since, t);
        for i in 0..3 {
            (velocity[i], way[i]) = self.model.lag.follow(self.velocity[i], self.target[i], dt);
        }
        (velocity, way)
    }

    /// Position and heading reckoned at `t`, when this is the way since then.
    fn reckon(&self, way: [f64; 3], t: i64) -> (Vec2, f64) {
        let Reckoned { at, heading, straight, .. } = self.reckoned;
        match straight {
            Some(v) => (along(at, v, seconds(self.since, t.min(self.expires)).max(0.0)), heading),
            None if way == [0.0; 3] => (at, heading),
            None => (along(at, chord(heading, way[0], way[1], way[2], 1.0), 1.0), heading + way[2]),
        }
    }

    fn draw(&mut self) {
        if let Some(noise) = &mut self.noise {
            self.factor = std::array::from_fn(|_| noise.factor(self.model.error));
        }
    }

    /// Up to `now`, for a command.
    fn command(&mut self, body: &mut Body, now: i64, checked: i64) -> Place {
        // After a stride a body rests without a plan for it.
        if !self.walking {
            self.extend(body, now, checked);
        }
        let place = body.place(now);
        if self.reckoned.origin.is_none() {
            (self.reckoned.origin, self.reckoned.heading) = (Some(place.heading), place.heading);
        }
        self.advance(now);
        place
    }
}

impl Drive for Holonomic {
    fn advance(&mut self, t: i64) {
        let (velocity, way) = match self.reckoned.straight {
            Some(_) if !self.walking => (self.velocity, [0.0; 3]),
            _ => self.state(t),
        };
        (self.reckoned.at, self.reckoned.heading) = self.reckon(way, t);
        (self.velocity, self.since) = (velocity, t);
    }

    /// Plans one piece from `t`, the instant of the velocity, on.
    fn plan(&mut self, body: &mut Body, t: i64, from: Place, checked: i64) {
        if t >= self.expires {
            (self.target, self.expires, self.walking) = ([0.0; 3], i64::MAX, false);
        }
        if self.model.lag.tau == 0.0 {
            self.velocity = self.target;
        }
        self.reckoned.straight = None;
        let v = self.velocity;
        let steady = v == self.target;
        if steady && v == [0.0; 3] {
            return body.push(Piece::rest(t, from), checked);
        }
        if steady && v[2] == 0.0 {
            let way = [v[0] * self.factor[0], v[1] * self.factor[0]];
            let piece = Piece::sliding_after(body.last(), t, self.expires, from, way, norm(way));
            self.reckoned.straight =
                Some(match self.reckoned.heading == from.heading && self.factor[0] == 1.0 {
                    true => piece.velocity,
                    false => chord(self.reckoned.heading, v[0], v[1], 0.0, 1.0),
                });
            return body.push(piece, checked);
        }
        let end = next_substep(t).min(self.expires);
        let dt = span(t, end);
        let (_, way) = self.state(end);
        let (ahead, left, turn) = (way[0] * self.factor[0], way[1] * self.factor[0], way[2] * self.factor[1]);
        let velocity = chord(from.heading, ahead, left, turn, dt);
        let speed = norm([ahead, left]) / dt;
        body.push(Piece::turning(t, end, from, velocity, turn / dt, speed), checked);
    }

    /// Ahead, left and turn count; too fast a twist is slowed down in its direction.
    fn twist(&mut self, body: &mut Body, now: i64, twist: [f64; 6], expires: i64, checked: i64) {
        let from = self.command(body, now, checked);
        let scale = (self.model.max_speed / norm([twist[0], twist[1]])).min(1.0);
        let turn = twist[5].clamp(-self.model.max_turn, self.model.max_turn);
        let target = [twist[0] * scale, twist[1] * scale, turn];
        if self.walking || target != self.target {
            self.draw();
        }
        (self.target, self.expires, self.walking) = (target, expires, false);
        self.plan(body, now, from, checked);
    }

    fn stride(&mut self, body: &mut Body, now: i64, command: Stride, expires: i64, checked: i64) {
        self.command(body, now, checked);
        self.draw();
        let (speed, end) =
            stride::walk(body, now, command, expires, self.model.max_speed, self.factor[0], checked);
        self.target = [0.0; 3];
        (self.velocity, self.expires, self.walking) = ([speed, 0.0, 0.0], end, true);
        let [c, s] = body.direction(Time(now));
        (self.reckoned.heading, self.reckoned.straight) = (command.heading, Some([speed * c, speed * s]));
    }

    fn travel(&self, t: i64) -> Travel {
        let (_, way) = self.state(t);
        let (at, heading) = self.reckon(way, t);
        let origin = self.reckoned.origin.unwrap_or(heading);
        let (s, c) = libm::sincos(-origin);
        Travel::Pose { at: turned(at, c, s), heading: heading - origin }
    }
}
