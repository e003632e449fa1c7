//! A drawing as SVG.

use super::drawing::{Drawing, Ink, Item, Segment, Shape};
use std::fmt::Write;

impl Drawing {
    /// The drawing as a complete SVG file.
    pub fn to_svg(&self) -> String {
        let mut s = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" role="img">
<title>{}</title>
<rect width="{w}" height="{h}" fill="#ffffff"/>
<g fill="none" stroke-linecap="round" stroke-linejoin="round">
"##,
            escape(&self.description),
            w = Num(self.width),
            h = Num(self.height),
        );
        for item in &self.items {
            write_item(&mut s, item);
        }
        s.push_str("</g>\n</svg>\n");
        s
    }
}

/// Writing to a String cannot fail: results are dropped.
fn write_item(s: &mut String, item: &Item) {
    match &item.shape {
        Shape::Circle { at: [x, y], radius } => {
            let _ = write!(s, r#"<circle cx="{}" cy="{}" r="{}""#, Num(*x), Num(*y), Num(*radius));
        }
        Shape::Path(segments) => {
            s.push_str(r#"<path d=""#);
            for segment in segments {
                let _ = match segment {
                    Segment::Move([x, y]) => write!(s, "M{} {}", Num(*x), Num(*y)),
                    Segment::Line([x, y]) => write!(s, "L{} {}", Num(*x), Num(*y)),
                    Segment::Cubic(a, b, c) => {
                        let [a, b, c] = [a, b, c].map(|p| p.map(Num));
                        write!(s, "C{} {} {} {} {} {}", a[0], a[1], b[0], b[1], c[0], c[1])
                    }
                    Segment::Close => write!(s, "Z"),
                };
            }
            s.push('"');
        }
    }
    if let Some(fill) = item.style.fill {
        paint(s, "fill", fill);
    }
    if let Some(line) = item.style.line {
        paint(s, "stroke", line.ink);
        let _ = write!(s, r#" stroke-width="{}""#, Num(line.width));
        if let Some(dash) = line.dash {
            let _ = write!(s, r#" stroke-dasharray="{}""#, Num(dash));
        }
    }
    if let Some(text) = &item.text {
        let _ = write!(s, r#" aria-label="{}""#, escape(text));
    }
    s.push_str("/>\n");
}

fn paint(s: &mut String, what: &str, ink: Ink) {
    let [r, g, b] = ink.color;
    let _ = write!(s, r##" {what}="#{r:02x}{g:02x}{b:02x}""##);
    if ink.alpha < 1.0 {
        let _ = write!(s, r#" {what}-opacity="{}""#, Num(ink.alpha));
    }
}

/// A number with at most two decimals.
struct Num(f64);

impl std::fmt::Display for Num {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Adding zero turns -0 into 0.
        let text = format!("{:.2}", (self.0 * 100.0).round() / 100.0 + 0.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no other control characters.
            c if c.is_control() => out.push(' '),
            // Nor these two.
            '\u{fffe}' | '\u{ffff}' => out.push('?'),
            c => out.push(c),
        }
    }
    out
}
