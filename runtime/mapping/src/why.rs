//! Why there is no answer: every refusal of this crate, typed, with a short text.

use std::fmt;

/// The reason why a service gives no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Why {
    /// A parameter or a number handed in is not finite or out of its range.
    BadNumber,
    /// A grid of so many cells is not made.
    TooLarge,
    /// Nobody says how far the map goes.
    NoBounds,
    /// No beam met anything.
    NothingInRange,
    /// Where the way is to begin there is no room for the body.
    StartNotFree,
    /// Where the way is to end there is no room for the body.
    TargetNotFree,
    /// There is no way with so much room.
    NoWay,
    /// What the scan shows does not fit the map anywhere near.
    NoMatch,
}

impl Why {
    /// A short text, without a full stop.
    pub fn text(self) -> &'static str {
        match self {
            Why::BadNumber => "a number is not finite or out of range",
            Why::TooLarge => "a map of too many cells",
            Why::NoBounds => "the world has no bounds",
            Why::NothingInRange => "nothing in range",
            Why::StartNotFree => "the start is not free",
            Why::TargetNotFree => "the target is not free",
            Why::NoWay => "no way",
            Why::NoMatch => "the scan does not fit the map",
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.text())
    }
}

impl std::error::Error for Why {}

/// All of them are finite, or why not.
pub fn finite(numbers: &[f64]) -> Result<(), Why> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Why::BadNumber) }
}
