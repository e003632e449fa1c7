//! What each diagnostic code means, at length: the pages of `lang/diagnostics/`.

include!(concat!(env!("OUT_DIR"), "/pages.rs"));

/// A page about a code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Explanation {
    /// The code.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// Markdown: what it means, an example that causes it, what to do.
    pub text: &'static str,
}

/// The page about `code`, in any case of letters.
pub fn explain(code: &str) -> Option<Explanation> {
    explanations().find(|e| e.code.eq_ignore_ascii_case(code.trim()))
}

/// All pages by code.
pub fn explanations() -> impl Iterator<Item = Explanation> {
    crate::code::CODES.iter().map(|(code, title)| Explanation {
        code,
        title,
        text: PAGES.iter().find(|(c, _)| c == code).map_or("", |(_, t)| *t),
    })
}
