//! Cameras: what a robot sees of the world, rendered when somebody reads it.
//!
//! `studio.rs` builds what can be seen of a scene, `shot.rs` takes images of it, `retake.rs` takes those of a trace
//! again. What an image is taken from is a row of numbers, its view, so that it can be.

mod retake;
mod shot;
mod studio;

pub use retake::Rendered;
pub use shot::{Cameraman, Order, Taking};
pub use studio::{Mounted, Studio};
