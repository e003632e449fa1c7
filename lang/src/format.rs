//! The canonical layout of a source.

use soifra_graph::Diagnostic;

/// Lays out a source anew; the errors when it cannot be read.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let (_, errors) = crate::parse::parse(0, text);
    if errors.is_empty() { Ok(text.to_string()) } else { Err(errors) }
}
