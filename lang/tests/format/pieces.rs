//! Tokens and comments, cut by other means than the formatter's own.

/// A token or comment.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Its text; a comment's lines without blanks at their ends, nor indentation under stars.
    pub text: String,
    /// The blanks before it.
    pub blanks: String,
}

impl Piece {
    pub fn is_comment(&self) -> bool {
        self.text.starts_with("//") || self.text.starts_with("/*")
    }

    /// Whether the blanks between this and the piece before mean something: a unit stands on the line of its
    /// number, a call's bracket touches what is called.
    pub fn is_bound_to(&self, before: &Piece) -> bool {
        let unit = before.text.starts_with(|c: char| c.is_ascii_digit())
            && self.text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '%');
        unit || self.text == "(" && self.blanks.is_empty()
    }
}

/// Cuts a source. A number and the unit that touches or follows it are apart, a unit is whole: `m/s`.
pub fn pieces(text: &str) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::new();
    let mut rest = text;
    loop {
        let blanks = rest.len() - rest.trim_start().len();
        let (before, at) = rest.split_at(blanks);
        if at.is_empty() {
            return out;
        }
        let len = length(at, out.last().map_or("", |p| &p.text));
        let text =
            if at.starts_with("/*") || at.starts_with("//") { comment(&at[..len]) } else { at[..len].into() };
        out.push(Piece { text, blanks: before.into() });
        rest = &at[len..];
    }
}

fn length(at: &str, before: &str) -> usize {
    let run = |s: &str, f: &dyn Fn(char) -> bool| s.find(|c| !f(c)).unwrap_or(s.len());
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let first = at.chars().next().unwrap();
    if at.starts_with("//") {
        return run(at, &|c| c != '\n');
    }
    if at.starts_with("/*") {
        return at.find("*/").unwrap() + 2;
    }
    if first == '"' {
        return at[1..].find('"').unwrap() + 2;
    }
    if before == "import" {
        return run(at, &|c| word(c) || c == '.');
    }
    // The inverse of a unit, in a type.
    let inverse = run(at, &|c| word(c) || c == '/' || c == '^');
    if at.starts_with("1/") && at[inverse..].starts_with('>') {
        return inverse;
    }
    if first.is_ascii_digit() {
        let whole = run(at, &|c| c.is_ascii_digit() || c == '_');
        let fraction = at[whole..].strip_prefix('.').map_or(0, |f| run(f, &|c| c.is_ascii_digit()));
        return whole + if fraction > 0 { fraction + 1 } else { 0 };
    }
    if word(first) {
        let mut len = run(at, &word);
        // Only a unit goes on behind these without a blank.
        let after_number = before.starts_with(|c: char| c.is_ascii_digit());
        while after_number && at[len..].starts_with(['/', '*', '^']) {
            let more = run(&at[len + 1..], &word);
            if more == 0 {
                break;
            }
            len += 1 + more;
        }
        return len;
    }
    let double = ["=>", "->", "<=", ">=", "==", "!=", ".."].iter().any(|d| at.starts_with(d));
    if double { 2 } else { first.len_utf8() }
}

fn comment(text: &str) -> String {
    let stars = text.lines().skip(1).all(|l| l.trim_start().starts_with('*'));
    let line = |l: &str| if stars { l.trim().to_string() } else { l.trim_end().to_string() };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// The syntax tree as text, without positions.
pub fn meaning(text: &str) -> String {
    let (tree, _) = soifra_lang::parse::parse(0, text);
    let tree = format!("{tree:?}");
    let mut out = String::new();
    let mut parts = tree.split("Span {");
    out.push_str(parts.next().unwrap_or_default());
    for p in parts {
        out.push_str(&p[p.find('}').unwrap_or(0)..]);
    }
    out
}
