//! A finding: what is wrong, where, and what to do about it. Rendering is the shell's job.

use crate::Span;
use serde::{Deserialize, Serialize};

/// How much a finding weighs. `Error` refuses the mission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Cannot work.
    Error,
    /// Works, but is probably not meant.
    Warning,
}

/// A span with a few words; no full stop.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What is to be seen there.
    pub text: String,
}

/// One finding of a parser, checker or verifier.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Diagnostic {
    /// Stable code, `S` and four digits; `soifra explain` knows it.
    pub code: &'static str,
    /// Weight.
    pub severity: Severity,
    /// One line, no full stop.
    pub title: String,
    /// The first label is the primary one.
    pub labels: Vec<Label>,
    /// What to do, in the user's words.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// An error with `code` and `title`; add labels and a hint with the builder methods.
    pub fn error(code: &'static str, title: impl Into<String>) -> Self {
        Self { code, severity: Severity::Error, title: title.into(), labels: Vec::new(), hint: None }
    }

    /// A warning.
    pub fn warning(code: &'static str, title: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, title) }
    }

    /// Adds a labelled span; the first one added is the primary one.
    #[must_use]
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Sets the hint.
    #[must_use]
    pub fn hint(mut self, text: impl Into<String>) -> Self {
        self.hint = Some(text.into());
        self
    }

    /// Where reports sort it: file and position of the primary label.
    pub fn position(&self) -> Span {
        self.labels.first().map(|l| l.span).unwrap_or_default()
    }
}

/// The name in `candidates` nearest to `word` by edit distance, when near enough to be a slip of the
/// keyboard (a third of its length); ties go to the alphabetically first.
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = word.chars().count().div_ceil(3).max(1);
    candidates
        .into_iter()
        .filter(|c| *c != word)
        .map(|c| (edit_distance(word, c), c))
        // A word that has nothing in common with another is no slip of the keyboard.
        .filter(|(d, c)| *d <= limit && *d < word.chars().count().max(c.chars().count()))
        .min()
        .map(|(_, c)| c)
}

/// Restricted Damerau-Levenshtein distance in characters (a swap of neighbours counts one).
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut before: Vec<usize> = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let change = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + change);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = last;
        last = row;
    }
    last[b.len()]
}
