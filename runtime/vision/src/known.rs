//! Obstacles that were seen and may be out of sight: nearer than an image is wide, or behind the robot's shoulder.
//!
//! Places need a speed in metres per second: a motion whose speed nobody knows leaves nothing to remember.

use crate::course::{Lane, Reach};
use crate::follow::Moment;
use crate::lens::Lens;
use crate::obstacle::{Obstacle, Post};
use crate::turning::{Footprint, outline};

/// An obstacle where it was last seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its left edge as it was seen then, metres in the level frame.
    pub left: [f64; 2],
    /// Its right edge.
    pub right: [f64; 2],
    /// Unit vector away from where it was seen: it is taken to be as deep that way as it is wide, and
    /// at least a metre.
    pub away: [f64; 2],
    /// Numbers of the tracks of its edges as last seen, left and right.
    pub ids: [u32; 2],
    /// Which of the obstacles that are seen now it is.
    pub which: Option<usize>,
    /// How often it was seen.
    pub sightings: u32,
    /// When it was last seen, s.
    pub seen: f64,
    /// For how long it should have been seen since and was not, s.
    pub missed: f64,
}

/// The least depth of an obstacle, metres.
const DEPTH: f64 = 1.0;

/// How well the direction of motion is known, radians.
const DRIFT: f64 = 0.01;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remembering {
    /// Fewest sightings of what is believed once it is out of sight.
    pub fewest: u32,
    /// What is in full view and not seen for so long is not there, s.
    pub doubt: f64,
    /// What is nearer than this is not doubted, metres.
    pub near: f64,
    /// Farthest obstacle remembered, metres.
    pub farthest: f64,
    /// Two places nearer than this, from edge to edge, are of one obstacle, metres.
    pub same: f64,
    /// What is farther behind than this is forgotten, metres.
    pub behind: f64,
    /// Largest ratio of the standard deviation to the time to contact.
    pub uncertainty: f64,
    /// Widest obstacle remembered, metres.
    pub widest: f64,
    /// How well the place of an edge by itself must be known, as a share of its distance.
    pub doubtful: f64,
    /// Farthest edge by itself that is remembered, metres.
    pub beside: f64,
    /// Most obstacles remembered.
    pub most: usize,
}

impl Default for Remembering {
    fn default() -> Self {
        Self {
            fewest: 3,
            doubt: 1.5,
            near: 2.5,
            farthest: 6.0,
            same: 0.3,
            behind: 1.0,
            uncertainty: 0.15,
            widest: 4.0,
            doubtful: 0.08,
            beside: 3.0,
            most: 16,
        }
    }
}

/// What is known after a look of a robot of a speed (m/s) through a lens, images `width` pixels wide: what is seen now, and
/// what was known and is not in view.
pub fn remember(
    before: &[Known],
    seen: &[Obstacle],
    now: &Moment,
    speed: f64,
    (lens, width): (&Lens, usize),
    how: &Remembering,
) -> Vec<Known> {
    // Who hardly moves measures nothing, and so misses nothing.
    let moves = speed > 0.5 * now.pace;
    let mut out: Vec<Known> = seen
        .iter()
        .enumerate()
        .filter(|(_, o)| o.contact.sigma <= how.uncertainty * o.contact.ttc)
        .filter_map(|(i, o)| Some(Known { which: Some(i), ..placed(o, now)? }))
        .filter(|k| ahead(k, now)[1] < how.farthest && k.width() < how.widest)
        .collect();
    for old in before {
        let same = out.iter_mut().filter(|k| k.which.is_some() && gap(k, old) < how.same);
        let joined = same.filter_map(|k| k.joined(old, now, how).map(|j| (k, j))).next();
        if let Some((known, joined)) = joined {
            *known = joined;
            continue;
        }
        let mut old = Known { which: None, ..*old };
        let interval = now.time - old.seen.max(now.time - 1.0);
        // What is near may hide its edges; forgetting it would be worse than believing in what is not there.
        if moves && ahead(&old, now)[0] > how.near && in_view(&old, now, lens, width) {
            old.missed += interval.clamp(0.0, 0.1);
        }
        if old.is_sure(how) && old.missed < how.doubt && ahead(&old, now)[1] > -how.behind {
            out.push(old);
        }
    }
    out.truncate(how.most);
    out
}

/// Edges by themselves that are known after a look: those placed now, and those known before that are not far behind.
pub fn remember_posts(before: &[Post], now_placed: Vec<Post>, now: &Moment, how: &Remembering) -> Vec<Post> {
    let near = |p: &Post| {
        let [ahead, left] = from(p.place, now);
        ahead > -how.behind && libm::hypot(ahead, left) < how.beside
    };
    let mut out = now_placed;
    let old: Vec<Post> = before.iter().filter(|b| out.iter().all(|p| p.id != b.id)).copied().collect();
    out.extend(old);
    out.retain(near);
    out.truncate(4 * how.most);
    out
}

/// Where an obstacle stands; nothing when numbers fail.
fn placed(obstacle: &Obstacle, now: &Moment) -> Option<Known> {
    let (s, c) = libm::sincos(now.course);
    let [near_left, near_right] = obstacle.edge_contacts(DRIFT);
    let edge = |tangent: f64, contact: f64| {
        let z = contact * now.pace;
        let x = tangent * z;
        [now.place[0] + z * c - x * s, now.place[1] + z * s + x * c]
    };
    let left = edge(obstacle.left_tangents.last()?.tangent, near_left);
    let right = edge(obstacle.right_tangents.last()?.tangent, near_right);
    let ids = [obstacle.left_id, obstacle.right_id];
    let known =
        Known { left, right, away: [c, s], ids, which: None, sightings: 1, seen: now.time, missed: 0.0 };
    left.iter().chain(&right).all(|v| v.is_finite()).then_some(known)
}

/// A point as seen from the camera along its way: ahead, to the left.
fn from(point: [f64; 2], now: &Moment) -> [f64; 2] {
    let (s, c) = libm::sincos(now.course);
    let (x, y) = (point[0] - now.place[0], point[1] - now.place[1]);
    [x * c + y * s, y * c - x * s]
}

/// How far ahead the nearer and the farther edge are.
fn ahead(known: &Known, now: &Moment) -> [f64; 2] {
    let (l, r) = (from(known.left, now)[0], from(known.right, now)[0]);
    [l.min(r), l.max(r)]
}

/// The distance between two segments, roughly: of their nearest ends or middles; zero when they overlap.
fn gap(a: &Known, b: &Known) -> f64 {
    let middle = |k: &Known| [0, 1].map(|i| (k.left[i] + k.right[i]) / 2.0);
    let (p, q) = (middle(a), middle(b));
    libm::hypot(p[0] - q[0], p[1] - q[1]) - (a.width() + b.width()) / 2.0
}

/// Should both edges be seen, and not at the rim of the image?
fn in_view(known: &Known, now: &Moment, lens: &Lens, width: usize) -> bool {
    [known.left, known.right].iter().all(|p| {
        let (x, y) = (p[0] - now.place[0], p[1] - now.place[1]);
        let pixel = lens.pixel(now.attitude.body([x, y, 0.0]));
        let rim = width as f64 * 0.08;
        pixel.is_some_and(|p| p[0] > rim && p[0] < width as f64 - rim)
    })
}

impl Known {
    /// The same obstacle as known before: an image may show part of it, so it reaches as far to each side as it was
    /// ever seen to. Nothing when together they would be much wider than either: they are two.
    fn joined(&self, before: &Known, now: &Moment, how: &Remembering) -> Option<Known> {
        let bearing = |p: [f64; 2]| {
            let [x, y] = from(p, now);
            libm::atan2(y, x)
        };
        // The same edge is now known better.
        let farther = |k: usize, by: f64| before.ids[k] != self.ids[k] && by > 0.0;
        let left =
            if farther(0, bearing(before.left) - bearing(self.left)) { before.left } else { self.left };
        let right =
            if farther(1, bearing(self.right) - bearing(before.right)) { before.right } else { self.right };
        let sightings = self.sightings.saturating_add(before.sightings);
        let joined = Known { left, right, away: before.away, sightings, ..*self };
        (joined.width() <= self.width().max(before.width()) + how.same).then_some(joined)
    }

    fn width(&self) -> f64 {
        libm::hypot(self.left[0] - self.right[0], self.left[1] - self.right[1])
    }

    /// Whether it was seen often enough to be believed.
    pub fn is_sure(&self, how: &Remembering) -> bool {
        self.sightings >= how.fewest
    }

    /// Its corners as seen from the middle of a body at `place` that goes along `course`: metres ahead and to the left.
    pub fn footprint(&self, place: [f64; 2], course: f64) -> Footprint {
        let depth = self.width().max(DEPTH);
        let behind = |p: [f64; 2]| [p[0] + depth * self.away[0], p[1] + depth * self.away[1]];
        let (s, c) = libm::sincos(course);
        [self.left, self.right, behind(self.right), behind(self.left)].map(|p| {
            let (x, y) = (p[0] - place[0], p[1] - place[1]);
            [x * c + y * s, y * c - x * s]
        })
    }

    /// How far ahead of the camera it is met in a lane; nothing when it is not in it.
    pub fn met(&self, now: &Moment, lane: &Lane) -> Option<f64> {
        let footprint = self.footprint(now.place, now.course);
        let within = |p: &[f64; 2]| p[0] > 0.0 && lane.right < p[1] && p[1] < lane.left;
        outline(&footprint).filter(within).map(|p| p[0]).reduce(f64::min)
    }
}

/// What a footprint will occupy when it is reached by something `front` metres ahead of the middle at `speed`: its
/// part within a lane of the half width `need`, or all of it when none is. Nothing when none of it is ahead of the
/// middle.
pub fn reach(footprint: &Footprint, need: f64, front: f64, speed: f64) -> Option<Reach> {
    let ahead: Vec<[f64; 2]> = outline(footprint).filter(|p| p[0] > 0.0).collect();
    let within: Vec<[f64; 2]> = ahead.iter().copied().filter(|p| p[1].abs() < need).collect();
    let points = if within.is_empty() { &ahead } else { &within };
    let over = |k: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick);
    let (left, right, near) = (over(1, f64::max)?, over(1, f64::min)?, over(0, f64::min)?);
    (speed > 0.0).then(|| Reach { left, right, ttc: (near - front) / speed })
}
