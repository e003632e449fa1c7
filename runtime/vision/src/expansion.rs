//! Time to contact by expansion of the obstacle's width (TTC-EO). Pure arithmetic on (time, width) values.
//!
//! Any abscissa that grows evenly with the distance travelled will do for the time: with metres from odometry
//! instead of seconds the result is the distance in metres, and the speed may change on the way.

use crate::refine::{median, tukey};
use crate::why::{Why, interval};

/// A width at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width {
    /// Seconds (or metres travelled).
    pub time: f64,
    /// The width in the image in any unit that is proportional to 1/distance: pixels of an undistorted image, or
    /// the difference of the tangents of the bearings.
    pub width: f64,
}

/// A time to contact by expansion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expansion {
    /// Time to contact at the last sample, s.
    pub ttc: f64,
    /// Its standard deviation from the scatter of the samples, s (zero for the published form).
    pub sigma: f64,
    /// Samples used.
    pub samples: usize,
}

/// The published form: E = w₂/w₁ − 1 (SOIFRA, Eq. 10), TTC₂ = Δt/E (Eq. 13), at the second sample.
///
/// # Errors
/// The interval's; [`Why::Degenerate`] for widths that are not positive; [`Why::NoMotion`] for E = 0,
/// [`Why::NotApproaching`] for E < 0.
pub fn published(first: Width, second: Width) -> Result<Expansion, Why> {
    let dt = interval(second.time - first.time)?;
    check(&[first, second])?;
    let e = second.width / first.width - 1.0;
    if e == 0.0 {
        return Err(Why::NoMotion);
    }
    let ttc = dt / e;
    if !ttc.is_finite() {
        Err(Why::NoMotion)
    } else if e < 0.0 {
        Err(Why::NotApproaching)
    } else {
        Ok(Expansion { ttc, sigma: 0.0, samples: 2 })
    }
}

/// Parameters of [`window`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Only samples within so many seconds of the last one.
    pub length: f64,
    /// Fewest samples.
    pub fewest: usize,
    /// Smallest expansion within the window, as the last width over the first minus 1.
    pub growth: f64,
    /// Largest ratio of the standard deviation to the time to contact.
    pub uncertainty: f64,
}

impl Default for Window {
    fn default() -> Self {
        Self { length: 2.5, fewest: 4, growth: 0.004, uncertainty: 0.5 }
    }
}

/// Over a window: at constant speed 1/w = α − βt is linear, TTC = (1/w)/β now. Robust: weighted by w⁴ (a width's
/// noise is even, so 1/w has σ/w²) and reweighted by Tukey; starts from the weighted least squares of all.
///
/// # Errors
/// [`Why::TooShort`], [`Why::Degenerate`] for widths that are not positive, [`Why::NoMotion`] and
/// [`Why::NotApproaching`] by the slope, [`Why::ZeroInterval`] and [`Why::NegativeInterval`] for times that do not
/// increase, [`Why::BadNumber`].
pub fn window(history: &[Width], how: &Window) -> Result<Expansion, Why> {
    let Some(last) = history.last() else { return Err(Why::TooShort) };
    if ![last.time, how.length, how.growth, how.uncertainty].iter().all(|v| v.is_finite()) {
        return Err(Why::BadNumber);
    }
    let from = history.iter().position(|s| last.time - s.time <= how.length).unwrap_or(0);
    let samples = &history[from..];
    check(samples)?;
    for pair in samples.windows(2) {
        interval(pair[1].time - pair[0].time)?;
    }
    if samples.len() < how.fewest.max(2) {
        return Err(Why::TooShort);
    }
    // Widths relative to the last one, times relative to now: the fit is then free of units.
    let points: Vec<(f64, f64, f64)> = samples
        .iter()
        .map(|s| {
            let w = s.width / last.width;
            (s.time - last.time, 1.0 / w, w * w * w * w)
        })
        .collect();
    let (alpha, beta, sigma) = robust(&points)?;
    let ttc = alpha / beta;
    let span = last.time - samples[0].time;
    if !ttc.is_finite() || (beta * span / alpha).abs() < how.growth {
        return Err(Why::NoMotion);
    }
    if ttc <= 0.0 {
        return Err(Why::NotApproaching);
    }
    let sigma = ttc * sigma / beta.abs();
    if !(sigma <= how.uncertainty * ttc) {
        return Err(Why::TooShort);
    }
    Ok(Expansion { ttc, sigma, samples: samples.len() })
}

/// Fits y = α − βt to (t, y, weight); gives α, β and the standard deviation of β.
fn robust(points: &[(f64, f64, f64)]) -> Result<(f64, f64, f64), Why> {
    let mut weights: Vec<f64> = points.iter().map(|p| p.2).collect();
    let mut fit = line(points, &weights)?;
    if points.len() > 4 {
        for _ in 0..6 {
            let off = |p: &(f64, f64, f64)| (p.1 - fit.0 + fit.1 * p.0) * libm::sqrt(p.2);
            let mut sizes: Vec<f64> = points.iter().map(|p| off(p).abs()).collect();
            let scale = median(&mut sizes).unwrap_or(0.0) * 1.4826;
            if !(scale > 1e-12) {
                break;
            }
            for (w, p) in weights.iter_mut().zip(points) {
                *w = p.2 * tukey(off(p) / scale);
            }
            fit = line(points, &weights)?;
        }
    }
    let (alpha, beta, spread) = fit;
    let (mut squares, mut count) = (0.0, 0.0);
    for (p, w) in points.iter().zip(&weights) {
        let r = p.1 - alpha + beta * p.0;
        squares += w * r * r;
        count += if *w > 0.0 { 1.0 } else { 0.0 };
    }
    let variance = squares / f64::max(count - 2.0, 1.0);
    Ok((alpha, beta, libm::sqrt(variance / spread)))
}

/// Weighted least squares; gives α, β and Σw(t − t̄)².
fn line(points: &[(f64, f64, f64)], weights: &[f64]) -> Result<(f64, f64, f64), Why> {
    let (mut s, mut st, mut sy) = (0.0, 0.0, 0.0);
    for (p, w) in points.iter().zip(weights) {
        s += w;
        st += w * p.0;
        sy += w * p.1;
    }
    if !(s > 0.0) {
        return Err(Why::Degenerate);
    }
    let (t0, y0) = (st / s, sy / s);
    let (mut stt, mut sty) = (0.0, 0.0);
    for (p, w) in points.iter().zip(weights) {
        stt += w * (p.0 - t0) * (p.0 - t0);
        sty += w * (p.0 - t0) * (p.1 - y0);
    }
    if !(stt > 0.0) {
        return Err(Why::Degenerate);
    }
    let beta = -sty / stt;
    Ok((y0 + beta * t0, beta, stt))
}

fn check(samples: &[Width]) -> Result<(), Why> {
    if samples.iter().any(|s| !s.time.is_finite() || !s.width.is_finite()) {
        Err(Why::BadNumber)
    } else if samples.iter().any(|s| !(s.width > 1e-9 && s.width < 1e9)) {
        Err(Why::Degenerate)
    } else {
        Ok(())
    }
}
