//! From operations to text: breaks the groups that do not fit, in one pass.

use super::build::{Gap, Hug, Op};
use super::measure::Measure;
use super::tokens::{Place, Source};
use super::{STEP, WIDTH};

/// Prints the operations.
pub fn print(source: &Source<'_>, ops: &[Op]) -> String {
    let measure = Measure::new(source, ops);
    let out = String::with_capacity(source.tokens.len() * 8);
    let mut p = Printer {
        source,
        measure,
        out,
        column: 0,
        levels: vec![0],
        broken: vec![true],
        values: Vec::new(),
        value_broke: false,
        next: 0,
    };
    for (i, op) in ops.iter().enumerate() {
        p.op(i, *op);
    }
    p.out
}

struct Printer<'s, 't> {
    source: &'s Source<'t>,
    measure: Measure,
    out: String,
    column: usize,
    /// Indentations, innermost last.
    levels: Vec<usize>,
    /// Whether the open groups are broken, innermost last.
    broken: Vec<bool>,
    /// Whether the open values went to lines of their own, innermost last.
    values: Vec<bool>,
    /// Whether the value that ended last did.
    value_broke: bool,
    /// Token to come.
    next: usize,
}

impl Printer<'_, '_> {
    fn op(&mut self, i: usize, op: Op) {
        let broken = self.broken.last().copied().unwrap_or(true);
        let level = self.level();
        match op {
            Op::Token => {
                self.write(self.source.tokens[self.next].text);
                self.next += 1;
            }
            Op::Gap { gap, token } => {
                let breaks = match gap {
                    Gap::Hard | Gap::Blank => true,
                    Gap::Line | Gap::Soft => broken,
                    Gap::Fill(end) => broken && !self.fits(i, end, self.column),
                    Gap::AfterValue => self.value_broke,
                    Gap::Tight | Gap::Space => false,
                };
                self.gap(gap, token, breaks);
            }
            Op::Open { end } => self.broken.push(broken && !self.fits(i, end, self.column)),
            Op::Close => {
                self.broken.pop();
            }
            Op::Value { hug, token, end } => {
                // Behind the gap, on this line or on the next.
                let here = self.column + 1 + self.measure.reach(i + 1) <= WIDTH;
                let next = || self.fits(i + 1, end, (level + 1) * STEP);
                let breaks = broken
                    && !self.fits(i, end, self.column)
                    && match hug {
                        Hug::Never => true,
                        Hug::IfTooLong => !here || next(),
                        Hug::Always => !here,
                    };
                self.levels.push(if breaks { level + 1 } else { level });
                self.values.push(breaks);
                self.gap(Gap::Line, token, breaks);
            }
            Op::EndValue => {
                self.value_broke = self.values.pop().unwrap_or(false);
                self.levels.pop();
            }
            Op::Dedent => {
                self.levels.pop();
            }
            Op::Indent(n) => self.levels.push(level + n),
        }
    }

    fn level(&self) -> usize {
        self.levels.last().copied().unwrap_or(0)
    }

    fn fits(&self, from: usize, to: usize, column: usize) -> bool {
        self.measure.flat(from, to).is_some_and(|w| column + w <= WIDTH)
    }

    /// The gap before a token, with the comments in it.
    fn gap(&mut self, gap: Gap, token: usize, breaks: bool) {
        let source = self.source;
        let t = &source.tokens[token];
        let comments = &source.comments[t.comments.clone()];
        let members = matches!(gap, Gap::Hard | Gap::Blank);
        let closes = matches!(t.text, ")" | "]" | "}");
        // A line break that only a comment asks for continues a line.
        let level = self.level() + usize::from(!breaks);
        let comment_level = level + usize::from(breaks && closes);
        let opened = source.opened(token);
        let paragraph = comments.iter().any(|c| c.breaks > 1) || t.breaks > 1;

        // What is still to be done: a line break, and a blank line that the gap insists on.
        let (mut pending, mut inline) = (breaks, false);
        let mut blank = gap == Gap::Blank && !paragraph;
        let mut first = opened;
        for (i, c) in comments.iter().enumerate() {
            match c.place(members, opened) {
                Place::Own => {
                    self.line(comment_level, members && !first && (blank || c.breaks > 1));
                    (blank, first, pending, inline) = (false, false, true, false);
                }
                Place::Trailing => {
                    self.write("  ");
                    pending = true;
                }
                Place::Inline => {
                    if pending {
                        // With the token, unless another comment ends the line first.
                        let alone = comments[i..].iter().any(|c| c.place(members, opened) != Place::Inline);
                        let level = if alone { comment_level } else { level };
                        self.line(level, members && !first && (blank || c.breaks > 1));
                        (blank, first, pending) = (false, false, false);
                    } else if inline || !opened || !matches!(gap, Gap::Tight | Gap::Soft | Gap::AfterValue) {
                        self.write(" ");
                    }
                    inline = true;
                }
            }
            self.comment(c.text);
        }
        if pending {
            let end = t.text.is_empty();
            self.line(level, members && !first && !closes && !end && (blank || t.breaks > 1));
        } else if inline {
            if !matches!(t.text, "," | ")" | "]" | ":" | "." | "?") {
                self.write(" ");
            }
        } else if !breaks && matches!(gap, Gap::Space | Gap::Line | Gap::Fill(_)) && token > 0 {
            self.write(" ");
        }
    }

    /// Begins a line; nothing where a text begins.
    fn line(&mut self, level: usize, blank: bool) {
        if !self.out.is_empty() {
            self.out.push_str(if blank { "\n\n" } else { "\n" });
        }
        self.column = level * STEP;
    }

    /// Writes a piece without line breaks; the indentation comes with the first of a line.
    fn write(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        if self.out.is_empty() || self.out.ends_with('\n') {
            self.out.extend(std::iter::repeat_n(' ', self.column));
        }
        self.out.push_str(text);
        self.column += text.chars().count();
    }

    /// Writes a comment. Lines of one that all begin with a star are brought under its first; the lines of
    /// others stay as they are.
    fn comment(&mut self, text: &str) {
        let mut lines = text.split('\n');
        let start = self.column;
        self.write(lines.next().unwrap_or_default().trim_end());
        let stars = lines.clone().all(|l| l.trim_start().starts_with('*'));
        for line in lines {
            self.out.push('\n');
            self.column = 0;
            if stars {
                self.column = start + 1;
                self.write(line.trim());
            } else {
                self.out.push_str(line.trim_end());
                self.column = line.trim_end().chars().count();
            }
        }
    }
}
