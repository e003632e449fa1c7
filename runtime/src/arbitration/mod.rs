//! Arbitration: which of several proposals an actuator gets. One file for each strategy.
//!
//! A strategy sees the proposals of one instant, whatever their content, and answers with a choice and a
//! reason for every source that did not get through. With no live proposal there is no choice, and the
//! safe action runs.

pub mod blend;
pub mod layers;
pub mod priority;
pub mod switch;

use crate::Time;

/// What an arbiter knows of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Proposal {
    /// When it proposed last; `None` when it never did.
    pub proposed: Option<Time>,
    /// Until when the proposal lives; it is dead at that instant.
    pub expires: Time,
}

impl Proposal {
    /// Whether it counts at `now`.
    pub fn alive(&self, now: Time) -> bool {
        self.proposed.is_some() && now < self.expires
    }
}

/// Why a source did not get through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// It has not proposed anything yet.
    Silent,
    /// Its last proposal has expired.
    Expired,
    /// Its index is not the highest.
    Index {
        /// Its index.
        own: f64,
        /// The winner's.
        best: f64,
    },
    /// Its index is the highest too, but another source with that index is declared before it.
    Tie(f64),
    /// A source declared before it proposes.
    After(u32),
    /// Its layer is inhibited.
    Inhibited,
    /// This source suppresses its layer.
    Suppressed(u32),
    /// A layer above it won.
    Below(u32),
    /// Its weight is not above zero.
    Weight(f64),
}

impl Reason {
    /// In words; `name` gives the name of a source.
    pub fn text(self, name: impl Fn(u32) -> String) -> String {
        match self {
            Reason::Silent => "proposes nothing".into(),
            Reason::Expired => "its proposal has expired".into(),
            Reason::Index { own, best } => format!("index {own} is below {best}"),
            Reason::Tie(index) => format!("index {index} too, but declared later"),
            Reason::After(winner) => format!("{} comes before it", name(winner)),
            Reason::Inhibited => "its layer is inhibited".into(),
            Reason::Suppressed(by) => format!("suppressed by {}", name(by)),
            Reason::Below(winner) => format!("{} is above it", name(winner)),
            Reason::Weight(w) => format!("weight {w} is not above zero"),
        }
    }
}

/// Sources that lost, with the reason.
pub type Losers = Vec<(u32, Reason)>;

/// Why a source without a live proposal does not count.
fn absence(p: &Proposal) -> Reason {
    if p.proposed.is_some() { Reason::Expired } else { Reason::Silent }
}
