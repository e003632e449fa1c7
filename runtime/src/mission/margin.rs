//! Margins of conditions: how far a condition is from changing its truth value.
//!
//! The margin of a comparison of quantities is the distance to the bound, positive when it holds; `and`
//! takes the smaller, `or` the greater, `not` the negative; `each robot` takes the least, `some robot` the
//! greatest. A part that compares no quantities counts as [`BOOLEAN`] when true and its negative when
//! false, so that it decides without being a distance.
//! After Fainekos and Pappas, Robustness of Temporal Logic Specifications for Continuous-Time Signals
//! (2009), definition 8.

use soifra_graph::{Binary, Dim, Expr, Function, Op, Quantifier, Type, Value, typing};

/// Stands for the margin of a part without quantities. Whatever reaches it is no distance.
pub(crate) const BOOLEAN: f64 = 1e300;

/// The expression of the margin of `e`: a plain number in SI units. `None` when nothing in it compares
/// quantities.
pub(crate) fn of(e: &Expr) -> Option<Expr> {
    let mut measured = false;
    let margin = build(e, &mut measured);
    measured.then_some(margin)
}

fn number(op: Op, args: Vec<Expr>, at: &Expr) -> Expr {
    Expr::new(op, args, Type::NUMBER, at.span)
}

fn constant(x: f64, at: &Expr) -> Expr {
    Expr::constant(Value::Number(x), Type::NUMBER, at.span)
}

fn build(e: &Expr, measured: &mut bool) -> Expr {
    match (&e.op, e.args.as_slice()) {
        (Op::Binary(op @ (Binary::And | Binary::Or)), [a, b]) => {
            let f = if *op == Binary::And { Function::Min } else { Function::Max };
            let args = vec![build(a, measured), build(b, measured)];
            number(Op::Builtin(f), args, e)
        }
        (Op::Not, [a]) => number(Op::Neg, vec![build(a, measured)], e),
        (Op::Binary(op), [a, b]) => match difference(*op, a, b, e) {
            Some(d) => {
                *measured = true;
                d
            }
            None => boolean(e),
        },
        (Op::Quantified(q @ (Quantifier::Each | Quantifier::Some)), [a]) => {
            let q = if *q == Quantifier::Each { Quantifier::Least } else { Quantifier::Most };
            number(Op::Quantified(q), vec![build(a, measured)], e)
        }
        (Op::OfRobot(r), [a]) => number(Op::OfRobot(*r), vec![build(a, measured)], e),
        (Op::Let(l), [v, body]) => number(Op::Let(*l), vec![v.clone(), build(body, measured)], e),
        (Op::If, [c, a, b]) => {
            let args = vec![c.clone(), build(a, measured), build(b, measured)];
            number(Op::If, args, e)
        }
        _ => boolean(e),
    }
}

fn boolean(e: &Expr) -> Expr {
    number(Op::If, vec![e.clone(), constant(BOOLEAN, e), constant(-BOOLEAN, e)], e)
}

fn difference(op: Binary, a: &Expr, b: &Expr, at: &Expr) -> Option<Expr> {
    let (high, low) = match op {
        Binary::Lt | Binary::Le => (b, a),
        Binary::Gt | Binary::Ge | Binary::Eq | Binary::Ne => (a, b),
        _ => return None,
    };
    typing::number(&a.ty)?;
    typing::number(&b.ty)?;
    let ty = typing::binary(Binary::Sub, &high.ty, &low.ty)?;
    let dim = typing::number(&ty)?;
    let d = Expr::new(Op::Binary(Binary::Sub), vec![high.clone(), low.clone()], ty.clone(), at.span);
    // Margins of different dimensions meet in `and` and `or`: they are compared as plain numbers.
    let one = Expr::constant(Value::Number(1.0), Type::Quantity(dim), at.span);
    let d =
        if ty == Type::Quantity(Dim::NONE) { d } else { number(Op::Binary(Binary::Div), vec![d, one], at) };
    let size = |d| number(Op::Builtin(Function::Abs), vec![d], at);
    Some(match op {
        Binary::Eq => number(Op::Neg, vec![size(d)], at),
        Binary::Ne => size(d),
        _ => d,
    })
}
