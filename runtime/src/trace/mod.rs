//! What is recorded of a run. Where it goes is the sink's business.

pub(crate) mod exact;
pub mod record;

pub use record::{Event, Record, Thread};

use crate::{Snapshot, Time};

/// Takes the records of a run, in order.
pub trait TraceSink {
    /// Whether records are wanted at all; when not, none are made.
    fn enabled(&self) -> bool {
        true
    }

    /// Takes one record. An error means that the trace stops being writable: the run is aborted.
    fn record(&mut self, record: &Record) -> Result<(), String>;

    /// Whether a snapshot is wanted of the run after what happened at `now`.
    fn wants_snapshot(&mut self, _now: Time) -> bool {
        false
    }

    /// Takes a snapshot that was wanted. An error is as in [`TraceSink::record`].
    fn snapshot(&mut self, _snapshot: &Snapshot) -> Result<(), String> {
        Ok(())
    }
}

/// Takes nothing.
#[derive(Debug, Default)]
pub struct NoTrace;

impl TraceSink for NoTrace {
    fn enabled(&self) -> bool {
        false
    }
    fn record(&mut self, _: &Record) -> Result<(), String> {
        Ok(())
    }
}

/// Keeps everything in memory.
impl TraceSink for Vec<Record> {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        self.push(record.clone());
        Ok(())
    }
}
