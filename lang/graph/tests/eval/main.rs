//! The evaluator: what expressions and statements compute, and that no graph makes it panic.

mod functions;
mod geometry;
mod lists;
mod malformed;
mod operators;
mod statements;
mod support;
