//! Straight segments in the image: their angle, the roll-compensated choice of the near-vertical ones, and the
//! merging of pieces that lie on one line. Pure geometry.

use std::f64::consts::{FRAC_PI_2, PI};

/// A straight segment, pixels, top first (y down, so `top[1] <= bottom[1]`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The upper end (x, y).
    pub top: [f64; 2],
    /// The lower end (x, y).
    pub bottom: [f64; 2],
}

impl Segment {
    /// From two ends in any order.
    pub fn new(a: [f64; 2], b: [f64; 2]) -> Self {
        if a[1] <= b[1] { Self { top: a, bottom: b } } else { Self { top: b, bottom: a } }
    }

    /// Length, pixels.
    pub fn length(&self) -> f64 {
        libm::hypot(self.bottom[0] - self.top[0], self.bottom[1] - self.top[1])
    }

    /// Angle α of the line against the x axis in image axes (x right, y down), in [0, π): π/2 is vertical.
    pub fn angle(&self) -> f64 {
        let angle = libm::atan2(self.bottom[1] - self.top[1], self.bottom[0] - self.top[0]);
        if (0.0..PI).contains(&angle) { angle } else { 0.0 }
    }

    /// How far the segment is from vertical in the world when the camera is rolled: |α + roll − π/2|, radians, in
    /// [0, π/2] (SOIFRA, obstacle detection, Algorithm 1: α + θ = 90°). Roll to the right is positive.
    pub fn off_vertical(&self, roll: f64) -> f64 {
        // An angle and its opposite are the same line: fold by π, in a way that holds for any finite roll.
        let turned = self.angle() + roll - FRAC_PI_2;
        let folded = libm::fmod(turned, PI).abs();
        if folded.is_nan() { FRAC_PI_2 } else { folded.min(PI - folded) }
    }

    /// x where the line crosses row `y`. A horizontal segment gives its middle.
    pub fn x_at(&self, y: f64) -> f64 {
        let height = self.bottom[1] - self.top[1];
        if height < 1e-9 {
            return (self.top[0] + self.bottom[0]) / 2.0;
        }
        self.top[0] + (self.bottom[0] - self.top[0]) * (y - self.top[1]) / height
    }

    /// The row of the middle.
    pub fn middle(&self) -> f64 {
        (self.top[1] + self.bottom[1]) / 2.0
    }
}

/// How pieces are merged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Merging {
    /// Largest distance across the line, pixels.
    pub across: f64,
    /// Largest gap along it, pixels.
    pub gap: f64,
}

/// Merges segments that lie on one line and overlap or nearly follow each other. The longer one leads: its line is
/// kept unless the piece lengthens it. The result is ordered by x at the middle row and does not depend on the
/// order of the input.
pub fn merge(segments: &[Segment], how: &Merging) -> Vec<Segment> {
    let mut pieces: Vec<Segment> = segments.to_vec();
    let key = |s: &Segment| [s.top[0], s.top[1], s.bottom[0], s.bottom[1]];
    pieces.sort_by(|a, b| {
        b.length().total_cmp(&a.length()).then_with(|| {
            key(a)
                .iter()
                .zip(key(b))
                .map(|(p, q)| p.total_cmp(&q))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        })
    });
    let mut merged: Vec<Segment> = Vec::new();
    for piece in pieces {
        match merged.iter_mut().find(|line| belongs(line, &piece, how)) {
            Some(line) => *line = join(line, &piece),
            None => merged.push(piece),
        }
    }
    // A line that grew may now reach another: once more is enough for pieces of one edge.
    let mut done: Vec<Segment> = Vec::new();
    for piece in merged {
        match done.iter_mut().find(|line| belongs(line, &piece, how)) {
            Some(line) => *line = join(line, &piece),
            None => done.push(piece),
        }
    }
    done.sort_by(|a, b| {
        a.x_at(a.middle()).total_cmp(&b.x_at(b.middle())).then(a.top[1].total_cmp(&b.top[1]))
    });
    done
}

/// Does `piece` lie on the line of `line`, not farther away along it than the gap? Both are near vertical, so that
/// rows measure along and columns across.
fn belongs(line: &Segment, piece: &Segment, how: &Merging) -> bool {
    let apart = (piece.top[1] - line.bottom[1]).max(line.top[1] - piece.bottom[1]);
    apart <= how.gap
        && (line.x_at(piece.top[1]) - piece.top[0]).abs() <= how.across
        && (line.x_at(piece.bottom[1]) - piece.bottom[0]).abs() <= how.across
}

fn join(a: &Segment, b: &Segment) -> Segment {
    let top = if a.top[1] <= b.top[1] { a.top } else { b.top };
    let bottom = if a.bottom[1] >= b.bottom[1] { a.bottom } else { b.bottom };
    Segment { top, bottom }
}
