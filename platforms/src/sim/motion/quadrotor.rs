//! Four rotors: it tilts to go somewhere, and needs time to settle after it has turned.

use super::{Drive, DriveModel, Lag, Phase, Stride, Travel, next_substep, stream};
use crate::sim::{
    args::Args,
    body::{Body, Piece, Place, seconds},
    flight::Leg,
    geometry::{Vec2, norm, turned},
    noise::{self, Stream},
};
use soifra_graph::Distribution;
use std::sync::Arc;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// Damping ratio of the attitude.
const DAMPING: f64 = 0.8;

/// A gust lasts so long (ns).
const GUST: i64 = 100_000_000;

/// Parameters, by platform.
#[derive(Debug, Clone)]
pub struct Model(Arc<Parameters>);

#[derive(Debug)]
struct Parameters {
    max_speed: f64,
    max_climb: f64,
    max_turn: f64,
    max_tilt: f64,
    /// Natural frequency of the attitude, rad/s.
    frequency: f64,
    /// Time constant of the speed that the autopilot holds, s.
    velocity_lag: f64,
    turn: Lag,
    /// Deceleration by the air for each m/s, 1/s.
    drag: f64,
    gust: Distribution,
    /// Height over the start that it takes off to, m.
    height: f64,
}

impl Model {
    /// From `quadrotor(…)`, with the height of the platform's `prepare = take_off(height: …)`.
    pub fn new(args: Args<'_>, height: Option<f64>) -> Result<Model, String> {
        let max_tilt = args.positive("max_tilt")?;
        if max_tilt >= std::f64::consts::FRAC_PI_4 * 1.9 {
            return Err(args.wrong("`max_tilt` must stay well below 90 deg"));
        }
        let Some(height) = height else {
            return Err(args.wrong("it flies: write `prepare = take_off(height: …)`"));
        };
        Ok(Model(Arc::new(Parameters {
            max_speed: args.positive("max_speed")?,
            max_climb: args.positive("max_climb")?,
            max_turn: args.positive("max_turn")?,
            max_tilt,
            frequency: 1.0 / args.positive("attitude_lag")?,
            velocity_lag: args.positive("velocity_lag")?,
            turn: Lag::new(args.at_least_zero("turn_lag")?, f64::INFINITY),
            drag: args.at_least_zero("drag")?,
            gust: args.distribution("gust")?,
            height,
        })))
    }
}

impl DriveModel for Model {
    fn drive(&self, seed: u64, source: &str, _: Vec2) -> Box<dyn Drive> {
        Box::new(Quadrotor {
            model: Arc::clone(&self.0),
            since: 0,
            state: State::default(),
            planned: None,
            target: [0.0; 4],
            expires: i64::MAX,
            hold: 0.0,
            origin: None,
            phase: Phase::Ground,
            gust: [0.0; 2],
            gust_ends: 0,
            noise: stream(!noise::is_none(self.0.gust), seed, source),
        })
    }

    fn strides(&self) -> bool {
        false
    }

    fn wheels(&self) -> bool {
        false
    }

    fn leaves_ground(&self) -> bool {
        true
    }
}

/// What is integrated. The heading is that of the body's way.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct State {
    /// Over the ground, in map.
    velocity: Vec2,
    climb: f64,
    height: f64,
    roll: [f64; 2],
    pitch: [f64; 2],
    turn: f64,
    heading: f64,
    /// Way since the start, along the axes of map.
    way: Vec2,
}

/// One robot. Speeds are held by an autopilot: from the error of the speed over the ground follows the tilt,
/// from the tilt the acceleration; the attitude is of second order.
#[derive(Debug)]
pub struct Quadrotor {
    model: Arc<Parameters>,
    /// The state is that of this instant (ns).
    since: i64,
    state: State,
    /// State at the end of the planned piece.
    planned: Option<(i64, State)>,
    /// Ahead, left, up, turn.
    target: [f64; 4],
    expires: i64,
    /// Height that is held while nothing else is asked for.
    hold: f64,
    /// Heading at the start, once it has taken off.
    origin: Option<f64>,
    phase: Phase,
    /// Acceleration by the wind, in map.
    gust: Vec2,
    gust_ends: i64,
    noise: Option<Box<Stream>>,
}

impl Quadrotor {
    /// The state after `dt` seconds, at most a substep.
    fn step(&self, s: State, dt: f64) -> State {
        let m = &*self.model;
        let on_ground = self.phase == Phase::Ground;
        if on_ground || dt <= 0.0 {
            return s;
        }
        let steered = self.phase == Phase::Underway;
        let [ahead, left, up, turn] = if steered { self.target } else { [0.0; 4] };
        let (sin, cos) = libm::sincos(s.heading);
        // In the frame that is turned with the body and stays level.
        let v = turned(s.velocity, cos, -sin);
        let want = [ahead - v[0], left - v[1]].map(|e| e / m.velocity_lag);
        let want = [want[0] + m.drag * v[0], want[1] + m.drag * v[1]];
        let most = GRAVITY * libm::tan(m.max_tilt);
        let scale = (most / norm(want)).min(1.0);
        let pitch_to = libm::atan(want[0] * scale / GRAVITY);
        let roll_to = -libm::atan(want[1] * scale / GRAVITY);
        let tilt = |[angle, rate]: [f64; 2], to: f64| {
            let w = m.frequency;
            let rate = rate + (w * w * (to - angle) - 2.0 * DAMPING * w * rate) * dt;
            [angle + rate * dt, rate]
        };
        let (roll, pitch) = (tilt(s.roll, roll_to), tilt(s.pitch, pitch_to));
        // The rotors hold the height, so the tilt alone makes the acceleration over the ground.
        let push = [GRAVITY * libm::tan(pitch[0]), -GRAVITY * libm::tan(roll[0])];
        let push = turned(push, cos, sin);
        let velocity: Vec2 =
            std::array::from_fn(|i| s.velocity[i] + (push[i] - m.drag * s.velocity[i] + self.gust[i]) * dt);
        let lag = 0.5 * m.velocity_lag;
        let climb_to = match up == 0.0 {
            true => (self.hold - s.height) / m.velocity_lag,
            false => up,
        };
        let climb_to = climb_to.clamp(-m.max_climb, m.max_climb);
        let climb = s.climb + (climb_to - s.climb) * (dt / lag).min(1.0);
        let (turn, turned_by) = m.turn.follow(s.turn, turn, dt);
        State {
            velocity,
            climb,
            height: s.height + 0.5 * (s.climb + climb) * dt,
            roll,
            pitch,
            turn,
            heading: s.heading + turned_by,
            way: std::array::from_fn(|i| s.way[i] + 0.5 * (s.velocity[i] + velocity[i]) * dt),
        }
    }

    fn at(&self, t: i64) -> State {
        match self.planned {
            Some((end, state)) if end == t => state,
            _ => self.step(self.state, seconds(self.since, t)),
        }
    }

    /// Up to `now`, for a command.
    fn command(&mut self, body: &mut Body, now: i64, checked: i64) -> Place {
        self.extend(body, now, checked);
        self.advance(now);
        body.place(now)
    }
}

impl Drive for Quadrotor {
    fn advance(&mut self, t: i64) {
        self.state = self.at(t);
        (self.since, self.planned) = (t, None);
        if t >= self.gust_ends
            && let Some(noise) = &mut self.noise
        {
            self.gust = [noise.draw(self.model.gust), noise.draw(self.model.gust)];
            self.gust_ends = t.saturating_add(GUST);
        }
        let phase = self.phase.next(self.state.height, self.hold);
        if phase == Phase::Ground && self.phase == Phase::Landing {
            let State { heading, way, .. } = self.state;
            self.state = State { height: self.hold, heading, way, ..State::default() };
        }
        self.phase = phase;
    }

    /// Plans one piece from `t`, the instant of the state, on.
    fn plan(&mut self, body: &mut Body, t: i64, from: Place, checked: i64) {
        if t >= self.expires {
            (self.target, self.expires) = ([0.0; 4], i64::MAX);
        }
        let s = self.state;
        if self.phase == Phase::Ground {
            body.push(Piece::rest(t, from), checked);
            body.fly(Leg::still(t, s.height), checked);
            return;
        }
        let end = next_substep(t).min(self.expires);
        let dt = seconds(t, end).max(1e-9);
        let next = self.step(s, dt);
        self.planned = Some((end, next));
        let velocity = std::array::from_fn(|i| 0.5 * (s.velocity[i] + next.velocity[i]));
        let speed = norm(velocity);
        let turn = (next.heading - s.heading) / dt;
        body.push(Piece::gliding(t, end, from, velocity, turn, speed), checked);
        let (now, then) = ([s.height, s.roll[0], s.pitch[0]], [next.height, next.roll[0], next.pitch[0]]);
        let rates = std::array::from_fn(|i| (then[i] - now[i]) / dt);
        body.fly(Leg { start: t, end, from: now, rates }, checked);
    }

    /// Ahead, left, up and turn count, each limited; too fast a way is slowed down in its direction.
    fn twist(&mut self, body: &mut Body, now: i64, twist: [f64; 6], expires: i64, checked: i64) {
        let from = self.command(body, now, checked);
        let m = &*self.model;
        let scale = (m.max_speed / norm([twist[0], twist[1]])).min(1.0);
        let up = twist[2].clamp(-m.max_climb, m.max_climb);
        let turn = twist[5].clamp(-m.max_turn, m.max_turn);
        if self.phase == Phase::Underway && (up != 0.0 || self.target[2] != 0.0) {
            self.hold = self.state.height;
        }
        (self.target, self.expires) = ([twist[0] * scale, twist[1] * scale, up, turn], expires);
        self.plan(body, now, from, checked);
    }

    /// Scenes with strides in the air are refused; hovers.
    fn stride(&mut self, body: &mut Body, now: i64, _: Stride, _: i64, checked: i64) {
        self.stop(body, now, checked);
    }

    fn prepare(&mut self, body: &mut Body, now: i64, checked: i64) {
        let from = self.command(body, now, checked);
        if self.phase == Phase::Ground {
            let height = body.flight().map_or(0.0, |f| f.at(now).height);
            self.origin.get_or_insert(from.heading);
            self.state = State { height, heading: from.heading, way: self.state.way, ..State::default() };
            (self.phase, self.hold) = (Phase::TakingOff, height + self.model.height);
        }
        self.plan(body, now, from, checked);
    }

    fn land(&mut self, body: &mut Body, now: i64, checked: i64) {
        let from = self.command(body, now, checked);
        if matches!(self.phase, Phase::TakingOff | Phase::Underway) {
            (self.phase, self.hold) = (Phase::Landing, body.floor());
        }
        self.plan(body, now, from, checked);
    }

    fn travel(&self, t: i64) -> Travel {
        let s = self.at(t);
        let origin = self.origin.unwrap_or(s.heading);
        let (sin, cos) = libm::sincos(-origin);
        Travel::Pose { at: turned(s.way, cos, sin), heading: s.heading - origin }
    }
}
