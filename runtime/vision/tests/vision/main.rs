//! The suite of the vision crate.

mod approach;
mod scene;
