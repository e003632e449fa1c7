//! Signatures of built-in functions and component models, written as text:
//! `polar<F, D>(length: Quantity<D>, heading: Heading<F>) -> Vector<F, D>`.

use crate::{Name, Type, Value, dim::Unit, pattern::Pattern};

/// A parameter with an optional default.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, usable at the call.
    pub name: Name,
    /// Accepted types.
    pub pattern: Pattern,
    /// Value when the argument is left out.
    pub default: Option<Value>,
}

/// A name, parameters, a result.
#[derive(Debug, Clone, PartialEq)]
pub struct Signature {
    /// Name.
    pub name: Name,
    /// Parameters in order.
    pub parameters: Vec<Parameter>,
    /// Result type.
    pub result: Pattern,
    /// As written, for diagnostics and documentation.
    pub text: String,
}

impl Signature {
    /// Parses a signature; a missing result stands for `Bool`.
    pub fn parse(text: &str) -> Result<Signature, String> {
        let open = text.find('(').ok_or("no parameter list")?;
        let name = text[..open].split('<').next().unwrap_or_default().trim();
        let close = matching(text, open).ok_or("unclosed parameter list")?;
        let mut parameters = Vec::new();
        for part in split_top(&text[open + 1..close]) {
            let (head, default) = match part.split_once(" = ") {
                Some((h, d)) => (h, Some(d.trim())),
                None => (part, None),
            };
            let (n, t) = head.split_once(':').ok_or_else(|| format!("`{part}` has no type"))?;
            let pattern = Pattern::parse(t.trim())?;
            let default = default.map(|d| default_value(d, &pattern)).transpose()?;
            parameters.push(Parameter { name: n.trim().into(), pattern, default });
        }
        let result = match text[close + 1..].trim().strip_prefix("->") {
            Some(r) => Pattern::parse(r)?,
            None => Pattern::Exact(Type::Bool),
        };
        Ok(Signature { name: name.into(), parameters, result, text: text.to_string() })
    }
}

fn matching(text: &str, open: usize) -> Option<usize> {
    let mut depth = 0;
    for (i, c) in text[open..].char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(open + i);
        }
    }
    None
}

fn split_top(s: &str) -> Vec<&str> {
    let (mut depth, mut from, mut parts) = (0, 0, Vec::new());
    let bytes = s.as_bytes();
    for (i, c) in s.char_indices() {
        match c {
            '<' | '(' => depth += 1,
            '>' if i > 0 && bytes[i - 1] == b'-' => {}
            '>' | ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(s[from..i].trim());
                from = i + 1;
            }
            _ => {}
        }
    }
    parts.push(s[from..].trim());
    parts.retain(|p| !p.is_empty());
    parts
}

/// `0`, `200 ms`, `none`, `true`, `"text"`, or an enum variant.
fn default_value(text: &str, pattern: &Pattern) -> Result<Value, String> {
    let (number, unit) = text.split_once(' ').unwrap_or((text, ""));
    if let (Some(x), Ok(true)) = (
        Unit::parse(if unit.is_empty() { "1" } else { unit }).ok().and_then(|u| u.value(number)),
        number.parse::<f64>().map(f64::is_finite),
    ) {
        return Ok(match pattern {
            Pattern::Exact(Type::Int) => Value::Int(x as i64),
            Pattern::Exact(Type::Distribution(_)) | Pattern::Distribution(_) => {
                Value::Distribution(crate::Distribution::Exact(x))
            }
            _ => Value::Number(x),
        });
    }
    Ok(match text {
        "none" => Value::None("not given".into()),
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        "empty" => Value::List(Vec::new()),
        _ if text.starts_with('"') => Value::Text(text.trim_matches('"').into()),
        _ => Value::Variant(text.into()),
    })
}
