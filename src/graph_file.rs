//! Graphs as files: YAML and JSON, both ways. The only module that knows serde_yaml.
//!
//! Both forms have one data model, JSON's: a YAML graph is that model written as YAML, so the two carry
//! the same and damage is told the same way. The canonical form, which the graph digest is of, is compact JSON.

use crate::report::Refusal;
use serde_json::Value;
use sha2::{Digest, Sha256};
use soifra_graph::{Diagnostic, Graph, SCHEMA, Span, span::Source};

/// Deepest nesting of brackets in a graph file.
const DEPTH: usize = 2048;

/// Reads any other YAML file of ours.
pub fn from_yaml<T: serde::de::DeserializeOwned>(path: &str, text: &str) -> Result<T, Refusal> {
    serde_path_to_error::deserialize(yaml_value(path, text)?).map_err(|e| {
        let seen = format!("at `{}`: {}", e.path(), e.inner());
        Refusal::about(
            path,
            "S9026",
            "the file does not have the form that is wanted",
            seen,
            "see docs/results.md for the form",
        )
    })
}

/// Whether a path names a graph file: by its ending.
pub fn is_graph(path: &str) -> bool {
    let lower = path.to_ascii_lowercase();
    [".yaml", ".yml", ".json"].iter().any(|e| lower.ends_with(e))
}

/// The graph as JSON text for people.
pub fn to_json(graph: &Graph) -> Result<String, String> {
    serde_json::to_string_pretty(graph).map(|s| s + "\n").map_err(|e| e.to_string())
}

/// The graph as YAML text.
pub fn to_yaml(graph: &Graph) -> Result<String, String> {
    let value = serde_json::to_value(graph).map_err(|e| e.to_string())?;
    serde_yaml::to_string(&value).map_err(|e| e.to_string())
}

/// The graph in the form that digests and traces use.
pub fn canonical(graph: &Graph) -> Result<String, String> {
    serde_json::to_string(graph).map_err(|e| e.to_string())
}

/// SHA-256 of the canonical form, in hexadecimal.
pub fn digest(graph: &Graph) -> String {
    canonical(graph).map(|text| sha256(text.as_bytes())).unwrap_or_default()
}

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// Reads a graph. What it says is not yet checked: that is the verifier's job.
pub fn parse(path: &str, text: &str) -> Result<Graph, Refusal> {
    let json = path.to_ascii_lowercase().ends_with(".json");
    let value = if json { json_value(path, text)? } else { yaml_value(path, text)? };
    from_value(path, value)
}

fn from_value(path: &str, value: Value) -> Result<Graph, Refusal> {
    let refuse =
        |code, title: &str, seen: String, hint: &str| Err(Refusal::about(path, code, title, seen, hint));
    let Value::Object(fields) = &value else {
        return refuse(
            "S9006",
            "this is no behaviour graph",
            kind(&value).into(),
            "make a graph file with `soifra graph MISSION --format yaml`",
        );
    };
    match fields.get("schema").and_then(Value::as_u64) {
        Some(v) if v == u64::from(SCHEMA) => {}
        Some(v) => {
            return refuse(
                "S9007",
                "the graph has another schema version",
                format!("it has version {v}, this soifra reads version {SCHEMA}"),
                "make the graph again from its source with this soifra",
            );
        }
        None => {
            return refuse(
                "S9006",
                "this is no behaviour graph",
                "it has no `schema` number".into(),
                "make a graph file with `soifra graph MISSION --format yaml`",
            );
        }
    }
    serde_path_to_error::deserialize::<_, Graph>(value).or_else(|e| {
        let place = e.path().to_string();
        let seen = if place == "." { e.inner().to_string() } else { format!("at `{place}`: {}", e.inner()) };
        refuse(
            "S9008",
            "the graph is damaged",
            seen,
            "make the graph again from its source; edit it only with care",
        )
    })
}

fn kind(v: &Value) -> &'static str {
    match v {
        Value::Null => "it is empty",
        Value::Array(_) => "it is a list",
        Value::Object(_) => "it is a table",
        _ => "it is a single value",
    }
}

fn json_value(path: &str, text: &str) -> Result<Value, Refusal> {
    if let Some(at) = too_deep(text) {
        return Err(syntax(
            path,
            text,
            Span::new(0, at, at + 1),
            format!("brackets nest deeper than {DEPTH} here"),
        ));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    // The depth was bounded above, and commands run on a large stack.
    reader.disable_recursion_limit();
    let value = serde::Deserialize::deserialize(&mut reader).and_then(|v: Value| reader.end().map(|()| v));
    value.map_err(|e| {
        let at = offset(text, e.line(), e.column());
        let what = e.to_string();
        syntax(path, text, at, what.split(" at line ").next().unwrap_or_default().into())
    })
}

fn yaml_value(path: &str, text: &str) -> Result<Value, Refusal> {
    serde_yaml::from_str::<Value>(text).map_err(|e| {
        let at = e.location().map_or(Span::default(), |l| Span::new(0, l.index(), l.index() + 1));
        let what = e.to_string();
        syntax(path, text, at, what.split(" at line ").next().unwrap_or_default().into())
    })
}

fn syntax(path: &str, text: &str, at: Span, seen: String) -> Refusal {
    let diagnostic = Diagnostic::error("S9005", "the graph file cannot be read")
        .at(at, seen)
        .hint("it was cut off or edited by hand; make it again with `soifra graph MISSION`");
    Refusal::with(diagnostic, Source { path: path.into(), text: text.into() })
}

/// The first bracket that opens too deep, outside of strings.
fn too_deep(text: &str) -> Option<usize> {
    let (mut depth, mut quoted, mut escaped) = (0usize, false, false);
    for (i, b) in text.bytes().enumerate() {
        match b {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            b'[' | b'{' if !quoted => {
                depth += 1;
                if depth > DEPTH {
                    return Some(i);
                }
            }
            b']' | b'}' if !quoted => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}

/// The byte at a line and column (bytes, from 1).
fn offset(text: &str, line: usize, column: usize) -> Span {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let at = (start + column.saturating_sub(1)).min(text.len());
    Span::new(0, at, at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(path: &str, text: &str) -> &'static str {
        parse(path, text).unwrap_err().findings.diagnostics[0].code
    }

    #[test]
    fn damage_is_told() {
        assert_eq!(code("a.json", ""), "S9005");
        assert_eq!(code("a.json", "{\"schema\": 1"), "S9005");
        assert_eq!(code("a.json", &"[".repeat(10_000_000)), "S9005");
        assert_eq!(code("a.yaml", &"[".repeat(100_000)), "S9005");
        assert_eq!(code("a.yaml", "\u{0}"), "S9005");
        assert_eq!(code("a.yaml", "- 1\n- 2\n"), "S9006");
        assert_eq!(code("a.yaml", ""), "S9006");
        assert_eq!(code("a.yaml", "schema: 77"), "S9007");
        assert_eq!(code("a.yaml", "schema: 1"), "S9008");
    }
}
