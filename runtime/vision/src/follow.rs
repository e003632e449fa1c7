//! Edges followed from frame to frame: what makes a history of an edge's bearing.
//!
//! A known edge is looked for where it is expected and refined there, whether or not Hough's transform finds it
//! again; Hough only brings new ones. The memory is a plain list that the caller keeps.

use crate::attitude::{Attitude, Rates, wrap};
use crate::edge::{Edge, Upright, seen, upright};
use crate::image::Gray;
use crate::lens::Lens;
use crate::reckoning::relative;
use crate::refine::{Refinement, refine};
use crate::segment::Segment;

/// What the robot knows about itself when a frame is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Seconds.
    pub time: f64,
    /// The camera's attitude; yaw from any heading that stays the same (an integrated gyro will do).
    pub attitude: Attitude,
    /// The camera's rates of turning.
    pub rates: Rates,
    /// Where the camera is in the level frame, metres; of a motion whose speed nobody knows, in units of what it
    /// covers in a second.
    pub place: [f64; 2],
    /// Azimuth of the direction of motion in the level frame, radians: the yaw, for a robot that drives straight
    /// ahead.
    pub course: f64,
    /// At which speed way counts as time, m/s: times to contact are what they would be at that speed. That of the motion
    /// itself, but for a robot that creeps or stands one at which it would not; 1 when nobody knows.
    pub pace: f64,
}

/// Where a camera was when something was seen, as seen from where it is now and moves to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Time that the way from there takes at the pace, s, counted back from now: not above zero unless the
    /// camera went backwards.
    pub time: f64,
    /// How far to the left of its present way it was, in units of what the pace covers in a second.
    pub aside: f64,
}

impl Moment {
    /// Straight ahead along `course` at a constant speed that nobody knows, so that places are times.
    pub fn steady(time: f64, attitude: Attitude, rates: Rates, course: f64) -> Self {
        let (s, c) = libm::sincos(course);
        Self { time, attitude, rates, place: [time * c, time * s], course, pace: 1.0 }
    }

    /// Level, straight ahead, at a constant speed that nobody knows.
    pub fn straight(time: f64) -> Self {
        Self::steady(time, Attitude::default(), Rates::default(), 0.0)
    }

    /// Is everything a number?
    pub fn is_finite(&self) -> bool {
        let numbers = [self.time, self.course, self.pace, self.place[0], self.place[1]];
        numbers.iter().all(|v| v.is_finite()) && self.attitude.is_finite() && self.rates.is_finite()
    }

    /// A former place as seen from now. The pace must not be zero.
    pub fn since(&self, place: [f64; 2]) -> Advance {
        let [ahead, left] = relative(place, self.place, self.course);
        Advance { time: ahead / self.pace, aside: left / self.pace }
    }
}

/// One sighting of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSight {
    /// Seconds.
    pub time: f64,
    /// Where the camera was then, metres in the level frame.
    pub place: [f64; 2],
    /// Where it stood in the level frame.
    pub upright: Upright,
}

/// An edge followed over frames.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeTrack {
    /// Its number: smaller ones were found earlier.
    pub id: u32,
    /// The edge as last seen.
    pub edge: Edge,
    /// Frames since then.
    pub missed: u32,
    /// Sightings, oldest first.
    pub sights: Vec<EdgeSight>,
}

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Most edges followed.
    pub most: usize,
    /// Sightings older than this are forgotten, s.
    pub memory: f64,
    /// Most sightings of an edge.
    pub samples: usize,
    /// Frames without a sighting after which an edge is forgotten.
    pub patience: u32,
    /// How new edges are refined.
    pub fresh: Refinement,
    /// How known edges are refined.
    pub known: Refinement,
    /// Largest deviation from vertical in the level frame, radians.
    pub tilt: f64,
    /// Two edges nearer than this are one, pixels.
    pub apart: f64,
}

impl Default for Following {
    fn default() -> Self {
        let fresh = Refinement::default();
        Self {
            most: 96,
            memory: 2.5,
            samples: 80,
            patience: 6,
            fresh,
            known: Refinement { reach: 2.0, support: 0.4, ..fresh },
            tilt: 0.06,
            apart: 3.0,
        }
    }
}

/// Carries known edges into the frame `image`, where they are expected: the best known first, and the number of the next
/// one that is new.
pub fn carry(
    tracks: Vec<EdgeTrack>,
    image: &Gray,
    moment: &Moment,
    lens: &Lens,
    how: &Following,
) -> (Vec<EdgeTrack>, u32) {
    let next = tracks.iter().map(|t| t.id).max().map_or(0, |id| id.wrapping_add(1));
    let mut kept: Vec<EdgeTrack> = Vec::with_capacity(tracks.len());
    for mut track in tracks {
        track.sights.retain(|s| s.time < moment.time && moment.time - s.time <= how.memory);
        let found = expected(&track, moment.time)
            .and_then(|at| seen(&at, lens, &moment.attitude))
            .and_then(|line| refine(image, &line, &how.known))
            .and_then(|edge| sight(&edge, moment, lens, how.tilt).map(|s| (edge, s)));
        match found {
            Some((edge, sight)) => {
                track.edge = edge;
                track.missed = 0;
                track.sights.push(sight);
                let surplus = track.sights.len().saturating_sub(how.samples.max(2));
                track.sights.drain(..surplus);
            }
            None => track.missed += 1,
        }
        if track.missed <= how.patience && !track.sights.is_empty() {
            kept.push(track);
        }
    }
    // Of two tracks that have run into one the better known stays.
    kept.sort_by(|a, b| b.sights.len().cmp(&a.sights.len()).then(a.id.cmp(&b.id)));
    let mut tracks: Vec<EdgeTrack> = Vec::with_capacity(kept.len());
    for track in kept {
        if track.missed > 0 || !tracks.iter().any(|t| same(&t.edge.line, &track.edge.line, how.apart / 2.0)) {
            tracks.push(track);
        }
    }
    (tracks, next)
}

/// Adds the edges of `segments` that are new to those that have been carried into the frame `image`. Ordered by x; the
/// longest stay when there are more than `most`.
pub fn take_up(
    (mut tracks, mut next): (Vec<EdgeTrack>, u32),
    image: &Gray,
    segments: &[Segment],
    moment: &Moment,
    lens: &Lens,
    how: &Following,
) -> Vec<EdgeTrack> {
    let mut fresh: Vec<&Segment> = segments.iter().collect();
    fresh.sort_by(|a, b| b.length().total_cmp(&a.length()));
    for segment in fresh {
        if tracks.len() >= how.most {
            break;
        }
        let known = |line: &Segment| tracks.iter().any(|t| same(&t.edge.line, line, how.apart));
        if known(segment) {
            continue;
        }
        let Some(edge) = refine(image, segment, &how.fresh) else { continue };
        let Some(sight) = sight(&edge, moment, lens, how.tilt) else { continue };
        if !known(&edge.line) {
            tracks.push(EdgeTrack { id: next, edge, missed: 0, sights: vec![sight] });
            next = next.wrapping_add(1);
        }
    }
    tracks.sort_by(|a, b| a.edge.x(lens).total_cmp(&b.edge.x(lens)).then(a.id.cmp(&b.id)));
    tracks
}

fn sight(edge: &Edge, moment: &Moment, lens: &Lens, tilt: f64) -> Option<EdgeSight> {
    let upright = upright(&edge.line, lens, &moment.attitude)?;
    (upright.tilt.abs() <= tilt).then_some(EdgeSight { time: moment.time, place: moment.place, upright })
}

/// Where the edge should stand at `time`: its bearing goes on as it went over its last sightings.
fn expected(track: &EdgeTrack, time: f64) -> Option<Upright> {
    let last = track.sights.last()?;
    let before = &track.sights[track.sights.len().saturating_sub(6)];
    let span = last.time - before.time;
    let rate = if span > 1e-9 { wrap(last.upright.bearing - before.upright.bearing) / span } else { 0.0 };
    // A thing ahead does not swing faster than this: a wild rate is noise.
    let rate = if rate.abs() < 2.0 { rate } else { 0.0 };
    Some(Upright { bearing: last.upright.bearing + rate * (time - last.time), ..last.upright })
}

/// Do two lines run within `apart` pixels of each other on rows that both have?
fn same(a: &Segment, b: &Segment, apart: f64) -> bool {
    let (from, to) = (a.top[1].max(b.top[1]), a.bottom[1].min(b.bottom[1]));
    if to < from {
        return false;
    }
    let y = (from + to) / 2.0;
    (a.x_at(y) - b.x_at(y)).abs() <= apart
}
