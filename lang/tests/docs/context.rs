//! Where fragments stand: the block `soi context` of the reference, which has a comment line
//! `// soi KIND` for each kind of fragment.

use super::blocks::{self, Block};

/// The text of a fragment, put into its place, and the lines before it.
pub fn wrap(reference: &str, block: &Block, fragment: &str) -> (String, usize) {
    let context = blocks::of(reference, "soi").into_iter().find(|b| b.kind() == "context");
    let context = context.expect("the reference has a block `soi context`").text;
    let place = format!("// soi {}\n", block.kind());
    let at = context
        .find(&place)
        .unwrap_or_else(|| panic!("line {}: no context for `{}`", block.line, block.kind()));
    let before = &context[..at];
    let text = format!("{before}\n{fragment}\n{}", &context[at + place.len()..]);
    (text, before.matches('\n').count() + 1)
}
