//! Fixed switch: the first source with a live proposal wins.

use super::{Losers, Proposal, Reason, absence};
use crate::Time;

/// The winner; `losers` gets everybody else.
pub fn decide(now: Time, proposals: &[Proposal], losers: &mut Losers) -> Option<u32> {
    let mut winner = None;
    for (i, p) in proposals.iter().enumerate() {
        match winner {
            _ if !p.alive(now) => losers.push((i as u32, absence(p))),
            None => winner = Some(i as u32),
            Some(w) => losers.push((i as u32, Reason::After(w))),
        }
    }
    winner
}
