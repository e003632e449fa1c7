//! Vision: images in, values out, on OpenCV.
//!
//! Every service is a pure function. What must be remembered from frame to frame ([`look::Memory`]) is a plain value
//! that the caller hands in and gets back; nothing is hidden. Every refusal is a [`Why`].
//!
//! | question | file |
//! |---|---|
//! | which near-vertical lines does the image have? | `contours`, `segment`, `refine` |
//! | which way does the body go, how fast? | `reckoning` |
//! | where do they stand, which is the published pair? | `edge` |
//! | how do they move, which of them are obstacles? | `follow`, `sweep`, `obstacle` |
//! | how do points on the obstacle move? | `points` |
//! | how long until contact? | `flow`, `robust`, `expansion` |
//! | where does it stand once it is out of sight? | `known`, `landmarks` |
//! | is it in the way, on which side is more room? | `course`, `turning` |
//! | all of it on a frame | `look` |
//! | who is there, who of them walks? | `person`, `clothes`, `people` over `ground` |
//! | pictures for people | `overlay` |
//!
//! Frames: image x right, y down, pixels, pixel centres at whole numbers; body x forward, y left, z up; the level
//! frame has z against gravity. Angles in radians, times in seconds.
//!
//! **Invariant:** same inputs, same values: no clock, no unseeded randomness, no order of threads (see
//! [`single_thread`]; the values do not depend on it). No input panics, no value is NaN.
#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "a comparison with NaN has to refuse; 2026-11-23")]

pub mod attitude;
pub mod clothes;
mod consensus;
pub mod contours;
pub mod course;
pub mod edge;
pub mod expansion;
pub mod flow;
pub mod follow;
pub mod ground;
pub mod image;
pub mod known;
pub mod landmarks;
pub mod lens;
pub mod look;
pub mod obstacle;
pub mod overlay;
pub mod people;
pub mod person;
pub mod points;
pub mod reckoning;
pub mod rectify;
pub mod refine;
pub mod robust;
pub mod segment;
pub mod sweep;
pub mod turning;
pub mod why;

pub use image::{Gray, ImageView};
pub use lens::Lens;
pub use why::Why;

/// Tells OpenCV to use one thread. To be called once by the program; what the services give does not depend on it,
/// only that they do not compete with the caller's own threads.
///
/// # Errors
/// [`Why::OpenCv`] only.
pub fn single_thread() -> Result<(), Why> {
    Ok(opencv::core::set_num_threads(1)?)
}
