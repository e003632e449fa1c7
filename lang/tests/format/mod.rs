//! The formatter keeps tokens, comments and meaning, is idempotent, and does not see line breaks.

mod golden;
mod odd;
mod pieces;
mod scrambled;

use pieces::{meaning, pieces};
use std::{fs, path::Path};

/// All sources of the repository that can be formatted: what is shipped, and the formatter's own cases.
fn sources() -> Vec<(String, String)> {
    let mut out = Vec::new();
    for folder in ["lang/std", "platforms", "missions", "tests/golden/format"] {
        collect(&super::docs::repository(folder), &mut out);
    }
    out.sort();
    assert!(out.len() > 8, "only {} sources found", out.len());
    out
}

fn collect(folder: &Path, out: &mut Vec<(String, String)>) {
    for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        if path.is_dir() {
            collect(&path, out);
        } else if path.extension().is_some_and(|e| e == "soi") {
            out.push((path.display().to_string(), fs::read_to_string(&path).unwrap()));
        }
    }
}

fn format(name: &str, text: &str) -> String {
    soifra_lang::format(text).unwrap_or_else(|e| panic!("{name}: {e:#?}\n{text}"))
}

/// What every output must be, whatever the input.
fn assert_faithful(name: &str, text: &str, formatted: &str) {
    let texts = |s| pieces(s).into_iter().map(|p| p.text).collect::<Vec<_>>();
    assert_eq!(texts(text), texts(formatted), "{name}: other tokens");
    assert_eq!(meaning(text), meaning(formatted), "{name}: another syntax tree");
    assert_eq!(format(name, formatted), formatted, "{name}: formatted twice");
    for line in formatted.lines() {
        assert_eq!(line.trim_end(), line, "{name}: blanks at the end of a line");
    }
    assert!(!formatted.contains('\r') && !formatted.contains("\n\n\n"), "{name}: line ends");
    assert!(formatted.is_empty() || formatted.ends_with('\n') && !formatted.ends_with("\n\n"), "{name}: end");
}

#[test]
fn sources_keep_tokens_comments_and_meaning() {
    for (name, text) in sources() {
        assert_faithful(&name, &text, &format(&name, &text));
    }
}

#[test]
fn a_type_may_end_right_before_an_equals_sign() {
    let text = "edition 1\n\nfn two(x:List<Length?,3>)->List<Length?,3>=x\nparam y:Quantity<m2/s>=1 m2/s\n";
    let wanted = "edition 1\n\nfn two(x: List<Length?, 3>) -> List<Length?, 3> = x\nparam y: Quantity<m2/s> = 1 m2/s\n";
    assert_eq!(format("text", text), wanted);
}
