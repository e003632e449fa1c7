//! The evaluator: expressions and statements are compiled to bytecode over f64 registers, which a small
//! machine runs.
//!
//! A [`Compiler`] turns expressions, statements and guards into [`Block`]s of one [`Program`]. Blocks of
//! one [`Scope`] share a frame: every local has registers of its own there, so that a block sees what
//! another one bound before. A run ([`Program::run`]) allocates nothing, ends within [`Block::bound`]
//! instructions, and reaches the rest of the world through [`Env`] only.
//!
//! Invariant: no graph, however malformed, makes the compiler or the machine panic: it is refused with
//! a [`CompileError`] or ends in a [`Fault`]. Numbers in registers are finite.

mod builtins;
mod code;
mod compile;
mod constant;
mod copy;
mod draw;
mod env;
mod fault;
mod geometry;
mod lists;
mod memory;
mod run;
mod run_other;
mod widths;

pub use code::Program;
pub use compile::{Block, Compiler, Scope};
pub use constant::{Known, Parameters, constant};
pub use copy::copy_registers;
pub use draw::sample;
pub use env::{Effect, Env, NoEnv};
pub use fault::{CompileError, Fault, FaultKind};
pub use memory::{Layout, Memory};

/// The greatest number of robots a quantified expression goes through.
pub const MAX_ROBOTS: u32 = 1 << 20;

/// The greatest number of registers a frame may need.
pub const MAX_FRAME: usize = 1 << 22;
