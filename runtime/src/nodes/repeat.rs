//! Repeat: ticks its child again when it succeeded, so many rounds, or while a condition holds.
//!
//! | before a round | result |
//! |---|---|
//! | all rounds are done | success |
//! | the condition does not hold | success |
//!
//! | child | result |
//! |---|---|
//! | success | running, and the next round begins at the next tick; success after the last round |
//! | running | running; the condition is not tested within a round |
//! | failure | failure |
//!
//! Halt: the child is halted, and the count begins anew.

use super::{Code, Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn repeat(
        &mut self,
        node: u32,
        times: Option<u32>,
        condition: Option<Code>,
        fresh: bool,
    ) -> Result<Status, H::Fault> {
        let tree = self.tree;
        let child = tree.child(node);
        if fresh {
            self.memory.slot[node as usize] = 0;
        }
        let done = |rounds: i64| times.is_some_and(|t| rounds >= i64::from(t));
        if !self.is_running(child) {
            if done(self.memory.slot[node as usize]) {
                return Ok(Status::Success);
            }
            if let Some(c) = condition
                && !self.host.holds(c)?
            {
                return Ok(Status::Success);
            }
        }
        match self.tick(child)? {
            Status::Success => {
                let rounds = self.memory.slot[node as usize].saturating_add(1);
                self.memory.slot[node as usize] = rounds;
                Ok(if done(rounds) { Status::Success } else { Status::Running })
            }
            other => Ok(other),
        }
    }
}
