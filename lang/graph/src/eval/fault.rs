//! What can go wrong when code is compiled and when it runs.

use crate::Span;
use std::fmt;

/// Something went wrong while a block ran; what it had done until then stays done.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What.
    pub kind: FaultKind,
    /// The operation.
    pub at: Span,
}

/// What went wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FaultKind {
    /// Division by zero, also as a remainder or a negative power.
    DivisionByZero,
    /// An argument for which the function has no value: the root of a negative number, the logarithm
    /// of zero, the arc sine of 2, a normal distribution with negative deviation.
    Domain(&'static str),
    /// The result is beyond the greatest number, or no number.
    NotFinite,
    /// A whole number left ±2^53.
    Overflow,
    /// The expression asks for something that is not available where it is evaluated.
    Unavailable(&'static str),
    /// The frame or the memory does not go with the code, or an enum value is none of its variants.
    Malformed,
    /// The surroundings refused an effect or a question, with the reason.
    Refused(String),
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FaultKind::DivisionByZero => f.write_str("division by zero"),
            FaultKind::Domain(what) => f.write_str(what),
            FaultKind::NotFinite => f.write_str("the result is not a finite number"),
            FaultKind::Overflow => f.write_str("a whole number beyond 2^53"),
            FaultKind::Unavailable(what) => write!(f, "{what} is not available here"),
            FaultKind::Malformed => f.write_str("the registers do not fit the expression"),
            FaultKind::Refused(why) => f.write_str(why),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

impl std::error::Error for Fault {}

/// An expression or statement that cannot be compiled. The checker lets none of these through; a graph
/// file that was altered by hand may hold them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompileError {
    /// One line, no full stop.
    pub text: String,
    /// The place.
    pub at: Span,
}

impl CompileError {
    pub(super) fn new(at: Span, text: impl Into<String>) -> Self {
        CompileError { text: text.into(), at }
    }
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for CompileError {}

impl From<CompileError> for Fault {
    fn from(e: CompileError) -> Self {
        Fault { kind: FaultKind::Refused(e.text), at: e.at }
    }
}
