//! What of a trace is in the top view: where everything was, what touched, how it ended.

use super::view::in_sight;
use crate::{plot::page::Ending, trace_file::shape};
use soifra_runtime::{Event, Record, Time};
use std::collections::BTreeMap;

/// Everything gathered from the records.
#[derive(Debug, Default)]
pub(super) struct Tracks {
    /// By robot index.
    pub robots: BTreeMap<usize, Track>,
    /// By name.
    pub movers: BTreeMap<String, Track>,
    /// When and which robot touched something.
    pub contacts: Vec<(Time, usize)>,
    pub ending: Ending,
}

/// Where a body was, each place once.
#[derive(Debug, Default)]
pub(super) struct Track {
    /// Times and places in metres, in order.
    pub points: Vec<(Time, [f64; 2])>,
    /// Heading at the end, counter-clockwise from east.
    pub heading: f64,
}

impl Tracks {
    /// Takes the next record.
    pub(super) fn take(&mut self, record: &Record) {
        self.ending.take(record);
        match &record.event {
            Event::Pose { robot, pose, .. } => {
                self.robots.entry(*robot as usize).or_default().take(record.t, pose)
            }
            Event::Mover { name, pose } => match self.movers.get_mut(name) {
                Some(track) => track.take(record.t, pose),
                None => self.movers.entry(name.clone()).or_default().take(record.t, pose),
            },
            Event::Contact { robot, begin: true, .. } => self.contacts.push((record.t, *robot as usize)),
            _ => {}
        }
    }
}

impl Track {
    fn take(&mut self, t: Time, pose: &[f64; 7]) {
        if !in_sight(pose) {
            return;
        }
        let at = [pose[0], pose[1]];
        self.heading = shape::yaw(pose);
        match &mut self.points[..] {
            // A long rest is two points.
            [.., (_, a), (last, b)] if *a == at && *b == at => *last = t,
            _ => self.points.push((t, at)),
        }
    }

    /// The last place.
    pub(super) fn end(&self) -> Option<[f64; 2]> {
        self.points.last().map(|p| p.1)
    }

    /// The place at a time, on the line between the poses around it.
    pub(super) fn at(&self, t: Time) -> Option<[f64; 2]> {
        let after = self.points.partition_point(|p| p.0 < t);
        match (after.checked_sub(1).and_then(|i| self.points.get(i)), self.points.get(after)) {
            (Some((t0, a)), Some((t1, b))) => {
                let s = (t - *t0).seconds() / (*t1 - *t0).seconds();
                Some([a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])])
            }
            (Some(p), None) | (None, Some(p)) => Some(p.1),
            (None, None) => None,
        }
    }
}

/// Few of `points` whose polyline is nowhere farther than `tolerance` from all of them (Douglas and
/// Peucker, "Algorithms for the reduction of the number of points required to represent a digitized line",
/// 1973).
pub(super) fn simplify(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    // First what hardly moved: a resting robot must not cost more than one that drives.
    let mut moved: Vec<[f64; 2]> = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let far = moved.last().is_none_or(|q| libm::hypot(p[0] - q[0], p[1] - q[1]) > tolerance / 4.0);
        if far || i + 1 == points.len() {
            moved.push(*p);
        }
    }
    let points = &moved[..];
    let mut keep = vec![false; points.len()];
    let mut pending = Vec::new();
    if let Some(last) = points.len().checked_sub(1) {
        (keep[0], keep[last]) = (true, true);
        pending.push((0, last));
    }
    while let Some((from, to)) = pending.pop() {
        let mut farthest = (tolerance, None);
        for i in from + 1..to {
            let d = distance(points[i], points[from], points[to]);
            if d > farthest.0 {
                farthest = (d, Some(i));
            }
        }
        if let (_, Some(i)) = farthest {
            keep[i] = true;
            pending.extend([(from, i), (i, to)]);
        }
    }
    points.iter().zip(keep).filter_map(|(p, k)| k.then_some(*p)).collect()
}

/// Distance of `p` from the segment `a`–`b`.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = d[0] * d[0] + d[1] * d[1];
    let s = if length > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(e[0] - s * d[0], e[1] - s * d[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_become_two_points_and_corners_stay() {
        let mut points: Vec<[f64; 2]> = (0..100).map(|i| [f64::from(i), 0.0]).collect();
        points.extend((1..100).map(|i| [99.0, f64::from(i)]));
        assert_eq!(simplify(&points, 0.1), [[0.0, 0.0], [99.0, 0.0], [99.0, 99.0]]);
        assert!(simplify(&[], 0.1).is_empty());
    }
}
