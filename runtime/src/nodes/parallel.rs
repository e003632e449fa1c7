//! Parallel: all children at every tick, until enough succeeded.
//!
//! | children | result |
//! |---|---|
//! | at least `successes` have succeeded | success; those that are running are halted |
//! | so many have failed that `successes` cannot be reached | failure; those that are running are halted |
//! | otherwise | running |
//!
//! A child that has ended is not ticked again before the parallel has ended. All children that are still
//! running are ticked before the result is decided, from left to right; success is decided before failure.
//! Halt: all running children are halted, from left to right.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn parallel(&mut self, node: u32, successes: u32, fresh: bool) -> Result<Status, H::Fault> {
        let tree = self.tree;
        let children = tree.children(node);
        if fresh {
            for &child in children {
                self.memory.status[child as usize] &= !3;
            }
        }
        let (mut succeeded, mut failed) = (0, 0);
        for &child in children {
            let mut status = self.memory.status[child as usize] & 3;
            if status < Status::Success as u8 {
                let result = self.tick(child)?;
                status = result as u8;
                // The low bits keep the result until the parallel ends.
                self.memory.status[child as usize] |= status;
            }
            succeeded += u32::from(status == Status::Success as u8);
            failed += u32::from(status == Status::Failure as u8);
        }
        let result = if succeeded >= successes {
            Status::Success
        } else if children.len() as u32 - failed < successes {
            Status::Failure
        } else {
            return Ok(Status::Running);
        };
        for &child in children {
            self.halt(child)?;
        }
        Ok(result)
    }
}
