//! What can be wrong with a recording, as diagnostics.

use crate::report::Refusal;

/// Why a recording cannot be used: a code, what is seen, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    code: &'static str,
    seen: String,
    hint: String,
}

/// Nobody names a recording, or nobody takes it.
const NOT_NAMED: &str = "S9030";
/// It cannot be read.
const NOT_READ: &str = "S9031";
/// Its images do not fit one another, or the camera.
const NOT_FITTING: &str = "S9032";
/// Its rate is none.
const NO_RATE: &str = "S9033";

impl Trouble {
    /// It is missing, or there is no use for it.
    pub fn not_named(seen: impl Into<String>, hint: impl Into<String>) -> Trouble {
        Trouble { code: NOT_NAMED, seen: seen.into(), hint: hint.into() }
    }

    /// It cannot be read.
    pub fn not_read(seen: impl Into<String>, hint: impl Into<String>) -> Trouble {
        Trouble { code: NOT_READ, seen: seen.into(), hint: hint.into() }
    }

    /// Images do not fit.
    pub fn not_fitting(seen: impl Into<String>, hint: impl Into<String>) -> Trouble {
        Trouble { code: NOT_FITTING, seen: seen.into(), hint: hint.into() }
    }

    /// Nobody knows how many images a second it has.
    pub fn no_rate(seen: impl Into<String>) -> Trouble {
        let hint = "say how many images a second it has, as `--rate 20Hz`";
        Trouble { code: NO_RATE, seen: seen.into(), hint: hint.into() }
    }

    /// A file that can be opened and not read.
    pub fn io(e: &std::io::Error) -> Trouble {
        Trouble::not_read(crate::files::reason(e), "make it readable, or name another file")
    }

    /// The same about one file of several.
    #[must_use]
    pub fn of(mut self, file: &str) -> Trouble {
        self.seen = format!("{file}: {}", self.seen);
        self
    }

    /// Whether size and channels are such as can be taken.
    pub fn fits(&self) -> bool {
        self.code != NOT_FITTING
    }

    /// What is seen.
    pub fn seen(&self) -> &str {
        &self.seen
    }

    /// As a refusal about a path.
    pub fn refusal(&self, path: &str) -> Refusal {
        let title = match self.code {
            NOT_NAMED => "this mission and this recording do not go together",
            NOT_READ => "the recording cannot be read",
            NOT_FITTING => "the images of the recording do not fit",
            _ => "the rate of the recording is not known",
        };
        Refusal::about(path, self.code, title, &self.seen, &self.hint)
    }
}
