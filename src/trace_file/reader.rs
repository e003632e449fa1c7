//! Reads a trace, whole or cut off anywhere.
//!
//! A file that ends early gives all whole chunks before its end; a file that is wrong before its end is
//! an error.

use super::{
    Header, TraceError,
    scan::{Content, End, Scanner, damaged},
    transform::Transform,
};
use serde::Deserialize;
use soifra_runtime::{Event, Record, Snapshot, Time};
use std::{
    fs::File,
    io::{BufReader, Read},
    path::Path,
};

/// A trace in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// What the run was a function of.
    pub header: Header,
    /// What happened, in order; numbers count from 0 without gaps.
    pub records: Vec<Record>,
    /// Whether the file was closed by its writer. If not, the records may end before the run did.
    pub complete: bool,
}

impl Trace {
    /// Time of the last record.
    pub fn last_time(&self) -> Time {
        self.records.last().map_or(Time::ZERO, |r| r.t)
    }

    /// Outcome and reason, if the run came to its end.
    pub fn outcome(&self) -> Option<(&str, &str)> {
        self.records.iter().rev().find_map(|r| match &r.event {
            Event::End { outcome, reason } => Some((outcome.as_str(), reason.as_str())),
            _ => None,
        })
    }
}

/// Reads a trace file into memory.
pub fn read(path: impl AsRef<Path>) -> Result<Trace, TraceError> {
    Reader::open(path)?.into_trace()
}

/// Reads the records of a trace one by one, with the memory of one chunk.
pub struct Reader<R> {
    header: Header,
    scanner: Scanner<R>,
    /// Number the next record must have.
    next: u64,
    failed: bool,
}

impl Reader<BufReader<File>> {
    /// Opens a file and reads its header.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TraceError> {
        Reader::new(BufReader::with_capacity(1 << 16, File::open(path)?))
    }
}

impl<R: Read> Reader<R> {
    /// Reads the header from the bytes of a trace file.
    pub fn new(input: R) -> Result<Self, TraceError> {
        let mut scanner = Scanner::new(input)?;
        while let Some(message) = scanner.next()? {
            match message.content {
                Content::Header => {
                    let header = Header::from_message(message.data, message.at)?;
                    return Ok(Reader { header, scanner, next: 0, failed: false });
                }
                Content::Record => return Err(TraceError::NotATrace),
                Content::Transform | Content::Snapshot | Content::Other => {}
            }
        }
        Err(if scanner.end() == Some(End::Closed) { TraceError::NotATrace } else { TraceError::NoHeader })
    }

    /// What the run was a function of.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Whether the file was closed by its writer; known when the iterator has ended.
    pub fn complete(&self) -> bool {
        self.scanner.end() == Some(End::Closed)
    }

    /// Reads the rest into memory.
    pub fn into_trace(mut self) -> Result<Trace, TraceError> {
        let records = self.by_ref().collect::<Result<Vec<_>, _>>()?;
        let complete = self.complete();
        Ok(Trace { header: self.header, records, complete })
    }

    /// The last snapshot that was taken at `until` or before. Nothing can be read afterwards.
    pub fn snapshot(mut self, until: Time) -> Result<Option<Snapshot>, TraceError> {
        #[derive(Deserialize)]
        struct Stamp {
            t: Time,
        }
        let mut last: Option<(u64, Vec<u8>)> = None;
        let wrong = |at: u64| move |e: serde_json::Error| damaged(at, format!("a snapshot: {e}"));
        while let Some(message) = self.scanner.next()? {
            if message.content == Content::Snapshot {
                let Stamp { t } = serde_json::from_slice(message.data).map_err(wrong(message.at))?;
                if t > until {
                    break;
                }
                last = Some((message.at, message.data.to_vec()));
            }
        }
        last.map(|(at, data)| serde_json::from_slice(&data).map_err(wrong(at))).transpose()
    }

    fn record(&mut self) -> Result<Option<Record>, TraceError> {
        let next = self.next;
        while let Some(message) = self.scanner.next()? {
            let at = message.at;
            let unreadable = |e: serde_json::Error| damaged(at, format!("record {next}: {e}"));
            let record = match message.content {
                Content::Record => serde_json::from_slice::<Record>(message.data).map_err(unreadable)?,
                Content::Transform => serde_json::from_slice::<Transform>(message.data)
                    .map_err(unreadable)?
                    .into_record()
                    .ok_or_else(|| damaged(at, format!("record {next}: its time is out of range")))?,
                Content::Header | Content::Snapshot | Content::Other => continue,
            };
            if record.n != next {
                return Err(damaged(at, format!("record {} stands where record {next} belongs", record.n)));
            }
            self.next += 1;
            return Ok(Some(record));
        }
        Ok(None)
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Record, TraceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let record = self.record();
        self.failed = record.is_err();
        record.transpose()
    }
}
