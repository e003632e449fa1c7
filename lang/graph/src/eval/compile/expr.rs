//! Code for expressions.
//!
//! [`Compiler::generate`] makes the code of one expression and says where its value lies. With a `dest`
//! the value comes to lie there; without one it stays where it is when it lies somewhere already (a local,
//! a state, a constant), so that nothing is copied for nothing. Whatever depends on nothing is run once,
//! here, and replaced by its value.

use super::emit::error;
use super::{Compiled, Compiler, MAX_DEPTH, Place};
use crate::{
    Expr, Op, Type,
    eval::{code::Space, widths::same_layout},
    typing,
};

/// How much of the stack the compiler needs for an operator, relative to a sum.
fn weight(op: &Op) -> u32 {
    match op {
        Op::IfSome { .. } | Op::List(..) | Op::Fold(..) => 3,
        Op::Switch { .. } | Op::Quantified(_) | Op::If | Op::Let(_) => 2,
        _ => 1,
    }
}

/// An operand of an instruction.
pub(super) enum Operand {
    /// A register.
    Register(u32),
    /// A constant of the pool.
    Constant(u32),
}

/// The arguments of an operator that takes `N`.
pub(super) fn arguments<const N: usize>(e: &Expr) -> Compiled<&[Expr; N]> {
    match <&[Expr; N]>::try_from(e.args.as_slice()) {
        Ok(args) => Ok(args),
        Err(_) => error(e.span, format!("{N} arguments are wanted here, not {}", e.args.len())),
    }
}

/// Refuses an expression whose type is not laid out as what its operator gives.
pub(super) fn gives(e: &Expr, given: &Type) -> Compiled<()> {
    if same_layout(&e.ty, given) {
        return Ok(());
    }
    error(e.span, format!("this is {given}, and said to be {}", e.ty))
}

impl Compiler<'_> {
    /// Code for `e`; see the module.
    pub(super) fn generate(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let weight = weight(&e.op);
        if self.body.depth + weight > MAX_DEPTH {
            return error(e.span, "this nests too deep");
        }
        self.body.depth += weight;
        let (start, variable, cost, top) = (self.here(), self.body.variable, self.body.cost, self.body.top);
        let place = self.dispatch(e, dest)?;
        self.body.depth -= weight;
        if variable == self.body.variable && self.here() > start {
            return self.folded(e, start, place, cost, top, dest);
        }
        Ok(place)
    }

    /// Code for `e` in the layout of `wanted`, which may be an optional of its type or a longer list.
    pub(super) fn gen_as(&mut self, e: &Expr, wanted: &Type, dest: Option<u32>) -> Compiled<Place> {
        if same_layout(&e.ty, wanted) {
            return self.generate(e, dest);
        }
        match (&e.ty, wanted) {
            (Type::List(a, n), Type::List(b, m)) if n <= m && (*n == 0 || same_layout(a, b)) => {
                let width = self.width(wanted, e.span)?;
                let d = self.dest(dest, width, e.span)?;
                self.generate(e, Some(d))
            }
            (Type::Option(_), _) => self.refuse(e, wanted),
            (_, Type::Option(value)) => {
                let width = self.width(wanted, e.span)?;
                let d = self.dest(dest, width, e.span)?;
                self.constant_into(d, 0.0, e.span);
                self.gen_as(e, value, Some(d + 1))?;
                Ok(Place::frame(d))
            }
            _ => self.refuse(e, wanted),
        }
    }

    fn refuse(&self, e: &Expr, wanted: &Type) -> Compiled<Place> {
        error(e.span, format!("{wanted} is wanted here, not {}", e.ty))
    }

    /// Code for a number, truth value or other value of one register; returns the register.
    pub(super) fn scalar(&mut self, e: &Expr) -> Compiled<u32> {
        self.one_register(e)?;
        let place = self.generate(e, None)?;
        self.in_frame(place, 1, e.span)
    }

    pub(super) fn one_register(&mut self, e: &Expr) -> Compiled<()> {
        match self.width(&e.ty, e.span)? {
            1 => Ok(()),
            _ => error(e.span, format!("a single number is wanted here, not {}", e.ty)),
        }
    }

    /// As [`Compiler::scalar`], but a constant is not loaded.
    pub(super) fn operand(&mut self, e: &Expr) -> Compiled<Operand> {
        self.one_register(e)?;
        let place = self.generate(e, None)?;
        Ok(match place.space {
            Space::Constants => Operand::Constant(place.at),
            _ => Operand::Register(self.in_frame(place, 1, e.span)?),
        })
    }

    /// Code for a value whose registers an instruction reads.
    pub(super) fn registers(&mut self, e: &Expr) -> Compiled<u32> {
        let n = self.width(&e.ty, e.span)?;
        let place = self.generate(e, None)?;
        self.in_frame(place, n, e.span)
    }

    /// Lets a local of an expression stand for a value that lies elsewhere while `body` is compiled.
    pub(super) fn with_bound<T>(
        &mut self,
        local: u32,
        place: Option<Place>,
        body: impl FnOnce(&mut Self) -> Compiled<T>,
    ) -> Compiled<T> {
        let set = |c: &mut Self, place| match c.body.bound.get_mut(local as usize) {
            Some(b) => std::mem::replace(b, place),
            None => None,
        };
        let before = set(self, place);
        let made = body(self);
        set(self, before);
        made
    }

    fn dispatch(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        match &e.op {
            Op::Const(value) => self.gen_const(e, value, dest),
            Op::Local(_) | Op::State(_) | Op::Param(_) | Op::Argument(_) => self.gen_slot(e, dest),
            Op::Reading(_) | Op::Heard(_) => self.gen_fetched(e, dest),
            Op::Now
            | Op::StepCount
            | Op::Elapsed
            | Op::Own(_)
            | Op::Truth(_)
            | Op::Run(_)
            | Op::Believed(..)
            | Op::Executed(..)
            | Op::Offering(_)
            | Op::Achieved(_) => self.gen_question(e, dest),
            Op::Quantified(q) => self.gen_quantified(e, *q, dest),
            Op::OfRobot(group) => self.gen_of_robot(e, *group, dest),
            Op::Call(function) => self.gen_call(e, *function, dest),
            Op::Builtin(f) => self.gen_builtin(e, *f, dest),
            Op::Binary(op) => self.gen_binary(e, *op, dest),
            Op::Sqrt | Op::Power(_) | Op::Neg | Op::Dot => self.gen_arithmetic(e, dest),
            Op::Not => self.gen_not(e, dest),
            Op::If => self.gen_if(e, dest),
            Op::Let(local) => self.gen_let(e, *local, dest),
            Op::IfSome { local, reason } => self.gen_if_some(e, *local, *reason, dest),
            Op::Switch { variants, rest } => self.gen_switch(e, variants, *rest, dest),
            Op::MakeRecord
            | Op::MakeList
            | Op::MakeVector
            | Op::MakeRange
            | Op::MakeMatrix
            | Op::MakeSome
            | Op::MakeNone(_) => self.gen_make(e, dest),
            Op::Field(_) | Op::Item(..) => self.gen_field(e, dest),
            Op::Part(part) => self.gen_part(e, *part, dest),
            Op::List(op, local) => self.gen_list(e, *op, *local, dest),
            Op::Fold(acc, item) => self.gen_fold(e, *acc, *item, dest),
            Op::Transpose | Op::Inverse => self.gen_matrix(e, dest),
        }
    }
}

/// Whether the value of `e` is written by one last instruction that has read its operands before.
pub(super) fn writes_last(e: &Expr) -> bool {
    use crate::{Binary as B, Function as F};
    let arithmetic =
        matches!(e.op, Op::Binary(B::Add | B::Sub | B::Mul | B::Div) | Op::Builtin(F::Min | F::Max | F::Abs));
    arithmetic && same_layout(&e.ty, &Type::NUMBER) && typing::number(&e.ty).is_some()
}
