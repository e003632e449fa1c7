//! Timeout: fails when its child runs longer than a duration, which is evaluated when it starts.
//!
//! | child | result |
//! |---|---|
//! | success | success |
//! | running | running; at the first tick later than the duration after the start the child is halted instead of ticked: failure |
//! | failure | failure |
//!
//! A child that ends at a tick exactly at the end of the duration still counts.
//! Halt: the child is halted.

use super::{Code, Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn timeout(&mut self, node: u32, limit: Code, fresh: bool) -> Result<Status, H::Fault> {
        let tree = self.tree;
        let child = tree.child(node);
        if fresh {
            let limit = self.host.duration(limit)?;
            self.memory.slot[node as usize] = (self.host.now() + limit).0;
        } else if self.host.now().0 > self.memory.slot[node as usize] {
            self.halt(child)?;
            return Ok(Status::Failure);
        }
        self.tick(child)
    }
}
