//! Where the robot is on a map that is being made: correlative scan matching (Olson, Real-Time Correlative Scan Matching, 2009).
//! All poses of a window about a guess are tried, first roughly, then finely about the best.

use crate::{
    field::Field,
    place::Place,
    scan::{Beam, points},
    why::{Why, finite},
};

/// How it is done.
#[derive(Clone, Copy, Debug)]
pub struct Matching {
    /// How far poses are tried about the guess: m, rad.
    pub window: [f64; 2],
    /// Steps of the last search: m, rad. Those of the first are four times as long.
    pub step: [f64; 2],
    /// So many beams of a scan count, as far as they reach, m.
    pub beams: usize,
    /// m.
    pub reach: f64,
    /// Deviation of the end of a beam from what it met, m.
    pub blur: f64,
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
            blur: 0.06,
            doubt: 0.02,
            least: 0.3,
        }
    }
}

/// The pose near a guess at which a scan fits best; `field` is that of what has been seen so far.
///
/// # Errors
/// [`Why::BadNumber`], [`Why::NothingInRange`], [`Why::NoMatch`].
pub fn match_scan(field: &Field, scan: &[Beam], guess: Place, how: &Matching) -> Result<Place, Why> {
    finite(&[guess.at[0], guess.at[1], guess.yaw, how.window[0], how.window[1]])?;
    if how.window.iter().chain(&how.step).any(|x| !(*x > 0.0)) {
        return Err(Why::BadNumber);
    }
    let ends = points(scan, how.reach, how.beams);
    if ends.is_empty() {
        return Err(Why::NothingInRange);
    }
    let fit = |place: Place| -> f64 {
        let narrow = 0.5 / (how.blur * how.blur).max(1e-9);
        let one = |end: &[f64; 2]| {
            let cell = field.layout.cell_of(place.outward(*end));
            let d = cell.map_or(f64::INFINITY, |cell| field.at(cell));
            libm::exp(-narrow * d * d)
        };
        ends.iter().map(one).sum::<f64>() / ends.len() as f64
    };
    let judge = |off: [f64; 3]| {
        let far = [off[0] / how.window[0], off[1] / how.window[0], off[2] / how.window[1]];
        let place = Place::new(guess.at[0] + off[0], guess.at[1] + off[1], guess.yaw + off[2]);
        fit(place) - how.doubt * far.iter().map(|f| f * f).sum::<f64>()
    };
    let rough = best(&judge, [0.0; 3], how.window, [4.0 * how.step[0], 4.0 * how.step[1]]);
    let fine = best(&judge, rough, [4.0 * how.step[0], 4.0 * how.step[1]], how.step);
    let place = Place::new(guess.at[0] + fine[0], guess.at[1] + fine[1], guess.yaw + fine[2]);
    if fit(place) < how.least { Err(Why::NoMatch) } else { Ok(place) }
}

/// The best of a window; of equals the one nearest to its middle.
fn best(judge: &dyn Fn([f64; 3]) -> f64, about: [f64; 3], window: [f64; 2], step: [f64; 2]) -> [f64; 3] {
    let count = |k: usize| ((window[k] / step[k]).round() as i64).clamp(0, 40);
    let (n, m) = (count(0), count(1));
    let (mut found, mut value) = (about, judge(about));
    for c in -m..=m {
        for b in -n..=n {
            for a in -n..=n {
                let off = [
                    about[0] + a as f64 * step[0],
                    about[1] + b as f64 * step[0],
                    about[2] + c as f64 * step[1],
                ];
                let v = judge(off);
                if v > value + 1e-12 {
                    (found, value) = (off, v);
                }
            }
        }
    }
    found
}
