//! The behaviour graph: the one vocabulary that the language and the runtime share.
//!
//! Quantities, frames and types; expressions and what they compute; agents, plans, machines and
//! arbiters; missions, worlds and platforms as data.
//!
//! Invariant: pure. Nothing here reads a file, a clock or a random source.

pub mod allocation;
pub mod behaviour;
pub mod component;
pub mod conversation;
pub mod diagnostic;
pub mod dim;
pub mod eval;
pub mod expr;
pub mod function;
pub mod mission;
pub mod pattern;
pub mod planning;
pub mod reason;
pub mod signature;
pub mod span;
pub mod types;
pub mod typing;
pub mod value;

pub use behaviour::*;
pub use conversation::{Conversation, ProtocolMove, ProtocolState, Role};
pub use diagnostic::{Diagnostic, Label, Severity, did_you_mean};
pub use dim::{Dim, Unit as QuantityUnit};
pub use expr::{Binary, Execution, Expr, ListOp, Op, Own, Part, Quantifier, Run, Truth, UserFunction};
pub use function::{FUNCTIONS, Function};
pub use mission::*;
pub use signature::Signature;
pub use span::Span;
pub use types::{Enum, Frame, Name, OPAQUE, Record, Type, TypeTable};
pub use value::{Distribution, Texts, Value};
