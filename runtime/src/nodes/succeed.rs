//! Succeed: failure becomes success.
//!
//! | child | result |
//! |---|---|
//! | success | success |
//! | running | running |
//! | failure | success |
//!
//! Halt: the child is halted.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn succeed(&mut self, node: u32) -> Result<Status, H::Fault> {
        let tree = self.tree;
        Ok(match self.tick(tree.child(node))? {
            Status::Failure => Status::Success,
            other => other,
        })
    }
}
