//! The wall clock. The only place that reads it: what it says goes into `host` objects and onto the
//! terminal, never into a run, a trace or a digest. It says when an instant of a run that is held to it is due,
//! and never what happens at that instant.

use soifra_runtime::Time;
use std::time::Instant;

/// Measures how long something took.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    #[allow(clippy::disallowed_methods, reason = "measures the host, outside every digest (2026-11)")]
    pub fn start() -> Self {
        Stopwatch(Instant::now())
    }

    /// Seconds since the start.
    pub fn seconds(self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }

    /// Time since the start.
    pub fn time(self) -> Time {
        Time(i64::try_from(self.0.elapsed().as_nanos()).unwrap_or(i64::MAX))
    }
}
