//! Code for everything that branches.

use super::arithmetic::mirrored;
use super::emit::error;
use super::expr::{Operand, arguments, gives};
use super::{Compiled, Compiler, MAX_DEPTH, Place};
use crate::{
    Binary, Expr, Op, Span, Type,
    eval::{code::Instr, widths::same_layout},
    typing,
};

impl Compiler<'_> {
    /// A truth value by jumps.
    #[inline(never)]
    pub(super) fn gen_logical(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let d = self.dest(dest, 1, e.span)?;
        let top = self.body.top;
        let (mut fails, mut end) = (Vec::new(), Vec::new());
        self.branch(e, false, &mut fails)?;
        self.constant_into(d, 1.0, e.span);
        self.jump(Instr::Jump { to: 0 }, &mut end, e.span);
        self.land(&fails);
        self.constant_into(d, 0.0, e.span);
        self.land(&end);
        self.body.top = top;
        Ok(Place::frame(d))
    }

    /// Code that jumps when the truth value of `e` is `when`, and falls through otherwise.
    pub(super) fn branch(&mut self, e: &Expr, when: bool, jumps: &mut Vec<u32>) -> Compiled<()> {
        if self.body.depth >= MAX_DEPTH {
            return error(e.span, "this nests too deep");
        }
        self.body.depth += 1;
        let top = self.body.top;
        self.branch_within(e, when, jumps)?;
        self.body.top = top;
        self.body.depth -= 1;
        Ok(())
    }

    #[inline(never)]
    fn branch_within(&mut self, e: &Expr, when: bool, jumps: &mut Vec<u32>) -> Compiled<()> {
        match (&e.op, e.args.as_slice()) {
            (Op::Not, [of]) => return self.branch(of, !when, jumps),
            (Op::Call(f), _) if self.branch_call(e, *f, when, jumps)? => return Ok(()),
            (Op::Binary(op @ (Binary::And | Binary::Or)), [l, r]) => {
                // `and` is decided by a false side, `or` by a true one.
                if when == (*op == Binary::Or) {
                    self.branch(l, when, jumps)?;
                    return self.perhaps(|c| c.branch(r, when, jumps));
                }
                let mut decided = Vec::new();
                self.branch(l, !when, &mut decided)?;
                self.perhaps(|c| c.branch(r, when, jumps))?;
                self.land(&decided);
                return Ok(());
            }
            (Op::Binary(op), [l, r]) if self.compares(*op, l, r)? => {
                let (a, b) = self.operands(l, r)?;
                let op = if when { *op } else { opposite(*op) };
                let instr = match (a, b) {
                    (Operand::Register(a), Operand::Constant(k)) => jump_constant(op, a, k),
                    (Operand::Constant(k), Operand::Register(a)) => jump_constant(mirrored(op), a, k),
                    (Operand::Register(a), Operand::Register(b)) => match op {
                        Binary::Lt => Instr::JumpLt { a, b, to: 0 },
                        Binary::Le => Instr::JumpLe { a, b, to: 0 },
                        Binary::Gt => Instr::JumpLt { a: b, b: a, to: 0 },
                        Binary::Ge => Instr::JumpLe { a: b, b: a, to: 0 },
                        Binary::Eq => Instr::JumpEq { a, b, to: 0 },
                        _ => Instr::JumpNe { a, b, to: 0 },
                    },
                    (Operand::Constant(j), Operand::Constant(k)) => {
                        let a = self.alloc(1, e.span)?;
                        self.emit(Instr::Const { d: a, k: j }, e.span);
                        jump_constant(op, a, k)
                    }
                };
                self.jump(instr, jumps, e.span);
                return Ok(());
            }
            _ => {}
        }
        // This level is counted again.
        self.body.depth -= 1;
        let operand = self.operand(e)?;
        self.body.depth += 1;
        match operand {
            Operand::Constant(k) => {
                let holds = self.program.constants.get(k as usize).is_some_and(|x| *x != 0.0);
                if holds == when {
                    self.jump(Instr::Jump { to: 0 }, jumps, e.span);
                }
            }
            Operand::Register(a) if when => self.jump(Instr::JumpIf { a, to: 0 }, jumps, e.span),
            Operand::Register(a) => self.jump(Instr::JumpUnless { a, to: 0 }, jumps, e.span),
        }
        Ok(())
    }

    /// Whether this is a comparison of single registers.
    fn compares(&mut self, op: Binary, l: &Expr, r: &Expr) -> Compiled<bool> {
        use Binary as B;
        Ok(matches!(op, B::Lt | B::Le | B::Gt | B::Ge | B::Eq | B::Ne)
            && typing::binary(op, &l.ty, &r.ty).is_some()
            && self.width(&l.ty, l.span)? == 1)
    }

    #[inline(never)]
    pub(super) fn gen_if(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let [condition, then, otherwise] = arguments(e)?;
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let (mut fails, mut end) = (Vec::new(), Vec::new());
        self.branch(condition, false, &mut fails)?;
        let before = self.body.cost;
        self.perhaps(|c| c.gen_as(then, &e.ty, Some(d)))?;
        self.jump(Instr::Jump { to: 0 }, &mut end, e.span);
        let first = std::mem::replace(&mut self.body.cost, before);
        self.body.top = top;
        self.land(&fails);
        self.perhaps(|c| c.gen_as(otherwise, &e.ty, Some(d)))?;
        self.body.cost = self.body.cost.max(first);
        self.body.top = top;
        self.land(&end);
        Ok(Place::frame(d))
    }

    #[inline(never)]
    pub(super) fn gen_let(&mut self, e: &Expr, local: u32, dest: Option<u32>) -> Compiled<Place> {
        let [value, body] = arguments(e)?;
        let (_, t) = self.local(local, e.span)?;
        gives(e, &body.ty)?;
        let place = self.gen_as(value, &t, None)?;
        self.with_bound(local, Some(place), |c| c.generate(body, dest))
    }

    #[inline(never)]
    pub(super) fn gen_if_some(
        &mut self,
        e: &Expr,
        local: u32,
        reason: Option<u32>,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        let [value, then, otherwise] = arguments(e)?;
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let (place, tag) = self.optional(value, local)?;
        let (mut absent, mut end) = (Vec::new(), Vec::new());
        self.jump(Instr::JumpIf { a: tag, to: 0 }, &mut absent, e.span);
        let before = self.body.cost;
        self.perhaps(|c| c.with_bound(local, Some(place.plus(1)), |c| c.gen_as(then, &e.ty, Some(d))))?;
        self.jump(Instr::Jump { to: 0 }, &mut end, e.span);
        let first = std::mem::replace(&mut self.body.cost, before);
        self.land(&absent);
        self.perhaps(|c| match reason {
            None => c.gen_as(otherwise, &e.ty, Some(d)),
            Some(r) => {
                let text = c.reason(r, tag, e.span)?;
                c.with_bound(r, Some(Place::frame(text)), |c| c.gen_as(otherwise, &e.ty, Some(d)))
            }
        })?;
        self.body.cost = self.body.cost.max(first);
        self.body.top = top;
        self.land(&end);
        Ok(Place::frame(d))
    }

    /// Code for an optional whose value a local is to hold: its place, and the register of its tag.
    pub(super) fn optional(&mut self, value: &Expr, local: u32) -> Compiled<(Place, u32)> {
        let Type::Option(inner) = &value.ty else {
            return error(value.span, format!("an optional is wanted here, not {}", value.ty));
        };
        let (_, t) = self.local(local, value.span)?;
        if !same_layout(inner, &t) {
            return error(value.span, format!("the local is {t}, the value is {inner}"));
        }
        let place = self.generate(value, None)?;
        let tag = self.in_frame(place, 1, value.span)?;
        Ok((place, tag))
    }

    /// The reason of an absent optional as a `Text` in a register.
    pub(super) fn reason(&mut self, local: u32, tag: u32, at: Span) -> Compiled<u32> {
        let (_, t) = self.local(local, at)?;
        if t != Type::Text {
            return error(at, "a reason is a Text");
        }
        let (d, k) = (self.alloc(1, at)?, self.pooled(-1.0));
        self.emit(Instr::AddK { d, a: tag, k }, at);
        Ok(d)
    }

    #[inline(never)]
    pub(super) fn gen_switch(
        &mut self,
        e: &Expr,
        variants: &[u32],
        rest: bool,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        if e.args.len() != 1 + variants.len() + usize::from(rest) {
            return error(e.span, "a switch has one body a variant");
        }
        let Some((value, bodies)) = e.args.split_first() else {
            return error(e.span, "a switch needs a value");
        };
        self.check_variants(value, variants)?;
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let a = self.scalar(value)?;
        let kept = self.body.top;
        let (mut end, before) = (Vec::new(), self.body.cost);
        let mut most = before;
        for (i, body) in bodies.iter().enumerate() {
            let mut other = Vec::new();
            if let Some(v) = variants.get(i) {
                let k = self.pooled(f64::from(*v));
                self.jump(Instr::JumpNeK { a, k, to: 0 }, &mut other, e.span);
            }
            self.perhaps(|c| c.gen_as(body, &e.ty, Some(d)))?;
            self.jump(Instr::Jump { to: 0 }, &mut end, e.span);
            most = most.max(self.body.cost);
            self.body.cost = before.saturating_add(i as u64 + 1);
            self.body.top = kept;
            self.land(&other);
        }
        if !rest {
            self.emit(Instr::Fail, e.span);
        }
        self.body.cost = self.body.cost.max(most);
        self.body.top = top;
        self.land(&end);
        Ok(Place::frame(d))
    }

    /// Refuses what is no enum, and variants it does not have.
    pub(super) fn check_variants(&self, value: &Expr, variants: &[u32]) -> Compiled<()> {
        let Type::Enum(name) = &value.ty else {
            return error(value.span, format!("an enum is wanted here, not {}", value.ty));
        };
        let count = self.widths.table.enums.get(name).map_or(0, |e| e.variants.len());
        match variants.iter().find(|v| **v as usize >= count) {
            Some(v) => error(value.span, format!("the enum `{name}` has no variant {v}")),
            None => Ok(()),
        }
    }
}

/// The comparison that holds when this one does not; numbers are finite.
fn opposite(op: Binary) -> Binary {
    match op {
        Binary::Lt => Binary::Ge,
        Binary::Le => Binary::Gt,
        Binary::Gt => Binary::Le,
        Binary::Ge => Binary::Lt,
        Binary::Eq => Binary::Ne,
        _ => Binary::Eq,
    }
}

fn jump_constant(op: Binary, a: u32, k: u32) -> Instr {
    match op {
        Binary::Lt => Instr::JumpLtK { a, k, to: 0 },
        Binary::Le => Instr::JumpLeK { a, k, to: 0 },
        Binary::Gt => Instr::JumpGtK { a, k, to: 0 },
        Binary::Ge => Instr::JumpGeK { a, k, to: 0 },
        Binary::Eq => Instr::JumpEqK { a, k, to: 0 },
        _ => Instr::JumpNeK { a, k, to: 0 },
    }
}
