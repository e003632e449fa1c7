//! Edges by themselves: upright edges placed by their own bearings, one by one, and remembered where they stand.
//!
//! A pair of edges tells that there is something between them; an edge by itself tells less, but is sure of its place.
//! The pattern on a face gives many, so that they trace out the surface also where no outline is seen as a pair. Places need
//! a speed in metres per second.

use crate::follow::{EdgeTrack, Moment};
use crate::known::{Remembering, shows};
use crate::lens::Lens;
use crate::obstacle::{Pairing, stands};
use crate::reckoning::relative;
use crate::sweep::{settled, sweep, tangents};

/// An upright edge by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// Number of its track.
    pub id: u32,
    /// Where it stands, metres in the level frame.
    pub place: [f64; 2],
    /// How well its distance is known, metres.
    pub sigma: f64,
    /// For how long it should have been seen since it was last and was not, s.
    pub missed: f64,
}

/// The edges that can be placed by themselves as seen from `now`, each to a share `doubt` of its distance: those well off
/// the course, seen for long.
pub fn landmarks(
    tracks: &[EdgeTrack],
    now: &Moment,
    lens: &Lens,
    doubt: f64,
    how: &Pairing,
) -> Vec<Landmark> {
    let noise = 0.03 / lens.fx;
    let (s, c) = libm::sincos(now.course);
    let placed = |track: &EdgeTrack| {
        let all = tangents(track, now, how.window.length);
        let settled = settled(&all, how.fewest, how.shortest, 5.0 * noise);
        let long = settled.last()?.time - settled.first()?.time >= 2.0 * how.shortest;
        let sweep = sweep(settled, how.fewest, noise).filter(|s| long && stands(track, s, how))?;
        let off = libm::hypot(sweep.sigma, how.drift * sweep.bias());
        if !(sweep.closing > 0.0 && off <= doubt * sweep.closing) {
            return None;
        }
        let z = now.pace / sweep.closing;
        let x = z * sweep.tangent;
        let place = [now.place[0] + z * c - x * s, now.place[1] + z * s + x * c];
        let sigma = libm::hypot(z, x) * off / sweep.closing;
        let known = place.iter().all(|v| v.is_finite()) && sigma.is_finite();
        known.then_some(Landmark { id: track.id, place, sigma, missed: 0.0 })
    };
    if !(now.is_finite() && now.pace > 0.0) {
        return Vec::new();
    }
    tracks.iter().filter(|t| t.missed == 0).filter_map(placed).collect()
}

/// What is known after a look, `interval` seconds after the last one: landmarks placed now, and those known before that are not
/// far away or in doubt. `moves`: whether the robot moves enough to place anything.
pub fn remember_landmarks(
    before: &[Landmark],
    placed: Vec<Landmark>,
    now: &Moment,
    (interval, moves): (f64, bool),
    (lens, width): (&Lens, usize),
    how: &Remembering,
) -> Vec<Landmark> {
    let mut out = placed;
    for old in before {
        if let Some(same) = out.iter_mut().find(|p| p.id == old.id) {
            // The place that is known best: later ones of an edge beside the body are worse.
            if old.sigma < same.sigma && apart(old, same) < 2.0 * (old.sigma + same.sigma) {
                *same = Landmark { missed: 0.0, ..*old };
            }
            continue;
        }
        let confirmed = out.iter().any(|p| p.missed == 0.0 && apart(p, old) < how.same);
        let [ahead, left] = relative(old.place, now.place, now.course);
        let distance = libm::hypot(ahead, left);
        let mut old = *old;
        if confirmed {
            old.missed = 0.0;
        } else if moves && distance > how.hidden && shows(old.place, now, lens, width) {
            old.missed += interval;
        }
        if old.missed < how.doubt && distance < how.beside {
            out.push(old);
        }
    }
    let near = |p: &Landmark| libm::hypot(p.place[0] - now.place[0], p.place[1] - now.place[1]);
    out.retain(|p| near(p) < how.beside);
    out.sort_by(|a, b| near(a).total_cmp(&near(b)).then(a.id.cmp(&b.id)));
    out.truncate(how.most_landmarks);
    out
}

/// The places of those that are not alone: an edge that was mistaken for another gives a place where nothing is, and hardly
/// twice the same.
pub fn believed(landmarks: &[Landmark], how: &Remembering) -> Vec<[f64; 2]> {
    let company = |p: &Landmark| landmarks.iter().any(|q| q.id != p.id && apart(p, q) < how.company);
    landmarks.iter().filter(|p| company(p)).map(|p| p.place).collect()
}

fn apart(a: &Landmark, b: &Landmark) -> f64 {
    libm::hypot(a.place[0] - b.place[0], a.place[1] - b.place[1])
}
