//! Where the robot is on a map that is being made: correlative scan matching (Olson, Real-Time Correlative Scan Matching, 2009).
//! All poses of a window about a guess are tried, first roughly, then twice more finely about the best.

use crate::{
    field::Field,
    place::{Place, wrap},
    scan::{Beam, points},
    why::{Why, finite},
};

/// What a scan can be fitted to.
pub trait Likely {
    /// How likely a beam ends at a point in `map`, m: about 1 on a face, 0 far from any.
    fn likely(&self, at: [f64; 2]) -> f64;
}

/// The distances of a grid as something to be fitted to.
#[derive(Clone, Copy, Debug)]
pub struct Near<'a> {
    /// The distances.
    pub field: &'a Field,
    /// Deviation of the end of a beam from what it met, m.
    pub blur: f64,
}

impl<'a> Near<'a> {
    /// With a blur that suits a scanner.
    pub fn new(field: &'a Field) -> Near<'a> {
        Near { field, blur: 0.06 }
    }
}

impl Likely for Near<'_> {
    fn likely(&self, at: [f64; 2]) -> f64 {
        let d = self.field.between(at);
        libm::exp(-0.5 * d * d / (self.blur * self.blur).max(1e-9))
    }
}

/// How it is done.
#[derive(Clone, Copy, Debug)]
pub struct Matching {
    /// How far poses are tried about the guess: m, rad.
    pub window: [f64; 2],
    /// Steps of the second search: m, rad. Those of the first are four times as long, those of the last a quarter.
    pub step: [f64; 2],
    /// So many beams of a scan count, as far as they reach, m.
    pub beams: usize,
    /// m.
    pub reach: f64,
    /// What the edge of the window costs, as a share of beams: where several poses fit, as in a passage, the guess counts.
    pub doubt: f64,
    /// At least such a share of beams must fit.
    pub least: f64,
}

impl Default for Matching {
    fn default() -> Self {
        Matching {
            window: [0.16, 0.07],
            step: [0.01, 0.0022],
            beams: 150,
            reach: 20.0,
            doubt: 0.02,
            least: 0.3,
        }
    }
}

/// The pose near a guess at which a scan fits best; `map` is what has been seen so far.
///
/// # Errors
/// [`Why::BadNumber`], [`Why::NothingInRange`], [`Why::NoMatch`].
pub fn match_scan(map: &impl Likely, scan: &[Beam], guess: Place, how: &Matching) -> Result<Place, Why> {
    finite(&[guess.at[0], guess.at[1], guess.yaw, how.window[0], how.window[1]])?;
    if how.window.iter().chain(&how.step).any(|x| !(*x > 0.0)) {
        return Err(Why::BadNumber);
    }
    let ends = points(scan, how.reach, how.beams);
    if ends.is_empty() {
        return Err(Why::NothingInRange);
    }
    let search = Search { map, ends, guess, how };
    let [n, m] = how.step;
    let rough = search.best([0.0; 3], how.window, [4.0 * n, 4.0 * m]);
    let fine = search.best(rough, [4.0 * n, 4.0 * m], [n, m]);
    let finest = search.best(fine, [n, m], [0.25 * n, 0.25 * m]);
    let [x, y, turn] = finest;
    let place = Place::new(guess.at[0] + x, guess.at[1] + y, wrap(guess.yaw + turn));
    if search.fit(&search.turned(turn), [x, y]) < how.least { Err(Why::NoMatch) } else { Ok(place) }
}

struct Search<'a, M> {
    map: &'a M,
    /// What beams met, as the body sees it.
    ends: Vec<[f64; 2]>,
    guess: Place,
    how: &'a Matching,
}

impl<M: Likely> Search<'_, M> {
    /// What beams met, in `map`, from the guess turned by so much.
    fn turned(&self, by: f64) -> Vec<[f64; 2]> {
        let (s, c) = libm::sincos(self.guess.yaw + by);
        let [x, y] = self.guess.at;
        self.ends.iter().map(|[a, b]| [x + c * a - s * b, y + s * a + c * b]).collect()
    }

    /// The share of beams that fit, shifted by so much.
    fn fit(&self, ends: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
        ends.iter().map(|[a, b]| self.map.likely([a + x, b + y])).sum::<f64>() / ends.len().max(1) as f64
    }

    /// The best of a window about an offset from the guess; of equals the one that is tried first, the middle before all.
    fn best(&self, about: [f64; 3], window: [f64; 2], step: [f64; 2]) -> [f64; 3] {
        let count = |k: usize| ((window[k] / step[k]).round() as i64).clamp(0, 40);
        let (n, m) = (count(0), count(1));
        let judge = |ends: &[[f64; 2]], [x, y, turn]: [f64; 3]| {
            let far = [x / self.how.window[0], y / self.how.window[0], turn / self.how.window[1]];
            self.fit(ends, [x, y]) - self.how.doubt * far.iter().map(|f| f * f).sum::<f64>()
        };
        let (mut found, mut value) = (about, judge(&self.turned(about[2]), about));
        for c in -m..=m {
            let turn = about[2] + c as f64 * step[1];
            let ends = self.turned(turn);
            for b in -n..=n {
                for a in -n..=n {
                    let off = [about[0] + a as f64 * step[0], about[1] + b as f64 * step[0], turn];
                    let v = judge(&ends, off);
                    if v > value + 1e-12 {
                        (found, value) = (off, v);
                    }
                }
            }
        }
        found
    }
}
