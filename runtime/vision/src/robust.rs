//! Time to contact by flow, robust: points followed over several frames, derotated, one expansion and one focus for
//! all of them.
//!
//! Points of one obstacle are at one distance, so that between two frames they scale about the focus:
//! now − then = (now − focus)·eT/(1 + eT), e the inverse time to contact now, T the baseline, both places as seen
//! along the straight line between where the camera was (see [`crate::follow::Advance`]). Scale and focus are
//! solved together: a turn that the gyro does not see shifts the focus, not the scale. No random sampling: the
//! start is the median over all pairs of points in a fixed order, then iteratively reweighted least squares.

use crate::attitude::{Attitude, Rates};
use crate::flow::{FlowContact, Track};
use crate::follow::Moment;
use crate::lens::Lens;
use crate::refine::{median, tukey};
use crate::why::{Why, interval};

/// Where on the obstacle a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// On its left edge.
    Left,
    /// On its right edge.
    Right,
    /// Between the edges.
    Interior,
}

/// One sighting of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Seconds.
    pub time: f64,
    /// The direction in the level frame (any length).
    pub ray: [f64; 3],
    /// Where the camera was then, metres in the level frame.
    pub place: [f64; 2],
}

/// A point followed over frames, oldest sighting first.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTrack {
    /// Where on the obstacle.
    pub part: Part,
    /// Its place in the last frame, pixels (x, y).
    pub pixel: [f64; 2],
    /// Its way between the last two frames, pixels (u, v); zero when it is new.
    pub way: [f64; 2],
    /// How well it can be followed, 0 to 1.
    pub quality: f64,
    /// Its sightings.
    pub sights: Vec<Sight>,
}

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robust {
    /// Longest baseline used, s.
    pub baseline: f64,
    /// Fewest points.
    pub fewest: usize,
    /// Above this rate of turning (any axis, rad/s) there is no answer.
    pub rotating: f64,
    /// Largest angle between the present way and the straight line from where a point was first seen, as a tangent.
    pub bend: f64,
    /// Smallest expansion over the baseline, as a share.
    pub growth: f64,
    /// Largest ratio of the standard deviation to the time to contact.
    pub uncertainty: f64,
}

impl Default for Robust {
    fn default() -> Self {
        Self { baseline: 1.5, fewest: 4, rotating: 0.6, bend: 0.5, growth: 0.004, uncertainty: 0.15 }
    }
}

/// A robust time to contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobustContact {
    /// Time to contact now, s.
    pub ttc: f64,
    /// Its standard deviation from the scatter of the points, s.
    pub sigma: f64,
    /// The focus of expansion as tangents of lateral (left positive) and vertical (up positive) angles from the
    /// direction of motion that was assumed.
    pub focus: [f64; 2],
    /// Points that count.
    pub points: usize,
}

/// A point's place now, then, the time between, and whether both axes count.
struct Pair {
    now: [f64; 2],
    then: [f64; 2],
    baseline: f64,
    both: bool,
}

impl Pair {
    /// The axes that count.
    fn axes(&self) -> &'static [usize] {
        if self.both { &[0, 1] } else { &[0] }
    }
}

/// From the history of points as seen from `now`, the moment of the last frame; points not seen in it are left out.
/// Points on edges count across the edge only (along it they say nothing).
///
/// # Errors
/// [`Why::Rotating`], [`Why::NoFeatures`], [`Why::TooShort`], [`Why::NoMotion`], [`Why::NotApproaching`],
/// [`Why::Degenerate`], [`Why::SpeedZero`], [`Why::BadNumber`].
pub fn history(points: &[PointTrack], now: &Moment, how: &Robust) -> Result<RobustContact, Why> {
    if !now.is_finite() {
        return Err(Why::BadNumber);
    }
    if now.pace <= 0.0 {
        return Err(Why::SpeedZero);
    }
    if now.rates.largest() > how.rotating {
        return Err(Why::Rotating);
    }
    let mut seen = 0usize;
    let mut pairs = Vec::with_capacity(points.len());
    for p in points {
        let Some(last) = p.sights.last().filter(|s| s.time == now.time) else { continue };
        seen += 1;
        let backs = p.sights.iter().map(|s| (s, now.since(s.place)));
        let mut fit = backs.filter(|(_, b)| -b.time <= how.baseline && b.time < 0.0);
        let Some((first, back)) = fit.find(|(_, b)| b.aside.abs() <= how.bend * -b.time) else { continue };
        let baseline = -back.time;
        if let (Some(mut here), Some(mut there)) = (along(last.ray, now.course), along(first.ray, now.course))
        {
            // Both as seen along the straight line between the two places.
            for place in [&mut here, &mut there] {
                place[0] += back.aside / baseline;
            }
            pairs.push(Pair { now: here, then: there, baseline, both: p.part == Part::Interior });
        }
    }
    if seen < how.fewest.max(2) {
        return Err(Why::NoFeatures);
    }
    if pairs.len() < how.fewest.max(2) {
        return Err(Why::TooShort);
    }
    solve(&pairs, how)
}

/// From the tracks between two frames: derotated by the gyro's rates, then as [`history`]. All points count in both
/// axes.
///
/// # Errors
/// As [`history`], and those of the interval.
pub fn pair(tracks: &[Track], lens: &Lens, rates: &Rates, dt: f64, how: &Robust) -> Result<FlowContact, Why> {
    let dt = interval(dt)?;
    lens.check()?;
    if !rates.is_finite() || tracks.iter().any(|t| !t.is_finite()) {
        return Err(Why::BadNumber);
    }
    if rates.largest() > how.rotating {
        return Err(Why::Rotating);
    }
    let ideal = Lens { distortion: None, ..*lens };
    let pairs: Vec<Pair> = crate::flow::derotated(tracks, lens, rates, dt)
        .iter()
        .filter_map(|t| {
            let now = ideal.normalise(t.x, t.y)?;
            let then = ideal.normalise(t.x - t.u, t.y - t.v)?;
            Some(Pair { now, then, baseline: dt, both: true })
        })
        .collect();
    if pairs.len() < how.fewest.max(2) {
        return Err(Why::NoFeatures);
    }
    let found = solve(&pairs, how)?;
    let focus = ideal.project(found.focus).ok_or(Why::Degenerate)?;
    Ok(FlowContact { ttc: found.ttc, focus, points: found.points })
}

/// The direction of a level ray seen along the course: tangents (lateral, left positive; vertical, up positive).
fn along(ray: [f64; 3], course: f64) -> Option<[f64; 2]> {
    let (s, c) = libm::sincos(course);
    let forward = ray[0] * c + ray[1] * s;
    let at = [(ray[1] * c - ray[0] * s) / forward, ray[2] / forward];
    (forward > 1e-6 && at.iter().all(|v| v.is_finite() && v.abs() < 1e3)).then_some(at)
}

/// The direction of a pixel in the level frame.
pub fn sight_ray(lens: &Lens, attitude: &Attitude, pixel: [f64; 2]) -> Option<[f64; 3]> {
    lens.ray(pixel[0], pixel[1]).map(|ray| attitude.level(ray))
}

fn solve(pairs: &[Pair], how: &Robust) -> Result<RobustContact, Why> {
    let moved = pairs.iter().any(|p| p.now != p.then);
    if !moved {
        return Err(Why::NoMotion);
    }
    let mut e = start(pairs).ok_or(Why::Degenerate)?;
    let mut focus = start_focus(pairs, e);
    let mut fit = None;
    for round in 0..10 {
        let scale = spread(pairs, e, focus, round);
        let step = step(pairs, e, focus, scale).ok_or(Why::Degenerate)?;
        e = step.e;
        focus = step.focus;
        if !(e.is_finite() && focus[0].is_finite() && focus[1].is_finite()) {
            return Err(Why::Degenerate);
        }
        fit = Some(step);
    }
    let fit = fit.ok_or(Why::Degenerate)?;
    let longest = pairs.iter().map(|p| p.baseline).fold(0.0, f64::max);
    if (e * longest).abs() < how.growth {
        return Err(Why::NoMotion);
    }
    if e < 0.0 {
        return Err(Why::NotApproaching);
    }
    if fit.points < how.fewest.max(2) {
        return Err(Why::NoFeatures);
    }
    let ttc = 1.0 / e;
    let sigma = fit.sigma * ttc * ttc;
    if !(ttc.is_finite() && sigma <= how.uncertainty * ttc) {
        return Err(Why::TooShort);
    }
    Ok(RobustContact { ttc, sigma, focus, points: fit.points })
}

/// The inverse time to contact as the median over all pairs of points of how their distance grew.
fn start(pairs: &[Pair]) -> Option<f64> {
    let mut found = Vec::with_capacity(pairs.len() * pairs.len() / 2);
    for (k, a) in pairs.iter().enumerate() {
        for b in &pairs[k + 1..] {
            if (a.baseline - b.baseline).abs() > 0.25 * a.baseline.max(b.baseline) {
                continue;
            }
            let vertical = if a.both && b.both { 1.0 } else { 0.0 };
            let now = [a.now[0] - b.now[0], (a.now[1] - b.now[1]) * vertical];
            let then = [a.then[0] - b.then[0], (a.then[1] - b.then[1]) * vertical];
            let size = now[0] * now[0] + now[1] * now[1];
            if size < 1e-4 {
                continue;
            }
            // Projected on the present direction: signed, and noise does not lengthen it.
            let ratio = (now[0] * then[0] + now[1] * then[1]) / size;
            let baseline = (a.baseline + b.baseline) / 2.0;
            if ratio > 0.05 {
                found.push((1.0 / ratio - 1.0) / baseline);
            }
        }
    }
    median(&mut found)
}

/// The focus that most points agree on, given the scale; the direction of motion itself while nothing expands.
fn start_focus(pairs: &[Pair], e: f64) -> [f64; 2] {
    let axis = |k: usize| {
        let mut found: Vec<f64> = pairs
            .iter()
            .filter(|p| k == 0 || p.both)
            .filter_map(|p| {
                let share = e * p.baseline / (1.0 + e * p.baseline);
                (share.abs() > 1e-6).then(|| p.now[k] - (p.now[k] - p.then[k]) / share)
            })
            .collect();
        median(&mut found).unwrap_or(0.0)
    };
    [axis(0), axis(1)]
}

/// Scale of the residuals for Tukey's weights: 1.4826 times the median of the sizes, generous at first.
fn spread(pairs: &[Pair], e: f64, focus: [f64; 2], round: usize) -> f64 {
    let mut sizes: Vec<f64> = Vec::with_capacity(2 * pairs.len());
    for p in pairs {
        let share = e * p.baseline / (1.0 + e * p.baseline);
        for &k in p.axes() {
            sizes.push((p.now[k] - p.then[k] - (p.now[k] - focus[k]) * share).abs());
        }
    }
    let scale = 1.4826 * median(&mut sizes).unwrap_or(0.0);
    scale.max(1e-9) * if round < 2 { 2.0 } else { 1.0 }
}

struct Step {
    e: f64,
    focus: [f64; 2],
    points: usize,
    sigma: f64,
}

/// A Gauss-Newton step on (e, e·focus): with share = eT/(1 + eT) the motion is now·share − focus·share; the
/// unknowns enter linearly as a = e and g = e·focus once (1 + eT) is taken from the last step.
fn step(pairs: &[Pair], e: f64, focus: [f64; 2], scale: f64) -> Option<Step> {
    let (mut m, mut b) = ([[0.0f64; 3]; 3], [0.0f64; 3]);
    let (mut points, mut squares, mut rows) = (0usize, 0.0, 0.0);
    for p in pairs {
        let base = 1.0 + e * p.baseline;
        if !(base > 0.05) {
            return None;
        }
        let gain = p.baseline / base;
        let mut counts = false;
        for &k in p.axes() {
            let moved = p.now[k] - p.then[k];
            let residual = moved - gain * e * (p.now[k] - focus[k]);
            let w = tukey(residual / scale);
            if w <= 0.0 {
                continue;
            }
            counts = true;
            squares += w * residual * residual;
            rows += 1.0;
            let row = [gain * p.now[k], if k == 0 { -gain } else { 0.0 }, if k == 1 { -gain } else { 0.0 }];
            for i in 0..3 {
                for j in 0..3 {
                    m[i][j] += w * row[i] * row[j];
                }
                b[i] += w * row[i] * moved;
            }
        }
        points += usize::from(counts);
    }
    // Without a point that counts vertically the vertical focus is free: hold it at zero.
    if m[2][2] == 0.0 {
        m[2][2] = 1.0;
    }
    let (solution, variance) = invert(m, b)?;
    let [a, gx, gy] = solution;
    // (1 + eT) was taken from the last step: the linear solution converges in a few rounds because eT is small.
    let focus = if a.abs() > 1e-9 { [gx / a, gy / a] } else { [0.0, 0.0] };
    let noise = squares / f64::max(rows - 3.0, 1.0);
    Some(Step { e: a, focus, points, sigma: libm::sqrt((noise * variance).max(0.0)) })
}

/// Solves the symmetric 3 x 3 system by eliminating the focus first; gives the solution and the first diagonal of
/// the inverse.
fn invert(m: [[f64; 3]; 3], b: [f64; 3]) -> Option<([f64; 3], f64)> {
    let (p, q) = (m[1][1], m[2][2]);
    if !(p > 0.0 && q > 0.0) {
        return None;
    }
    // The focus's two unknowns do not mix with each other.
    let left = m[0][0] - m[0][1] * m[0][1] / p - m[0][2] * m[0][2] / q;
    if !(left > 1e-12 * m[0][0]) {
        return None;
    }
    let a = (b[0] - m[0][1] * b[1] / p - m[0][2] * b[2] / q) / left;
    let solution = [a, (b[1] - m[0][1] * a) / p, (b[2] - m[0][2] * a) / q];
    solution.iter().all(|v| v.is_finite()).then_some((solution, 1.0 / left))
}
