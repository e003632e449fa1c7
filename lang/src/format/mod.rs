//! The canonical layout of a source.
//!
//! The output depends on the tokens, on the comments and on where the author left blank lines; never on
//! the input's indentation or line breaks. Tokens and comments stay, and stay in order, so formatting
//! cannot change a meaning.
//!
//! - Lines have up to [`WIDTH`] columns, indented by two spaces a level; the brace of a block ends the line
//!   that opens it.
//! - One member, statement, state, arm, entry or record field a line. One blank line is kept between them
//!   where the author left any; items in braces always have one around them.
//! - A block stays on one line when it fits, holds a single plain statement (or sub-goal, or leaf of a
//!   plan) and belongs to a guard, an arm, a transition, `on enter`, `on exit`, a goal or a plan
//!   node. Enumerations stay on one line when they fit. All other blocks are broken.
//! - A list in brackets that does not fit has one part a line; a list of plain numbers is filled.
//! - A value that does not fit beside its `=`, `=>` or keyword moves to the next line, indented; but a list,
//!   a `match`, or a call whose arguments all have names stays and is broken inside its brackets, and calls
//!   on each other stay and go one a line, each before its `.`.
//! - Operators break before, loosest first. A guard's own continuation lines are indented twice, so that
//!   they stand apart from what it guards.
//! - A comment on its own line stays so, at the indentation of what follows; one that ends a line stays
//!   there, two spaces after it, and does not count for the width.

mod behaviour;
mod build;
mod items;
mod measure;
mod print;
mod tokens;
mod values;

use soifra_graph::Diagnostic;

/// Columns of a line.
pub const WIDTH: usize = 100;
/// Columns of a level of indentation.
const STEP: usize = 2;

/// Lays out a source anew; the errors when its syntax is wrong.
///
/// Names, types and units need not be known: what is formatted need not be a valid mission yet.
pub fn format(text: &str) -> Result<String, Vec<Diagnostic>> {
    let Some(root) = crate::parse::tree(text) else { return Err(crate::parse::parse(0, text).1) };
    let source = tokens::Source::read(&root, text);
    let ops = build::Builder::new(&source).file(root);
    Ok(print::print(&source, &ops))
}
