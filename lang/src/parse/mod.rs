//! Text to syntax tree. The grammar is `grammar.pest`; errors recover at the next item.

mod advice;
mod behaviour;
mod conversation;
mod cursor;
mod expr;
mod items;
mod message;
mod nesting;

use crate::{ast, code};
use pest::{Parser as _, error::InputLocation};
use soifra_graph::{Diagnostic, Span};

pub(crate) use expr::infix_power;
use grammar::Grammar;
pub(crate) use grammar::Rule;

#[allow(missing_docs, reason = "generated from the grammar, 2026-11")]
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "grammar.pest"]
    pub struct Grammar;
}

pub(crate) use cursor::Cursor;

/// Deepest nesting of brackets a source may have.
pub const MAX_NESTING: usize = 256;
/// Longest identifier, in bytes.
pub const MAX_IDENT: usize = 255;
/// Longest chain of operators in one expression.
pub const MAX_CHAIN: usize = 256;

/// What the builders share: the file they build and the errors they found.
pub(crate) struct Builder {
    pub file: u32,
    /// Where the piece begins that is read now.
    base: usize,
    pub errors: Vec<Diagnostic>,
}

/// Parses source number `file`: the tree of everything readable, and all errors.
pub fn parse(file: u32, text: &str) -> (ast::File, Vec<Diagnostic>) {
    let mut b = Builder { file, base: 0, errors: Vec::new() };
    let mut tree = ast::File::default();
    if let Err(at) = nesting::check(text) {
        let d = Diagnostic::error(code::NESTING, format!("brackets nest deeper than {MAX_NESTING}"));
        b.errors.push(
            d.at(Span::new(file, at, at + 1), "the bracket that is too many")
                .hint("give inner parts names with `let`, or move them into functions"),
        );
        return (tree, b.errors);
    }
    b.file(text, &mut tree);
    (tree, b.errors)
}

/// Whether a text is a sequence of items, by the grammar alone: what [`parse`] costs at least.
pub fn recognise(text: &str) -> bool {
    Grammar::parse(Rule::file, text).is_ok()
}

/// The parse tree of a text; `None` when its syntax is wrong, which [`parse`] explains.
pub(crate) fn tree(text: &str) -> Option<pest::iterators::Pair<'_, Rule>> {
    nesting::check(text).ok()?;
    let root = Grammar::parse(Rule::file, text).ok()?.next()?;
    root.clone().into_inner().all(|p| p.as_rule() != Rule::junk).then_some(root)
}

impl Builder {
    fn file(&mut self, text: &str, tree: &mut ast::File) {
        let mut next = Rule::head;
        // Begin and end of the item before, when it is among the items.
        let mut before = None;
        // Behind the last piece there is nothing to read.
        while let Some(root) = Grammar::parse(next, &text[self.base..]).ok().and_then(|mut p| p.next()) {
            let length = root.as_span().end();
            self.piece(text, root, &mut before, tree);
            self.base += length;
            next = Rule::piece;
        }
    }

    fn piece(
        &mut self,
        text: &str,
        root: pest::iterators::Pair<'_, Rule>,
        before: &mut Option<(usize, usize)>,
        tree: &mut ast::File,
    ) {
        for pair in root.into_inner() {
            match pair.as_rule() {
                Rule::edition => {
                    let span = self.span(&pair);
                    let mut c = Cursor::new(pair);
                    let n = self.int(&mut c);
                    tree.edition = Some((n, span));
                }
                Rule::import => {
                    *before = None;
                    tree.imports.push(self.import(pair));
                }
                Rule::item => {
                    let place = (self.base + pair.as_span().start(), self.base + end(&pair));
                    *before = None;
                    if let Some(inner) = pair.into_inner().find(|p| p.as_rule() != Rule::COMMENT)
                        && let Some(item) = self.item(inner)
                    {
                        tree.items.push(item);
                        *before = Some(place);
                    }
                }
                Rule::junk => {
                    let mut from = self.base + pair.as_span().start();
                    // What follows on the line of an item is the rest of it: it was not understood whole.
                    if let Some((start, end)) = before.take()
                        && !text[end..from].contains('\n')
                        && Grammar::parse(Rule::ITEM_START, &text[from..]).is_err()
                    {
                        tree.items.pop();
                        from = start;
                    }
                    self.junk(&text[from..self.base + pair.as_span().end()], from, tree);
                }
                _ => {}
            }
        }
    }

    /// Something between items that is none: parsed again by itself, for pest's own error.
    fn junk(&mut self, text: &str, at: usize, tree: &mut ast::File) {
        tree.unread.push(Span::new(self.file, at, at + text.len()));
        // A damaged import is explained as one, a whole one stands in the wrong place.
        let is_import = Grammar::parse(Rule::K_IMPORT, text).is_ok();
        let damaged = is_import.then(|| Grammar::parse(Rule::import, text).err()).flatten();
        let e = match damaged.map_or_else(|| Grammar::parse(Rule::item_alone, text), Err) {
            Err(e) => message::syntax(self.file, at, text, &e),
            // Readable alone but not where it stands: an edition or import after the items, say.
            Ok(_) => Diagnostic::error(code::SYNTAX, "this cannot stand here")
                .at(Span::new(self.file, at, at + text.trim_end().len().min(40)), "unexpected here"),
        };
        self.errors.push(e);
    }

    pub fn span(&self, pair: &pest::iterators::Pair<'_, Rule>) -> Span {
        Span::new(self.file, self.base + pair.as_span().start(), self.base + end(pair))
    }

    pub fn ident(&mut self, c: &mut Cursor<'_>) -> ast::Ident {
        match c.take(Rule::ident) {
            Some(p) => self.name(&p),
            None => ast::Ident { name: "?".into(), span: Span::new(self.file, 0, 0) },
        }
    }

    pub fn name(&mut self, p: &pest::iterators::Pair<'_, Rule>) -> ast::Ident {
        let (span, text) = (self.span(p), p.as_str());
        if text.len() > MAX_IDENT {
            self.errors.push(
                Diagnostic::error(code::LONG_NAME, format!("a name of {} bytes is too long", text.len()))
                    .at(
                        Span { end: span.start + 32, ..span },
                        format!("names have at most {MAX_IDENT} bytes"),
                    )
                    .hint("choose a shorter name"),
            );
            return ast::Ident { name: text[..32].into(), span };
        }
        ast::Ident { name: text.into(), span }
    }

    pub fn int(&mut self, c: &mut Cursor<'_>) -> i64 {
        let Some(p) = c.take(Rule::int) else { return 0 };
        p.as_str().parse().ok().filter(|n: &i64| *n <= 1 << 53).unwrap_or_else(|| {
            self.errors.push(
                Diagnostic::error(code::NUMBER_RANGE, "this number is too large")
                    .at(self.span(&p), "whole numbers go to 9007199254740992")
                    .hint("write a smaller number"),
            );
            0
        })
    }
}

/// Where an error is.
pub(crate) fn offset(e: &pest::error::Error<Rule>) -> usize {
    match e.location {
        InputLocation::Pos(p) => p,
        InputLocation::Span((a, _)) => a,
    }
}

/// Where a pair ends: blanks and comments after its last token belong to what comes next.
fn end(pair: &pest::iterators::Pair<'_, Rule>) -> usize {
    let (start, text) = (pair.as_span().start(), pair.as_str().trim_end());
    let last_line = &text[text.rfind('\n').map_or(0, |i| i + 1)..];
    if !text.ends_with("*/") && !last_line.contains("//") {
        return start + text.len();
    }
    let mut kept = text.len();
    for inner in pair.clone().into_inner().rev() {
        let span = inner.as_span();
        if span.end() < start + kept {
            break;
        }
        if inner.as_rule() != Rule::COMMENT {
            return end(&inner);
        }
        kept = text[..span.start().saturating_sub(start).min(text.len())].trim_end().len();
    }
    start + kept
}

/// The text of a string literal without its quotes.
pub(crate) fn unquote(s: &str) -> String {
    s.trim_matches('"').to_string()
}
