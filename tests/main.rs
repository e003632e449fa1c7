//! The integration tests, one binary: `tests/<area>/` are its modules.

mod cli;
mod fuzz;
mod structure;
mod support;
mod trace;
