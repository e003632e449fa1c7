//! Retry: ticks its child again when it failed, so many times.
//!
//! | child | result |
//! |---|---|
//! | success | success |
//! | running | running |
//! | failure | running, and the child is started again at the next tick; failure when it has been started again `times` times |
//!
//! Halt: the child is halted, and the count begins anew.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn retry(&mut self, node: u32, times: u32, fresh: bool) -> Result<Status, H::Fault> {
        if fresh {
            self.memory.slot[node as usize] = 0;
        }
        let tree = self.tree;
        match self.tick(tree.child(node))? {
            Status::Failure if self.memory.slot[node as usize] < i64::from(times) => {
                self.memory.slot[node as usize] += 1;
                Ok(Status::Running)
            }
            other => Ok(other),
        }
    }
}
