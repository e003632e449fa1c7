//! Numbers records and hands them to the sink.

use super::Snapshot;
use crate::{Event, Record, Time, TraceSink};

/// The way into the trace.
pub(crate) struct Recorder<'m> {
    sink: &'m mut dyn TraceSink,
    enabled: bool,
    next: u64,
    /// Why the trace is not writable any more.
    pub failed: Option<String>,
}

impl<'m> Recorder<'m> {
    pub fn new(sink: &'m mut dyn TraceSink) -> Self {
        let enabled = sink.enabled();
        Recorder { sink, enabled, next: 0, failed: None }
    }

    /// Whether records are to be made.
    pub fn on(&self) -> bool {
        self.enabled
    }

    /// Records what `event` gives; nothing is made when no trace is kept. Returns the number.
    #[inline(always)]
    pub fn record(
        &mut self,
        t: Time,
        causes: impl IntoIterator<Item = u64>,
        event: impl FnOnce() -> Event,
    ) -> Option<u64> {
        if self.enabled { Some(self.write(t, causes, event)) } else { None }
    }

    /// Whether the trace wants a snapshot after what happened at `now`.
    pub fn wants_snapshot(&mut self, now: Time) -> bool {
        self.enabled && self.failed.is_none() && self.sink.wants_snapshot(now)
    }

    /// Takes a snapshot.
    pub fn snapshot(&mut self, snapshot: &Snapshot) {
        self.failed = self.sink.snapshot(snapshot).err();
    }

    /// Number of the next record.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Goes on with record `next`.
    pub fn go_on(&mut self, next: u64) {
        self.next = next;
    }

    #[inline(never)]
    fn write(
        &mut self,
        t: Time,
        causes: impl IntoIterator<Item = u64>,
        event: impl FnOnce() -> Event,
    ) -> u64 {
        let n = self.next;
        self.next += 1;
        if self.failed.is_none() {
            let record = Record { n, t, causes: causes.into_iter().collect(), event: event() };
            self.failed = self.sink.record(&record).err();
        }
        n
    }
}
