//! How fast each edge closes in, from its bearing alone.
//!
//! A vertical edge at lateral offset X and distance Z is seen at the tangent q = X/Z off the direction of motion;
//! from a former place, t seconds of way back and y aside of the present way (see [`crate::follow::Advance`]), it was
//! seen at q(t, y)·(1 − e·t) = q(0) − e·y, e the inverse time to contact now. So speed and direction may have changed
//! on the way. Edges of one face share e; a nearer thing has a greater e than what is behind it. This is what tells an
//! obstacle's outline from the texture of a wall or a floor.

use crate::attitude::wrap;
use crate::expansion::Width;
use crate::follow::{EdgeTrack, Moment};

/// An edge's closing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Tangent of the bearing off the course now, left positive.
    pub tangent: f64,
    /// Inverse time to contact, 1/s.
    pub closing: f64,
    /// Its standard deviation from the scatter of the bearings, 1/s.
    pub sigma: f64,
}

impl Sweep {
    /// By how much the closing is off for each radian that the course is off, 1/s: the tangents of all edges are
    /// then off by the same, and e = q̇/q.
    pub fn bias(&self) -> f64 {
        self.closing / if self.tangent.abs() < 1e-9 { 1e-9 } else { self.tangent }
    }
}

/// A sighting of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Way back in time at the pace, s; see [`crate::follow::Advance`].
    pub time: f64,
    /// How far aside of the present way it was seen from, in what the pace covers in a second.
    pub aside: f64,
    /// Tangent of the bearing off the present direction of motion, left positive.
    pub tangent: f64,
}

/// Sightings nearer together than this are one, s of way: a robot that stands sees the same again and again.
const STEP: f64 = 0.004;

/// Sightings of one edge within `length` seconds of way, as seen from `now`: oldest first.
pub fn tangents(track: &EdgeTrack, now: &Moment, length: f64) -> Vec<Tangent> {
    let mut out: Vec<Tangent> = Vec::with_capacity(track.sights.len());
    for s in track.sights.iter().rev() {
        let back = now.since(s.place);
        let off = wrap(s.upright.bearing - now.course);
        if out.last().is_some_and(|t| back.time > t.time - STEP) || off.abs() >= 1.4 {
            continue;
        }
        if back.time < -length {
            break;
        }
        out.push(Tangent { time: back.time, aside: back.aside, tangent: libm::tan(off) });
    }
    out.reverse();
    out
}

/// The closing of one edge from its tangents; `noise` is the smallest noise of a tangent. `None` for fewer than
/// `fewest` sightings.
pub fn sweep(tangents: &[Tangent], fewest: usize, noise: f64) -> Option<Sweep> {
    let now = tangents.last()?;
    if tangents.len() < fewest.max(3) {
        return None;
    }
    // q = q0 + e·(t·q − y): a straight line over the abscissa t·q − y.
    let n = tangents.len() as f64;
    let abscissa = |s: &Tangent| (s.time - now.time) * s.tangent - (s.aside - now.aside);
    let mx = tangents.iter().map(abscissa).sum::<f64>() / n;
    let my = tangents.iter().map(|s| s.tangent).sum::<f64>() / n;
    let (mut xx, mut xy) = (0.0, 0.0);
    for s in tangents {
        let x = abscissa(s) - mx;
        xx += x * x;
        xy += x * (s.tangent - my);
    }
    if !(xx > 1e-18) {
        return None;
    }
    let closing = xy / xx;
    let tangent = my - closing * mx;
    let squares: f64 = tangents
        .iter()
        .map(|s| {
            let r = s.tangent - tangent - closing * abscissa(s);
            r * r
        })
        .sum();
    let scatter = (squares / (n - 2.0)).max(noise * noise);
    let sigma = libm::sqrt(scatter / xx);
    (closing.is_finite() && sigma.is_finite() && tangent.is_finite()).then_some(Sweep {
        tangent,
        closing,
        sigma,
    })
}

/// The latest part of a history that one closing explains. A track may have changed over to another edge that it
/// met: where an early and a late part of the history disagree beyond their noise
/// only the later one counts, cut where they disagree most; and so on with that. What is left spans at least `shortest`
/// seconds. `noise` is the error of a tangent that may last (the background moving past the edge pulls at it).
pub fn settled(tangents: &[Tangent], fewest: usize, shortest: f64, noise: f64) -> &[Tangent] {
    let fewest = fewest.max(5);
    let mut rest = tangents;
    while rest.len() >= 2 * fewest {
        let worst = (1..6)
            .map(|k| (rest.len() * k / 6).clamp(fewest, rest.len() - fewest))
            .filter(|&at| rest[rest.len() - 1].time - rest[at].time >= shortest)
            .map(|at| (disagreement(&rest[..at], &rest[at..], fewest, noise), at))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match worst {
            Some((size, at)) if size > 1.0 => rest = &rest[at..],
            _ => break,
        }
    }
    rest
}

/// By how much two parts of a history disagree, in units of what their noise allows.
fn disagreement(early: &[Tangent], late: &[Tangent], fewest: usize, noise: f64) -> f64 {
    let (Some(before), Some(now)) = (sweep(early, fewest, noise), sweep(late, fewest, noise)) else {
        return 0.0;
    };
    // The early part speaks of its own end: brought to the present, e grows as the distance shrinks.
    let gap = late[late.len() - 1].time - early[early.len() - 1].time;
    let base = 1.0 - before.closing * gap;
    if base <= 0.1 {
        return 0.0;
    }
    let doubt = 5.0 * libm::hypot(before.sigma / (base * base), now.sigma) + 0.1 * now.closing.abs();
    (before.closing / base - now.closing).abs() / doubt
}

/// The width between two edges at the times both were seen: difference of the tangents, left minus right.
pub fn widths(left: &[Tangent], right: &[Tangent]) -> Vec<Width> {
    let mut widths = Vec::with_capacity(left.len().min(right.len()));
    let mut k = 0;
    for l in left {
        while k < right.len() && right[k].time < l.time {
            k += 1;
        }
        if k < right.len() && right[k].time == l.time {
            widths.push(Width { time: l.time, width: l.tangent - right[k].tangent });
        }
    }
    widths
}
