//! The grammar in the reference is made from `grammar.pest`.
//!
//! `<!-- grammar: robot binding; inline robot_target count -->` shows two rules; those after `inline` are
//! written out where they are used. What is left out: look-ahead, and the difference between atomic and
//! other rules.

use super::{read, regions};
use std::collections::{BTreeMap, BTreeSet};

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Rule(String),
    Text(String),
    Mark(char),
}

/// Rules by name, in the tokens of their bodies.
fn rules() -> BTreeMap<String, Vec<Token>> {
    let text: String = read("lang/src/grammar.pest")
        .lines()
        .filter(|l| !l.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    let tokens = tokenize(&text);
    let mut out = BTreeMap::new();
    let mut i = 0;
    while i < tokens.len() {
        let Token::Rule(name) = &tokens[i] else { panic!("a rule name is wanted, not {:?}", tokens[i]) };
        assert_eq!(tokens[i + 1], Token::Mark('='), "{name}");
        i += 2;
        while matches!(&tokens[i], Token::Mark('@' | '$' | '!')) || tokens[i] == Token::Rule("_".into()) {
            i += 1;
        }
        assert_eq!(tokens[i], Token::Mark('{'), "{name}");
        let end = i + tokens[i..].iter().position(|t| *t == Token::Mark('}')).unwrap();
        out.insert(name.clone(), tokens[i + 1..end].to_vec());
        i = end + 1;
    }
    out
}

fn tokenize(text: &str) -> Vec<Token> {
    let mut out = Vec::new();
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        if c == '"' {
            let mut s = String::new();
            while let Some(c) = chars.next() {
                match c {
                    '"' => break,
                    '\\' => s.extend(chars.next()),
                    c => s.push(c),
                }
            }
            out.push(Token::Text(s));
        } else if c.is_ascii_alphabetic() || c == '_' {
            let mut s = c.to_string();
            while let Some(c) = chars.next_if(|c| c.is_ascii_alphanumeric() || *c == '_') {
                s.push(c);
            }
            out.push(Token::Rule(s));
        } else if !c.is_whitespace() {
            out.push(Token::Mark(c));
        }
    }
    out
}

/// The body of a rule as EBNF.
fn body(rules: &BTreeMap<String, Vec<Token>>, name: &str, inline: &[&str]) -> String {
    let tokens = rules.get(name).unwrap_or_else(|| panic!("grammar.pest has no rule `{name}`"));
    let mut out = String::new();
    let mut i = 0;
    while i < tokens.len() {
        match &tokens[i] {
            Token::Rule(r) if inline.contains(&r.as_str()) => {
                let inner = body(rules, r, inline);
                let repeated = matches!(tokens.get(i + 1), Some(Token::Mark('?' | '*' | '+')));
                let brackets = (repeated || inner.contains(" | ")) && tokens.len() > 1;
                out.push_str(&if brackets { format!("({inner})") } else { inner });
            }
            Token::Rule(r) => match r.strip_prefix("K_") {
                Some(word) => out.push_str(&format!("\"{}\"", word.to_lowercase())),
                None => out.push_str(&word(r)),
            },
            Token::Text(t) if t.contains('"') => out.push_str(&format!("'{t}'")),
            Token::Text(t) => out.push_str(&format!("\"{t}\"")),
            Token::Mark('~') => out.push(' '),
            Token::Mark('|') => out.push_str(" | "),
            // Look-ahead: its operand is left out.
            Token::Mark('!' | '&') => {
                i += 1;
                if tokens[i] == Token::Mark('(') {
                    let mut depth = 0;
                    loop {
                        match tokens[i] {
                            Token::Mark('(') => depth += 1,
                            Token::Mark(')') => depth -= 1,
                            _ => {}
                        }
                        if depth == 0 {
                            break;
                        }
                        i += 1;
                    }
                }
                if tokens.get(i + 1) == Some(&Token::Mark('~')) {
                    i += 1;
                } else {
                    out.truncate(out.trim_end().len());
                }
            }
            Token::Mark(c) => out.push(*c),
        }
        i += 1;
    }
    // The ends of a file and what error recovery skips are no concern of a writer.
    [
        (" | junk", ""),
        ("SOI ", ""),
        (" EOI", ""),
        ("(character)", "character"),
        ("(prefix )", "prefix"),
        ("  ", " "),
    ]
    .iter()
    .fold(out, |s, (a, b)| s.replace(a, b))
    .trim()
    .to_string()
}

/// A rule of the grammar, or of pest itself, as it is shown.
fn word(rule: &str) -> String {
    match rule {
        "ASCII_ALPHA" => "letter".into(),
        "ASCII_DIGIT" => "digit".into(),
        "IDC" => "(letter | digit | \"_\")".into(),
        "ANY" => "character".into(),
        "type_ref" => "type".into(),
        "gap" => String::new(),
        other => other.into(),
    }
}

/// `a = b c` with alternatives on lines of their own when the line gets long.
fn shown(rules: &BTreeMap<String, Vec<Token>>, name: &str, inline: &[&str]) -> String {
    let body = body(rules, name, inline);
    let name = word(name);
    let line = format!("{name} = {body}");
    if line.len() <= 110 {
        return line;
    }
    let (mut parts, mut depth, mut from) = (Vec::new(), 0, 0);
    let bytes = body.as_bytes();
    let mut quoted = false;
    for i in 0..bytes.len() {
        match bytes[i] {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'(' => depth += 1,
            b')' => depth -= 1,
            b'|' if depth == 0 => {
                parts.push(body[from..i].trim());
                from = i + 1;
            }
            _ => {}
        }
    }
    parts.push(body[from..].trim());
    if parts.len() > 1 {
        return format!("{name} = {}", parts.join(&format!("\n{}| ", " ".repeat(name.len() + 1))));
    }
    // One long sequence: broken between its parts, not within brackets.
    let (mut out, mut width, mut depth) = (format!("{name} ="), name.len() + 2, 0);
    for word in body.split(' ') {
        if depth == 0 && width + word.len() > 92 {
            out.push_str(&format!("\n{}", " ".repeat(name.len() + 2)));
            width = name.len() + 2;
        }
        depth += word.matches('(').count() as i32 - word.matches(')').count() as i32;
        if word.contains("\"(\"") || word.contains("\")\"") {
            depth = 0;
        }
        out.push(' ');
        out.push_str(word);
        width += word.len() + 1;
    }
    out
}

fn marker(text: &str) -> (Vec<&str>, Vec<&str>) {
    let (names, inline) = text.split_once(';').unwrap_or((text, ""));
    (names.split_whitespace().collect(), inline.split_whitespace().skip(1).collect())
}

#[test]
fn grammar_is_up_to_date() {
    let rules = rules();
    regions::check("docs/language.md", "grammar", |text| {
        let (names, inline) = marker(text);
        let lines: Vec<String> = names.iter().map(|n| shown(&rules, n, &inline)).collect();
        format!("```ebnf\n{}\n```", lines.join("\n"))
    });
}

/// Rules that are described in words, or belong to the formatter and to error recovery.
const IN_WORDS: &[&str] = &[
    "WHITESPACE",
    "COMMENT",
    "IDC",
    "KEYWORD",
    "RESERVED",
    "KEYWORD_NOT_UNIT",
    "gap",
    "junk",
    "item_alone",
    "head",
    "piece",
    "ITEM_START",
    "STMT_END",
    "tokens",
    "token",
    "name_token",
    "numeral",
    "mark",
];

#[test]
fn every_rule_is_shown_once() {
    let rules = rules();
    let text = read("docs/language.md");
    let mut seen: BTreeSet<String> = BTreeSet::new();
    for line in text.lines().filter_map(|l| l.strip_prefix("<!-- grammar: ")) {
        let (names, inline) = marker(line.trim_end_matches("-->").trim());
        for n in &names {
            assert!(seen.insert((*n).to_string()), "`{n}` is shown twice");
        }
        seen.extend(inline.iter().map(|n| (*n).to_string()));
    }
    let missing: Vec<&String> = rules
        .keys()
        .filter(|r| !r.starts_with("K_") && !IN_WORDS.contains(&r.as_str()) && !seen.contains(*r))
        .collect();
    assert!(missing.is_empty(), "docs/language.md shows no grammar of {missing:?}");
}

/// The words that cannot be names, for the tables.
pub fn reserved() -> Vec<String> {
    let rules = rules();
    rules["RESERVED"]
        .iter()
        .filter_map(|t| if let Token::Text(t) = t { Some(t.clone()) } else { None })
        .collect()
}

/// All keywords, for the tables.
pub fn keywords() -> BTreeSet<String> {
    let rules = rules();
    rules["KEYWORD"]
        .iter()
        .filter_map(|t| if let Token::Text(t) = t { Some(t.clone()) } else { None })
        .collect()
}
