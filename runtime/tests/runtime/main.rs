//! The runtime from the outside: missions written in the language, on a scripted platform.

mod allocation;
mod arbitration;
mod conversations;
mod cores;
mod determinism;
mod expectations;
mod faults;
mod machines;
mod mended;
mod operator;
mod plans;
mod replay;
mod scheduling;
mod support;
mod topics;
mod troubles;
