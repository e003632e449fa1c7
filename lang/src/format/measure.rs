//! Widths of operations printed flat, added up once so that every question is answered at once.

use super::build::{Gap, Op};
use super::tokens::{Place, Source};

/// Sums over the operations.
pub struct Measure {
    /// Columns of the operations before each.
    width: Vec<usize>,
    /// Unavoidable line breaks before each.
    breaks: Vec<usize>,
    /// Columns from each operation up to where the line may break next.
    reach: Vec<usize>,
}

impl Measure {
    pub fn new(source: &Source<'_>, ops: &[Op]) -> Measure {
        let (mut width, mut breaks) = (vec![0; ops.len() + 1], vec![0; ops.len() + 1]);
        let mut next = 0;
        for (i, op) in ops.iter().enumerate() {
            let (mut w, mut forced) = (0, 0);
            match *op {
                Op::Token => {
                    w = source.tokens[next].text.chars().count();
                    next += 1;
                }
                Op::Gap { gap, token } => {
                    let hard = matches!(gap, Gap::Hard | Gap::Blank);
                    let (comments, broken) = comments(source, token, hard);
                    w = comments + usize::from(matches!(gap, Gap::Space | Gap::Line | Gap::Fill(_)));
                    forced = usize::from(hard || broken);
                }
                Op::Value { token, .. } => {
                    let (comments, broken) = comments(source, token, false);
                    w = comments + 1;
                    forced = usize::from(broken);
                }
                _ => {}
            }
            width[i + 1] = width[i] + w;
            breaks[i + 1] = breaks[i] + forced;
        }
        let mut reach = vec![0; ops.len() + 1];
        for (i, op) in ops.iter().enumerate().rev() {
            let may_break = match op {
                Op::Gap { gap, .. } => !matches!(gap, Gap::Tight | Gap::Space | Gap::AfterValue),
                Op::Value { .. } => true,
                _ => false,
            };
            let must_break = breaks[i + 1] > breaks[i];
            reach[i] = if may_break || must_break { 0 } else { width[i + 1] - width[i] + reach[i + 1] };
        }
        Measure { width, breaks, reach }
    }

    /// Columns of operations `from..to` on one line with what must follow there; `None` when they have to break.
    pub fn flat(&self, from: usize, to: usize) -> Option<usize> {
        (self.breaks[to] == self.breaks[from]).then(|| self.width[to] - self.width[from] + self.reach[to])
    }

    /// Columns from operation `at` up to where the line may break next.
    pub fn reach(&self, at: usize) -> usize {
        self.reach[at]
    }
}

/// Columns of the comments before a token, and whether they break the line.
fn comments(source: &Source<'_>, token: usize, hard: bool) -> (usize, bool) {
    let all = &source.comments[source.tokens[token].comments.clone()];
    let opened = source.opened(token);
    let broken = all.iter().any(|c| c.place(hard, opened) != Place::Inline || c.text.contains('\n'));
    (all.iter().map(|c| c.text.chars().count() + 1).sum(), broken)
}
