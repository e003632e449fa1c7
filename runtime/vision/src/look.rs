//! The services put together: a frame and the memory in, what is seen and the next memory out.

use crate::contours::{Contours, verticals};
use crate::course::Lane;
use crate::edge::{Edge, nearest_pair};
use crate::follow::{EdgeTrack, Following, Moment, carry, take_up};
use crate::image::{Gray, ImageView};
use crate::known::{Known, Remembering, remember};
use crate::landmarks::{Landmark, landmarks, remember_landmarks};
use crate::lens::Lens;
use crate::obstacle::{Obstacle, Pairing, obstacles};
use crate::points::{self, Flow};
use crate::refine::{Refinement, refine};
use crate::robust::PointTrack;
use crate::why::Why;

/// Parameters of [`look`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Looking {
    /// Contours and segments.
    pub contours: Contours,
    /// Edges over frames.
    pub edges: Following,
    /// Edges to obstacles.
    pub pairing: Pairing,
    /// Points on the obstacle.
    pub points: points::Following,
    /// What the body takes up on its way.
    pub lane: Lane,
    /// Obstacles out of sight, for motions of a known speed, m/s.
    pub remembering: Option<(Remembering, f64)>,
}

/// What is carried from frame to frame: a plain value, the caller's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// The time of the last frame, s.
    pub time: Option<f64>,
    /// The last frame in grey.
    pub image: Option<Gray>,
    /// Edges followed.
    pub edges: Vec<EdgeTrack>,
    /// Points followed on the first obstacle.
    pub points: Vec<PointTrack>,
    /// Where obstacles stand.
    pub known: Vec<Known>,
    /// Where edges by themselves stand.
    pub landmarks: Vec<Landmark>,
}

/// What is seen in a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// All upright edges of this frame, from the left.
    pub edges: Vec<Edge>,
    /// The obstacles, or why there is none: those in the lane before the others, each nearest first.
    pub obstacles: Result<Vec<Obstacle>, Why>,
    /// Which of them is the first: the nearest that is known to be in the lane; of none that is known the first in the list.
    pub first: Result<usize, Why>,
    /// Time to contact with the first one at the moment's pace, s: by its expansion, now or when that was known best.
    pub contact: Result<f64, Why>,
    /// Flow of points on the first obstacle since the last frame.
    pub flows: Vec<Flow>,
}

/// Looks at a frame: edges are followed and paired, points on the first obstacle are followed. The next memory
/// comes back; after an error go on from the old one with the next frame.
///
/// # Errors
/// [`Why::Black`], [`Why::White`]; the interval's, when the frame is not newer than the last;
/// [`Why::BadLens`], also for a lens with distortion (see [`crate::rectify`]); [`Why::WrongSize`] when the size has
/// changed; [`Why::BadNumber`].
pub fn look(
    frame: &ImageView<'_>,
    memory: &Memory,
    moment: &Moment,
    lens: &Lens,
    how: &Looking,
) -> Result<(Seen, Memory), Why> {
    look_at(Gray::of(frame)?, memory, moment, lens, how, None)
}

/// As [`look`], for a frame that is grey already; with another thread at hand, what is known is followed on it while contours
/// are looked for. What is seen is the same.
///
/// # Errors
/// As [`look`].
pub fn look_at(
    image: Gray,
    memory: &Memory,
    moment: &Moment,
    lens: &Lens,
    how: &Looking,
    helper: Option<&rayon::ThreadPool>,
) -> Result<(Seen, Memory), Why> {
    lens.check()?;
    if lens.distortion.is_some() {
        return Err(Why::BadLens);
    }
    if !moment.is_finite() {
        return Err(Why::BadNumber);
    }
    if let Some(last) = memory.time {
        crate::why::interval(moment.time - last)?;
    }
    if memory.image.as_ref().is_some_and(|i| (i.width(), i.height()) != (image.width(), image.height())) {
        return Err(Why::WrongSize);
    }
    image.lit()?;
    let known = || {
        let edges = carry(memory.edges.clone(), &image, moment, lens, &how.edges);
        let points = match &memory.image {
            Some(previous) => {
                points::advance(memory.points.clone(), previous, &image, moment, lens, &how.points)?
            }
            None => Vec::new(),
        };
        Ok((edges, points))
    };
    let new = || verticals(&image, moment.attitude.roll, &how.contours);
    let nothing = memory.points.is_empty() && memory.edges.is_empty();
    let (segments, known) = both(helper.filter(|_| !nothing), new, known);
    let segments = match segments {
        Ok(segments) => segments,
        Err(Why::NoFeatures) => Vec::new(),
        Err(why) => return Err(why),
    };
    let (carried, mut followed) = known.unwrap_or(Err(Why::OpenCv))?;
    let edges = take_up(carried, &image, &segments, moment, lens, &how.edges);
    let mut found = obstacles(&edges, moment, lens, &how.pairing);
    if let Ok(list) = &mut found {
        list.sort_by_key(|o| !how.lane.holds(o, moment.pace));
    }
    let obstacles = found.as_deref().unwrap_or_default();
    let interval = memory.time.map_or(0.0, |last| moment.time - last);
    let placed = how.remembering.as_ref().map_or_else(Vec::new, |(remembering, _)| {
        landmarks(&edges, moment, lens, remembering.doubtful, &how.pairing)
    });
    let known = how.remembering.as_ref().map_or_else(Vec::new, |(remembering, speed)| {
        let doubting = (interval, *speed > 0.5 * moment.pace);
        let camera = (lens, image.width());
        remember(&memory.known, (obstacles, &placed), moment, doubting, camera, remembering)
    });
    let landmarks = how.remembering.as_ref().map_or_else(Vec::new, |(remembering, speed)| {
        let doubting = (interval, *speed > 0.5 * moment.pace);
        remember_landmarks(&memory.landmarks, placed, moment, doubting, (lens, image.width()), remembering)
    });
    let (first, contact) = first(&found, &known, moment, how);
    if let Some(first) = first.ok().and_then(|i| obstacles.get(i)) {
        followed = points::replenish(followed, &image, &first.left, &first.right, moment, lens, &how.points);
    }
    let seen = Seen {
        edges: edges.iter().filter(|t| t.missed == 0).map(|t| t.edge).collect(),
        obstacles: found,
        first,
        contact,
        flows: points::flows(&followed),
    };
    let memory =
        Memory { time: Some(moment.time), image: Some(image), edges, points: followed, known, landmarks };
    Ok((seen, memory))
}

/// Both, the second by a helper if there is one.
fn both<A, B: Send>(
    helper: Option<&rayon::ThreadPool>,
    mine: impl FnOnce() -> A,
    other: impl FnOnce() -> B + Send,
) -> (A, Option<B>) {
    let mut done = None;
    let mine = match helper {
        Some(pool) => pool.in_place_scope(|scope| {
            scope.spawn(|_| done = Some(other()));
            mine()
        }),
        None => {
            let mine = mine();
            done = Some(other());
            mine
        }
    };
    (mine, done)
}

/// Which of the obstacles that are seen is the first, and the time to contact with it.
fn first(
    seen: &Result<Vec<Obstacle>, Why>,
    known: &[Known],
    moment: &Moment,
    how: &Looking,
) -> (Result<usize, Why>, Result<f64, Why>) {
    let sure = known.iter().filter(|k| how.remembering.as_ref().is_some_and(|(r, _)| k.is_sure(r)));
    let met = sure.filter_map(|k| k.met(moment, &how.lane).map(|ahead| (k, ahead)));
    match met.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((known, _)) => {
            let recent = how.remembering.as_ref().map_or(0.0, |(r, _)| r.recent);
            (known.which.ok_or(Why::NoObstacle), known.contact(moment, recent).ok_or(Why::NoObstacle))
        }
        None => match seen {
            Ok(all) => {
                let first = all.iter().position(|o| !behind_known(o, known, moment, how));
                let contact = first.and_then(|i| all.get(i)).map(|o| o.contact.ttc);
                (first.ok_or(Why::NoObstacle), contact.ok_or(Why::NoObstacle))
            }
            Err(why) => (Err(*why), Err(*why)),
        },
    }
}

/// Whether it borders on something known that is nearer: then it is what is seen beside that.
fn behind_known(obstacle: &Obstacle, known: &[Known], moment: &Moment, how: &Looking) -> bool {
    let beside = |k: &&Known| k.ids[0] == obstacle.right_id || k.ids[1] == obstacle.left_id;
    let sure = |k: &&Known| how.remembering.as_ref().is_some_and(|(r, _)| k.is_sure(r));
    let mut nearer =
        known.iter().filter(beside).filter(sure).filter_map(|k| k.contact(moment, f64::INFINITY));
    nearer.any(|contact| contact < obstacle.contact.ttc)
}

/// The published detection, from two frames alone.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestPair {
    /// All refined near-vertical edges, the nearest to the optical centre first.
    pub edges: Vec<Edge>,
    /// The nearest on the left of the optical centre.
    pub left: Edge,
    /// The nearest on the right.
    pub right: Edge,
    /// Width at the optical row, pixels.
    pub width: f64,
    /// Flow of points on and between them.
    pub flows: Vec<Flow>,
}

/// The published way (SOIFRA, Algorithm 1): contours, segments with α + roll ≈ 90°, the nearest one on each side of
/// the optical centre, their sparse flow between two frames. `roll` is that of the present frame, radians.
///
/// # Errors
/// [`Why::Black`], [`Why::White`], [`Why::NoFeatures`], [`Why::OneEdge`], [`Why::WrongSize`], [`Why::BadLens`],
/// [`Why::BadNumber`].
pub fn nearest(
    previous: &Gray,
    present: &Gray,
    roll: f64,
    lens: &Lens,
    contours: &Contours,
    how: &points::Following,
) -> Result<NearestPair, Why> {
    lens.check()?;
    if previous.width() != present.width() || previous.height() != present.height() {
        return Err(Why::WrongSize);
    }
    present.lit()?;
    let refinement = Refinement::default();
    let mut edges: Vec<Edge> =
        verticals(present, roll, contours)?.iter().filter_map(|s| refine(present, s, &refinement)).collect();
    edges.sort_by(|a, b| {
        let away = |e: &Edge| (e.x(lens) - lens.cx).abs();
        away(a).total_cmp(&away(b))
    });
    let (l, r) = nearest_pair(&edges, lens)?;
    let (left, right) = (edges[l], edges[r]);
    let chosen = points::choose(present, &left, &right, how);
    let flows = points::flow(previous, present, &chosen, how)?;
    Ok(NearestPair { width: right.x(lens) - left.x(lens), edges, left, right, flows })
}
