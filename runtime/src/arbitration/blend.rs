//! Weighted mean of the live proposals, for twists and vectors. Weights at or below zero do not count.

use super::{Losers, Proposal, Reason, absence};
use crate::Time;

/// Puts the mean into `out` and returns when the first of the proposals in it expires; `None` when there
/// is none. `commands` holds one command a source, each as wide as `out`.
pub fn decide(
    now: Time,
    proposals: &[Proposal],
    weights: &[f64],
    commands: &[f64],
    out: &mut [f64],
    losers: &mut Losers,
) -> Option<Time> {
    let (mut total, mut expires) = (0.0, Time::MAX);
    let width = out.len();
    out.fill(0.0);
    for (i, (p, &w)) in proposals.iter().zip(weights).enumerate() {
        if !p.alive(now) {
            losers.push((i as u32, absence(p)));
        } else if w > 0.0 {
            total += w;
            expires = expires.min(p.expires);
            for (o, c) in out.iter_mut().zip(&commands[i * width..]) {
                *o += w * c;
            }
        } else {
            losers.push((i as u32, Reason::Weight(w)));
        }
    }
    if total <= 0.0 {
        return None;
    }
    for o in out.iter_mut() {
        *o /= total;
    }
    Some(expires)
}
