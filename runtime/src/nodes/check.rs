//! Check: a condition.
//!
//! Success when it holds, else failure; never running, so there is nothing to halt.

use super::{Code, Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    #[inline(always)]
    pub(super) fn check(&mut self, condition: Code) -> Result<Status, H::Fault> {
        Ok(if self.host.holds(condition)? { Status::Success } else { Status::Failure })
    }
}
