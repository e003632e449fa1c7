//! Wait: runs for a duration, which is evaluated when it starts, then succeeds.
//!
//! Running before, success at the first tick at or after the end; a duration of zero succeeds at once.
//! Halt: the time begins anew.

use super::{Code, Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn wait(&mut self, node: u32, duration: Code, fresh: bool) -> Result<Status, H::Fault> {
        if fresh {
            let duration = self.host.duration(duration)?;
            self.memory.slot[node as usize] = (self.host.now() + duration).0;
        }
        let over = self.host.now().0 >= self.memory.slot[node as usize];
        Ok(if over { Status::Success } else { Status::Running })
    }
}
