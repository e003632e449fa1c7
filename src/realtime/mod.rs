//! `run --realtime`: the schedule of virtual time, held to the wall clock, and an operator at standard input.
//!
//! In the simulator lateness alters nothing: an instant that comes late is the same instant. Whatever of the
//! wall clock is to alter a run has to come in as an [`Input`], which is recorded.

mod lateness;
mod lines;
mod operator;

pub use lateness::{Lateness, Summary};
pub use operator::Operator;

use crate::{report::Refusal, wall_clock::Stopwatch};
use soifra_runtime::{Input, Pacer, Time};
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

/// A run that is to stop is asked at least so often, also while nothing is due.
const SLICE: Time = Time(20_000_000);

/// Waits until instants are due on the wall clock.
pub struct WallPacer<'a> {
    stop: &'a AtomicBool,
    operator: Operator<'a>,
    lateness: Lateness,
    /// Runs since the run has begun, and at which instant that was.
    watch: Stopwatch,
    origin: Time,
}

impl<'a> WallPacer<'a> {
    /// A pacer for a run that `stop` stops.
    pub fn new(stop: &'a AtomicBool, operator: Operator<'a>, lateness: Lateness) -> Self {
        WallPacer { stop, operator, lateness, watch: Stopwatch::start(), origin: Time::ZERO }
    }

    /// What came of it, and what is wrong with the file that was to be written.
    pub fn finish(mut self) -> (Summary, Option<Refusal>) {
        self.operator.close();
        self.lateness.finish()
    }

    /// Virtual time as it is on the wall.
    fn wall(&self) -> Time {
        self.origin + self.watch.time()
    }
}

impl Pacer for WallPacer<'_> {
    fn begin(&mut self, now: Time) {
        (self.watch, self.origin) = (Stopwatch::start(), now);
    }

    fn pace(&mut self, now: Time, next: Time, inputs: &mut Vec<Input>) -> Time {
        loop {
            if self.stop.load(Ordering::Relaxed) {
                return next;
            }
            self.operator.take(inputs);
            let wall = self.wall();
            if wall >= next || !inputs.is_empty() {
                // What is done while the run lags behind is done at its next instant.
                let at = wall.min(next).max(now + Time(1));
                self.lateness.take(at, wall - at);
                return at;
            }
            let rest = (next - wall).min(SLICE);
            self.operator.wait(Duration::from_nanos(u64::try_from(rest.0).unwrap_or(0)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pacer(stop: &AtomicBool) -> WallPacer<'_> {
        WallPacer::new(stop, Operator::nobody(), Lateness::new())
    }

    #[test]
    fn an_instant_comes_when_it_is_due_and_a_stop_comes_at_once() {
        let stop = AtomicBool::new(false);
        let mut pacer = pacer(&stop);
        let watch = Stopwatch::start();
        pacer.begin(Time::ZERO);
        let (a, b) = (Time(15_000_000), Time(45_000_000));
        assert_eq!(pacer.pace(Time::ZERO, a, &mut Vec::new()), a);
        assert!(watch.time() >= a);
        assert_eq!(pacer.pace(a, b, &mut Vec::new()), b);
        assert!(watch.time() >= b);
        std::thread::scope(|s| {
            s.spawn(|| {
                std::thread::sleep(Duration::from_millis(30));
                stop.store(true, Ordering::Relaxed);
            });
            pacer.pace(b, Time(3_600_000_000_000), &mut Vec::new());
        });
        assert!(watch.seconds() < 10.0, "nobody waits for an hour");
        let (summary, wrong) = pacer.finish();
        assert!(summary.instants == 2 && wrong.is_none(), "the run that is stopped has no further instant");
    }

    #[test]
    fn a_run_begins_at_its_own_time() {
        let stop = AtomicBool::new(false);
        let mut pacer = pacer(&stop);
        let hour = Time(3_600_000_000_000);
        pacer.begin(hour);
        assert_eq!(pacer.pace(hour, hour + Time(1_000_000), &mut Vec::new()), hour + Time(1_000_000));
    }
}
