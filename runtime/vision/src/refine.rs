//! Edges to a fraction of a pixel: on every row near a segment the gradient's maximum is interpolated, and a line is
//! fitted to all of them robustly.
//!
//! The maximum is searched along the row, not along the exact normal: for a straight step the two see the same line,
//! and rows need no resampling. Central differences with a parabola through three of them are free of bias for a
//! step that is averaged over each pixel; with image noise σ and contrast c a row is off by about 1.2·σ·2/c pixels,
//! the line by that over the root of the rows.

use crate::edge::Edge;
use crate::image::Gray;
use crate::segment::Segment;

/// Parameters of the refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// How far to the left and right of the guess the gradient's maximum is searched, pixels.
    pub reach: f64,
    /// Weakest gradient that counts, grey levels over two pixels.
    pub weakest: i32,
    /// Smallest share of the rows that must show the edge.
    pub support: f64,
    /// Shortest edge, rows.
    pub shortest: f64,
    /// At most so many rows are looked at; more are sampled evenly.
    pub rows: usize,
    /// Rows without the edge after which lengthening it stops.
    pub gap: usize,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { reach: 2.5, weakest: 10, support: 0.5, shortest: 24.0, rows: 160, gap: 6 }
    }
}

/// A gradient maximum: row, column, strength (grey levels over two pixels, signed: brighter to the right).
struct Peak {
    y: f64,
    x: f64,
    strength: f64,
}

/// Refines `guess` in `image`. `None` when too few rows show an edge near it.
pub fn refine(image: &Gray, guess: &Segment, how: &Refinement) -> Option<Edge> {
    let first = fit(image, guess, how.reach, how)?;
    let guess = lengthen(image, &first.line, how)?;
    fit(image, &guess, (how.reach * 0.6).max(1.5), how)
}

/// One pass: peaks near the guess, then a line through them.
fn fit(image: &Gray, guess: &Segment, reach: f64, how: &Refinement) -> Option<Edge> {
    let last = image.height() as f64 - 1.0;
    let (from, to) = (guess.top[1].max(0.0).ceil(), guess.bottom[1].min(last).floor());
    if !(to - from).is_finite() || to - from < how.shortest.max(4.0) {
        return None;
    }
    let step = ((to - from) / how.rows.max(8) as f64).ceil().max(1.0) as usize;
    let mut peaks = Vec::with_capacity(how.rows + 1);
    let mut looked = 0usize;
    for y in (from as usize..=to as usize).step_by(step) {
        looked += 1;
        peaks.extend(
            peak(image.row(y), guess.x_at(y as f64), reach, how.weakest).map(|(x, strength)| Peak {
                y: y as f64,
                x,
                strength,
            }),
        );
    }
    let line = Line::robust(&peaks, guess)?;
    let (from, to, support) = stretch(&peaks, &line, from, step, looked)?;
    if support < how.support || line.inliers < 8 || to - from < how.shortest {
        return None;
    }
    let end = |y: f64| [line.at(y), y];
    Some(Edge {
        line: Segment { top: end(from), bottom: end(to) },
        sigma: line.sigma,
        strength: line.strength,
        polarity: line.polarity,
        support,
    })
}

/// The strongest local maximum of the gradient's magnitude within `reach` of `x`, interpolated; with its signed
/// strength.
fn peak(row: &[u8], x: f64, reach: f64, weakest: i32) -> Option<(f64, f64)> {
    let lowest = (x - reach).ceil().max(2.0);
    let highest = (x + reach).floor().min(row.len() as f64 - 3.0);
    if !(lowest <= highest) {
        return None;
    }
    let gradient = |k: usize| i32::from(row[k + 1]) - i32::from(row[k - 1]);
    let (mut best, mut at) = (weakest.max(1) - 1, 0usize);
    for k in lowest as usize..=highest as usize {
        let strength = gradient(k).abs();
        if strength > best {
            (best, at) = (strength, k);
        }
    }
    if at == 0 {
        return None;
    }
    let centre = gradient(at);
    let sign = centre.signum();
    let (left, right) = (sign * gradient(at - 1), sign * gradient(at + 1));
    // A maximum at the border of the search belongs to a neighbour.
    if left > best || right > best {
        return None;
    }
    let bend = f64::from(left + right - 2 * best);
    let offset = if bend < 0.0 { (f64::from(left - right) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
    Some((at as f64 + offset, f64::from(centre)))
}

/// The stretch of rows that shows the line best (a row with it counts 5, one without −3; the largest sum), and the
/// share of its rows that do. Beyond it the line runs over something else: a wall's stripe ends where an obstacle
/// stands in front of it.
fn stretch(peaks: &[Peak], line: &Line, from: f64, step: usize, looked: usize) -> Option<(f64, f64, f64)> {
    let mut shown = vec![false; looked];
    for p in peaks {
        if (p.x - line.at(p.y)).abs() <= line.tight
            && let Some(row) = shown.get_mut(((p.y - from) / step as f64) as usize)
        {
            *row = true;
        }
    }
    let (mut best, mut sum, mut start, mut range) = (0i64, 0i64, 0usize, None);
    for (k, &on) in shown.iter().enumerate() {
        if sum <= 0 {
            (sum, start) = (0, k);
        }
        sum += if on { 5 } else { -3 };
        if sum > best {
            (best, range) = (sum, Some((start, k)));
        }
    }
    let (first, last) = range?;
    let count = shown[first..=last].iter().filter(|on| **on).count();
    let row = |k: usize| from + (k * step) as f64;
    Some((row(first), row(last), count as f64 / (last - first + 1) as f64))
}

/// Follows the line beyond its ends while rows go on to show it.
fn lengthen(image: &Gray, line: &Segment, how: &Refinement) -> Option<Segment> {
    let slope = (line.bottom[0] - line.top[0]) / (line.bottom[1] - line.top[1]).max(1.0);
    let last = image.height() as i64 - 1;
    let follow = |from: f64, step: i64| {
        let (mut y, mut end, mut missed) = (from as i64 + step, from, 0usize);
        while (0..=last).contains(&y) && missed <= how.gap {
            let x = line.top[0] + slope * (y as f64 - line.top[1]);
            match peak(image.row(y as usize), x, 1.5, how.weakest) {
                Some((found, _)) if (found - x).abs() <= 0.8 => (end, missed) = (y as f64, 0),
                _ => missed += 1,
            }
            y += step;
        }
        [line.top[0] + slope * (end - line.top[1]), end]
    };
    let (top, bottom) = (follow(line.top[1], -1), follow(line.bottom[1], 1));
    (top[0].is_finite() && bottom[0].is_finite()).then_some(Segment { top, bottom })
}

/// x = a + b·(y − y₀), with what the fit says about itself.
struct Line {
    a: f64,
    b: f64,
    y0: f64,
    inliers: usize,
    /// Distance within which a peak belongs to the line, pixels.
    tight: f64,
    sigma: f64,
    strength: f64,
    polarity: f64,
}

impl Line {
    fn at(&self, y: f64) -> f64 {
        self.a + self.b * (y - self.y0)
    }

    /// Iteratively reweighted least squares (Tukey's weights on the distance across), from the guess shifted by the
    /// median distance.
    fn robust(peaks: &[Peak], guess: &Segment) -> Option<Self> {
        if peaks.len() < 8 {
            return None;
        }
        let mut away: Vec<f64> = peaks.iter().map(|p| p.x - guess.x_at(p.y)).collect();
        let shift = median(&mut away)?;
        let y0 = peaks.iter().map(|p| p.y).sum::<f64>() / peaks.len() as f64;
        let slope = (guess.bottom[0] - guess.top[0]) / (guess.bottom[1] - guess.top[1]).max(1.0);
        let (mut a, mut b) = (guess.x_at(y0) + shift, slope);
        let mut scale = 1.0;
        for round in 0..5 {
            let mut off: Vec<f64> = peaks.iter().map(|p| (p.x - a - b * (p.y - y0)).abs()).collect();
            scale = (median(&mut off)? * 1.4826).clamp(0.08, if round == 0 { 1.0 } else { 0.5 });
            let (mut s, mut sy, mut syy, mut sx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for p in peaks {
                let y = p.y - y0;
                let w = tukey((p.x - a - b * y) / scale);
                s += w;
                sy += w * y;
                syy += w * y * y;
                sx += w * p.x;
                sxy += w * p.x * y;
            }
            let det = s * syy - sy * sy;
            if !(det > 1e-9) {
                return None;
            }
            a = (syy * sx - sy * sxy) / det;
            b = (s * sxy - sy * sx) / det;
        }
        let (mut inliers, mut squares, mut strength, mut signs) = (0usize, 0.0, 0.0, 0.0);
        for p in peaks {
            let r = p.x - a - b * (p.y - y0);
            if r.abs() <= 4.0 * scale {
                inliers += 1;
                squares += r * r;
                strength += p.strength.abs();
                signs += p.strength.signum();
            }
        }
        let n = inliers as f64;
        if inliers < 3 || !a.is_finite() || !b.is_finite() {
            return None;
        }
        let sigma = libm::sqrt(squares / (n - 2.0) / n);
        Some(Self {
            a,
            b,
            y0,
            inliers,
            tight: (4.0 * scale).min(0.7),
            sigma,
            strength: strength / n,
            polarity: signs / n,
        })
    }
}

/// Tukey's biweight of a residual in units of the scale (cut at 4.685).
pub(crate) fn tukey(r: f64) -> f64 {
    let u = r / 4.685;
    let v = 1.0 - u * u;
    if v > 0.0 { v * v } else { 0.0 }
}

/// The median; reorders. `None` for an empty slice.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (_, m, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*m)
}
