//! Is it in the way? The published test, and the one that knows the body's width. Pure geometry.

use crate::flow::Track;
use crate::obstacle::Obstacle;
use crate::sweep::Tangent;
use crate::why::Why;

/// The published test (SOIFRA, obstacle detection): the flow vectors of the left and the right edge, drawn on as
/// rays in their own direction, do not meet: `true`, on collision course.
///
/// Weak as a safety test: the sides of a wide gap diverge too, and a thing at the shoulder has both edges on one
/// side. [`course`] is the one to use.
///
/// # Errors
/// [`Why::NoFeatures`] when one side has no track; [`Why::NoMotion`] when one side does not move;
/// [`Why::BadNumber`].
pub fn diverging(left: &[Track], right: &[Track]) -> Result<bool, Why> {
    let (l, r) = (mean(left)?, mean(right)?);
    let cross = l.u * r.v - l.v * r.u;
    let (dx, dy) = (r.x - l.x, r.y - l.y);
    let size = libm::hypot(l.u, l.v) * libm::hypot(r.u, r.v);
    if cross.abs() <= 1e-9 * size {
        // Parallel: on one line they meet when they point at each other, else never.
        let aside = (dx * l.v - dy * l.u).abs();
        let on_one_line = aside <= 1e-9 * libm::hypot(l.u, l.v) * libm::hypot(dx, dy).max(1.0);
        let towards = dx * l.u + dy * l.v > 0.0 && dx * r.u + dy * r.v < 0.0;
        return Ok(!(on_one_line && towards));
    }
    let s = (dx * r.v - dy * r.u) / cross;
    let t = (dx * l.v - dy * l.u) / cross;
    Ok(!(s >= 0.0 && t >= 0.0))
}

fn mean(tracks: &[Track]) -> Result<Track, Why> {
    if tracks.is_empty() {
        return Err(Why::NoFeatures);
    }
    let n = tracks.len() as f64;
    let sum = |of: fn(&Track) -> f64| tracks.iter().map(of).sum::<f64>() / n;
    let mean = Track { x: sum(|t| t.x), y: sum(|t| t.y), u: sum(|t| t.u), v: sum(|t| t.v) };
    if ![mean.x, mean.y, mean.u, mean.v].iter().all(|v| v.is_finite()) {
        return Err(Why::BadNumber);
    }
    if libm::hypot(mean.u, mean.v) < 1e-9 { Err(Why::NoMotion) } else { Ok(mean) }
}

/// How an edge's bearing moves: lateral over forward offset in the level frame, seen along the direction of
/// motion, left positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Tangent of the bearing now.
    pub tangent: f64,
    /// Its rate, 1/s, free of the camera's own turning.
    pub rate: f64,
}

impl Bearing {
    /// From the history of one edge and the inverse time to contact `closing` (1/s) of the thing it belongs to.
    /// From t seconds of way back and y aside its tangent was ξ = (ξ₀ + at − closing·y)/(1 − closing·t), linear in ξ₀
    /// and a; the rate now is a + closing·ξ₀. Were the direction of motion known exactly, a would be zero: it is what
    /// the edge itself tells of it. No focus of expansion is needed. The last sighting is now.
    ///
    /// # Errors
    /// [`Why::TooShort`] for fewer than three samples, [`Why::ZeroInterval`], [`Why::BadNumber`].
    pub fn fit(history: &[Tangent], closing: f64) -> Result<Self, Why> {
        let Some(now) = history.last() else { return Err(Why::TooShort) };
        if history.len() < 3 {
            return Err(Why::TooShort);
        }
        let known = |s: &Tangent| s.time.is_finite() && s.aside.is_finite() && s.tangent.is_finite();
        if !closing.is_finite() || !history.iter().all(known) {
            return Err(Why::BadNumber);
        }
        let n = history.len() as f64;
        let (mut st, mut stt, mut sy, mut sty) = (0.0, 0.0, 0.0, 0.0);
        for s in history {
            let t = s.time - now.time;
            let y = s.tangent * (1.0 - closing * t) + closing * (s.aside - now.aside);
            st += t;
            stt += t * t;
            sy += y;
            sty += t * y;
        }
        let det = n * stt - st * st;
        if !(det > 1e-12) {
            return Err(Why::ZeroInterval);
        }
        let a = (n * sty - st * sy) / det;
        let tangent = (sy - a * st) / n;
        let rate = a + closing * tangent;
        if tangent.is_finite() && rate.is_finite() { Ok(Self { tangent, rate }) } else { Err(Why::BadNumber) }
    }

    /// The lateral offset at contact, metres, left positive: with distance Z = v·τ and Ẋ/Z = ξ̇ − ξ/τ the offset
    /// X + Ẋτ is v·τ²·ξ̇.
    pub fn offset(&self, ttc: f64, speed: f64) -> f64 {
        speed * ttc * ttc * self.rate
    }
}

/// What an obstacle will occupy when it is reached: lateral offsets of its edges, metres, left positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Of the left edge.
    pub left: f64,
    /// Of the right edge.
    pub right: f64,
    /// Time until then, s.
    pub ttc: f64,
}

impl Reach {
    /// Predicted from the bearings of the two edges, the time to contact (s) and the speed (m/s).
    ///
    /// # Errors
    /// [`Why::SpeedZero`], [`Why::NotApproaching`] for a time to contact that is not positive, [`Why::BadNumber`].
    pub fn predict(left: &Bearing, right: &Bearing, ttc: f64, speed: f64) -> Result<Self, Why> {
        if speed == 0.0 {
            return Err(Why::SpeedZero);
        }
        let (a, b) = (left.offset(ttc, speed), right.offset(ttc, speed));
        if !(ttc.is_finite() && a.is_finite() && b.is_finite()) {
            return Err(Why::BadNumber);
        }
        if ttc <= 0.0 || speed < 0.0 {
            return Err(Why::NotApproaching);
        }
        Ok(Self { left: a.max(b), right: a.min(b), ttc })
    }
}

/// What a body takes up on its way, as lateral offsets from the camera's way, metres, left positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lane {
    /// Its left side.
    pub left: f64,
    /// Its right side.
    pub right: f64,
}

impl Lane {
    /// Whether an obstacle will be in it, approached at `speed`.
    pub fn holds(&self, obstacle: &Obstacle, speed: f64) -> bool {
        obstacle.reach(speed).is_ok_and(|r| r.right < self.left && self.right < r.left)
    }
}

/// The body and the room it wants beside it, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Half of the width.
    pub half_width: f64,
    /// Kept free on each side.
    pub margin: f64,
}

/// A side to pass on, as the robot sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Freer {
    /// To the robot's left.
    Left,
    /// To the robot's right.
    Right,
}

/// The verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Going on straight, the body (with its margin) meets an obstacle.
    pub collision: bool,
    /// Which obstacle is met first, or, when none is, passes nearest: an index into the list given.
    pub nearest: usize,
    /// Room between the body's side and that obstacle as it passes, metres; negative: overlap. Without the margin.
    pub clearance: f64,
    /// The side with the smaller sidestep.
    pub freer: Freer,
    /// The sidestep to the left, metres, after which nothing in the list is in the way.
    pub to_left: f64,
    /// The sidestep to the right, metres.
    pub to_right: f64,
}

/// The clearance-aware test: an obstacle is in the way when what it will occupy overlaps the body and its margin.
/// Obstacles on one side, several, and the gaps between them are all the same case. A tie goes to the left.
///
/// # Errors
/// [`Why::NoObstacle`] for an empty list, [`Why::BadNumber`].
pub fn course(obstacles: &[Reach], body: &Body) -> Result<Course, Why> {
    let need = body.half_width + body.margin;
    if !need.is_finite() || need < 0.0 || body.half_width < 0.0 {
        return Err(Why::BadNumber);
    }
    if obstacles.iter().any(|o| ![o.left, o.right, o.ttc].iter().all(|v| v.is_finite())) {
        return Err(Why::BadNumber);
    }
    let hits = |o: &Reach, at: f64| o.right - need < at && at < o.left + need;
    let clearance = |o: &Reach| o.right.max(-o.left) - body.half_width;
    let met =
        obstacles.iter().enumerate().filter(|(_, o)| hits(o, 0.0)).min_by(|a, b| a.1.ttc.total_cmp(&b.1.ttc));
    let passed = obstacles.iter().enumerate().min_by(|a, b| clearance(a.1).total_cmp(&clearance(b.1)));
    let Some((nearest, obstacle)) = met.or(passed) else { return Err(Why::NoObstacle) };
    // Sideways until free: each obstacle in the way pushes on to its far side. At most one push an obstacle.
    let free = |sign: f64| {
        let mut at = 0.0;
        for _ in 0..=obstacles.len() {
            let Some(o) = obstacles.iter().find(|o| hits(o, at)) else { break };
            at = if sign > 0.0 { o.left + need } else { o.right - need };
        }
        f64::abs(at)
    };
    let (to_left, to_right) = (free(1.0), free(-1.0));
    Ok(Course {
        collision: met.is_some(),
        nearest,
        clearance: clearance(obstacle),
        freer: freer(obstacle, to_left, to_right),
        to_left,
        to_right,
    })
}

/// The smaller sidestep; when neither side needs one, away from the obstacle.
fn freer(obstacle: &Reach, to_left: f64, to_right: f64) -> Freer {
    let left = if to_left == to_right { obstacle.left + obstacle.right <= 0.0 } else { to_left < to_right };
    if left { Freer::Left } else { Freer::Right }
}
