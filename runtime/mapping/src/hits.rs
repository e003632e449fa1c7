//! Where beams have ended: what a scan is fitted to while a map is being made.
//!
//! A cell of a grid is full or not, so that a face on the border of two cells is drawn half a cell too far away, and each scan
//! that is fitted to it pushes on. The ends of beams themselves, shared among the cells around them, keep their place.

use crate::{
    grid::Layout,
    matching::Likely,
    place::Place,
    scan::{Beam, points},
};

/// So many ends make a cell as likely as not.
const HALF: f32 = 2.0;

/// How many beams have ended around the middle of each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Hits {
    layout: Layout,
    density: Vec<f32>,
}

impl Hits {
    /// None yet.
    pub fn none(layout: Layout) -> Hits {
        Hits { layout, density: vec![0.0; layout.cells()] }
    }

    /// With those of a scan from a pose, as far as `reach`, m.
    pub fn with(&self, from: Place, scan: &[Beam], reach: f64) -> Hits {
        let mut out = self.clone();
        if from.is_finite() && reach > 0.0 {
            for end in points(scan, reach, usize::MAX) {
                out.add(from.outward(end));
            }
        }
        out
    }

    /// Shares an end among the four middles of cells around it.
    fn add(&mut self, at: [f64; 2]) {
        let Some((cell, [u, v])) = around(&self.layout, at) else { return };
        for (cell, share) in corners(cell, [u, v]) {
            if let Some(d) = self.density.get_mut(self.layout.index(cell)) {
                *d += share as f32;
            }
        }
    }

    /// Blurred by a normal distribution of `deviation`, m.
    pub fn blurred(&self, deviation: f64) -> Blurred {
        let [nx, ny] = self.layout.size;
        let scale = (deviation / self.layout.cell).max(1e-3);
        let half = (2.5 * scale).ceil() as usize;
        let bell = |i: usize| {
            let d = i.abs_diff(half) as f64 / scale;
            libm::exp(-0.5 * d * d) as f32
        };
        let weights: Vec<f32> = (0..=2 * half).map(bell).collect();
        // A straight face, full of ends, has 1.
        let face: f32 = weights.iter().sum();
        let full: Vec<f32> = self.density.iter().map(|d| d / (d + HALF) / face).collect();
        let along = spread(&full, [nx, ny], 1, &weights);
        Blurred { layout: self.layout, values: spread(&along, [ny, nx], nx, &weights) }
    }
}

/// Spreads values along an axis of `n` cells that lie `stride` apart, for each of the others.
fn spread(values: &[f32], [n, others]: [usize; 2], stride: usize, weights: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; values.len()];
    let half = weights.len() / 2;
    let other = if stride == 1 { n } else { 1 };
    for row in 0..others {
        for i in 0..n {
            let value = values[row * other + i * stride];
            if value == 0.0 {
                continue;
            }
            for (k, w) in weights.iter().enumerate() {
                if let Some(to) = (i + k).checked_sub(half).filter(|to| *to < n) {
                    out[row * other + to * stride] += value * w;
                }
            }
        }
    }
    out
}

/// The lower left of the four middles of cells around a point, and how far from it the point is, in cells; none at the border.
fn around(layout: &Layout, at: [f64; 2]) -> Option<([usize; 2], [f64; 2])> {
    let [x, y] = layout.position(at).map(|v| v - 0.5);
    let (i, j) = (x.floor(), y.floor());
    let inside = i >= 0.0 && j >= 0.0 && i + 1.0 < layout.size[0] as f64 && j + 1.0 < layout.size[1] as f64;
    inside.then_some(([i as usize, j as usize], [x - i, y - j]))
}

/// The four cells and their shares.
fn corners([i, j]: [usize; 2], [u, v]: [f64; 2]) -> [([usize; 2], f64); 4] {
    [
        ([i, j], (1.0 - u) * (1.0 - v)),
        ([i + 1, j], u * (1.0 - v)),
        ([i, j + 1], (1.0 - u) * v),
        ([i + 1, j + 1], u * v),
    ]
}

/// Blurred hits.
#[derive(Clone, Debug, PartialEq)]
pub struct Blurred {
    layout: Layout,
    values: Vec<f32>,
}

impl Likely for Blurred {
    fn likely(&self, at: [f64; 2]) -> f64 {
        let Some((cell, share)) = around(&self.layout, at) else { return 0.0 };
        let value = |c| self.values.get(self.layout.index(c)).map_or(0.0, |v| f64::from(*v));
        corners(cell, share).into_iter().map(|(c, share)| share * value(c)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_on_the_border_of_cells_keeps_its_place() {
        let layout = Layout::covering([0.0, 0.0], [4.0, 4.0], 0.025).expect("a layout");
        // A face at x = 3, seen from (1, 2), where the border of two cells is.
        let from = Place::new(1.0, 2.0, 0.0);
        let beam = |k: i32| {
            let bearing = 0.004 * f64::from(k);
            Beam { bearing, range: Some(2.0 / libm::cos(bearing)) }
        };
        let scan: Vec<Beam> = (-100..=100).map(beam).collect();
        let hits = Hits::none(layout).with(from, &scan, 10.0).blurred(0.02);
        let best = (0..400).map(|k| 2.9 + 0.0005 * f64::from(k)).max_by(|a, b| {
            let [a, b] = [a, b].map(|x| hits.likely([*x, 2.0]));
            a.total_cmp(&b)
        });
        assert!((best.expect("a best") - 3.0).abs() < 0.013);
        // As likely before as behind.
        let [before, behind] = [2.98, 3.02].map(|x| hits.likely([x, 2.0]));
        assert!((before - behind).abs() < 0.02 * before, "{before} {behind}");
        assert!(hits.likely([3.0, 2.0]) > 0.3 && hits.likely([2.0, 2.0]) == 0.0);
        assert_eq!(hits.likely([-1.0, 9.0]), 0.0);
    }
}
