//! What can be wrong with a trace file, in sentences for users.

use super::SCHEMA;
use std::{fmt, io};

/// Why a trace cannot be read.
#[derive(Debug)]
pub enum TraceError {
    /// The file cannot be opened or read.
    Io(io::Error),
    /// The file holds nothing.
    Empty,
    /// The file is no MCAP file.
    NotMcap,
    /// An MCAP file, but not one that soifra wrote.
    NotATrace,
    /// The file ends before its header is complete.
    NoHeader,
    /// The header names another schema version.
    Schema(u64),
    /// The content at byte `at` is damaged.
    Damaged {
        /// Offset of the damaged part in the file.
        at: u64,
        /// What is wrong with it.
        what: String,
    },
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TraceError::Io(e) if e.kind() == io::ErrorKind::IsADirectory => {
                f.write_str("this is a directory, not a trace")
            }
            TraceError::Io(e) => f.write_str(&crate::files::reason(e)),
            TraceError::Empty => {
                f.write_str("the trace is empty: the run ended before anything was recorded")
            }
            TraceError::NotMcap => f.write_str("this is not a trace: it does not begin like an MCAP file"),
            TraceError::NotATrace => {
                f.write_str("this is an MCAP file but not a trace of soifra: it has no header message")
            }
            TraceError::NoHeader => {
                f.write_str("the trace ends before its header is complete: nothing can be recovered")
            }
            TraceError::Schema(found) => write!(
                f,
                "the trace has schema version {found}, but this soifra reads version {SCHEMA}: read it with the version that wrote it"
            ),
            TraceError::Damaged { at, what } => write!(f, "the trace is damaged at byte {at}: {what}"),
        }
    }
}

impl std::error::Error for TraceError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            TraceError::Io(e) => Some(e),
            _ => None,
        }
    }
}

impl From<io::Error> for TraceError {
    fn from(e: io::Error) -> Self {
        TraceError::Io(e)
    }
}
