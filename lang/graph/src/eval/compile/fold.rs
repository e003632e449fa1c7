//! What depends on nothing is computed here, once, and its code is taken back.

use super::{Compiled, Compiler, Place};
use crate::{
    Expr, Span, Type,
    eval::{
        Memory, NoEnv,
        code::{Instr, Space},
        run::Machine,
    },
};

/// Widest constant that is folded, and most registers a folded expression may need.
const FOLD_WIDTH: u32 = 4096;
const FOLD_FRAME: u32 = 1 << 16;

impl Compiler<'_> {
    /// The value of constant code from `start` instead of that code, when it has one.
    #[inline(never)]
    pub(super) fn folded(
        &mut self,
        e: &Expr,
        start: u32,
        place: Place,
        cost: u64,
        top: u32,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        match self.fold(&e.ty, start, place, e.span) {
            Some(folded) => {
                self.body.cost = cost;
                self.body.top = top;
                let n = self.width(&e.ty, e.span)?;
                Ok(self.settle(folded, dest, n, e.span))
            }
            None => Ok(place),
        }
    }

    /// Runs the code from `start`, which depends on nothing, and takes it back for its value. When it
    /// faults it stays: the fault belongs to the run.
    #[inline(never)]
    fn fold(&mut self, t: &Type, start: u32, place: Place, at: Span) -> Option<Place> {
        let n = self.width(t, at).ok()?;
        if n > FOLD_WIDTH || self.body.peak > FOLD_FRAME {
            return None;
        }
        let from = match place.space {
            Space::Frame => place.at as usize,
            _ => return None,
        };
        self.program.code.push(Instr::End);
        self.program.spans.push(at);
        if self.scratch.len() < self.body.peak as usize {
            self.scratch.resize(self.body.peak as usize, 0.0);
        }
        let mut memory = Memory { states: &mut [], arguments: &[], params: &[] };
        let ran = self.program.execute(
            start as usize,
            &mut self.scratch,
            &mut Machine::new(&mut memory, &mut NoEnv),
        );
        self.program.code.pop();
        self.program.spans.pop();
        ran.ok()?;
        let shape = self.widths.shape(t).ok()?;
        let value = self.scratch.get_mut(from..from + n as usize)?;
        if let Some(shape) = shape {
            shape.tidy(value).ok()?;
        }
        self.program.code.truncate(start as usize);
        self.program.spans.truncate(start as usize);
        if let [x] = value {
            let x = *x;
            return Some(Place { space: Space::Constants, at: self.pooled(x) });
        }
        let k = self.program.constants.len() as u32;
        self.program.constants.extend_from_slice(value);
        Some(Place { space: Space::Constants, at: k })
    }
}
