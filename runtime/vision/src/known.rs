//! Obstacles that were seen and may be out of sight: nearer than an image is wide, or behind the robot's shoulder.
//!
//! Places need a speed in metres per second: a motion whose speed nobody knows leaves nothing to remember.

use crate::course::{Lane, Reach};
use crate::follow::Moment;
use crate::landmarks::Landmark;
use crate::lens::Lens;
use crate::obstacle::Obstacle;
use crate::reckoning::relative;
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
    /// Numbers of the tracks of the edges that it was last seen to reach to, left and right.
    pub ids: [u32; 2],
    /// When they were seen, s.
    pub reached: [f64; 2],
    /// Which of the obstacles that are seen now it is.
    pub which: Option<usize>,
    /// How far ahead it is, as known best.
    pub range: Range,
    /// How often it was seen.
    pub sightings: u32,
    /// When it was last seen, s.
    pub seen: f64,
    /// For how long it should have been seen since and was not, s.
    pub missed: f64,
}

/// How far ahead an obstacle was when that was known best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Along the direction of motion then, metres.
    pub ahead: f64,
    /// Its standard deviation then, metres.
    pub sigma: f64,
    /// Where the camera was then, metres in the level frame.
    pub place: [f64; 2],
    /// The direction of motion then, radians.
    pub course: f64,
}

impl Range {
    /// As it is now: metres ahead and their standard deviation, which grows with the way since. Nothing after a turn: then it
    /// is another side that is met.
    fn at(&self, now: &Moment) -> Option<[f64; 2]> {
        let [way, _] = relative(now.place, self.place, self.course);
        let turned = crate::attitude::wrap(now.course - self.course).abs();
        (turned < TURNED).then(|| [self.ahead - way, libm::hypot(self.sigma, AGEING * way)])
    }
}

/// After a turn by so much a range does not count any more, radians.
const TURNED: f64 = 0.15;

/// By how much a range is less certain for each metre gone since, metres.
const AGEING: f64 = 0.03;

/// The least depth of an obstacle, metres.
const DEPTH: f64 = 1.0;

/// How well the direction of motion is known, radians.
const DRIFT: f64 = 0.01;

/// Two bearings so near may be of one edge, radians.
const RIM: f64 = 0.03;

/// A distance is well known to this share of it.
const CERTAIN: f64 = 0.05;

/// An edge so near to the course shows no distance by itself: tangent.
const OFF_AXIS: f64 = 0.05;

/// What is so many times as far away stands behind.
const BEHIND: f64 = 1.4;

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
    /// An edge by itself that is nearer than this may not show any more, metres.
    pub hidden: f64,
    /// An edge by itself is believed when there is another one so near, metres.
    pub company: f64,
    /// Most edges by themselves remembered.
    pub most_landmarks: usize,
    /// For how long an obstacle is taken to reach as far as it was seen to, when what is seen of it now is less, s.
    pub extent: f64,
    /// For how long the time to contact with what is not seen is told, s.
    pub recent: f64,
    /// Most obstacles remembered.
    pub most: usize,
}

impl Default for Remembering {
    fn default() -> Self {
        Self {
            fewest: 6,
            doubt: 0.75,
            near: 1.2,
            farthest: 6.0,
            same: 0.3,
            behind: 1.0,
            uncertainty: 0.15,
            widest: 4.0,
            doubtful: 0.08,
            beside: 6.0,
            hidden: 1.0,
            company: 0.4,
            most_landmarks: 128,
            extent: 2.5,
            recent: 0.3,
            most: 16,
        }
    }
}

/// What is known after a look through a lens, images `width` pixels wide, `interval` seconds after the last one: what is seen
/// now, and what was known and is not in view. A robot that hardly moves measures nothing, and so misses nothing.
pub fn remember(
    before: &[Known],
    (seen, placed_now): (&[Obstacle], &[Landmark]),
    now: &Moment,
    (interval, moves): (f64, bool),
    (lens, width): (&Lens, usize),
    how: &Remembering,
) -> Vec<Known> {
    let mut out: Vec<Known> = seen
        .iter()
        .enumerate()
        .filter(|(_, o)| o.contact.sigma <= how.uncertainty * o.contact.ttc)
        .filter_map(|(i, o)| Some(Known { which: Some(i), ..placed(o, now)? }))
        .filter(|k| ahead(k, now)[1] < how.farthest && k.width() < how.widest)
        .collect();
    let others: Vec<Known> =
        out.iter().copied().chain(before.iter().filter(|k| k.is_sure(how)).copied()).collect();
    let through = Through::new(seen, placed_now, now);
    for old in before {
        let same = out.iter_mut().filter(|k| k.which.is_some() && gap(k, old) < how.same);
        let joined = same.filter_map(|k| k.joined(old, (&others, &through), now, how).map(|j| (k, j))).next();
        if let Some((known, joined)) = joined {
            *known = joined;
            continue;
        }
        let mut old = Known { which: None, ..*old };
        // What is near may hide its edges; forgetting it would be worse than believing in what is not there.
        let [right, left] = [old.right, old.left].map(|p| polar(p, now));
        let contradicted = in_view(&old, now, lens, width) || through.between(right, left);
        if moves && ahead(&old, now)[0] > how.near && contradicted {
            old.missed += interval;
        }
        if old.is_sure(how) && old.missed < how.doubt && ahead(&old, now)[1] > -how.behind {
            out.push(old);
        }
    }
    out.truncate(how.most);
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
    let [ahead, sigma] = [obstacle.contact.ttc, obstacle.contact.sigma].map(|t| t * now.pace);
    let range = Range { ahead, sigma, place: now.place, course: now.course };
    let known = Known {
        left,
        right,
        away: [c, s],
        ids,
        reached: [now.time; 2],
        which: None,
        range,
        sightings: 1,
        seen: now.time,
        missed: 0.0,
    };
    left.iter().chain(&right).all(|v| v.is_finite()).then_some(known)
}

/// How far ahead the nearer and the farther edge are.
fn ahead(known: &Known, now: &Moment) -> [f64; 2] {
    let [l, r] = [known.left, known.right].map(|p| relative(p, now.place, now.course)[0]);
    [l.min(r), l.max(r)]
}

/// How far away a place is, and its bearing off the course, radians.
fn polar(place: [f64; 2], now: &Moment) -> [f64; 2] {
    let [x, y] = relative(place, now.place, now.course);
    [libm::hypot(x, y), libm::atan2(y, x)]
}

/// What is seen far away, in directions in which nothing can stand before it: distance and bearing.
struct Through(Vec<[f64; 2]>);

impl Through {
    /// Edges placed by themselves, and those of obstacles whose distance is well known.
    fn new(seen: &[Obstacle], placed: &[Landmark], now: &Moment) -> Through {
        let mut all: Vec<[f64; 2]> = placed.iter().map(|l| polar(l.place, now)).collect();
        for o in seen.iter().filter(|o| o.contact.sigma <= CERTAIN * o.contact.ttc) {
            let ahead = o.contact.ttc * now.pace;
            let tangents = [&o.left_tangents, &o.right_tangents].map(|t| t.last().map_or(0.0, |t| t.tangent));
            let off = tangents.into_iter().filter(|t| t.abs() > OFF_AXIS);
            all.extend(off.map(|t| [ahead * libm::sqrt(1.0 + t * t), libm::atan(t)]));
        }
        Through(all)
    }

    /// Whether something between two places, the right one first, is seen far behind them.
    fn between(&self, [a, right]: [f64; 2], [b, left]: [f64; 2]) -> bool {
        let behind = BEHIND * a.max(b);
        self.0.iter().any(|[away, bearing]| *away > behind && right + RIM < *bearing && *bearing < left - RIM)
    }
}

/// The distance between two segments, roughly: of their nearest ends or middles; zero when they overlap.
fn gap(a: &Known, b: &Known) -> f64 {
    let middle = |k: &Known| [0, 1].map(|i| (k.left[i] + k.right[i]) / 2.0);
    let (p, q) = (middle(a), middle(b));
    libm::hypot(p[0] - q[0], p[1] - q[1]) - (a.width() + b.width()) / 2.0
}

/// Should both edges be seen, and not at the rim of the image?
fn in_view(known: &Known, now: &Moment, lens: &Lens, width: usize) -> bool {
    [known.left, known.right].iter().all(|p| shows(*p, now, lens, width))
}

/// Is a place on the floor within the image, and not at its rim?
pub(crate) fn shows(place: [f64; 2], now: &Moment, lens: &Lens, width: usize) -> bool {
    let (x, y) = (place[0] - now.place[0], place[1] - now.place[1]);
    let pixel = lens.pixel(now.attitude.body([x, y, 0.0]));
    let rim = width as f64 * 0.08;
    pixel.is_some_and(|p| p[0] > rim && p[0] < width as f64 - rim)
}

impl Known {
    /// The same obstacle as known before: an image may show part of it, so it reaches as far to each side as it was
    /// seen to of late, unless one of the `others` is there. Nothing when together they would be much wider than either: they are two.
    fn joined(
        &self,
        before: &Known,
        (others, through): (&[Known], &Through),
        now: &Moment,
        how: &Remembering,
    ) -> Option<Known> {
        let bearing = |p| polar(p, now)[1];
        let another = |p| others.iter().any(|o| o.hides(p, now) && gap(o, self) >= how.same);
        // The same edge is now known better.
        let farther = |k: usize, by: f64| {
            let (mine, old) = (polar(self.side(k).0, now), polar(before.side(k).0, now));
            let open = if k == 0 { through.between(mine, old) } else { through.between(old, mine) };
            let late = now.time - before.reached[k] > how.extent;
            before.ids[k] != self.ids[k] && by > 0.0 && !late && !open && !another(before.side(k).0)
        };
        let left = farther(0, bearing(before.left) - bearing(self.left));
        let right = farther(1, bearing(self.right) - bearing(before.right));
        let [(left, id_left, reached_left), (right, id_right, reached_right)] =
            [(0, left), (1, right)].map(|(k, farther)| if farther { before } else { self }.side(k));
        let sightings = self.sightings.saturating_add(before.sightings);
        // What was known better before still is, less the way since: a pair that is new or narrow tells little.
        let better = before.range.at(now).is_some_and(|[_, sigma]| sigma < self.range.sigma);
        let range = if better { before.range } else { self.range };
        let (ids, reached) = ([id_left, id_right], [reached_left, reached_right]);
        let joined = Known { left, right, ids, reached, away: before.away, range, sightings, ..*self };
        (joined.width() <= self.width().max(before.width()) + how.same).then_some(joined)
    }

    /// Whether it stands where a place is seen, or before it.
    fn hides(&self, place: [f64; 2], now: &Moment) -> bool {
        let [[_, left], [near, right], [away, bearing]] =
            [self.left, self.right, place].map(|p| polar(p, now));
        right - RIM <= bearing && bearing <= left + RIM && near <= away + DEPTH
    }

    /// Its left edge (0) or its right one (1): place, number, and when it was seen.
    fn side(&self, k: usize) -> ([f64; 2], u32, f64) {
        ([self.left, self.right][k], self.ids[k], self.reached[k])
    }

    fn width(&self) -> f64 {
        libm::hypot(self.left[0] - self.right[0], self.left[1] - self.right[1])
    }

    /// Whether it was seen often enough to be believed.
    pub fn is_sure(&self, how: &Remembering) -> bool {
        self.sightings >= how.fewest
    }

    /// Time to contact at the moment's pace, s, when it was seen no longer than `recent` seconds ago.
    pub fn contact(&self, now: &Moment, recent: f64) -> Option<f64> {
        let [ahead, _] = self.range.at(now).filter(|_| now.time - self.seen <= recent)?;
        (ahead > 0.0 && now.pace > 0.0).then(|| ahead / now.pace)
    }

    /// Its corners as seen from the middle of a body at `place` that goes along `course`: metres ahead and to the left.
    pub fn footprint(&self, place: [f64; 2], course: f64) -> Footprint {
        let depth = self.width().max(DEPTH);
        let behind = |p: [f64; 2]| [p[0] + depth * self.away[0], p[1] + depth * self.away[1]];
        [self.left, self.right, behind(self.right), behind(self.left)].map(|p| relative(p, place, course))
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
