//! People, followed from image to image by the colours of their clothes, and which of them walk.
//!
//! Who is new is told by the shape of a whole person ([`crate::person`]). From then on the clothes tell where somebody is, also so
//! near that head or feet are out of the image: the bearing from where their colours are, the range from where they end on
//! the ground. Somebody walks whose place on the ground moves.

use crate::{
    clothes::{Clothes, Part},
    ground::Ground,
    image::{Gray, ImageView},
    person::{Searching, Shape, shapes},
    why::{Why, interval},
};

use core::ops::Range;

/// Where the camera is at an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// Seconds.
    pub time: f64,
    /// Of the camera's foot, metres, in a frame that stays.
    pub place: [f64; 2],
    /// Radians from that frame's x to the left.
    pub yaw: f64,
    /// The camera over the ground, its yaw 0.
    pub ground: Ground,
}

/// Somebody who is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Stays the same.
    pub number: u32,
    /// Metres, in the frame that stays.
    pub place: [f64; 2],
    /// Metres a second.
    pub velocity: [f64; 2],
    /// When it was seen last, seconds.
    pub seen: f64,
    /// Images in which it had the shape of a person.
    pub shapes: u32,
    /// Whether it walks.
    pub walks: bool,
    /// Metres that the patch of its clothes is wide, of late.
    pub width: f64,
    /// Images in which it was as narrow as a person.
    narrow: u32,
    /// When it was found by itself last, seconds.
    alone: f64,
    /// Images since, in which it should have had that shape and had not.
    doubts: u32,
    clothes: Clothes,
    /// How it was seen of late.
    way: Vec<Sighting>,
}

/// Somebody in an image.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sighting {
    /// Seconds.
    time: f64,
    /// Metres, in the frame that stays.
    place: [f64; 2],
    /// How much of the image is likely their legs between ankle and knee, as metres of width.
    legs: f64,
}

/// Everybody who is followed or remembered.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct People {
    /// Of the image, seconds.
    pub time: f64,
    /// In the order of their numbers.
    pub tracks: Vec<Track>,
    next: u32,
}

/// So many are followed.
pub const MOST: usize = 8;
/// Images with the shape of a person until somebody counts as one.
pub const SURE: u32 = 3;
/// A shape this far from the classifier's boundary begins a track.
const BEGIN: f64 = 0.5;
/// Seconds that somebody unseen is thought to go on.
const COASTING: f64 = 1.0;
/// Seconds that the clothes of somebody are remembered.
const REMEMBERED: f64 = 60.0;
/// Clothes that are as alike are the same.
const SAME: f64 = 0.6;
/// Images without the shape of a person until what is followed is none.
const DOUBTS: u32 = 30;
/// Seconds over which walking is judged, and at least.
const WINDOW: [f64; 2] = [3.0, 1.5];
/// Metres a second: one walks above, and stands below.
const WALKING: [f64; 2] = [0.15, 0.08];
/// Metres: the legs of somebody who walks part and close, so that the fifth and the fourth fifth of their widths differ at least so
/// much. The standard deviation on figures is 0.05 to 0.11, on things that are pushed and on who stands 0.005 to 0.02.
const GAIT: f64 = 0.06;
/// How much a way along the sight counts for walking, beside one across: at most, and times the range in metres.
const DEPTH: [f64; 2] = [0.5, 2.0];
/// Images until somebody new is where they seem to be.
const SETTLING: usize = 5;
/// Metres over the ground at which what is worn below the hip ends above the shoes.
const HEM: f64 = 0.06;
/// A column is of somebody that is so likely.
const LIKELY: f64 = 0.35;
/// Metres between patches of colour on one person.
const GAP: f64 = 0.06;
/// Metres that the middle of a patch may be off where somebody is thought to be.
const ASIDE: f64 = 0.45;
/// Metres: what is wider is nobody, or somebody and something beside in the same colours.
const WIDE: f64 = 0.6;
/// Images in which somebody was narrow until what is wide beside them is something else.
const NARROW: u32 = 8;
/// Seconds for which somebody beside something in the same colours is thought to go on.
const HIDDEN: f64 = 3.0;
/// The nearer foot is that much nearer than the middle, metres.
const FOOT: f64 = 0.12;

impl Standpoint {
    /// A place ahead and left of the camera in the frame that stays.
    fn out(&self, [ahead, left]: [f64; 2]) -> [f64; 2] {
        let (s, c) = libm::sincos(self.yaw);
        [self.place[0] + c * ahead - s * left, self.place[1] + s * ahead + c * left]
    }

    /// The reverse.
    fn seen(&self, at: [f64; 2]) -> [f64; 2] {
        let (s, c) = libm::sincos(self.yaw);
        let [x, y] = [at[0] - self.place[0], at[1] - self.place[1]];
        [c * x + s * y, c * y - s * x]
    }
}

/// Who is seen in an image, after those that were before.
///
/// # Errors
/// Those of [`shapes`], [`Why::WrongChannels`] for an image without colours, and [`Why::ZeroInterval`] or
/// [`Why::NegativeInterval`] for one that is not later than the one before.
pub fn people(
    image: &ImageView<'_>,
    before: Option<&People>,
    at: &Standpoint,
    how: &Searching,
) -> Result<People, Why> {
    if image.channels() != 3 {
        return Err(Why::WrongChannels);
    }
    if ![at.time, at.place[0], at.place[1], at.yaw].iter().all(|v| v.is_finite() && v.abs() < 1e9) {
        return Err(Why::BadNumber);
    }
    let dt = before.map(|b| interval(at.time - b.time)).transpose()?.unwrap_or(0.0);
    let found = shapes(&Gray::of(image)?, &at.ground, how)?;
    let mut all = before.cloned().unwrap_or_default();
    all.time = at.time;
    for track in &mut all.tracks {
        track.follow(image, at, dt);
    }
    let mut taken = vec![false; all.tracks.len()];
    for shape in &found {
        associate(image, at, shape, &mut all, &mut taken);
    }
    for (track, taken) in all.tracks.iter_mut().zip(&taken) {
        let [ahead, left] = at.seen(track.place);
        let whole = ahead > how.nearest * 1.15 && libm::hypot(ahead, left) < how.farthest * 0.8;
        if *taken {
            track.doubts = 0;
        } else if whole && track.seen == at.time {
            track.doubts += 1;
        }
        track.judge(at);
    }
    all.tracks.retain(|t| {
        let unseen = at.time - t.seen;
        if t.shapes >= SURE { unseen < REMEMBERED && t.doubts < DOUBTS } else { unseen < 0.5 && t.doubts < 5 }
    });
    one_each(&mut all.tracks);
    Ok(all)
}

/// Of two tracks at one place the one that is surer stays.
fn one_each(tracks: &mut Vec<Track>) {
    let mut kept: Vec<Track> = Vec::new();
    tracks.sort_by_key(|t| (core::cmp::Reverse(t.shapes), t.number));
    for t in tracks.drain(..) {
        let far = |k: &Track| libm::hypot(k.place[0] - t.place[0], k.place[1] - t.place[1]) > 0.35;
        if kept.iter().all(|k| k.seen != t.seen || far(k)) && kept.len() < MOST {
            kept.push(t);
        }
    }
    kept.sort_by_key(|t| t.number);
    *tracks = kept;
}

/// Gives a shape to whom it belongs, or begins a track.
fn associate(image: &ImageView<'_>, at: &Standpoint, shape: &Shape, all: &mut People, taken: &mut Vec<bool>) {
    let range = libm::hypot(shape.place[0], shape.place[1]);
    let near = |t: &Track| {
        let [ahead, left] = at.seen(t.place);
        let other = libm::hypot(ahead, left);
        let aside = (left * shape.place[0] - ahead * shape.place[1]).abs() / range.max(0.1);
        (at.time - t.seen <= COASTING && aside < 0.5 && (other - range).abs() < 0.3 * range).then_some(aside)
    };
    let known = (0..taken.len()).filter(|i| !taken[*i]);
    let nearest = known.filter_map(|i| Some((i, near(&all.tracks[i])?))).min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((i, _)) = nearest {
        let track = &mut all.tracks[i];
        taken[i] = true;
        track.shapes = track.shapes.saturating_add(1);
        if track.seen != at.time {
            track.take(image, at, shape.place);
        }
        return;
    }
    // What belongs to somebody who has been given a surer shape begins nothing.
    let twice = |t: &Track| at.time - t.seen <= COASTING && near(t).is_some();
    if shape.score < BEGIN || all.tracks.iter().any(twice) {
        return;
    }
    let Some(clothes) = Clothes::of(image, &at.ground, shape.place) else { return };
    let lost =
        |t: &&mut Track| t.shapes >= SURE && at.time - t.seen > COASTING && t.clothes.alike(&clothes) > SAME;
    let place = at.out(shape.place);
    if let Some(track) = all.tracks.iter_mut().find(lost) {
        track.take(image, at, shape.place);
        track.velocity = [0.0; 2];
        return;
    }
    let (seen, way) = (at.time, Vec::new());
    let number = all.next;
    all.next = all.next.wrapping_add(1);
    let velocity = [0.0; 2];
    all.tracks.push(Track {
        number,
        place,
        velocity,
        seen,
        shapes: 1,
        walks: false,
        width: 0.4,
        narrow: 0,
        alone: at.time,
        doubts: 0,
        clothes,
        way,
    });
    taken.push(true);
}

impl Track {
    /// Whether it may be a person: it had the shape of one, and is no wider.
    pub fn is_sure(&self) -> bool {
        self.shapes >= SURE && self.width < WIDE
    }

    /// It is there.
    fn take(&mut self, image: &ImageView<'_>, at: &Standpoint, place: [f64; 2]) {
        self.place = at.out(place);
        self.seen = at.time;
        self.alone = at.time;
        self.way.clear();
        self.walks = false;
        if let Some(now) = Clothes::of(image, &at.ground, place) {
            self.clothes.adapt(&now, 0.3);
        }
    }

    /// Where its clothes are now.
    fn follow(&mut self, image: &ImageView<'_>, at: &Standpoint, dt: f64) {
        if at.time - self.seen > COASTING {
            return;
        }
        let [px, py] = [0, 1].map(|k| self.place[k] + self.velocity[k] * dt);
        let predicted = at.seen([px, py]);
        self.place = [px, py];
        let Some(found) = find(image, &at.ground, predicted, &self.clothes) else {
            self.velocity = self.velocity.map(|v| 0.95 * v);
            return;
        };
        if found.width > WIDE && self.narrow >= NARROW && at.time - self.alone < HIDDEN {
            // Beside something in the same colours: it goes on.
            self.seen = at.time;
            return;
        }
        self.alone = at.time;
        self.narrow = self.narrow.saturating_add(u32::from(found.width < WIDE));
        self.width += 0.15 * (found.width - self.width);
        let measured = at.out(found.place);
        let sighting = Sighting { time: at.time, place: measured, legs: found.legs };
        let range = libm::hypot(predicted[0], predicted[1]).max(0.1);
        let sight = at.out([predicted[0] / range, predicted[1] / range]);
        let sight = [sight[0] - at.place[0], sight[1] - at.place[1]];
        if self.way.len() <= SETTLING && !self.walks {
            self.velocity = [0.0; 2];
            self.place = [0, 1].map(|k| 0.5 * (self.place[k] + measured[k]));
            self.seen = at.time;
            self.way.push(sighting);
            return;
        }
        let off = [measured[0] - px, measured[1] - py];
        let along = off[0] * sight[0] + off[1] * sight[1];
        let across = [off[0] - along * sight[0], off[1] - along * sight[1]];
        for k in 0..2 {
            self.place[k] += 0.5 * across[k] + 0.25 * along * sight[k];
            self.velocity[k] += (0.12 * across[k] + 0.03 * along * sight[k]) / dt.max(0.02);
        }
        let speed = libm::hypot(self.velocity[0], self.velocity[1]);
        if speed > 1.5 {
            self.velocity = self.velocity.map(|v| 1.5 * v / speed);
        }
        self.seen = at.time;
        self.way.push(sighting);
        if let Some(now) = Clothes::of(image, &at.ground, at.seen(self.place)) {
            self.clothes.adapt(&now, 0.04);
        }
    }

    /// Whether it walks.
    fn judge(&mut self, at: &Standpoint) {
        self.way.retain(|s| at.time - s.time <= WINDOW[0]);
        let third = self.way.len() / 3;
        let (Some(first), Some(last)) = (self.way.first(), self.way.last()) else { return };
        if third < 4 || last.time - first.time < WINDOW[1] {
            return;
        }
        let mean = |part: &[Sighting]| {
            let n = part.len() as f64;
            [0, 1, 2].map(|k| part.iter().map(|s| [s.time, s.place[0], s.place[1]][k]).sum::<f64>() / n)
        };
        let (a, b) = (mean(&self.way[..third]), mean(&self.way[self.way.len() - third..]));
        let [ahead, left] = at.seen(self.place);
        let range = libm::hypot(ahead, left).max(0.1);
        let (s, c) = libm::sincos(at.yaw);
        let (x, y) = (b[1] - a[1], b[2] - a[2]);
        let (x, y) = (c * x + s * y, c * y - s * x);
        let along = (x * ahead + y * left) / range;
        let across = (y * ahead - x * left) / range;
        let depth = DEPTH[0].min(DEPTH[1] / range);
        let speed = libm::hypot(across, depth * along) / (b[0] - a[0]).max(0.1);
        let mut legs: Vec<f64> = self.way.iter().map(|s| s.legs).collect();
        legs.sort_by(f64::total_cmp);
        let spread = legs[legs.len() * 4 / 5] - legs[legs.len() / 5];
        let [walks, stands] = WALKING;
        self.walks = if self.walks { speed > stands } else { spread > GAIT && speed > walks };
    }
}

/// Clothes that were found near a place.
struct Found {
    /// Metres ahead and left of the camera's foot.
    place: [f64; 2],
    /// Metres.
    width: f64,
    /// See [`Sighting`].
    legs: f64,
}

/// Where clothes are near a place, both in metres ahead and left of the camera's foot: of several patches of their colours the one
/// next to it.
fn find(image: &ImageView<'_>, ground: &Ground, place: [f64; 2], clothes: &Clothes) -> Option<Found> {
    let size = (image.width(), image.height());
    let range = libm::hypot(place[0], place[1]);
    if !(place[0] > 0.2) {
        return None;
    }
    let pixels = ground.lens.fx / place[0];
    let [x, _] = ground.pixel([place[0], place[1], 0.5])?;
    // At the border of the image only a part would be found.
    if x - 0.35 * pixels < 0.0 || x + 0.35 * pixels > size.0 as f64 {
        return None;
    }
    let (left, weights) = profile(image, ground, place, clothes)?;
    let patches = patches(&weights, GAP * pixels);
    let off = |p: &Range<usize>| (0.5 * (p.start + p.end) as f64 - 0.5 + left as f64 - x).abs();
    let wide = patches.into_iter().filter(|p| p.len() as f64 > 0.1 * pixels);
    let patch = wide.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let inside = x - left as f64 >= patch.start as f64 && x - left as f64 <= patch.end as f64;
    if off(&patch) > ASIDE * pixels && !inside {
        return None;
    }
    let width = patch.len() as f64 / pixels;
    let sum: f64 = weights[patch.clone()].iter().sum();
    let x = left as f64 + patch.map(|i| weights[i] * i as f64).sum::<f64>() / sum;
    let aside = place[0] * ((x - ground.lens.cx) / ground.lens.fx);
    let here = [place[0], -aside];
    let foot = foot(image, ground, here, clothes, pixels)?;
    let by_foot = Ground { height: ground.height - HEM, ..*ground }.place(x, foot)?;
    let measured = libm::hypot(by_foot[0], by_foot[1]) + FOOT;
    // Where the end of the clothes cannot be that of the feet, the bearing counts alone.
    let measured = if (0.5 * range..1.35 * range).contains(&measured) { measured } else { range };
    let by = measured / libm::hypot(here[0], here[1]).max(0.1);
    let place = [here[0] * by, here[1] * by];
    Some(Found { place, width: width * by, legs: legs(image, ground, place, clothes) })
}

/// How likely each column around a place shows somebody, from the first column on: the mean over the rows of thighs, where a step
/// does not widen them, and of the trunk if that is in the image.
fn profile(
    image: &ImageView<'_>,
    ground: &Ground,
    place: [f64; 2],
    clothes: &Clothes,
) -> Option<(usize, Vec<f64>)> {
    let size = (image.width(), image.height());
    let columns = |part, up| columns(image, clothes, part, ground.upright(size, place, [-0.9, 0.9], up)?);
    let (left, lower) = columns(Part::Lower, [0.45, 0.85])?;
    let upper = columns(Part::Upper, [1.0, 1.4]).map(|(_, u)| u);
    let both =
        |(i, l): (usize, f64)| upper.as_ref().map_or(l, |u| 0.5 * l + 0.5 * u.get(i).copied().unwrap_or(0.0));
    Some((left, lower.into_iter().enumerate().map(both).collect()))
}

/// How likely each column of a box is of that part of somebody, and the first column.
fn columns(
    image: &ImageView<'_>,
    clothes: &Clothes,
    part: Part,
    [left, right, top, bottom]: [usize; 4],
) -> Option<(usize, Vec<f64>)> {
    let step = ((bottom - top) / 40).max(1);
    let column = |x| {
        let likely = |y| image.pixel(x, y).map_or(0.0, |p| clothes.likely(p, part));
        let rows = (top..bottom).step_by(step);
        let n = rows.len().max(1) as f64;
        rows.map(likely).sum::<f64>() / n
    };
    (left < right && top < bottom).then(|| (left, (left..right).map(column).collect()))
}

/// See [`Sighting`].
fn legs(image: &ImageView<'_>, ground: &Ground, place: [f64; 2], clothes: &Clothes) -> f64 {
    let within = ground.upright((image.width(), image.height()), place, [-0.5, 0.5], [0.08, 0.35]);
    let seen = within.and_then(|w| columns(image, clothes, Part::Lower, w));
    let likely = seen.map_or(0, |(_, c)| c.iter().filter(|l| **l > LIKELY).count());
    likely as f64 * place[0] / ground.lens.fx
}

/// The runs of likely columns; gaps of so many columns do not end one.
fn patches(weights: &[f64], gap: f64) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for i in (0..weights.len()).filter(|i| weights[*i] > LIKELY) {
        match all.last_mut() {
            Some(last) if (i - last.end) as f64 <= gap => last.end = i + 1,
            _ => all.push(i..i + 1),
        }
    }
    all
}

/// The row in which the clothes of somebody end on the ground.
fn foot(image: &ImageView<'_>, ground: &Ground, at: [f64; 2], clothes: &Clothes, pixels: f64) -> Option<f64> {
    let size = (image.width(), image.height());
    let [left, right, _, bottom] = ground.upright(size, at, [-0.5, 0.5], [-0.3, 0.5])?;
    let [_, begin] = ground.pixel([at[0], at[1], 0.5])?;
    let begin = begin.clamp(0.0, size.1 as f64) as usize;
    let enough = (0.06 * pixels).max(2.0) as usize;
    let gap = (0.07 * pixels).max(2.0) as usize;
    let mut last = None;
    for y in begin..bottom {
        let likely = |x: &usize| image.pixel(*x, y).is_some_and(|p| clothes.likely(p, Part::Lower) > 0.5);
        if (left..right).filter(likely).count() >= enough {
            last = Some(y);
        } else if y - last.unwrap_or(begin) > gap {
            break;
        }
    }
    last.map(|y| y as f64 + 0.5)
}
