//! Edges paired to obstacles.
//!
//! The published way takes the nearest edge on each side of the optical centre, whatever it belongs to. This one
//! asks what the edges do over time: an obstacle is a pair of edges that reach the horizon, close in at one rate,
//! with nothing farther away seen between them and nothing of the same rate right outside of them. Marks on walls,
//! floor tiles and the pattern on the obstacle's own face all fail one of these.

use crate::consensus::consensus;
use crate::course::{Bearing, Reach};
use crate::edge::Edge;
use crate::expansion::{Expansion, Width, Window, window};
use crate::follow::{EdgeTrack, Moment};
use crate::lens::Lens;
use crate::sweep::{Sweep, Tangent, settled, sweep, tangents, widths};
use crate::why::Why;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairing {
    /// Fewest common sightings of two edges.
    pub fewest: usize,
    /// Shortest time over which they were seen, s.
    pub shortest: f64,
    /// The window of the expansion.
    pub window: Window,
    /// Uncertainty of the direction of motion, radians.
    pub drift: f64,
    /// Relative difference of closing rates that counts as another distance.
    pub difference: f64,
    /// Straight ahead, within this tangent of the course, where lines on the floor seem to stand, ...
    pub ahead: f64,
    /// ... an edge must end above the horizon by this tangent.
    pub above: f64,
    /// An edge must begin below the horizon, or above it by no more than this tangent.
    pub horizon: f64,
    /// ... or, of a tall one, above it by no more than this share of its upper end.
    pub faint: f64,
    /// Narrowest obstacle, tangent.
    pub narrowest: f64,
    /// Smallest closing rate, 1/s: what is slower is far away.
    pub slowest: f64,
    /// Most obstacles given.
    pub most: usize,
}

impl Default for Pairing {
    fn default() -> Self {
        Self {
            fewest: 6,
            shortest: 0.3,
            window: Window::default(),
            drift: 0.006,
            difference: 0.12,
            ahead: 0.04,
            above: 0.03,
            horizon: 0.1,
            faint: 0.5,
            narrowest: 0.02,
            slowest: 0.02,
            most: 8,
        }
    }
}

/// How much the edges of one thing differ in distance, as a share.
const DEPTH: f64 = 0.15;

/// What is seen right outside of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Beyond {
    /// Something farther away: the edge hides it.
    Farther,
    /// Nothing that tells.
    Unknown,
}

/// An obstacle: two edges that move as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Number of the left edge's track.
    pub left_id: u32,
    /// Number of the right edge's track.
    pub right_id: u32,
    /// The left edge as seen now.
    pub left: Edge,
    /// The right edge as seen now.
    pub right: Edge,
    /// Width at the optical row, pixels.
    pub width: f64,
    /// Tangents of the left edge's bearing off the course over time (left positive).
    pub left_tangents: Vec<Tangent>,
    /// Those of the right edge.
    pub right_tangents: Vec<Tangent>,
    /// The history of the width: difference of the tangents, free of roll, pitch and turning.
    pub widths: Vec<Width>,
    /// Time to contact by expansion over that history.
    pub contact: Expansion,
    /// How fast each edge closes in by its own bearing, left and right.
    pub sweeps: [Sweep; 2],
    /// What is seen beyond the left edge, and beyond the right.
    pub beyond: [Beyond; 2],
}

impl Obstacle {
    /// Time to contact with each edge, s, left and right: what the edge's own bearing says of it and what the width says
    /// of both, weighted by their uncertainty. Edges of one thing need not be equally far: the width is trusted to
    /// `DEPTH` of the closing rate, bearings to a course known to `drift` radians.
    pub fn edge_contacts(&self, drift: f64) -> [f64; 2] {
        let both = 1.0 / self.contact.ttc;
        let of_both = libm::hypot(DEPTH * both, both * self.contact.sigma / self.contact.ttc);
        self.sweeps.map(|own| {
            let of_own = libm::hypot(own.sigma, drift * own.bias()).max(1e-9);
            let (a, b) = (1.0 / (of_both * of_both), 1.0 / (of_own * of_own));
            let closing = (both * a + own.closing * b) / (a + b);
            // Never farther than twice, or nearer than half of what the width says.
            1.0 / closing.clamp(0.5 * both, 2.0 * both)
        })
    }

    /// What it will occupy when it is reached at `speed` (m/s).
    ///
    /// # Errors
    /// Those of [`Bearing::fit`] and [`Reach::predict`].
    pub fn reach(&self, speed: f64) -> Result<Reach, Why> {
        let closing = 1.0 / self.contact.ttc;
        let left = Bearing::fit(&self.left_tangents, closing)?;
        let right = Bearing::fit(&self.right_tangents, closing)?;
        Reach::predict(&left, &right, self.contact.ttc, speed)
    }
}

/// An edge that takes part.
struct Candidate<'a> {
    track: &'a EdgeTrack,
    tangents: Vec<Tangent>,
    sweep: Sweep,
}

/// A pair that may be one thing.
struct Pair {
    left: usize,
    right: usize,
    widths: Vec<Width>,
    contact: Expansion,
    /// Closing rate, 1/s, less what its edges disagree with it and its uncertainty.
    near: f64,
    /// The uncertainty of the closing rate, 1/s.
    sigma: f64,
    beyond: [Beyond; 2],
}

/// The obstacles among the edges as seen from `now`, nearest first, none overlapping a nearer one.
///
/// # Errors
/// [`Why::NoFeatures`] without edges; [`Why::OneEdge`] for a single one; [`Why::TooShort`] while none was seen long
/// enough; [`Why::NoObstacle`] when no two belong together; [`Why::SpeedZero`] for a pace that is not positive;
/// [`Why::BadNumber`].
pub fn obstacles(
    tracks: &[EdgeTrack],
    now: &Moment,
    lens: &Lens,
    how: &Pairing,
) -> Result<Vec<Obstacle>, Why> {
    if !now.is_finite() {
        return Err(Why::BadNumber);
    }
    if now.pace <= 0.0 {
        return Err(Why::SpeedZero);
    }
    match tracks.iter().filter(|t| t.missed == 0).count() {
        0 => return Err(Why::NoFeatures),
        1 => return Err(Why::OneEdge),
        _ => {}
    }
    let noise = 0.03 / lens.fx;
    let mut candidates: Vec<Candidate<'_>> = tracks
        .iter()
        .filter(|t| t.missed == 0)
        .filter_map(|track| {
            let tangents = tangents(track, now, how.window.length);
            let tangents = settled(&tangents, how.fewest, how.shortest, 5.0 * noise).to_vec();
            let long = tangents.last()?.time - tangents.first()?.time >= how.shortest;
            let sweep = sweep(&tangents, how.fewest, noise).filter(|s| long && stands(track, s, how))?;
            Some(Candidate { track, tangents, sweep })
        })
        .collect();
    if candidates.len() < 2 {
        return Err(Why::TooShort);
    }
    // From the left: the greatest bearing first.
    candidates.sort_by(|a, b| b.sweep.tangent.total_cmp(&a.sweep.tangent).then(a.track.id.cmp(&b.track.id)));
    let mut pairs: Vec<Pair> = Vec::new();
    for left in 0..candidates.len() {
        for right in left + 1..candidates.len() {
            pairs.extend(pair(&candidates, left, right, how));
        }
    }
    let chosen = choose(&candidates, pairs, how);
    if chosen.is_empty() {
        return Err(Why::NoObstacle);
    }
    Ok(chosen.into_iter().map(|p| obstacle(&candidates, p, lens, how)).collect())
}

/// Does the edge stand on the floor and, where lines on the floor seem upright, rise above the horizon? Judged on its
/// latest sightings, a third must agree: its ends flicker. A line on the floor that is seen elsewhere than straight
/// ahead points at a place on the horizon that does not move, so that its closing rate gives it away.
pub(crate) fn stands(track: &EdgeTrack, sweep: &Sweep, how: &Pairing) -> bool {
    let latest = &track.sights[track.sights.len().saturating_sub(12)..];
    let above = if sweep.tangent.abs() < how.ahead { how.above } else { f64::NEG_INFINITY };
    let standing = latest
        .iter()
        .filter(|s| {
            // A long edge may be too faint to be seen down to the floor.
            let below = how.horizon.max(how.faint * s.upright.upper);
            s.upright.upper > above && s.upright.lower < below
        })
        .count();
    3 * standing >= latest.len().max(1)
}

/// Nearest first, none overlapping another. Of the pairs at the distance of the nearest that share rows with it the
/// outline is the one that hides something on both sides, then the widest: the others are the pattern within.
fn choose(candidates: &[Candidate<'_>], mut pairs: Vec<Pair>, how: &Pairing) -> Vec<Pair> {
    pairs.sort_by(|a, b| b.near.total_cmp(&a.near).then(a.left.cmp(&b.left)).then(a.right.cmp(&b.right)));
    let breadth = |p: &Pair| candidates[p.left].sweep.tangent - candidates[p.right].sweep.tangent;
    let apart = |a: &Pair, b: &Pair| a.right <= b.left || b.right <= a.left;
    let mut chosen: Vec<Pair> = Vec::new();
    while chosen.len() < how.most && !pairs.is_empty() {
        let first = &pairs[0];
        let limit = first.near * (1.0 - how.difference / 3.0) - first.sigma;
        let best = (0..pairs.len())
            .filter(|&k| pairs[k].near >= limit && !apart(&pairs[k], first))
            .max_by(|&a, &b| {
                let rank = |k: usize| (std::cmp::Reverse(unknowns(&pairs[k])), breadth(&pairs[k]));
                rank(a).0.cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1)).then(b.cmp(&a))
            })
            .unwrap_or(0);
        let best = pairs.swap_remove(best);
        pairs.retain(|p| apart(p, &best));
        pairs.sort_by(|a, b| b.near.total_cmp(&a.near).then(a.left.cmp(&b.left)).then(a.right.cmp(&b.right)));
        chosen.push(best);
    }
    chosen
}

fn unknowns(pair: &Pair) -> usize {
    pair.beyond.iter().filter(|b| **b == Beyond::Unknown).count()
}

/// Are these two the outline of one thing?
fn pair(candidates: &[Candidate<'_>], left: usize, right: usize, how: &Pairing) -> Option<Pair> {
    let (l, r) = (&candidates[left], &candidates[right]);
    if l.sweep.tangent - r.sweep.tangent < how.narrowest {
        return None;
    }
    // Cheap first: rates that differ beyond doubt.
    if (l.sweep.closing - r.sweep.closing).abs() > doubt(l, r, how) + how.difference * l.sweep.closing.abs() {
        return None;
    }
    // What the neighbours say costs less than a fit, and settles most pairs.
    let before = candidates[..left].iter().rev().find(|c| beside(l, c));
    let after = candidates[right + 1..].iter().find(|c| beside(r, c));
    let beyond = [beyond(l, before, how)?, beyond(r, after, how)?];
    let widths = widths(&l.tangents, &r.tangents);
    let span = widths.last()?.time - widths.first()?.time;
    if widths.len() < how.fewest || span < how.shortest {
        return None;
    }
    let contact = window(&widths, &how.window).ok()?;
    let closing = 1.0 / contact.ttc;
    if closing < how.slowest {
        return None;
    }
    // The rate of the width does not depend on the course, those of the edges do.
    let slack =
        |c: &Candidate<'_>| how.difference * closing + 3.0 * c.sweep.sigma + how.drift * c.sweep.bias().abs();
    if [l, r].iter().any(|c| (c.sweep.closing - closing).abs() > slack(c)) {
        return None;
    }
    // Something farther away between them: they are the sides of a gap.
    if candidates[left + 1..right]
        .iter()
        .any(|c| beside(l, c) && beside(r, c) && c.sweep.closing < closing - slack(c))
    {
        return None;
    }
    let against = |c: &Candidate<'_>| ((c.sweep.closing - closing).abs() - c.sweep.sigma).max(0.0);
    let sigma = closing * contact.sigma / contact.ttc;
    let near = closing - against(l) - against(r) - sigma;
    Some(Pair { left, right, widths, contact, near, sigma, beyond })
}

/// Are two edges beside each other, at one height for at least a quarter of the shorter one? What is seen above an
/// obstacle says nothing about it.
fn beside(a: &Candidate<'_>, b: &Candidate<'_>) -> bool {
    let span =
        |c: &Candidate<'_>| c.track.sights.last().map_or((0.0, 0.0), |s| (s.upright.lower, s.upright.upper));
    let ((a0, a1), (b0, b1)) = (span(a), span(b));
    a1.min(b1) - a0.max(b0) >= 0.25 * (a1 - a0).min(b1 - b0)
}

/// How much the rates of two edges may differ by noise and by the course being off: 1/s.
fn doubt(a: &Candidate<'_>, b: &Candidate<'_>, how: &Pairing) -> f64 {
    2.5 * libm::hypot(a.sweep.sigma, b.sweep.sigma) + how.drift * (a.sweep.bias() - b.sweep.bias()).abs()
}

/// What the next edge outward says about `edge`; `None` when the same surface goes on there.
fn beyond(edge: &Candidate<'_>, next: Option<&Candidate<'_>>, how: &Pairing) -> Option<Beyond> {
    let Some(next) = next else { return Some(Beyond::Unknown) };
    let (here, there) = (edge.sweep.closing, next.sweep.closing);
    let doubt = doubt(edge, next, how);
    if there < here * (1.0 - how.difference / 3.0) - doubt {
        Some(Beyond::Farther)
    } else if doubt > 0.3 * here || there > here * (1.0 + how.difference) + doubt {
        Some(Beyond::Unknown)
    } else {
        None
    }
}

fn obstacle(candidates: &[Candidate<'_>], pair: Pair, lens: &Lens, how: &Pairing) -> Obstacle {
    let (l, r) = (&candidates[pair.left], &candidates[pair.right]);
    let closing = 1.0 / pair.contact.ttc;
    let on_face = |c: &&Candidate<'_>| {
        let slack = how.difference * closing + 2.0 * c.sweep.sigma + how.drift * c.sweep.bias().abs();
        beside(l, c) && beside(r, c) && (c.sweep.closing - closing).abs() <= slack
    };
    let within = candidates[pair.left + 1..pair.right].iter().filter(on_face);
    let edges: Vec<&[Tangent]> =
        std::iter::once(l).chain(within).chain([r]).map(|c| &c.tangents[..]).collect();
    let contact = consensus(&edges, pair.contact, &how.window);
    Obstacle {
        left_id: l.track.id,
        right_id: r.track.id,
        left: l.track.edge,
        right: r.track.edge,
        width: r.track.edge.x(lens) - l.track.edge.x(lens),
        left_tangents: l.tangents.clone(),
        right_tangents: r.tangents.clone(),
        widths: pair.widths,
        contact,
        sweeps: [l.sweep, r.sweep],
        beyond: pair.beyond,
    }
}
