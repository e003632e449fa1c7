//! Fallback: children in order until one does not fail.
//!
//! | child | result |
//! |---|---|
//! | success | success |
//! | running | running |
//! | failure | the next child is ticked; failure after the last |
//!
//! Reactive (without memory): every tick starts again at the first child, so that a better way is taken
//! as soon as it opens; when a child runs or succeeds, children to its right that are still running from
//! an earlier tick are halted.
//! With memory: a tick resumes at the child that was running.
//! Ended, it starts at the first child again.
//! Halt: the running child is halted.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn fallback(&mut self, node: u32, memory: bool, fresh: bool) -> Result<Status, H::Fault> {
        let tree = self.tree;
        let first = if memory && !fresh { self.memory.slot[node as usize] as usize } else { 0 };
        for (i, &child) in tree.children(node).iter().enumerate().skip(first) {
            match self.tick(child)? {
                Status::Failure => {}
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
        Ok(Status::Failure)
    }
}
