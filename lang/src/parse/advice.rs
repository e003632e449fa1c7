//! What to do about a syntax error, told from what stands there.

use super::Rule;
use pest::Parser as _;
use soifra_graph::did_you_mean;

/// A hint for what was found at byte `from` of `text`, where `expected` could have stood.
pub fn hint(text: &str, from: usize, expected: &[String]) -> String {
    let found = &text[from..];
    let word: &str =
        &found[..found.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(found.len())];
    let after = found[word.len()..].trim_start();
    let wanted = |what: &str| expected.iter().any(|e| e == what);
    if found.trim().is_empty() {
        return "something before this is not finished, or a bracket is not closed".into();
    }
    if word.is_empty() {
        return match found.chars().next() {
            Some('&') => "two conditions are joined with `and`".into(),
            Some('|') => "two conditions are joined with `or`; `or` also gives a value in place of an absent one".into(),
            Some('!') if !found.starts_with("!=") => "the opposite of a condition is `not …`".into(),
            Some(';') => "nothing closes a statement: leave the `;` out".into(),
            Some('=') if !found.starts_with("==") => {
                "two values are compared with `==`; a state is changed with `set NAME = …`".into()
            }
            Some('(') => "write the bracket of a call directly after its name; to multiply, write `*`".into(),
            Some(c @ (')' | ']' | '}')) => format!("something before `{c}` is not finished, or one bracket is too many"),
            Some(c) if !c.is_ascii() && c.is_alphanumeric() => {
                "names are made of the letters a to z, digits and `_`; other letters can stand in texts and comments".into()
            }
            _ if wanted("a value") => "a value is missing before this".into(),
            _ => "see the construct's grammar in docs/language.md, or `soifra explain S0101`".into(),
        };
    }
    if wanted("a name") && super::Grammar::parse(Rule::RESERVED, word).is_ok() {
        return format!("`{word}` is a word of the language and cannot be a name: choose another");
    }
    if word == "import" || word == "edition" {
        return format!("`{word}` stands at the top of the file, before everything else");
    }
    let step = ["+=", "-=", "*=", "/=", "++", "--"].iter().find(|s| after.starts_with(**s));
    if let Some(step) = step {
        return format!("a state is changed with `set {word} = {word} {} …`", &step[..1]);
    }
    if after.starts_with('=') && !after.starts_with("==") && !after.starts_with("=>") {
        return format!("a state is changed with `set {word} = …`, a value is named with `let {word} = …`");
    }
    if let Some(near) = did_you_mean(word, expected.iter().map(|e| e.trim_matches('`'))) {
        return format!("did you mean `{near}`?");
    }
    "something before this is not finished, or this belongs elsewhere; `soifra explain S0101` says more"
        .into()
}

/// The bracket before byte `from` that is still open there, the innermost one.
pub fn open_bracket(text: &str, from: usize) -> Option<usize> {
    let (bytes, mut open, mut i) = (text.as_bytes(), Vec::new(), 0);
    while i < from.min(bytes.len()) {
        match bytes[i] {
            b'/' if bytes.get(i + 1) == Some(&b'/') => {
                i += text[i..].find('\n').unwrap_or(text.len() - i);
                continue;
            }
            b'/' if bytes.get(i + 1) == Some(&b'*') => {
                i += text[i..].find("*/").map_or(text.len() - i, |n| n + 2);
                continue;
            }
            b'"' => i += text[i + 1..].find(['"', '\n']).map_or(text.len() - i, |n| n + 1),
            b'(' | b'[' | b'{' => open.push(i),
            b')' | b']' | b'}' => {
                open.pop();
            }
            _ => {}
        }
        i += 1;
    }
    open.pop()
}
