//! Code for operators and for everything that branches.

use super::MAX_ROBOTS;
use super::code::{Instr, Space};
use super::compile::{Compiled, Compiler, MAX_DEPTH, Place, error};
use super::compile_expr::{Operand, arguments, gives};
use super::widths::same_layout;
use crate::{Binary, Expr, Quantifier, Span, Type, expr::Op, typing};

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

    /// A truth value by jumps.
    #[inline(never)]
    fn gen_logical(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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

    #[inline(never)]
    fn gen_compare(
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
    fn operands(&mut self, l: &Expr, r: &Expr) -> Compiled<(Operand, Operand)> {
        Ok((self.operand(l)?, self.operand(r)?))
    }

    #[inline(never)]
    fn gen_equal(&mut self, e: &Expr, n: u32, dest: Option<u32>) -> Compiled<Place> {
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
    fn gen_sum(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
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
    fn gen_wide_sum(&mut self, e: &Expr, add: bool, dest: Option<u32>) -> Compiled<Place> {
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
    fn gen_product(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
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
                return self.finish_sum(top, dest, e.span, |d| Instr::DivK { d, a, k });
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
    fn gen_wide_product(&mut self, e: &Expr, op: Binary, dest: Option<u32>) -> Compiled<Place> {
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
            (Binary::Mul, t, s) if typing::number(s).is_some() && same_layout(t, &e.ty) => {
                Instr::ScaleN { n, d, a, b }
            }
            (Binary::Mul, s, t) if typing::number(s).is_some() && same_layout(t, &e.ty) => {
                Instr::ScaleN { n, d, a: b, b: a }
            }
            (Binary::Div, t, s) if typing::number(s).is_some() && same_layout(t, &e.ty) => {
                Instr::DivN { n, d, a, b }
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

    #[inline(never)]
    pub(super) fn gen_quantified(&mut self, e: &Expr, q: Quantifier, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        gives(e, &Type::NUMBER)?;
        gives(of, &Type::NUMBER)?;
        self.body.variable += 1;
        let at = e.span;
        let d = self.dest(dest, 1, at)?;
        let top = self.body.top;
        let state = self.alloc(3, at)?;
        let start = match q {
            Quantifier::Each => 1.0,
            Quantifier::Least => f64::MAX,
            Quantifier::Most => f64::MIN,
            _ => 0.0,
        };
        self.fetch_for_loop(of);
        self.constant_into(d, start, at);
        let (mut out, mut end) = (Vec::new(), Vec::new());
        self.jump(Instr::RobotFirst { q: state, to: 0 }, &mut out, at);
        let (body, before) = (self.here(), self.body.cost);
        let nested = std::mem::replace(&mut self.body.in_loop, true);
        let mut next = Vec::new();
        match q {
            Quantifier::Each => self.branch(of, false, &mut end)?,
            Quantifier::Some => self.branch(of, true, &mut end)?,
            Quantifier::Count => {
                self.branch(of, false, &mut next)?;
                let k = self.pooled(1.0);
                self.emit(Instr::AddK { d, a: d, k }, at);
            }
            _ => {
                let b = self.scalar(of)?;
                self.emit(
                    match q {
                        Quantifier::Least => Instr::Min { d, a: d, b },
                        Quantifier::Most => Instr::Max { d, a: d, b },
                        _ => Instr::Add { d, a: d, b },
                    },
                    at,
                );
            }
        }
        self.body.in_loop = nested;
        self.land(&next);
        self.emit(Instr::RobotNext { q: state, to: body }, at);
        self.repeat(before, u64::from(MAX_ROBOTS));
        if matches!(q, Quantifier::Each | Quantifier::Some) {
            self.jump(Instr::Jump { to: 0 }, &mut out, at);
            self.land(&end);
            self.constant_into(d, 1.0 - start, at);
            self.emit(Instr::RobotRestore { q: state }, at);
        }
        self.land(&out);
        if q == Quantifier::Mean {
            self.emit(Instr::RobotCount { d: state, q: state }, at);
            self.emit(Instr::Div { d, a: d, b: state }, at);
        }
        self.body.top = top;
        Ok(Place::frame(d))
    }

    /// Counts what was compiled since `before` so many times.
    pub(super) fn repeat(&mut self, before: u64, times: u64) {
        let once = self.body.cost - before;
        self.body.cost = before.saturating_add(once.saturating_mul(times));
    }

    #[inline(never)]
    pub(super) fn gen_of_robot(&mut self, e: &Expr, group: u32, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        if group as usize >= self.robots.len() {
            return error(e.span, format!("there is no robot {group} here"));
        }
        gives(e, &of.ty)?;
        self.body.variable += 1;
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let q = self.alloc(1, e.span)?;
        self.emit(Instr::RobotSet { q, group }, e.span);
        self.generate(of, Some(d))?;
        self.emit(Instr::RobotRestore { q }, e.span);
        self.body.top = top;
        Ok(Place::frame(d))
    }
}

/// The comparison with its sides swapped.
fn mirrored(op: Binary) -> Binary {
    match op {
        Binary::Lt => Binary::Gt,
        Binary::Le => Binary::Ge,
        Binary::Gt => Binary::Lt,
        Binary::Ge => Binary::Le,
        op => op,
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
