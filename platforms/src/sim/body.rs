//! Bodies and how they move: a trajectory is a row of pieces of constant velocity, each known from its
//! start to its end, in integer nanoseconds. Between two pieces, and after the last, a body rests.
//!
//! A position is always computed from the start of its piece, never from where somebody last looked. So
//! neither polling nor the instants of collision checks can change it by a bit.

use super::{
    flight::{Attitude, Flight, Leg},
    geometry::{Vec2, turned},
};
use soifra_runtime::Time;

/// Constant velocity for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Holds from here (ns) …
    pub start: i64,
    /// … to here; [`i64::MAX`] when nothing else is planned.
    pub end: i64,
    /// Position at the start.
    pub at: Vec2,
    /// Heading at the start.
    pub heading: f64,
    /// Velocity in the plane.
    pub velocity: Vec2,
    /// Turn rate.
    pub turn: f64,
    /// Path walked up to the start.
    pub path: f64,
    /// Path walked per second; more than |velocity| where the piece stands for an arc.
    pub speed: f64,
    /// Sine and cosine of half the heading, where it does not turn: z and w of its quaternion.
    half: [f64; 2],
}

/// Where a body is at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position.
    pub at: Vec2,
    /// Heading; not wrapped.
    pub heading: f64,
    /// Path walked.
    pub path: f64,
}

/// So many past pieces are much.
const MANY: usize = 16;

/// Seconds from `a` to `b`.
pub fn seconds(a: i64, b: i64) -> f64 {
    b.saturating_sub(a) as f64 * 1e-9
}

impl Piece {
    /// Standing still from `start` on.
    pub fn rest(start: i64, from: Place) -> Piece {
        Piece::sliding(start, i64::MAX, from, [0.0; 2], 0.0)
    }

    /// Moving and turning from `start` to `end`. Of a turning piece no more than the heading is kept: most
    /// of them nobody looks at.
    pub fn turning(start: i64, end: i64, from: Place, velocity: Vec2, turn: f64, speed: f64) -> Piece {
        let Place { at, heading, path } = from;
        if turn == 0.0 {
            return Piece { velocity, ..Piece::sliding(start, end, from, [0.0; 2], speed) };
        }
        Piece { start, end, at, heading, velocity, turn, path, speed, half: [0.0, 1.0] }
    }

    /// Moving with a velocity in map, whatever way the body faces, and perhaps turning.
    pub fn gliding(start: i64, end: i64, from: Place, velocity: Vec2, turn: f64, speed: f64) -> Piece {
        let Place { at, heading, path } = from;
        let half = if turn == 0.0 { libm::sincos(0.5 * heading).into() } else { [0.0, 1.0] };
        Piece { start, end, at, heading, velocity, turn, path, speed, half }
    }

    /// Moving without a turn: velocities ahead and to the left, and their norm.
    pub fn sliding(start: i64, end: i64, from: Place, way: Vec2, speed: f64) -> Piece {
        let Place { at, heading, path } = from;
        let (z, w) = libm::sincos(0.5 * heading);
        let velocity = turned(way, w * w - z * z, 2.0 * w * z);
        Piece { start, end, at, heading, velocity, turn: 0.0, path, speed, half: [z, w] }
    }

    /// As [`Piece::sliding`], for a body that last moved as `before` says: mostly in the same heading.
    pub fn sliding_after(before: &Piece, start: i64, end: i64, from: Place, way: Vec2, speed: f64) -> Piece {
        if before.turn != 0.0 || before.heading != from.heading {
            return Piece::sliding(start, end, from, way, speed);
        }
        let ([z, w], Place { at, path, .. }) = (before.half, from);
        let velocity = turned(way, w * w - z * z, 2.0 * w * z);
        Piece { start, end, at, velocity, path, speed, ..*before }
    }

    /// Resting where this one ends, until `end`.
    fn rest_until(&self, end: i64) -> Piece {
        let Place { at, heading, path } = self.place(self.end);
        Piece {
            start: self.end,
            end,
            at,
            heading,
            velocity: [0.0; 2],
            turn: 0.0,
            path,
            speed: 0.0,
            half: self.half,
        }
    }

    /// Where it is at `t`, or at its end when that is earlier.
    pub fn place(&self, t: i64) -> Place {
        let dt = seconds(self.start, t.min(self.end));
        Place {
            at: [self.at[0] + self.velocity[0] * dt, self.at[1] + self.velocity[1] * dt],
            heading: self.heading + self.turn * dt,
            path: self.path + self.speed * dt,
        }
    }

    /// z and w of the quaternion at `t`.
    fn quaternion(&self, t: i64) -> [f64; 2] {
        if self.turn == 0.0 {
            return self.half;
        }
        let (s, c) = libm::sincos(0.5 * self.place(t).heading);
        [s, c]
    }
}

/// An upright cylinder that may move.
#[derive(Debug, Clone)]
pub struct Body {
    /// The last piece. Apart from `past`, so that asking about the present stays in one place of memory.
    current: Piece,
    /// Pieces before, as far as the search for contacts may still need them.
    past: Vec<Piece>,
    /// Radius.
    pub radius: f64,
    /// Height of its base and of its top over the ground of the world, where it starts.
    span: [f64; 2],
    /// Height and tilt, where it flies.
    flight: Option<Box<Flight>>,
    /// How much infrared it reflects.
    pub reflectance: f64,
    /// What it is called.
    pub name: String,
}

impl Body {
    /// A body that stands still.
    pub fn new(name: String, radius: f64, span: [f64; 2], reflectance: f64, at: Place) -> Body {
        Body { current: Piece::rest(0, at), past: Vec::new(), radius, span, flight: None, reflectance, name }
    }

    /// The same, able to leave the ground.
    pub fn flying(self) -> Body {
        Body { flight: Some(Box::new(Flight::new(self.span[0]))), ..self }
    }

    /// Height and tilt, where it flies.
    pub fn flight(&self) -> Option<&Flight> {
        self.flight.as_deref()
    }

    /// Height of the ground it started from.
    pub fn floor(&self) -> f64 {
        self.span[0]
    }

    /// Height of its base and of its top at `t`.
    pub fn span(&self, t: i64) -> [f64; 2] {
        match &self.flight {
            None => self.span,
            Some(f) => {
                let base = f.at(t).height;
                [base, base + (self.span[1] - self.span[0])]
            }
        }
    }

    /// Heights that it may be at, whenever.
    pub fn reach(&self) -> [f64; 2] {
        if self.flight.is_some() { [f64::NEG_INFINITY, f64::INFINITY] } else { self.span }
    }

    /// Goes on with a leg of its flight; see [`Flight::push`].
    pub fn fly(&mut self, leg: Leg, checked: i64) {
        if let Some(f) = &mut self.flight {
            f.push(leg, checked);
        }
    }

    /// Height and tilt at `t`; on the ground it stands upright.
    pub fn attitude(&self, t: i64) -> Attitude {
        match &self.flight {
            Some(f) => f.at(t),
            None => Attitude { height: self.span[0], ..Attitude::default() },
        }
    }

    /// Velocity over the ground and turn rate at `t`, in map; at the end of a piece still its own, until another follows.
    pub fn motion(&self, t: i64) -> (Vec2, f64) {
        let piece = self.piece(t);
        if t <= piece.end { (piece.velocity, piece.turn) } else { ([0.0; 2], 0.0) }
    }

    /// The pieces from the one in force at `from` to the one in force at `to`, rests between them included.
    pub fn pieces(&self, from: i64, to: i64) -> Pieces<'_> {
        let n = self.past.len();
        // Most often the last piece has been in force all the while.
        let mut next = n;
        while next > 0 && self.nth(next).start > from {
            next -= 1;
        }
        Pieces { body: self, next, resting: false, from, to }
    }

    /// Of the past pieces and the current one, in this order.
    fn nth(&self, i: usize) -> &Piece {
        self.past.get(i).unwrap_or(&self.current)
    }

    /// The piece in force at `t`, or before it when the body rests then; of two that meet there, the later.
    fn piece(&self, t: i64) -> &Piece {
        if self.current.start <= t {
            return &self.current;
        }
        self.past.iter().rfind(|p| p.start <= t).or(self.past.first()).unwrap_or(&self.current)
    }

    /// Where it is at `t`.
    pub fn place(&self, t: i64) -> Place {
        self.piece(t).place(t)
    }

    /// Pose in `map` at `t`: x y z qx qy qz qw.
    pub fn pose(&self, t: Time) -> [f64; 7] {
        let piece = self.piece(t.0);
        let (p, half) = (piece.place(t.0), piece.quaternion(t.0));
        self.posed(p.at, half, &self.attitude(t.0))
    }

    /// Poses half of `span` (s) before and after `t`, as if it moved all the while as it does then.
    pub fn poses_around(&self, t: Time, span: f64) -> [[f64; 7]; 2] {
        let ((velocity, turn), a, place) = (self.motion(t.0), self.attitude(t.0), self.place(t.0));
        let still = velocity == [0.0; 2] && turn == 0.0 && a.rates == [0.0; 2] && a.climb == 0.0;
        if still {
            return [self.pose(t); 2];
        }
        [-0.5 * span, 0.5 * span].map(|dt| {
            let at = [place.at[0] + velocity[0] * dt, place.at[1] + velocity[1] * dt];
            let half = libm::sincos(0.5 * (place.heading + turn * dt)).into();
            let tilt = [a.roll + a.rates[0] * dt, a.pitch + a.rates[1] * dt];
            let height = a.height + a.climb * dt;
            self.posed(at, half, &Attitude { height, roll: tilt[0], pitch: tilt[1], ..a })
        })
    }

    /// A pose from its parts; `[z, w]` is the quaternion of the heading.
    fn posed(&self, at: Vec2, [z, w]: [f64; 2], a: &Attitude) -> [f64; 7] {
        if self.flight.is_none() {
            return [at[0], at[1], a.height, 0.0, 0.0, z, w];
        }
        // First the heading, then pitch, then roll.
        let ((sr, cr), (sp, cp)) = (libm::sincos(0.5 * a.roll), libm::sincos(0.5 * a.pitch));
        let q = [
            w * cp * sr - z * sp * cr,
            w * sp * cr + z * cp * sr,
            z * cp * cr - w * sp * sr,
            w * cp * cr + z * sp * sr,
        ];
        [at[0], at[1], a.height, q[0], q[1], q[2], q[3]]
    }

    /// Position in `map` at `t`.
    pub fn position(&self, t: Time) -> [f64; 3] {
        let [x, y] = self.place(t.0).at;
        [x, y, self.span(t.0)[0]]
    }

    /// Cosine and sine of the heading at `t`.
    pub fn direction(&self, t: Time) -> Vec2 {
        let [z, w] = self.piece(t.0).quaternion(t.0);
        [w * w - z * z, 2.0 * w * z]
    }

    /// The last piece.
    pub fn last(&self) -> &Piece {
        &self.current
    }

    /// The end of what is planned.
    pub fn planned(&self) -> i64 {
        self.current.end
    }

    /// Whether much past motion is kept.
    pub fn is_long(&self) -> bool {
        self.past.len() > MANY
    }

    /// Ends what is planned at `t`, which is not before the start of the last piece.
    pub fn cut(&mut self, t: i64) {
        self.current.end = self.current.end.min(t);
    }

    /// Goes on with a piece: from its start on, nothing else is planned. Forgets what ended before `checked`.
    #[inline(always)] // So that the piece is made where it stays.
    pub fn push(&mut self, piece: Piece, checked: i64) {
        self.cut(piece.start);
        if self.current.start < piece.start {
            if self.past.len() >= 3 && self.past[0].end < checked {
                // The last of them may still be in force, resting, at `checked`.
                let stale = self.past.iter().take_while(|p| p.end < checked).count();
                self.past.drain(..stale - 1);
            }
            self.past.push(self.current);
        }
        self.current = piece;
    }
}

/// The pieces of a span of time, see [`Body::pieces`].
#[derive(Debug)]
pub struct Pieces<'a> {
    body: &'a Body,
    next: usize,
    /// The rest after the piece before `next` comes first.
    resting: bool,
    from: i64,
    to: i64,
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        loop {
            let last = self.body.past.len();
            if self.resting {
                self.resting = false;
                let before = self.body.nth(self.next - 1);
                let until = if self.next > last { i64::MAX } else { self.body.nth(self.next).start };
                if before.end < until && until >= self.from && before.end < self.to {
                    return Some(before.rest_until(until));
                }
            }
            if self.next > last {
                return None;
            }
            let piece = self.body.nth(self.next);
            if piece.start > self.to {
                return None;
            }
            (self.next, self.resting) = (self.next + 1, true);
            if piece.end >= self.from {
                return Some(*piece);
            }
        }
    }
}
