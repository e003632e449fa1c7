//! The tokens of a source and the comments between them, cut where the parser cut them.

use crate::parse::Rule;
use pest::iterators::Pair;
use std::{collections::BTreeSet, ops::Range};

/// A token, and what stood between it and the one before.
pub struct Token<'t> {
    pub text: &'t str,
    /// First byte in the source.
    pub start: usize,
    /// Line breaks right before it, after the last comment: 0, 1 or 2 for more.
    pub breaks: u8,
    /// Comments before it, as indices.
    pub comments: Range<usize>,
}

/// A comment.
pub struct Comment<'t> {
    /// With its marks, without blanks at the end.
    pub text: &'t str,
    /// Line breaks right before it: 0, 1 or 2 for more; the source's start counts as one.
    pub breaks: u8,
    /// Whether a line break follows.
    pub ends_line: bool,
}

/// Where a comment stands.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// On lines of its own.
    Own,
    /// At the end of a line.
    Trailing,
    /// Before a token, on its line.
    Inline,
}

impl Comment<'_> {
    /// Where it stands; `at_break` when the layout always breaks the line there, `opened` when that is right
    /// after an opening bracket.
    pub fn place(&self, at_break: bool, opened: bool) -> Place {
        match (self.breaks > 0, self.ends_line) {
            (true, true) => Place::Own,
            (false, true) => Place::Trailing,
            // On one line with the members around it: it belongs to the one before, if there is one.
            (false, false) if at_break && opened => Place::Own,
            (false, false) if at_break => Place::Trailing,
            _ => Place::Inline,
        }
    }
}

/// A source as tokens; the last token is empty and stands for the end.
pub struct Source<'t> {
    pub tokens: Vec<Token<'t>>,
    pub comments: Vec<Comment<'t>>,
}

impl<'t> Source<'t> {
    /// Whether a token comes right after an opening bracket, or first.
    pub fn opened(&self, token: usize) -> bool {
        token.checked_sub(1).is_none_or(|i| matches!(self.tokens[i].text, "(" | "[" | "{"))
    }

    /// Cuts `text`, whose tree is `root`. Words and marks mean the same everywhere; where a number, a unit
    /// or a text ends only the grammar knows.
    pub fn read(root: &Pair<'t, Rule>, text: &'t str) -> Source<'t> {
        let mut r = Reader {
            text,
            at: 0,
            breaks: 1,
            first: 0,
            tokens: Vec::new(),
            comments: Vec::new(),
            closings: closings(root),
        };
        for leaf in root.clone().into_inner().flatten() {
            let rule = leaf.as_rule();
            if !matches!(
                rule,
                Rule::COMMENT
                    | Rule::ident
                    | Rule::string
                    | Rule::int
                    | Rule::number
                    | Rule::unit
                    | Rule::inverse
            ) {
                continue;
            }
            let span = leaf.as_span();
            r.plain(span.start());
            if rule == Rule::COMMENT { r.comment(span.end()) } else { r.token(span.end()) }
        }
        r.plain(text.len());
        r.token(text.len());
        if let Some(last) = r.comments.last_mut()
            && r.tokens.last().is_some_and(|end| end.comments.end > end.comments.start)
        {
            last.ends_line = true;
        }
        Source { tokens: r.tokens, comments: r.comments }
    }
}

/// Where the `>` stand that close a type: one of them and a `=` are no `>=`.
fn closings(root: &Pair<'_, Rule>) -> BTreeSet<usize> {
    let types = root.clone().into_inner().flatten().filter(|p| p.as_rule() == Rule::type_name);
    types.filter_map(|p| Some(p.as_span().start() + p.as_str().rfind('>')?)).collect()
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    breaks: u8,
    /// First comment since the last token.
    first: usize,
    tokens: Vec<Token<'t>>,
    comments: Vec<Comment<'t>>,
    closings: BTreeSet<usize>,
}

impl Reader<'_> {
    /// Cuts blanks, words and marks up to byte `end`.
    fn plain(&mut self, end: usize) {
        let bytes = self.text.as_bytes();
        while self.at < end {
            let from = self.at;
            match bytes[from] {
                b'\n' => {
                    self.breaks = (self.breaks + 1).min(2);
                    self.at += 1;
                }
                b' ' | b'\t' | b'\r' => self.at += 1,
                c if is_word(c) => {
                    let len = bytes[from..end].iter().take_while(|c| is_word(**c)).count();
                    self.token(from + len);
                }
                _ => {
                    let two = bytes[from..end].get(..2);
                    let double = matches!(two, Some(b"=>" | b"->" | b"<=" | b">=" | b"==" | b"!=" | b".."))
                        && !self.closings.contains(&from);
                    let one = self.text[from..].chars().next().map_or(1, char::len_utf8);
                    self.token(from + if double { 2 } else { one });
                }
            }
        }
    }

    fn token(&mut self, end: usize) {
        let comments = self.first..self.comments.len();
        self.mark_end_of_comment(!comments.is_empty());
        self.first = self.comments.len();
        let text = &self.text[self.at..end];
        self.tokens.push(Token { text, start: self.at, breaks: self.breaks, comments });
        self.at = end;
        self.breaks = 0;
    }

    fn comment(&mut self, end: usize) {
        self.mark_end_of_comment(self.first < self.comments.len());
        let text = self.text[self.at..end].trim_end();
        self.comments.push(Comment { text, breaks: self.breaks, ends_line: false });
        self.at = end;
        self.breaks = 0;
    }

    /// Tells the comment before, if there is one since the last token, whether its line ends.
    fn mark_end_of_comment(&mut self, there_is: bool) {
        if let (true, Some(last)) = (there_is, self.comments.last_mut()) {
            last.ends_line = self.breaks > 0;
        }
    }
}

fn is_word(c: u8) -> bool {
    c.is_ascii_alphanumeric() || c == b'_'
}
