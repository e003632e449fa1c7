//! Sequence: children in order until one does not succeed.
//!
//! | child | result |
//! |---|---|
//! | success | the next child is ticked; success after the last |
//! | running | running |
//! | failure | failure |
//!
//! Reactive (without memory): every tick starts again at the first child, so that a condition further
//! left is tested again and again; when a child runs or fails, children to its right that are still
//! running from an earlier tick are halted.
//! With memory: a tick resumes at the child that was running.
//! Ended, it starts at the first child again.
//! Halt: the running child is halted.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn sequence(&mut self, node: u32, memory: bool, fresh: bool) -> Result<Status, H::Fault> {
        let tree = self.tree;
        let first = if memory && !fresh { self.memory.slot[node as usize] as usize } else { 0 };
        for (i, &child) in tree.children(node).iter().enumerate().skip(first) {
            match self.tick(child)? {
                Status::Success => {}
                other => {
                    if memory {
                        self.memory.slot[node as usize] = i as i64;
                    } else if !fresh {
                        self.halt_after(node, i)?;
                    }
                    return Ok(other);
                }
            }
        }
        Ok(Status::Success)
    }
}
