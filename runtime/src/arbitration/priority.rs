//! Priority index: the highest index among the live proposals wins, the first declared of equals.

use super::{Losers, Proposal, Reason, absence};
use crate::Time;

/// The winner; `losers` gets everybody else. `indices` has one entry a source.
pub fn decide(now: Time, proposals: &[Proposal], indices: &[f64], losers: &mut Losers) -> Option<u32> {
    let mut winner: Option<(usize, f64)> = None;
    for (i, (p, &index)) in proposals.iter().zip(indices).enumerate() {
        if p.alive(now) && winner.is_none_or(|(_, best)| index > best) {
            winner = Some((i, index));
        }
    }
    for (i, (p, &own)) in proposals.iter().zip(indices).enumerate() {
        match winner {
            Some((w, _)) if w == i => {}
            _ if !p.alive(now) => losers.push((i as u32, absence(p))),
            Some((_, best)) if own == best => losers.push((i as u32, Reason::Tie(own))),
            Some((_, best)) => losers.push((i as u32, Reason::Index { own, best })),
            None => {}
        }
    }
    winner.map(|(w, _)| w as u32)
}
