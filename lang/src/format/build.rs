//! From syntax tree to layout: tokens with the gaps between them, grouped.
//!
//! Every token has exactly one gap before it. A group is either flat, all on one line, or broken at every
//! [`Gap::Line`] of its own.

use super::tokens::Source;
use crate::parse::Rule;
use pest::iterators::Pair;

/// A node of the parse tree.
pub type Node<'i> = Pair<'i, Rule>;

/// What stands between two tokens.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Gap {
    /// Nothing.
    Tight,
    /// A space.
    Space,
    /// A space, or a line break when its group is broken.
    Line,
    /// Nothing, or a line break when its group is broken.
    Soft,
    /// A space, or a line break when its group is broken and what follows, up to that operation, is too long.
    Fill(usize),
    /// Nothing, or a line break when the value that ends right before went to a line of its own.
    AfterValue,
    /// A line break; a blank line where there was one.
    Hard,
    /// A blank line.
    Blank,
}

/// How a value that is too long for its line is laid out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Hug {
    /// On the next line.
    Never,
    /// On the next line if it fits there, else broken inside its brackets.
    IfTooLong,
    /// Broken inside its brackets.
    Always,
}

/// An operation of the printer.
#[derive(Clone, Copy, Debug)]
pub enum Op {
    /// The gap before token number `token`.
    Gap { gap: Gap, token: usize },
    /// The next token.
    Token,
    /// A group, up to operation `end`.
    Open { end: usize },
    /// Its end.
    Close,
    /// The gap before token number `token`, which begins a value that goes up to operation `end`.
    Value { hug: Hug, token: usize, end: usize },
    /// Its end.
    EndValue,
    /// Indents lines to come.
    Indent(usize),
    /// Undoes the last indent.
    Dedent,
}

/// A part of a node: a token of its own, by its text, or a child.
pub enum Part<'i, 't> {
    Own(&'t str),
    Child(Node<'i>),
}

/// Builds the operations while it walks the tree.
pub struct Builder<'s, 't> {
    source: &'s Source<'t>,
    ops: Vec<Op>,
    /// Groups and values that are open.
    open: Vec<usize>,
    /// Token to come.
    next: usize,
    /// Gap wished for before it; `None`: what its neighbours suggest.
    wish: Option<Gap>,
    /// Whether its gap is already among the operations.
    gap_done: bool,
}

impl<'s, 't> Builder<'s, 't> {
    pub fn new(source: &'s Source<'t>) -> Self {
        let ops = Vec::with_capacity(source.tokens.len() * 3);
        Builder { source, ops, open: Vec::new(), next: 0, wish: None, gap_done: false }
    }

    /// Lays out a whole file.
    pub fn file(mut self, root: Node<'_>) -> Vec<Op> {
        let mut after_braces = false;
        for child in children(root) {
            if child.as_rule() == Rule::EOI {
                continue;
            }
            let braces = is_braced_item(&child);
            self.gap(if after_braces || braces { Gap::Blank } else { Gap::Hard });
            self.node(child);
            after_braces = braces;
        }
        self.gap(Gap::Hard);
        while self.next < self.source.tokens.len() {
            self.token();
        }
        self.ops
    }

    /// Wishes for a gap before the token to come.
    pub fn gap(&mut self, gap: Gap) {
        self.wish = Some(gap);
    }

    /// Wishes for a gap unless there is a wish.
    pub fn gap_or(&mut self, gap: Gap) {
        self.wish.get_or_insert(gap);
    }

    /// The text of the token to come; empty at the end.
    pub fn peek(&self) -> &'t str {
        self.source.tokens.get(self.next).map_or("", |t| t.text)
    }

    /// Whether the last token was a comma.
    pub fn follows_comma(&self) -> bool {
        self.next.checked_sub(1).is_some_and(|i| self.source.tokens[i].text == ",")
    }

    /// Whether comments stand before the token to come.
    pub fn comment_next(&self) -> bool {
        self.source.tokens.get(self.next).is_some_and(|t| !t.comments.is_empty())
    }

    /// The next token, after its gap.
    pub fn token(&mut self) {
        self.flush();
        self.ops.push(Op::Token);
        self.next += 1;
        self.gap_done = false;
    }

    fn flush(&mut self) {
        let wish = self.wish.take();
        if self.gap_done {
            return;
        }
        let gap = wish.unwrap_or_else(|| {
            let before = self.next.checked_sub(1).map_or("", |i| self.source.tokens[i].text);
            match (before, self.peek()) {
                (_, "," | ")" | "]" | ":" | "." | "?") | ("(" | "[" | ".", _) => Gap::Tight,
                _ => Gap::Space,
            }
        });
        self.ops.push(Op::Gap { gap, token: self.next });
        self.gap_done = true;
    }

    /// Opens a group; the gap before it does not belong to it.
    pub fn open(&mut self) {
        self.flush();
        self.open.push(self.ops.len());
        self.ops.push(Op::Open { end: 0 });
    }

    /// Closes the group opened last.
    pub fn close(&mut self) {
        self.shut(Op::Close);
    }

    /// Begins a value; the gap before it is the value's.
    pub fn open_value(&mut self, hug: Hug) {
        self.wish = None;
        self.gap_done = true;
        self.open.push(self.ops.len());
        self.ops.push(Op::Value { hug, token: self.next, end: 0 });
    }

    /// Ends the value begun last.
    pub fn close_value(&mut self) {
        self.shut(Op::EndValue);
    }

    fn shut(&mut self, op: Op) {
        let here = self.ops.len();
        if let Some(Op::Open { end } | Op::Value { end, .. }) = self.open.pop().map(|i| &mut self.ops[i]) {
            *end = here;
        }
        self.ops.push(op);
    }

    pub fn indent(&mut self, levels: usize) {
        self.ops.push(Op::Indent(levels));
    }

    pub fn dedent(&mut self) {
        self.ops.push(Op::Dedent);
    }

    /// Puts the gap before the token to come among the operations, as one of a filled list; the gap of the
    /// part before, if any, learns how far that part reaches.
    pub fn fill(&mut self, last: Option<usize>) -> usize {
        let here = self.ops.len();
        self.end_fill(last);
        self.gap(Gap::Fill(here));
        self.flush();
        here
    }

    /// Tells the last gap of a filled list that its part ends here.
    pub fn end_fill(&mut self, last: Option<usize>) {
        let here = self.ops.len();
        if let Some(Op::Gap { gap, .. }) = last.and_then(|i| self.ops.get_mut(i)) {
            *gap = Gap::Fill(here);
        }
    }

    /// Hands over the parts of a node in order. A token that the visitor leaves is emitted after it.
    pub fn parts<'i>(&mut self, node: Node<'i>, mut visit: impl FnMut(&mut Self, Part<'i, 't>)) {
        let end = node.as_span().end();
        for child in children(node) {
            self.own(child.as_span().start(), &mut visit);
            let to = child.as_span().end();
            visit(self, Part::Child(child));
            self.rest(to);
        }
        self.own(end, &mut visit);
    }

    fn own<'i>(&mut self, end: usize, visit: &mut impl FnMut(&mut Self, Part<'i, 't>)) {
        while let Some(t) = self.source.tokens.get(self.next).filter(|t| t.start < end) {
            let before = self.next;
            visit(self, Part::Own(t.text));
            if self.next == before {
                self.token();
            }
        }
    }

    /// Emits the tokens up to byte `end`, with plain gaps.
    pub fn rest(&mut self, end: usize) {
        // The end of the source is an empty token that belongs to nobody.
        while self.source.tokens.get(self.next).is_some_and(|t| t.start < end && !t.text.is_empty()) {
            self.token();
        }
    }
}

/// The children of a node, without comments.
pub fn children(node: Node<'_>) -> impl Iterator<Item = Node<'_>> {
    node.into_inner().filter(|p| p.as_rule() != Rule::COMMENT)
}

/// The only child of a node, if it has just one.
pub fn only_child(node: Node<'_>) -> Option<Node<'_>> {
    let mut all = children(node);
    let first = all.next()?;
    all.next().is_none().then_some(first)
}

/// Whether an item's members stand in braces, on lines of their own.
fn is_braced_item(node: &Node<'_>) -> bool {
    children(node.clone()).next().is_some_and(|p| match p.as_rule() {
        Rule::mission | Rule::agent | Rule::platform | Rule::world | Rule::record | Rule::test => true,
        Rule::function => children(p).any(|c| c.as_rule() == Rule::function_body),
        _ => false,
    })
}
