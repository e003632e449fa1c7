//! Invert: turns success into failure and failure into success.
//!
//! | child | result |
//! |---|---|
//! | success | failure |
//! | running | running |
//! | failure | success |
//!
//! Halt: the child is halted.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn invert(&mut self, node: u32) -> Result<Status, H::Fault> {
        let tree = self.tree;
        Ok(match self.tick(tree.child(node))? {
            Status::Success => Status::Failure,
            Status::Failure => Status::Success,
            other => other,
        })
    }
}
