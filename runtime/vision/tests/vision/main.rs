//! The suite of the vision crate.
#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "tests print their figures; 2026-11-23")]
#![allow(clippy::unwrap_used, reason = "tests; 2026-11-23")]

mod approach;
mod contact;
mod gaps;
mod geometry;
mod people;
mod places;
mod robustness;
mod scene;
