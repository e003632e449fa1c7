//! A planar laser scan.

use super::{
    Mount, Needs, Sensor, View, draw,
    ranging::{MOST_BEAMS, Seen, beam, in_sight},
    unit,
};
use crate::sim::{
    geometry::{Shape, Vec2, along, dot, norm, sub, turned},
    noise::{self, Stream},
};
use soifra_graph::Distribution;
use std::f64::consts::{PI, TAU};

/// Registers: count, then bearing, tag, range of each beam. Beams begin at the centre of the body, which is
/// not in their way.
#[derive(Debug)]
pub struct Laser {
    bearings: Vec<(f64, Vec2)>,
    /// First bearing and the angle between two.
    first: f64,
    step: f64,
    range: (f64, f64),
    noise: Distribution,
    /// Over the base of the robot.
    height: f64,
    streams: Vec<Stream>,
    seen: Vec<Seen>,
    hits: Vec<f64>,
}

impl Laser {
    /// From `laser(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Laser, String> {
        let args = mount.args;
        let (beams, (low, high)) = (args.count("beams", MOST_BEAMS)?, args.range("field")?);
        if high - low > TAU + 1e-9 {
            return Err(args.wrong("`field` is wider than a full turn"));
        }
        let step = if beams > 1 { (high - low) / (beams - 1) as f64 } else { 0.0 };
        let noise = args.distribution("noise")?;
        let bearing = |i: usize| low + i as f64 * step;
        Ok(Laser {
            bearings: (0..beams).map(|i| (bearing(i), unit(bearing(i)))).collect(),
            first: low,
            step,
            range: args.reach("range")?,
            noise,
            height: args.at_least_zero("height")?,
            streams: mount.streams(!noise::is_none(noise)),
            seen: Vec::new(),
            hits: vec![f64::INFINITY; beams],
        })
    }

    /// Tries the beams that point at a shape: those within the angle under which it is seen, which is found
    /// from the middle of the shape and its farthest rim to both sides.
    fn cast(&mut self, shape: &Shape, at: Vec2, ahead: Vec2) {
        let n = self.bearings.len();
        let Some((middle, half)) = angle_of(shape, at, ahead) else {
            return self.try_beams(shape, at, ahead, 0, n);
        };
        if self.step == 0.0 {
            return self.try_beams(shape, at, ahead, 0, n);
        }
        // The middle as an angle past the first beam, and the same a turn earlier and later.
        let past = (middle - self.first).rem_euclid(TAU);
        for past in [past - TAU, past, past + TAU] {
            let from = ((past - half) / self.step - 1e-6).ceil().max(0.0);
            let to = ((past + half) / self.step + 1e-6).floor().min(n as f64 - 1.0);
            if from <= to {
                self.try_beams(shape, at, ahead, from as usize, to as usize + 1);
            }
        }
    }

    fn try_beams(&mut self, shape: &Shape, at: Vec2, ahead: Vec2, from: usize, to: usize) {
        for i in from..to {
            let dir = turned(self.bearings[i].1, ahead[0], ahead[1]);
            if let Some(d) = shape.ray(at, dir) {
                self.hits[i] = self.hits[i].min(d);
            }
        }
    }
}

/// Bearing of the middle of a shape and half the angle it fills; `None` from inside, or nearly so.
fn angle_of(shape: &Shape, from: Vec2, ahead: Vec2) -> Option<(f64, f64)> {
    let (center, half) = match *shape {
        Shape::Disc { at, radius } => {
            let d = norm(sub(at, from));
            if d <= radius * (1.0 + 1e-9) {
                return None;
            }
            (sub(at, from), libm::asin(radius / d))
        }
        Shape::Box { at, axis, half } => {
            if shape.distance(from) <= 1e-9 {
                return None;
            }
            let center = sub(at, from);
            let side = [-axis[1], axis[0]];
            let mut widest: f64 = 0.0;
            for (i, j) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let corner = along(along(center, axis, i * half[0]), side, j * half[1]);
                let c = dot(center, corner) / (norm(center) * norm(corner));
                widest = widest.max(libm::acos(c.clamp(-1.0, 1.0)));
            }
            (center, widest)
        }
    };
    let local = turned(center, ahead[0], -ahead[1]);
    let half = half + 1e-9;
    (half.is_finite() && half < PI).then(|| (libm::atan2(local[1], local[0]), half))
}

impl Sensor for Laser {
    fn needs(&self) -> Needs {
        Needs { robots: true, movers: true }
    }

    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let body = &view.bodies[robot];
        let (at, ahead) = (body.place(view.at.0).at, body.direction(view.at));
        let mut seen = std::mem::take(&mut self.seen);
        in_sight(view, robot, at, self.range.1, body.span(view.at.0)[0] + self.height, &mut seen);
        self.hits.fill(f64::INFINITY);
        for s in &seen {
            self.cast(&s.shape, at, ahead);
        }
        self.seen = seen;
        out.push(self.bearings.len() as f64);
        for i in 0..self.bearings.len() {
            let near = Some(self.hits[i]).filter(|d| *d <= self.range.1);
            let reads = near.map(|d| d + draw(&mut self.streams, seat, self.noise));
            beam(out, self.bearings[i].0, reads, self.range);
        }
    }
}
