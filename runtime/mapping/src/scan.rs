//! Scans of a range scanner that turns about the origin of the body.

use crate::place::Place;

/// A beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Counter-clockwise from straight ahead, rad.
    pub bearing: f64,
    /// How far away it met something, m.
    pub range: Option<f64>,
}

impl Beam {
    /// Whether its numbers are finite and its range is not negative.
    pub fn is_sound(&self) -> bool {
        self.bearing.is_finite() && self.range.is_none_or(|r| r.is_finite() && r >= 0.0)
    }
}

/// Points that at most `most` beams met, as the body sees them, m, evenly chosen; none is farther than `reach`.
pub fn points(scan: &[Beam], reach: f64, most: usize) -> Vec<[f64; 2]> {
    let met: Vec<(f64, f64)> = scan
        .iter()
        .filter(|b| b.is_sound())
        .filter_map(|b| Some((b.bearing, b.range?)))
        .filter(|(_, r)| *r <= reach)
        .collect();
    let stride = met.len().div_ceil(most.max(1)).max(1);
    met.into_iter()
        .step_by(stride)
        .map(|(bearing, range)| Place::new(0.0, 0.0, bearing).outward([range, 0.0]))
        .collect()
}
