//! Act: statements.
//!
//! At every tick the prelude is evaluated first, then:
//!
//! | | result |
//! |---|---|
//! | `until` holds | success; the body does not run |
//! | else `fails` holds | failure; the body does not run |
//! | else, with `until` | the body runs: running |
//! | else, without `until` | the body runs: success |
//!
//! Halt: the prelude is evaluated, then the halt statements run. An act that has ended is not halted.

use super::{Host, Status, Ticker};

impl<H: Host> Ticker<'_, H> {
    pub(super) fn act(&mut self, act: u32) -> Result<Status, H::Fault> {
        let act = self.tree.act(act);
        if let Some(prelude) = act.prelude {
            self.host.run(prelude)?;
        }
        if let Some(until) = act.until
            && self.host.holds(until)?
        {
            return Ok(Status::Success);
        }
        if let Some(fails) = act.fails
            && self.host.holds(fails)?
        {
            return Ok(Status::Failure);
        }
        if let Some(body) = act.body {
            self.host.run(body)?;
        }
        Ok(if act.until.is_some() { Status::Running } else { Status::Success })
    }

    pub(super) fn halt_act(&mut self, act: u32) -> Result<(), H::Fault> {
        let act = self.tree.act(act);
        if let Some(halt) = act.halt {
            if let Some(prelude) = act.prelude {
                self.host.run(prelude)?;
            }
            self.host.run(halt)?;
        }
        Ok(())
    }
}
