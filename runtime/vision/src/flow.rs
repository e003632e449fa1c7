//! Time to contact by optical flow (TTC-OF), the published way: least squares for the focus of expansion, distance
//! to it over the length of the flow. Pure geometry on tracks.

use crate::attitude::Rates;
use crate::lens::Lens;
use crate::why::{Why, interval};

/// A point and its flow between two frames, pixels: (x, y) in the later frame, (u, v) the way it came since the
/// earlier one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Column.
    pub x: f64,
    /// Row.
    pub y: f64,
    /// Motion along x.
    pub u: f64,
    /// Motion along y.
    pub v: f64,
}

impl Track {
    pub(crate) fn is_finite(&self) -> bool {
        [self.x, self.y, self.u, self.v].iter().all(|v| v.is_finite() && v.abs() < 1e9)
    }
}

/// A time to contact by flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowContact {
    /// Time to contact at the later frame, s.
    pub ttc: f64,
    /// The focus of expansion, pixels.
    pub focus: [f64; 2],
    /// Points used.
    pub points: usize,
}

/// The focus of expansion (AᵀA)⁻¹Aᵀb with rows A = (v, −u), b = x·v − y·u (SOIFRA, Eq. 5 and 6; the printed row
/// loses the sign). Pixels.
///
/// # Errors
/// [`Why::NoFeatures`] for fewer than two tracks, [`Why::NoMotion`] when nothing moves, [`Why::Degenerate`] when
/// all flows are parallel, [`Why::BadNumber`].
pub fn focus(tracks: &[Track]) -> Result<[f64; 2], Why> {
    if tracks.len() < 2 {
        return Err(Why::NoFeatures);
    }
    if tracks.iter().any(|t| !t.is_finite()) {
        return Err(Why::BadNumber);
    }
    // Positions from their middle: the normal equations are then well scaled.
    let n = tracks.len() as f64;
    let (mx, my) = (tracks.iter().map(|t| t.x).sum::<f64>() / n, tracks.iter().map(|t| t.y).sum::<f64>() / n);
    let (mut vv, mut uv, mut uu, mut p, mut q) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for t in tracks {
        let b = (t.x - mx) * t.v - (t.y - my) * t.u;
        vv += t.v * t.v;
        uv -= t.u * t.v;
        uu += t.u * t.u;
        p += t.v * b;
        q -= t.u * b;
    }
    if !(uu + vv > 1e-18) {
        return Err(Why::NoMotion);
    }
    let det = vv * uu - uv * uv;
    if !(det > 1e-9 * (uu + vv) * (uu + vv)) {
        return Err(Why::Degenerate);
    }
    let found = [mx + (uu * p - uv * q) / det, my + (vv * q - uv * p) / det];
    if found.iter().all(|v| v.is_finite()) { Ok(found) } else { Err(Why::Degenerate) }
}

/// The published time to contact: the focus of all tracks, then for each point its distance to the focus over its
/// flow (Eq. 4), the mean over the points, times `dt`. Points without flow are left out. Positions are expected
/// undistorted ([`undistorted`]).
///
/// # Errors
/// Those of [`focus`] and of the interval; [`Why::NotApproaching`] when the flow points at the focus.
pub fn published(tracks: &[Track], dt: f64) -> Result<FlowContact, Why> {
    let dt = interval(dt)?;
    let focus = focus(tracks)?;
    let (mut sum, mut points, mut outward) = (0.0, 0usize, 0.0);
    for t in tracks {
        let flow = libm::hypot(t.u, t.v);
        if flow < 1e-9 {
            continue;
        }
        let (dx, dy) = (t.x - focus[0], t.y - focus[1]);
        sum += libm::hypot(dx, dy) / flow;
        outward += (dx * t.u + dy * t.v) / flow;
        points += 1;
    }
    let ttc = sum / points.max(1) as f64 * dt;
    if points == 0 || !ttc.is_finite() {
        Err(Why::NoMotion)
    } else if outward < 0.0 {
        Err(Why::NotApproaching)
    } else {
        Ok(FlowContact { ttc, focus, points })
    }
}

/// The tracks as an ideal lens of the same focal lengths and centre would have seen them. Points that cannot be
/// undistorted are left out.
pub fn undistorted(tracks: &[Track], lens: &Lens) -> Vec<Track> {
    let ideal = Lens { distortion: None, ..*lens };
    let straight = |x: f64, y: f64| lens.normalise(x, y).and_then(|at| ideal.project(at));
    tracks
        .iter()
        .filter_map(|t| {
            let now = straight(t.x, t.y)?;
            let before = straight(t.x - t.u, t.y - t.v)?;
            Some(Track { x: now[0], y: now[1], u: now[0] - before[0], v: now[1] - before[1] })
        })
        .collect()
}

/// The tracks without the flow that the camera's own turning makes (`rates` in rad/s over `dt` seconds): what is
/// left is the flow of the translation, at the later position. Undistorted as [`undistorted`]. Points that leave
/// the lens are left out.
pub fn derotated(tracks: &[Track], lens: &Lens, rates: &Rates, dt: f64) -> Vec<Track> {
    let ideal = Lens { distortion: None, ..*lens };
    tracks
        .iter()
        .filter_map(|t| {
            let at = lens.normalise(t.x, t.y)?;
            let now = ideal.project(at)?;
            let before = lens.normalise(t.x - t.u, t.y - t.v).and_then(|at| ideal.project(at))?;
            let turned = rates.turned(&ideal, before[0], before[1], dt)?;
            Some(Track { x: now[0], y: now[1], u: now[0] - turned[0], v: now[1] - turned[1] })
        })
        .collect()
}
