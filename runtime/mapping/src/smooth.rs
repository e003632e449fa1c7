//! Makes a way over cells one to drive on: pulled straight where nothing is nearer for it, then rounded.

use crate::{field::Field, place::apart, route::Room};

/// Distance of points, m.
pub const SPACING: f64 = 0.1;
/// How often each point is drawn towards the middle of its neighbours: corners are rounded over about a metre.
const ROUNDS: usize = 80;
/// Of the way to that middle.
const PULL: f64 = 0.5;

/// A way with points [`SPACING`] apart and the same ends.
pub fn smooth(field: &Field, points: &[[f64; 2]], room: &Room) -> Vec<[f64; 2]> {
    let mut way = spaced(&straight(field, &spaced(points, 2.0 * SPACING), room), SPACING);
    let enough = room.clearance + 0.5 * room.comfort;
    for _ in 0..ROUNDS {
        for i in 1..way.len().saturating_sub(1) {
            let (a, p, b) = (way[i - 1], way[i], way[i + 1]);
            let pulled = |axis: usize| p[axis] + PULL * (0.5 * (a[axis] + b[axis]) - p[axis]);
            let to = [pulled(0), pulled(1)];
            let d = field.of_point(to);
            if d >= enough || d >= field.of_point(p) {
                way[i] = to;
            }
        }
    }
    spaced(&way, SPACING)
}

/// Leaves out points as long as the straight line has the room that the way has.
fn straight(field: &Field, points: &[[f64; 2]], room: &Room) -> Vec<[f64; 2]> {
    let liked = room.clearance + room.comfort;
    let (mut out, mut from) = (Vec::new(), 0);
    out.extend(points.first());
    while from + 1 < points.len() {
        let (mut to, mut least) = (from + 1, liked);
        let mut best = to;
        while to < points.len() {
            least = least.min(field.of_point(points[to]));
            if !clear(field, points[from], points[to], least) {
                // A little farther it may be clear again; not for long ways.
                if to > best + 10 {
                    break;
                }
            } else {
                best = to;
            }
            to += 1;
        }
        out.push(points[best]);
        from = best;
    }
    out
}

/// Whether nothing is nearer to a line than `least`.
fn clear(field: &Field, a: [f64; 2], b: [f64; 2], least: f64) -> bool {
    let n = (apart(a, b) / field.layout.cell).ceil().max(1.0) as usize;
    (0..=n).all(|i| {
        let t = i as f64 / n as f64;
        field.of_point([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]) >= least - 1e-6
    })
}

/// The same way with points so far apart; the ends are kept.
pub fn spaced(points: &[[f64; 2]], spacing: f64) -> Vec<[f64; 2]> {
    let length: f64 = points.windows(2).map(|w| apart(w[0], w[1])).sum();
    let n = (length / spacing).ceil().max(1.0) as usize;
    let step = length / n as f64;
    let mut out: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let mut gone = 0.0;
    for w in points.windows(2) {
        let d = apart(w[0], w[1]);
        while out.len() < n && d > 0.0 && out.len() as f64 * step <= gone + d {
            let t = (out.len() as f64 * step - gone) / d;
            out.push([w[0][0] + t * (w[1][0] - w[0][0]), w[0][1] + t * (w[1][1] - w[0][1])]);
        }
        gone += d;
    }
    if points.len() > 1 {
        out.extend(points.last());
    }
    out
}
