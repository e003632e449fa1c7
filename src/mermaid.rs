//! What Mermaid's languages have in common.

/// A text in which nothing is markup: what Mermaid would read as such is written as entities, ends of lines
/// as breaks.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '"' => out.push_str("#quot;"),
            '<' => out.push_str("#lt;"),
            '>' => out.push_str("#gt;"),
            '#' => out.push_str("#35;"),
            '&' => out.push_str("#amp;"),
            ';' => out.push_str("#59;"),
            '\n' => out.push_str("<br/>"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// The front matter that gives a picture its title.
pub fn title(text: &str) -> String {
    // The front matter is YAML, where a backslash begins an escape.
    format!("---\ntitle: \"{}\"\n---\n", escape(text).replace('\\', "\\\\"))
}
