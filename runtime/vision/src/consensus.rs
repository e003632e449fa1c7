//! Time to contact with one face, out of all the edges on it: the pattern between the outlines expands as they do.

use crate::expansion::{Expansion, Window, window};
use crate::sweep::{Tangent, widths};

/// Pairs narrower than this share of the widest are left out: their noise is greater.
const NARROW: f64 = 0.4;
/// Most edges taken, evenly from left to right: what more of them would add is little.
const EDGES: usize = 6;
/// What disagrees with the middle of all by more than so many of its standard deviations does not count.
const OFF: f64 = 3.0;

/// Of the histories of all edges of a face, from left to right, the first and the last being its outline, whose own expansion
/// is `outline`: the mean of the closing rates of wide pairs, each weighted by its certainty.
pub(crate) fn consensus(edges: &[&[Tangent]], outline: Expansion, how: &Window) -> Expansion {
    let n = edges.len().min(EDGES);
    if n < 3 {
        return outline;
    }
    let chosen: Vec<&[Tangent]> = (0..n).map(|k| edges[k * (edges.len() - 1) / (n - 1)]).collect();
    let tangent = |k: usize| chosen[k].last().map_or(0.0, |t| t.tangent);
    let full = tangent(0) - tangent(n - 1);
    let mut rates: Vec<(f64, f64)> = vec![rate(&outline)];
    for i in 0..n {
        for j in i + 1..n {
            let whole = i == 0 && j == n - 1;
            if !whole && tangent(i) - tangent(j) >= NARROW * full {
                rates.extend(window(&widths(chosen[i], chosen[j]), how).ok().map(|e| rate(&e)));
            }
        }
    }
    let middle = middle(&mut rates);
    let (mut weights, mut sum) = (0.0, 0.0);
    for (closing, sigma) in &rates {
        if (closing - middle).abs() <= OFF * sigma {
            let weight = 1.0 / (sigma * sigma);
            weights += weight;
            sum += weight * closing;
        }
    }
    let closing = sum / weights;
    // Pairs share edges: a face gives no more than one independent pair for two edges.
    let sigma = libm::sqrt(rates.len() as f64 / weights / (n as f64 / 2.0));
    if closing.is_finite() && closing > 0.0 && sigma.is_finite() {
        Expansion { ttc: 1.0 / closing, sigma: sigma / (closing * closing), ..outline }
    } else {
        outline
    }
}

/// Closing rate and its standard deviation, 1/s; no pair is better than a part in a thousand.
fn rate(e: &Expansion) -> (f64, f64) {
    let closing = 1.0 / e.ttc;
    (closing, (closing * e.sigma / e.ttc).max(1e-3 * closing))
}

/// The weighted median.
fn middle(rates: &mut [(f64, f64)]) -> f64 {
    rates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let weight = |r: &(f64, f64)| 1.0 / (r.1 * r.1);
    let half = rates.iter().map(weight).sum::<f64>() / 2.0;
    let mut below = 0.0;
    for r in rates.iter() {
        below += weight(r);
        if below >= half {
            return r.0;
        }
    }
    rates[rates.len() - 1].0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An edge `aside` metres off the course on a face 3 m ahead, at 0.5 m/s; its pixels are off by `error` by turns.
    fn edge(aside: f64, error: f64) -> Vec<Tangent> {
        let time = |k: i32| 0.05 * f64::from(k);
        let wobble = |k: i32| if k % 2 == 0 { error } else { -error };
        (-40..=0)
            .map(|k| Tangent {
                time: time(k),
                aside: 0.0,
                tangent: aside / (3.0 - 0.5 * time(k)) + wobble(k),
            })
            .collect()
    }

    #[test]
    fn edges_within_the_outline_speak_for_it() {
        let how = Window::default();
        // The outline's pair is off: its left edge moves as one farther away.
        let left: Vec<Tangent> =
            edge(0.5, 0.0).iter().map(|t| Tangent { tangent: t.tangent - 0.002 * t.time, ..*t }).collect();
        let (a, b, c, d) = (edge(0.4, 1e-5), edge(0.3, 1e-5), edge(-0.4, 1e-5), edge(-0.5, 1e-5));
        let outline = window(&widths(&left, &d), &how).unwrap();
        let together = consensus(&[&left, &a, &b, &c, &d], outline, &how);
        assert!(
            (together.ttc - 6.0).abs() < 0.5 * (outline.ttc - 6.0).abs(),
            "{} {}",
            together.ttc,
            outline.ttc
        );
        assert!(together.sigma > 0.0 && together.sigma.is_finite());
        // Without others the outline's own word stands.
        assert_eq!(consensus(&[&left, &d], outline, &how), outline);
    }
}
