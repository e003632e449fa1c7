//! Subsumption: layers that suppress and are inhibited.
//! After Brooks, A Robust Layered Control System for a Mobile Robot (1986), section III.
//!
//! Layers are gone through from the topmost down. One takes part when it has a live proposal or its hold
//! lasts, is not inhibited, and is not suppressed by one gone through before. A layer that takes part
//! suppresses the layers it names, also some above it. The topmost layer that takes part, has a live
//! proposal and is not suppressed in the end wins.
//!
//! A hold goes on suppressing after the last proposal of its layer; it proposes nothing itself.

use super::{Losers, Proposal, Reason, absence};
use crate::Time;

/// What a layer is at the moment of the decision.
#[derive(Debug, Clone, Copy)]
pub struct Layer<'a> {
    /// Sources it suppresses.
    pub suppresses: &'a [u32],
    /// How long it suppresses after its last proposal.
    pub hold: Time,
    /// Whether it is inhibited now.
    pub inhibited: bool,
}

/// The winner; `losers` gets everybody else. The second result is the next instant at which a hold
/// ends, when the decision may come out differently.
pub fn decide(
    now: Time,
    proposals: &[Proposal],
    layers: &[Layer<'_>],
    losers: &mut Losers,
) -> (Option<u32>, Option<Time>) {
    let mut suppressed: Vec<Option<u32>> = vec![None; proposals.len()];
    let mut again: Option<Time> = None;
    for (i, (p, layer)) in proposals.iter().zip(layers).enumerate() {
        let held = p.proposed.map(|t| t + layer.hold).filter(|end| now < *end);
        if layer.inhibited || suppressed[i].is_some() || !(p.alive(now) || held.is_some()) {
            continue;
        }
        if let Some(end) = held {
            again = Some(again.map_or(end, |a| a.min(end)));
        }
        for &s in layer.suppresses {
            if let Some(slot) = suppressed.get_mut(s as usize)
                && s as usize != i
            {
                slot.get_or_insert(i as u32);
            }
        }
    }
    let counts = |i: usize| proposals[i].alive(now) && !layers[i].inhibited && suppressed[i].is_none();
    let count = proposals.len().min(layers.len());
    let winner = (0..count).find(|&i| counts(i)).map(|i| i as u32);
    for i in 0..count {
        let p = &proposals[i];
        match (winner, suppressed[i]) {
            (Some(w), _) if w as usize == i => {}
            _ if !p.alive(now) => losers.push((i as u32, absence(p))),
            _ if layers[i].inhibited => losers.push((i as u32, Reason::Inhibited)),
            (_, Some(by)) => losers.push((i as u32, Reason::Suppressed(by))),
            (Some(w), _) => losers.push((i as u32, Reason::Below(w))),
            (None, None) => {}
        }
    }
    (winner, again)
}
