//! What could not be read may have declared what seems to be missing: that is not the user's second mistake.

use crate::{code, modules::Program};
use soifra_graph::{Diagnostic, Severity, Span};
use std::collections::BTreeSet;

/// What the compiler has not seen.
pub(crate) struct Unseen<'p> {
    program: &'p Program,
    /// The words of everything between the readable items; `None` when whole files are missing.
    words: Option<BTreeSet<&'p str>>,
}

impl<'p> Unseen<'p> {
    /// What is missing of a program whose loading gave `errors`.
    pub fn of(program: &'p Program, errors: &[Diagnostic]) -> Unseen<'p> {
        let file_lost = |d: &Diagnostic| {
            d.severity == Severity::Error
                && matches!(d.code, code::NESTING | code::MISSING_IMPORT | code::IMPORT_CYCLE)
        };
        let unread = program.modules.iter().flat_map(|m| &m.tree.unread);
        let words = unread.flat_map(|span| text(program, *span).split(|c: char| !is_word(c)));
        let words: BTreeSet<&str> = words.filter(|w| !w.is_empty()).collect();
        // An import that cannot be read is a file that is not there.
        let lost = errors.iter().any(file_lost) || words.iter().any(|w| w.eq_ignore_ascii_case("import"));
        let words = (!lost).then_some(words);
        Unseen { program, words }
    }

    /// Whether a diagnostic may be no more than a consequence.
    pub fn explains(&self, d: &Diagnostic) -> bool {
        let about_a_name = matches!(
            d.code,
            code::UNKNOWN_NAME
                | code::UNKNOWN_TYPE
                | code::UNKNOWN_FIELD
                | code::UNKNOWN_PLATFORM
                | code::MISSING_MEMBER
        );
        let named = |words: &BTreeSet<&str>| {
            let said = text(self.program, d.position());
            said.split(|c: char| !is_word(c)).any(|w| words.contains(w))
        };
        about_a_name && self.words.as_ref().is_none_or(named)
    }
}

fn text(program: &Program, at: Span) -> &str {
    let source = program.sources.get(at.file as usize);
    source.and_then(|s| s.text.get(at.start as usize..at.end as usize)).unwrap_or_default()
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}
