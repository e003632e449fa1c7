//! Registers, instructions, constants: what all code is made with.

use super::{Compiled, Compiler, Place};
use crate::{
    Conjunct, Expr, Span, Type,
    eval::{
        CompileError, MAX_FRAME,
        code::{Instr, Space},
    },
};

impl Compiler<'_> {
    /// Registers of a type.
    pub(super) fn width(&mut self, t: &Type, at: Span) -> Compiled<u32> {
        self.widths.width(t).or_else(|text| error(at, text))
    }

    /// Free registers.
    pub(super) fn alloc(&mut self, n: u32, at: Span) -> Compiled<u32> {
        let d = self.body.top;
        if d as usize + n as usize > MAX_FRAME {
            return error(at, "the values here take too many registers");
        }
        self.body.top = d + n;
        self.body.peak = self.body.peak.max(self.body.top);
        Ok(d)
    }

    /// The registers wanted, or free ones.
    pub(super) fn dest(&mut self, dest: Option<u32>, n: u32, at: Span) -> Compiled<u32> {
        dest.map_or_else(|| self.alloc(n, at), Ok)
    }

    /// Appends an instruction.
    pub(super) fn emit(&mut self, instr: Instr, at: Span) {
        self.program.code.push(instr);
        self.program.spans.push(at);
        self.body.cost = self.body.cost.saturating_add(1);
    }

    /// The next instruction.
    pub(super) fn here(&self) -> u32 {
        self.program.code.len() as u32
    }

    /// Appends a jump whose target is set by [`Compiler::land`].
    pub(super) fn jump(&mut self, instr: Instr, jumps: &mut Vec<u32>, at: Span) {
        jumps.push(self.here());
        self.emit(instr, at);
    }

    /// Lets jumps come here.
    pub(super) fn land(&mut self, jumps: &[u32]) {
        let here = self.here();
        for j in jumps {
            if let Some(to) = self.program.code.get_mut(*j as usize).and_then(Instr::target) {
                *to = here;
            }
        }
    }

    /// Index of a constant in the pool.
    pub(super) fn pooled(&mut self, x: f64) -> u32 {
        let constants = &mut self.program.constants;
        *self.pool.entry(x.to_bits()).or_insert_with(|| {
            constants.push(x);
            (constants.len() - 1) as u32
        })
    }

    /// Sets a register to a constant.
    pub(super) fn constant_into(&mut self, d: u32, x: f64, at: Span) {
        let k = self.pooled(x);
        self.emit(Instr::Const { d, k }, at);
    }

    /// Copies a value of `n` registers to `d`, unless it is there.
    pub(super) fn copy(&mut self, place: Place, d: u32, n: u32, at: Span) {
        let Place { space, at: from } = place;
        if n == 0 || place == Place::frame(d) {
            return;
        }
        let instr = match (space, n) {
            (Space::Frame, 1) => Instr::Move { d, a: from },
            (Space::Frame, 3) => Instr::Move3 { d, a: from },
            (Space::Constants, 1) => Instr::Const { d, k: from },
            (Space::States, 1) => Instr::LoadState { d, at: from },
            (_, 1) => Instr::Load { space, d, at: from },
            _ => Instr::Copy { space, d, at: from, n },
        };
        self.emit(instr, at);
    }

    /// The value where it is wanted, or where it is when nobody cares.
    pub(super) fn settle(&mut self, place: Place, dest: Option<u32>, n: u32, at: Span) -> Place {
        match dest {
            Some(d) => {
                self.copy(place, d, n, at);
                Place::frame(d)
            }
            None => place,
        }
    }

    /// First register of a value, which is loaded when it is not in the frame.
    pub(super) fn in_frame(&mut self, place: Place, n: u32, at: Span) -> Compiled<u32> {
        if place.space == Space::Frame {
            return Ok(place.at);
        }
        let d = self.alloc(n, at)?;
        self.copy(place, d, n, at);
        Ok(d)
    }

    /// Zeroes what a value of type `t` does not use.
    pub(super) fn tidy(&mut self, a: u32, t: &Type, at: Span) -> Compiled<()> {
        let shape = self.widths.shape(t).or_else(|text| error(at, text))?;
        if let Some(shape) = shape {
            let index = self.program.shapes.iter().position(|s| *s == shape).unwrap_or_else(|| {
                self.program.shapes.push(shape);
                self.program.shapes.len() - 1
            });
            self.emit(Instr::Tidy { a, shape: index as u32 }, at);
        }
        Ok(())
    }

    /// Type of a local.
    pub(super) fn local(&self, index: u32, at: Span) -> Compiled<(u32, Type)> {
        match self.body.locals.get(index as usize) {
            Some((register, t)) => Ok((*register, t.clone())),
            None => error(at, format!("there is no local {index}")),
        }
    }
}

/// A refusal.
#[cold]
pub(super) fn error<T>(at: Span, text: impl Into<String>) -> Compiled<T> {
    Err(Box::new(CompileError::new(at, text)))
}

impl Conjunct {
    /// The expression that is evaluated.
    pub(super) fn expr(&self) -> &Expr {
        match self {
            Conjunct::Holds(e) | Conjunct::Binds(_, e) => e,
        }
    }
}

impl Instr {
    /// The target, when this is a jump.
    fn target(&mut self) -> Option<&mut u32> {
        match self {
            Instr::Jump { to }
            | Instr::JumpIf { to, .. }
            | Instr::JumpUnless { to, .. }
            | Instr::JumpLt { to, .. }
            | Instr::JumpLe { to, .. }
            | Instr::JumpEq { to, .. }
            | Instr::JumpNe { to, .. }
            | Instr::JumpLtK { to, .. }
            | Instr::JumpLeK { to, .. }
            | Instr::JumpGtK { to, .. }
            | Instr::JumpGeK { to, .. }
            | Instr::JumpEqK { to, .. }
            | Instr::JumpNeK { to, .. }
            | Instr::RobotFirst { to, .. }
            | Instr::RobotNext { to, .. }
            | Instr::ListFirst { to, .. }
            | Instr::ListFirst3 { to, .. }
            | Instr::ListNext { to, .. }
            | Instr::ListNext3 { to, .. } => Some(to),
            _ => None,
        }
    }
}
