//! Thrusters under water: a body that water carries, and that holds itself against it.
//!
//! Roll and pitch are not simulated. A vehicle of this class is stable by itself, with its buoyancy above its weight,
//! and has thrusters left to be held level; what remains is as small as the noise of an inertial unit. The autopilot
//! is given true speeds and depth: the errors of a velocity log are those of the sensor that agents read.

mod autopilot;
mod hull;

use super::{Drive, DriveModel, Phase, Stride, Travel, next_substep};
use crate::sim::{
    args::Args,
    body::{Body, Piece, Place, seconds},
    flight::Leg,
    geometry::{Vec2, norm, turned},
};
use autopilot::{Autopilot, Axes, Thrust};
use hull::{Hull, Motion};
use std::sync::Arc;

/// An autopilot that is to be quicker (s) would be so between two steps of its own.
const QUICKEST: f64 = 0.02;

/// Parameters, by platform.
#[derive(Debug, Clone)]
pub struct Model(Arc<Parameters>);

#[derive(Debug)]
struct Parameters {
    max_speed: f64,
    max_climb: f64,
    max_turn: f64,
    /// Time constant of the speed that the autopilot holds, s.
    velocity_lag: f64,
    hull: Hull,
    autopilot: Autopilot,
    /// Height over the start that it climbs to, m.
    height: f64,
}

impl Model {
    /// From `submersible(…)`, with the mass of the body (kg) and the height of the platform's `prepare =
    /// take_off(height: …)`.
    pub fn new(args: Args<'_>, mass: f64, height: Option<f64>) -> Result<Model, String> {
        let Some(height) = height else {
            return Err(args.wrong("it swims: write `prepare = take_off(height: …)`"));
        };
        let parts = |name: &str, least: f64| -> Result<[f64; 3], String> {
            let v = args.vector(name)?;
            let low = v.iter().any(|x| *x < least);
            if low { Err(args.wrong(format_args!("a part of `{name}` is below {least}"))) } else { Ok(v) }
        };
        let added = parts("added_mass", 0.0)?;
        let hull = Hull {
            mass: added.map(|m| mass + m),
            inertia: args.positive("inertia")?,
            linear: parts("linear_drag", 0.0)?,
            quadratic: parts("quadratic_drag", 0.0)?,
            linear_turn: args.at_least_zero("linear_turn_drag")?,
            quadratic_turn: args.at_least_zero("quadratic_turn_drag")?,
        };
        let thruster_lag = args.at_least_zero("thruster_lag")?;
        let lag = |name: &str| match args.positive(name)? {
            tau if tau < QUICKEST => Err(args.wrong(format_args!("`{name}` is below {QUICKEST} s"))),
            // Twice as slow is where speeds begin to swing for ever.
            tau if tau < thruster_lag => Err(args.wrong(format_args!(
                "the autopilot is quicker (`{name}`) than its thrusters (`thruster_lag`)"
            ))),
            tau => Ok(tau),
        };
        let (velocity_lag, turn_lag) = (lag("velocity_lag")?, lag("turn_lag")?);
        let [ahead, left, up] = parts("thrust", f64::MIN_POSITIVE)?;
        let [mx, my, mz] = hull.mass;
        let autopilot = Autopilot::new(
            [mx, my, mz, hull.inertia],
            [velocity_lag, velocity_lag, velocity_lag, turn_lag],
            [ahead, left, up, args.positive("torque")?],
            thruster_lag,
        );
        Ok(Model(Arc::new(Parameters {
            max_speed: args.positive("max_speed")?,
            max_climb: args.positive("max_climb")?,
            max_turn: args.positive("max_turn")?,
            velocity_lag,
            hull,
            autopilot,
            height,
        })))
    }
}

impl DriveModel for Model {
    fn drive(&self, _: u64, _: &str, current: Vec2) -> Box<dyn Drive> {
        Box::new(Submersible {
            model: Arc::clone(&self.0),
            current,
            since: 0,
            state: State::default(),
            planned: None,
            target: [0.0; 4],
            expires: i64::MAX,
            hold: 0.0,
            origin: None,
            phase: Phase::Ground,
            powered: true,
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

/// What is integrated.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct State {
    /// Against the water.
    motion: Motion,
    thrust: Thrust,
    height: f64,
    heading: f64,
    /// Way over the ground since the start, along the axes of map.
    way: Vec2,
}

/// One robot.
#[derive(Debug)]
pub struct Submersible {
    model: Arc<Parameters>,
    /// Of the water, in map.
    current: Vec2,
    /// The state is that of this instant (ns).
    since: i64,
    state: State,
    /// State at the end of the planned piece.
    planned: Option<(i64, State)>,
    /// Ahead, left, up, turn.
    target: Axes,
    expires: i64,
    /// Height that is held while nothing else is asked for.
    hold: f64,
    /// Heading at the start, once it has taken off.
    origin: Option<f64>,
    phase: Phase,
    /// Without power its thrusters stand, and it drifts.
    powered: bool,
}

impl Submersible {
    /// Velocity over the ground, in map.
    fn over_ground(&self, s: &State) -> Vec2 {
        let (sin, cos) = libm::sincos(s.heading);
        let [u, v, _] = s.motion.velocity;
        let [x, y] = turned([u, v], cos, sin);
        [x + self.current[0], y + self.current[1]]
    }

    /// The state after `dt` seconds, at most a substep.
    fn step(&self, s: State, dt: f64) -> State {
        if self.phase == Phase::Ground || dt <= 0.0 {
            return s;
        }
        let m = &*self.model;
        let (sin, cos) = libm::sincos(s.heading);
        let before = self.over_ground(&s);
        let [ahead, left] = turned(before, cos, -sin);
        let now = [ahead, left, s.motion.velocity[2], s.motion.turn];
        let [ahead, left, up, turn] = if self.phase == Phase::Underway { self.target } else { [0.0; 4] };
        // The depth is held by a climb that is half as quick as the climb follows, so that it does not overshoot.
        let up = if up == 0.0 { 0.5 * (self.hold - s.height) / m.velocity_lag } else { up };
        let wanted = [ahead, left, up.clamp(-m.max_climb, m.max_climb), turn];
        let thrust = m.autopilot.step(s.thrust, wanted, now, self.powered, dt);
        let [x, y, z, torque] = thrust.given;
        let motion = m.hull.step(s.motion, [x, y, z], torque, dt);
        let next = State {
            motion,
            thrust,
            height: s.height + 0.5 * (s.motion.velocity[2] + motion.velocity[2]) * dt,
            heading: s.heading + 0.5 * (s.motion.turn + motion.turn) * dt,
            way: s.way,
        };
        let after = self.over_ground(&next);
        State { way: std::array::from_fn(|i| s.way[i] + 0.5 * (before[i] + after[i]) * dt), ..next }
    }

    fn at(&self, t: i64) -> State {
        match self.planned {
            Some((end, state)) if end == t => state,
            _ => self.step(self.state, seconds(self.since, t)),
        }
    }

    /// Standing on the bottom: the water moves past.
    fn standing(&self, height: f64, heading: f64) -> State {
        let (sin, cos) = libm::sincos(heading);
        let [u, v] = turned(self.current, cos, -sin);
        let motion = Motion { velocity: [-u, -v, 0.0], turn: 0.0 };
        State { motion, thrust: Thrust::default(), height, heading, way: self.state.way }
    }

    /// Up to `now`, for a command.
    fn command(&mut self, body: &mut Body, now: i64, checked: i64) -> Place {
        self.extend(body, now, checked);
        self.advance(now);
        body.place(now)
    }
}

impl Drive for Submersible {
    fn advance(&mut self, t: i64) {
        self.state = self.at(t);
        (self.since, self.planned) = (t, None);
        let phase = self.phase.next(self.state.height, self.hold);
        if phase == Phase::Ground && self.phase == Phase::Landing {
            self.state = self.standing(self.hold, self.state.heading);
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
        let velocity = std::array::from_fn(|i| (next.way[i] - s.way[i]) / dt);
        let turn = (next.heading - s.heading) / dt;
        body.push(Piece::gliding(t, end, from, velocity, turn, norm(velocity)), checked);
        let rates = [(next.height - s.height) / dt, 0.0, 0.0];
        body.fly(Leg { start: t, end, from: [s.height, 0.0, 0.0], rates }, checked);
    }

    /// Ahead, left, up and turn count, each limited; too fast a way is slowed down in its direction.
    fn twist(&mut self, body: &mut Body, now: i64, twist: [f64; 6], expires: i64, checked: i64) {
        let from = self.command(body, now, checked);
        let m = &*self.model;
        let scale = (m.max_speed / norm([twist[0], twist[1]])).min(1.0);
        let up = twist[2].clamp(-m.max_climb, m.max_climb);
        let turn = twist[5].clamp(-m.max_turn, m.max_turn);
        let climbs = up != 0.0 || self.target[2] != 0.0 || !self.powered;
        if self.phase == Phase::Underway && climbs {
            self.hold = self.state.height;
        }
        self.powered = true;
        (self.target, self.expires) = ([twist[0] * scale, twist[1] * scale, up, turn], expires);
        self.plan(body, now, from, checked);
    }

    /// Scenes with strides under water are refused; holds itself where it is.
    fn stride(&mut self, body: &mut Body, now: i64, _: Stride, _: i64, checked: i64) {
        self.stop(body, now, checked);
    }

    fn power_off(&mut self, body: &mut Body, now: i64, checked: i64) {
        let from = self.command(body, now, checked);
        self.powered = false;
        self.plan(body, now, from, checked);
    }

    fn prepare(&mut self, body: &mut Body, now: i64, checked: i64) {
        let from = self.command(body, now, checked);
        if self.phase == Phase::Ground {
            let height = body.flight().map_or(0.0, |f| f.at(now).height);
            self.origin.get_or_insert(from.heading);
            self.state = self.standing(height, from.heading);
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
