//! What a drive that leaves the ground is doing.

/// As near as this to the height that was asked for counts as there (m).
pub const THERE: f64 = 0.02;

/// From standing to following commands and back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// It stands and has not begun to take off.
    Ground,
    /// It climbs to its height; what it is commanded does not count yet.
    TakingOff,
    /// It follows its commands.
    Underway,
    /// It goes down; what it is commanded does not count any more.
    Landing,
}

impl Phase {
    /// The phase after this one, at a height, when that is to be `hold`.
    pub fn next(self, height: f64, hold: f64) -> Phase {
        match self {
            Phase::TakingOff if height >= hold - THERE => Phase::Underway,
            Phase::Landing if height <= hold + THERE => Phase::Ground,
            same => same,
        }
    }
}
