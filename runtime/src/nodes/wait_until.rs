//! Wait until: runs until a condition holds, then succeeds.
//!
//! Success at the first tick at which it holds, which may be the one that starts it; else running.
//! Halt: nothing to do.

use super::{Code, Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn wait_until(&mut self, condition: Code) -> Result<Status, H::Fault> {
        Ok(if self.host.holds(condition)? { Status::Success } else { Status::Running })
    }
}
