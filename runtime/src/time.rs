//! Virtual time: integer nanoseconds since the start of the run.

use serde::{Deserialize, Serialize};
use std::ops::{Add, Sub};

/// An instant or a span of virtual time, in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Time(pub i64);

impl Time {
    /// The start.
    pub const ZERO: Time = Time(0);
    /// Later than everything.
    pub const MAX: Time = Time(i64::MAX);

    /// The nearest nanosecond to `s` seconds; `None` when it does not fit (about 292 years) or is not finite.
    pub fn from_seconds(s: f64) -> Option<Time> {
        let ns = (s * 1e9).round();
        (ns.is_finite() && ns.abs() < 9.2e18).then_some(Time(ns as i64))
    }

    /// In seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / 1e9
    }
}

impl Add for Time {
    type Output = Time;
    fn add(self, other: Time) -> Time {
        Time(self.0.saturating_add(other.0))
    }
}

impl Sub for Time {
    type Output = Time;
    fn sub(self, other: Time) -> Time {
        Time(self.0.saturating_sub(other.0))
    }
}
