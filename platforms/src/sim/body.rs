//! Bodies and how they move: a trajectory is a row of pieces of constant velocity, each known from its
//! start to its end, in integer nanoseconds.
//!
//! A position is always computed from the start of its piece, never from where somebody last looked. So
//! neither polling nor the instants of collision checks can change it by a bit.

use super::geometry::Vec2;
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

/// Seconds from `a` to `b`.
pub fn seconds(a: i64, b: i64) -> f64 {
    b.saturating_sub(a) as f64 * 1e-9
}

impl Piece {
    /// Standing still from `start` on.
    pub fn rest(start: i64, from: Place) -> Piece {
        Piece::moving(start, i64::MAX, from, [0.0; 2], 0.0, 0.0)
    }

    /// Moving from `start` to `end`.
    pub fn moving(start: i64, end: i64, from: Place, velocity: Vec2, turn: f64, speed: f64) -> Piece {
        // Of a turning piece no more than the heading is kept: most of them nobody looks at.
        let (s, c) = if turn == 0.0 { libm::sincos(0.5 * from.heading) } else { (0.0, 1.0) };
        let Place { at, heading, path } = from;
        Piece { start, end, at, heading, velocity, turn, path, speed, half: [s, c] }
    }

    /// Straight ahead, backwards when the speed is negative.
    pub fn walking(start: i64, end: i64, from: Place, speed: f64) -> Piece {
        let mut piece = Piece::moving(start, end, from, [0.0; 2], 0.0, speed.abs());
        let [z, w] = piece.half;
        piece.velocity = [speed * (w * w - z * z), speed * (2.0 * w * z)];
        piece
    }

    /// Standing still where this one ends, in its heading there.
    pub fn then_rest(&self) -> Piece {
        let from = self.place(self.end);
        match self.turn == 0.0 {
            true => Piece {
                start: self.end,
                end: i64::MAX,
                at: from.at,
                velocity: [0.0; 2],
                path: from.path,
                speed: 0.0,
                ..*self
            },
            false => Piece::rest(self.end, from),
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
    /// What it is called.
    pub name: String,
    /// Radius.
    pub radius: f64,
    /// Height of its base and of its top over the ground of the world.
    pub span: [f64; 2],
    /// How much infrared it reflects.
    pub reflectance: f64,
    /// By start; the last one has no end or reaches beyond the present.
    pieces: Vec<Piece>,
}

impl Body {
    /// A body that stands still.
    pub fn new(name: String, radius: f64, span: [f64; 2], reflectance: f64, at: Place) -> Body {
        Body { name, radius, span, reflectance, pieces: vec![Piece::rest(0, at)] }
    }

    /// Whether two bodies stand at one height.
    pub fn level_with(&self, span: [f64; 2]) -> bool {
        self.span[0] <= span[1] && span[0] <= self.span[1]
    }

    /// The pieces since the last collision check, at least.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The piece in force at `t`; of two that meet there, the later.
    pub fn piece(&self, t: i64) -> &Piece {
        let mut last = self.pieces.len() - 1;
        while last > 0 && self.pieces[last].start > t {
            last -= 1;
        }
        &self.pieces[last]
    }

    /// Where it is at `t`.
    pub fn place(&self, t: i64) -> Place {
        self.piece(t).place(t)
    }

    /// Path walked up to `t`.
    pub fn path(&self, t: i64) -> f64 {
        let piece = self.piece(t);
        piece.path + piece.speed * seconds(piece.start, t.min(piece.end))
    }

    /// Pose in `map` at `t`: x y z qx qy qz qw.
    pub fn pose(&self, t: Time) -> [f64; 7] {
        let piece = self.piece(t.0);
        let (p, q) = (piece.place(t.0), piece.quaternion(t.0));
        [p.at[0], p.at[1], self.span[0], 0.0, 0.0, q[0], q[1]]
    }

    /// Cosine and sine of the heading at `t`.
    pub fn direction(&self, t: Time) -> Vec2 {
        let [z, w] = self.piece(t.0).quaternion(t.0);
        [w * w - z * z, 2.0 * w * z]
    }

    /// The end of what is planned.
    pub fn planned(&self) -> i64 {
        self.pieces[self.pieces.len() - 1].end
    }

    /// Drops what was planned from `t` on.
    pub fn cut(&mut self, t: i64) {
        while self.pieces.len() > 1 && self.pieces[self.pieces.len() - 1].start >= t {
            self.pieces.pop();
        }
        let last = self.pieces.len() - 1;
        self.pieces[last].end = self.pieces[last].end.min(t);
    }

    /// Appends a piece that starts where the last one ends; forgets those that ended before `checked`.
    pub fn push(&mut self, piece: Piece, checked: i64) {
        if self.pieces.len() >= 4 && self.pieces[0].end < checked {
            let stale = self.pieces.iter().take_while(|p| p.end < checked).count();
            self.pieces.drain(..stale.min(self.pieces.len() - 1));
        }
        let last = self.pieces.len() - 1;
        if self.pieces[last].start >= piece.start {
            self.pieces[last] = piece;
        } else {
            self.pieces.push(piece);
        }
    }
}
