//! pest's errors in the words of someone who writes missions.

use super::{Rule, advice};
use crate::code;
use pest::error::{Error, ErrorVariant};
use soifra_graph::{Diagnostic, Span};

/// The diagnostic for a syntax error in `text`, which starts at byte `at` of source `file`.
pub fn syntax(file: u32, at: usize, text: &str, e: &Error<Rule>) -> Diagnostic {
    let from = skip_blank(text, super::offset(e).min(text.len()));
    let found = &text[from..];
    let len = word_length(found);
    let expected = expected(e);
    if let Some(d) = never_closed(file, at, text, from).or_else(|| misread(file, at, text, from, &expected)) {
        return d;
    }
    let title = if found.trim().is_empty() {
        "the text ends in the middle of something".to_string()
    } else {
        format!("`{}` cannot stand here", found[..len].escape_debug().to_string().replace("\\'", "'"))
    };
    let label = match &expected[..expected.len().min(8)] {
        [] => "unexpected".to_string(),
        [one] => format!("expected {one}"),
        [init @ .., last] => format!("expected {} or {last}", init.join(", ")),
    };
    let (start, end) = if found.trim().is_empty() {
        let end = text.trim_end().len();
        (text[..end].char_indices().next_back().map_or(0, |(i, _)| i), end)
    } else {
        (from, from + len)
    };
    let d = Diagnostic::error(code::SYNTAX, title).at(Span::new(file, at + start, at + end), label);
    // An open bracket matters where something of it was still to come.
    let round =
        advice::open_bracket(text, from).filter(|b| !text[*b..].starts_with('{') || found.trim().is_empty());
    let d = match round {
        Some(b) => d.at(Span::new(file, at + b, at + b + 1), "this bracket is still open"),
        None => d,
    };
    d.hint(match round.filter(|_| found[..len].chars().all(|c| c.is_ascii_alphabetic())) {
        Some(_) if !found.trim().is_empty() => {
            "close the bracket before this, or finish what stands in it".to_string()
        }
        _ => advice::hint(text, from, &expected),
    })
}

/// The error for a text or comment that begins at `from` and does not end.
fn never_closed(file: u32, at: usize, text: &str, from: usize) -> Option<Diagnostic> {
    let found = &text[from..];
    let start = if found.starts_with('*') && text[..from].ends_with('/') { from - 1 } else { from };
    let error = |what: &str, end: usize| {
        Diagnostic::error(code::SYNTAX, format!("{what} is never closed"))
            .at(Span::new(file, at + start, at + end), "begins here")
    };
    if text[start..].starts_with("/*") {
        return Some(error("this comment", start + 2).hint("close it with `*/`"));
    }
    let rest = found.strip_prefix('"')?;
    let line = rest.split('\n').next().unwrap_or_default();
    (!line.contains('"')).then(|| {
        error("this text", start + 1).hint("close it with `\"` on the same line; texts have one line")
    })
}

/// The error for a line whose last words were read as the beginning of an entry, `role name = model(…)`, which
/// shows only at the line behind it.
fn misread(file: u32, at: usize, text: &str, from: usize, expected: &[String]) -> Option<Diagnostic> {
    let before = text[..from].trim_end();
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let start = before.trim_end_matches(is_word).len();
    if start == before.len()
        || !text[before.len()..from].contains('\n')
        || !expected.iter().any(|e| e == "count")
    {
        return None;
    }
    let line = before[before.rfind('\n').map_or(0, |i| i + 1)..].trim_start();
    let word = &before[start..];
    let d = |title: String, label| {
        Diagnostic::error(code::SYNTAX, title).at(Span::new(file, at + start, at + before.len()), label)
    };
    Some(if line.starts_with("expect ") {
        d(format!("`{word}` cannot stand here"), "unexpected").hint(
            "an expectation is `never …`, `always …`, `eventually …` or a condition that is asked at the end",
        )
    } else {
        d(
            format!("`{word}` is not the end of this"),
            "something is missing behind it, or this belongs elsewhere",
        )
        .hint("an entry is written `role name = model(…)`; see the construct's grammar in docs/language.md")
    })
}

fn skip_blank(text: &str, mut from: usize) -> usize {
    while !text.is_char_boundary(from) {
        from -= 1;
    }
    from + (text[from..].len() - text[from..].trim_start().len())
}

/// Length of the word, or the single character, that `s` begins with.
fn word_length(s: &str) -> usize {
    let word = s.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(s.len());
    if word > 0 { word.min(64) } else { s.chars().next().map_or(0, char::len_utf8) }
}

/// What could have stood there, as words, most telling first.
fn expected(e: &Error<Rule>) -> Vec<String> {
    let ErrorVariant::ParsingError { positives, .. } = &e.variant else { return Vec::new() };
    let mut words: Vec<String> = Vec::new();
    for rule in positives {
        let word = match rule {
            Rule::COMMENT | Rule::EOI | Rule::junk => continue,
            Rule::operand | Rule::expr | Rule::primary | Rule::tuple | Rule::list => "a value".to_string(),
            Rule::prefix | Rule::is_test => continue,
            Rule::infix => "an operator".into(),
            Rule::postfix | Rule::args => continue,
            Rule::ident | Rule::path => "a name".into(),
            Rule::string => "a text in quotes".into(),
            Rule::int | Rule::number | Rule::quantity => "a number".into(),
            Rule::unit | Rule::inverse => "a unit".into(),
            Rule::type_ref | Rule::type_name | Rule::inline_enum | Rule::service_type => "a type".into(),
            Rule::stmt | Rule::body | Rule::block => "a statement".into(),
            Rule::entry => "an entry like `role name = model(…)`".into(),
            Rule::item | Rule::item_alone | Rule::mission => "an item such as `mission` or `agent`".into(),
            r => {
                let name = format!("{r:?}");
                match name.strip_prefix("K_") {
                    Some(k) => format!("`{}`", k.to_lowercase()),
                    None => name.split('_').next().unwrap_or_default().to_string(),
                }
            }
        };
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words.sort_by_key(|w| w.starts_with('`'));
    words
}
