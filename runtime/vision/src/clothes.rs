//! The colours that somebody wears, as histograms, and where an image has them.

use crate::{ground::Ground, image::ImageView};

/// Steps of the share that red and green have of a colour.
const SHARES: usize = 24;
/// Steps of its brightness, which changes as somebody turns in the light.
const LEVELS: usize = 3;

/// Metres to either side: what is surely somebody's, and where surely nobody is.
const TRUNK: f64 = 0.13;
const BESIDE: [f64; 2] = [0.5, 0.9];
/// Metres over the ground.
const UPPER: [f64; 2] = [1.0, 1.38];
const LOWER: [f64; 2] = [0.1, 0.8];

/// Histograms of what somebody wears above and below the hip, and of what is around; each sums to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Clothes {
    upper: Vec<f32>,
    lower: Vec<f32>,
    around: Vec<f32>,
}

/// Which part of somebody.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Above the hip.
    Upper,
    /// Below.
    Lower,
}

fn bin(pixel: &[u8]) -> usize {
    let [r, g, b] = [0, 1, 2].map(|k| usize::from(pixel.get(k).copied().unwrap_or(0)));
    let sum = r + g + b;
    let share = |v: usize| (v * SHARES / (sum + 1)).min(SHARES - 1);
    (sum * LEVELS / 766 * SHARES + share(r)) * SHARES + share(g)
}

/// Adds the pixels of boxes, and divides by their number; none without any.
fn histogram(image: &ImageView<'_>, boxes: &[[usize; 4]]) -> Option<Vec<f32>> {
    let mut counts = vec![0f32; SHARES * SHARES * LEVELS];
    let mut all = 0f32;
    for [left, right, top, bottom] in boxes {
        for y in *top..*bottom {
            for x in *left..*right {
                if let Some(pixel) = image.pixel(x, y) {
                    counts[bin(pixel)] += 1.0;
                    all += 1.0;
                }
            }
        }
    }
    if all < 20.0 {
        return None;
    }
    counts.iter_mut().for_each(|c| *c /= all);
    Some(counts)
}

impl Clothes {
    /// What somebody wears who stands at a place, in metres ahead and left of the camera's foot. None when too little of it is in the
    /// image.
    pub fn of(image: &ImageView<'_>, ground: &Ground, place: [f64; 2]) -> Option<Self> {
        let size = (image.width(), image.height());
        let within = |aside, up| ground.upright(size, place, aside, up);
        let [near, far] = BESIDE;
        let up = [0.0, UPPER[1]];
        let around: Vec<_> =
            [within([near, far], up), within([-far, -near], up)].into_iter().flatten().collect();
        Some(Self {
            upper: histogram(image, &[within([-TRUNK, TRUNK], UPPER)?])?,
            lower: histogram(image, &[within([-TRUNK, TRUNK], LOWER)?])?,
            around: histogram(image, &around)?,
        })
    }

    /// How likely a pixel belongs to that part rather than to what is around, 0 to 1.
    pub(crate) fn likely(&self, pixel: &[u8], part: Part) -> f64 {
        let k = bin(pixel);
        let own = if part == Part::Upper { &self.upper } else { &self.lower };
        let (own, around) = (f64::from(own[k]), f64::from(self.around[k]));
        own / (own + around + 2e-3)
    }

    /// How alike two are, 0 to 1: the Bhattacharyya coefficient of the part that is less alike.
    pub fn alike(&self, other: &Self) -> f64 {
        let of = |a: &[f32], b: &[f32]| -> f64 {
            a.iter().zip(b).map(|(x, y)| libm::sqrt(f64::from(*x) * f64::from(*y))).sum()
        };
        of(&self.upper, &other.upper).min(of(&self.lower, &other.lower))
    }

    /// Takes over some of what is seen now, since light changes and surroundings do.
    pub fn adapt(&mut self, now: &Self, share: f32) {
        let pairs =
            [(&mut self.upper, &now.upper), (&mut self.lower, &now.lower), (&mut self.around, &now.around)];
        for (known, seen) in pairs {
            known.iter_mut().zip(seen).for_each(|(k, s)| *k += share * (*s - *k));
        }
    }
}
