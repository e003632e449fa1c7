//! Code for arithmetic and comparisons.

use super::emit::error;
use super::expr::{Operand, arguments, gives};
use super::{Compiled, Compiler, Place};
use crate::{
    Binary, Expr, Op, Span, Type,
    eval::{
        code::{Instr, Space},
        widths::same_layout,
    },
    typing,
};

impl Compiler<'_> {
    #[inline(never)]
    pub(super) fn gen_binary(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let Some(t) = typing::binary(op, &l.ty, &r.ty) else {
            return error(e.span, format!("{} and {} do not go together here", l.ty, r.ty));
        };
        gives(e, &t)?;
        match op {
            Binary::And | Binary::Or => self.gen_logical(e, dest),
            Binary::Lt | Binary::Le | Binary::Gt | Binary::Ge => self.gen_compare(e.span, op, l, r, dest),
            Binary::Eq | Binary::Ne => match self.width(&l.ty, l.span)? {
                1 => self.gen_compare(e.span, op, l, r, dest),
                n => self.gen_equal(e, n, dest),
            },
            Binary::Add | Binary::Sub => self.gen_sum(e, op, dest),
            Binary::Mul | Binary::Div => self.gen_product(e, op, dest),
        }
    }

    #[inline(never)]
    pub(super) fn gen_compare(
        &mut self,
        at: Span,
        op: Binary,
        l: &Expr,
        r: &Expr,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        let top = self.body.top;
        let (a, b) = self.operands(l, r)?;
        self.body.top = top;
        let d = self.dest(dest, 1, at)?;
        let instr = match (op, a, b) {
            (op, Operand::Register(a), Operand::Constant(k)) => compare_constant(op, d, a, k),
            (op, Operand::Constant(k), Operand::Register(a)) => compare_constant(mirrored(op), d, a, k),
            (op, Operand::Register(a), Operand::Register(b)) => match op {
                Binary::Lt => Instr::Lt { d, a, b },
                Binary::Le => Instr::Le { d, a, b },
                Binary::Gt => Instr::Lt { d, a: b, b: a },
                Binary::Ge => Instr::Le { d, a: b, b: a },
                Binary::Eq => Instr::Eq { d, a, b },
                _ => Instr::Ne { d, a, b },
            },
            (op, Operand::Constant(j), Operand::Constant(k)) => {
                self.emit(Instr::Const { d, k: j }, at);
                compare_constant(op, d, d, k)
            }
        };
        self.emit(instr, at);
        Ok(Place::frame(d))
    }

    /// Both operands; the registers of the first stay while the second is computed.
    pub(super) fn operands(&mut self, l: &Expr, r: &Expr) -> Compiled<(Operand, Operand)> {
        Ok((self.operand(l)?, self.operand(r)?))
    }

    #[inline(never)]
    pub(super) fn gen_equal(&mut self, e: &Expr, n: u32, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let Ok(n) = u8::try_from(n) else {
            return error(e.span, format!("values of type {} cannot be compared", l.ty));
        };
        if !same_layout(&l.ty, &r.ty) {
            return error(e.span, format!("{} and {} cannot be compared", l.ty, r.ty));
        }
        let top = self.body.top;
        let (a, b) = (self.registers(l)?, self.registers(r)?);
        self.body.top = top;
        let d = self.dest(dest, 1, e.span)?;
        self.emit(Instr::EqN { n, d, a, b }, e.span);
        if matches!(e.op, Op::Binary(Binary::Ne)) {
            self.emit(Instr::Not { d, a: d }, e.span);
        }
        Ok(Place::frame(d))
    }

    #[inline(never)]
    pub(super) fn gen_sum(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let add = op == Binary::Add;
        if self.width(&l.ty, l.span)? > 1 {
            return self.gen_wide_sum(e, add, dest);
        }
        let top = self.body.top;
        let (a, b) = self.operands(l, r)?;
        let wraps = matches!(l.ty, Type::Heading(_));
        let whole = l.ty == Type::Int && r.ty == Type::Int;
        let (a, b) = match (a, b) {
            (Operand::Register(a), Operand::Constant(k)) if !wraps && !whole => {
                let k = if add { k } else { self.negated(k) };
                return self.finish_sum(top, dest, e.span, |d| Instr::AddK { d, a, k });
            }
            (Operand::Constant(k), Operand::Register(a)) if !wraps && !whole => {
                return self.finish_sum(top, dest, e.span, |d| match add {
                    true => Instr::AddK { d, a, k },
                    false => Instr::SubFromK { d, a, k },
                });
            }
            (a, b) => (self.loaded(a, e.span)?, self.loaded(b, e.span)?),
        };
        self.finish_sum(top, dest, e.span, |d| match (wraps, whole, add) {
            (true, _, true) => Instr::AddWrap { d, a, b },
            (true, _, false) => Instr::SubWrap { d, a, b },
            (_, true, true) => Instr::AddInt { d, a, b },
            (_, true, false) => Instr::SubInt { d, a, b },
            (_, _, true) => Instr::Add { d, a, b },
            (_, _, false) => Instr::Sub { d, a, b },
        })
    }

    /// Frees the operands and appends the instruction, which reads them before it writes.
    fn finish_sum(
        &mut self,
        top: u32,
        dest: Option<u32>,
        at: Span,
        instr: impl FnOnce(u32) -> Instr,
    ) -> Compiled<Place> {
        self.body.top = top;
        let d = self.dest(dest, 1, at)?;
        self.emit(instr(d), at);
        Ok(Place::frame(d))
    }

    /// The instruction that divides by a constant. A product is the same where the reciprocal is exact.
    fn quotient(&mut self, k: u32) -> impl FnOnce(u32, u32) -> Instr + use<> {
        let x = self.program.constants.get(k as usize).copied().unwrap_or_default();
        let power_of_two = x.is_normal() && x.to_bits() << 12 == 0 && x.recip().is_normal();
        let by = if power_of_two { self.pooled(x.recip()) } else { k };
        move |d, a| if power_of_two { Instr::MulK { d, a, k: by } } else { Instr::DivK { d, a, k: by } }
    }

    fn negated(&mut self, k: u32) -> u32 {
        let x = self.program.constants.get(k as usize).copied().unwrap_or_default();
        self.pooled(-x)
    }

    /// An operand in a register.
    fn loaded(&mut self, operand: Operand, at: Span) -> Compiled<u32> {
        match operand {
            Operand::Register(a) => Ok(a),
            Operand::Constant(k) => self.in_frame(Place { space: Space::Constants, at: k }, 1, at),
        }
    }

    /// Number of registers of a wide operand.
    fn wide(&mut self, t: &Type, at: Span) -> Compiled<u16> {
        let n = self.width(t, at)?;
        u16::try_from(n).or_else(|_| error(at, "too wide a value"))
    }

    #[inline(never)]
    pub(super) fn gen_wide_sum(&mut self, e: &Expr, add: bool, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let n = self.wide(&l.ty, l.span)?;
        if self.width(&r.ty, r.span)? != u32::from(n) {
            return error(e.span, format!("{} and {} do not go together here", l.ty, r.ty));
        }
        let d = self.dest(dest, u32::from(n), e.span)?;
        let top = self.body.top;
        let (a, b) = (self.registers(l)?, self.registers(r)?);
        self.body.top = top;
        let instr = match (n, add) {
            (3, true) => Instr::Add3 { d, a, b },
            (3, false) => Instr::Sub3 { d, a, b },
            (n, true) => Instr::AddN { n, d, a, b },
            (n, false) => Instr::SubN { n, d, a, b },
        };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    #[inline(never)]
    pub(super) fn gen_product(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let (wl, wr) = (typing::number(&l.ty).is_none(), typing::number(&r.ty).is_none());
        if wl || wr {
            return self.gen_wide_product(e, op, dest);
        }
        let top = self.body.top;
        let (a, b) = self.operands(l, r)?;
        let whole = l.ty == Type::Int && r.ty == Type::Int && op == Binary::Mul;
        let by_zero = |c: &Self, k: u32| c.program.constants.get(k as usize).is_none_or(|x| *x == 0.0);
        let (a, b) = match (op, a, b) {
            (Binary::Mul, Operand::Register(a), Operand::Constant(k))
            | (Binary::Mul, Operand::Constant(k), Operand::Register(a))
                if !whole =>
            {
                return self.finish_sum(top, dest, e.span, |d| Instr::MulK { d, a, k });
            }
            (Binary::Div, Operand::Register(a), Operand::Constant(k)) if !by_zero(self, k) => {
                let instr = self.quotient(k);
                return self.finish_sum(top, dest, e.span, |d| instr(d, a));
            }
            (_, a, b) => (self.loaded(a, e.span)?, self.loaded(b, e.span)?),
        };
        self.finish_sum(top, dest, e.span, |d| match (op, whole) {
            (Binary::Mul, true) => Instr::MulInt { d, a, b },
            (Binary::Mul, false) => Instr::Mul { d, a, b },
            _ => Instr::Div { d, a, b },
        })
    }

    #[inline(never)]
    pub(super) fn gen_wide_product(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
        let [l, r] = arguments(e)?;
        let n = self.wide(&e.ty, e.span)?;
        let d = self.dest(dest, u32::from(n), e.span)?;
        let top = self.body.top;
        let (a, b) = (self.registers(l)?, self.registers(r)?);
        self.body.top = top;
        let instr = match (op, &l.ty, &r.ty) {
            (Binary::Mul, Type::Matrix(r, n), Type::Matrix(_, c)) => {
                if *r > 8 || *n > 8 || *c > 8 {
                    return error(e.span, "matrices have at most 8 rows and columns");
                }
                Instr::MatrixProduct { r: *r, n: *n, c: *c, d, a, b }
            }
            (Binary::Mul, t, s) if typing::number(s).is_some() && same_layout(t, &e.ty) => scale(n, d, a, b),
            (Binary::Mul, s, t) if typing::number(s).is_some() && same_layout(t, &e.ty) => scale(n, d, b, a),
            (Binary::Div, t, s) if typing::number(s).is_some() && same_layout(t, &e.ty) => {
                if n == 3 {
                    Instr::Div3 { d, a, b }
                } else {
                    Instr::DivN { n, d, a, b }
                }
            }
            _ => return error(e.span, format!("{} and {} do not go together here", l.ty, r.ty)),
        };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    /// Square root, power, minus, dot product.
    #[inline(never)]
    pub(super) fn gen_arithmetic(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        if e.op == Op::Dot {
            let [l, r] = arguments(e)?;
            let Some(t) = typing::dot(&l.ty, &r.ty) else {
                return error(e.span, format!("{} and {} have no dot product", l.ty, r.ty));
            };
            gives(e, &t)?;
            let top = self.body.top;
            let (a, b) = (self.registers(l)?, self.registers(r)?);
            return self.finish_sum(top, dest, e.span, |d| Instr::Dot { d, a, b });
        }
        let [of] = arguments(e)?;
        let t = match e.op {
            Op::Sqrt => typing::sqrt(&of.ty),
            Op::Power(n) => typing::power(&of.ty, n),
            _ => typing::negate(&of.ty),
        };
        let Some(t) = t else {
            return error(e.span, format!("this cannot be done with {}", of.ty));
        };
        gives(e, &t)?;
        let n = self.wide(&t, e.span)?;
        if n > 1 {
            let d = self.dest(dest, u32::from(n), e.span)?;
            let top = self.body.top;
            let a = self.registers(of)?;
            self.body.top = top;
            self.emit(Instr::NegN { n, d, a }, e.span);
            return Ok(Place::frame(d));
        }
        let top = self.body.top;
        let a = self.scalar(of)?;
        self.finish_sum(top, dest, e.span, |d| match e.op {
            Op::Sqrt => Instr::Sqrt { d, a },
            Op::Power(n) if t == Type::Int => Instr::PowerInt { d, a, n },
            Op::Power(2) => Instr::Mul { d, a, b: a },
            Op::Power(n) => Instr::Power { d, a, n },
            _ => Instr::Neg { d, a },
        })
    }

    #[inline(never)]
    pub(super) fn gen_not(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        gives(e, &Type::Bool)?;
        let top = self.body.top;
        let a = self.scalar(of)?;
        self.finish_sum(top, dest, e.span, |d| Instr::Not { d, a })
    }
}

/// The comparison with its sides swapped.
pub(super) fn mirrored(op: Binary) -> Binary {
    match op {
        Binary::Lt => Binary::Gt,
        Binary::Le => Binary::Ge,
        Binary::Gt => Binary::Lt,
        Binary::Ge => Binary::Le,
        op => op,
    }
}

fn compare_constant(op: Binary, d: u32, a: u32, k: u32) -> Instr {
    match op {
        Binary::Lt => Instr::LtK { d, a, k },
        Binary::Le => Instr::LeK { d, a, k },
        Binary::Gt => Instr::GtK { d, a, k },
        Binary::Ge => Instr::GeK { d, a, k },
        Binary::Eq => Instr::EqK { d, a, k },
        _ => Instr::NeK { d, a, k },
    }
}

/// The values from `a` times the number at `b`.
fn scale(n: u16, d: u32, a: u32, b: u32) -> Instr {
    if n == 3 { Instr::Scale3 { d, a, b } } else { Instr::ScaleN { n, d, a, b } }
}
