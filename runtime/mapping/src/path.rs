//! Following a way: how far off it a body is, and on which curve it comes back to it.

use crate::{
    field::Field,
    place::{Place, apart},
    why::{Why, finite},
};

/// A way over the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    points: Vec<[f64; 2]>,
    /// How far along the way each point is, m.
    along: Vec<f64>,
}

/// Where a body is on a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// How far it is to the left of the way, m; the cross-track error.
    pub deviation: f64,
    /// How much of the way is left, m.
    pub remaining: f64,
    /// Where the point to steer for is seen, counter-clockwise from straight ahead, rad.
    pub bearing: f64,
    /// Of the arc that leads there, to the left, 1/m.
    pub curvature: f64,
}

impl Path {
    /// The way along points.
    ///
    /// # Errors
    /// [`Why::BadNumber`] for fewer than two points, or numbers that are not finite.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Path, Why> {
        finite(points.as_flattened())?;
        if points.len() < 2 {
            return Err(Why::BadNumber);
        }
        let mut along = vec![0.0];
        let mut gone = 0.0;
        for w in points.windows(2) {
            gone += apart(w[0], w[1]);
            along.push(gone);
        }
        Ok(Path { points, along })
    }

    /// m.
    pub fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    /// How far along the way the point of it is that is nearest, m, and how far to the left of it `at` is, m.
    pub fn nearest(&self, at: [f64; 2]) -> (f64, f64) {
        let (mut best, mut found) = (f64::INFINITY, (0.0, 0.0));
        for (w, s) in self.points.windows(2).zip(&self.along) {
            let (a, d) = (w[0], [w[1][0] - w[0][0], w[1][1] - w[0][1]]);
            let length = libm::hypot(d[0], d[1]);
            if length == 0.0 {
                continue;
            }
            let v = [at[0] - a[0], at[1] - a[1]];
            let t = ((v[0] * d[0] + v[1] * d[1]) / (length * length)).clamp(0.0, 1.0);
            let off = libm::hypot(v[0] - t * d[0], v[1] - t * d[1]);
            if off < best {
                best = off;
                let left = if d[0] * v[1] - d[1] * v[0] < 0.0 { -off } else { off };
                found = (s + t * length, left);
            }
        }
        found
    }

    /// The point so far along the way, m; beyond its end, on the last piece made longer.
    pub fn point(&self, along: f64) -> [f64; 2] {
        let i = self.along.partition_point(|s| *s <= along).clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[i - 1], self.points[i]);
        let length = self.along[i] - self.along[i - 1];
        let t = if length > 0.0 { (along - self.along[i - 1]) / length } else { 0.0 };
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }

    /// Pure pursuit (Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992): the arc that is tangent to the
    /// body and leads to the point of the way that is `lookahead` beyond the nearest. Its curvature is 2 y / d², where y is how
    /// far to the left that point is, and d how far away.
    pub fn track(&self, place: Place, lookahead: f64) -> Tracking {
        let (along, deviation) = self.nearest(place.at);
        let [x, y] = place.inward(self.point(along + lookahead.max(0.0)));
        let d2 = x * x + y * y;
        let curvature = if d2 > 1e-6 { 2.0 * y / d2 } else { 0.0 };
        Tracking { deviation, remaining: self.length() - along, bearing: libm::atan2(y, x), curvature }
    }

    /// How far the way is free from where `at` is on it, m: to where something is nearer than `clearance`, or to its end.
    pub fn free(&self, field: &Field, at: [f64; 2], clearance: f64) -> f64 {
        let (from, _) = self.nearest(at);
        let (length, step) = (self.length(), field.layout.cell);
        let n = ((length - from) / step).ceil().max(0.0) as usize;
        let near = |i: &usize| field.of_point(self.point((from + *i as f64 * step).min(length))) < clearance;
        (0..=n).find(near).map_or(length - from, |i| (i as f64 * step).min(length - from))
    }
}
