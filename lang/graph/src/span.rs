//! Where in the sources something was written.

use serde::{Deserialize, Serialize};

/// A byte range in one source text. `file` indexes [`crate::Graph::sources`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(from = "[u32; 3]", into = "[u32; 3]")]
pub struct Span {
    /// Index of the source text.
    pub file: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The range `start..end` of source `file`.
    pub fn new(file: u32, start: usize, end: usize) -> Self {
        Self { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span that holds both; `other` must be in the same file, else `self` is returned.
    #[must_use]
    pub fn to(self, other: Span) -> Self {
        if self.file != other.file {
            return self;
        }
        Self { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

impl From<[u32; 3]> for Span {
    fn from([file, start, end]: [u32; 3]) -> Self {
        Self { file, start, end }
    }
}

impl From<Span> for [u32; 3] {
    fn from(s: Span) -> Self {
        [s.file, s.start, s.end]
    }
}

/// A source text that went into a graph: `path` is as the user named it, relative where possible.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Display path.
    pub path: String,
    /// Whole text.
    pub text: String,
}
