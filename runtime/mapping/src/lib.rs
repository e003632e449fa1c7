//! Mapping: scans in, maps, poses and ways out.
//!
//! Every service is a pure function of plain values that the caller hands in and gets back; nothing is hidden. Every refusal
//! is a [`Why`].
//!
//! | question | file |
//! |---|---|
//! | what is where? | `grid`, `shape` |
//! | what does a scan say of it? | `scan`, `observe` |
//! | how far is the nearest thing? | `field` |
//! | where is the robot, on a map that is known? | `particles`, `random` |
//! | where is it, on a map that is being made? | `matching` |
//! | which way leads there? | `route`, `smooth` |
//! | how is it followed? | `path` |
//! | how much do two maps have in common? | `overlap` |
//!
//! Frames: `map` is x east, y north; a body is x forward, y left. Lengths in metres, angles in radians, counter-clockwise.
//!
//! **Invariant:** same inputs, same values: no clock, randomness from what is handed in only. No input panics, no value is NaN.
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a comparison with NaN has to refuse; 2026-11-23")]

pub mod field;
pub mod grid;
pub mod hits;
pub mod matching;
pub mod observe;
pub mod overlap;
pub mod particles;
pub mod path;
pub mod place;
pub mod random;
pub mod route;
pub mod scan;
pub mod shape;
pub mod smooth;
pub mod why;

pub use field::Field;
pub use grid::{Grid, Layout};
pub use hits::Hits;
pub use path::Path;
pub use place::Place;
pub use scan::Beam;
pub use why::Why;
