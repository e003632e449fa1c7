//! A camera: scenes in, RGB frames out, on the CPU, the same bytes on every machine.
//!
//! Frames. The world is ENU in metres, z up. A camera's own frame is x forward, y left, z up, as a robot's body.
//! In the image x goes right and y down, in pixels; the centre of the pixel (i, j) is at (i + 0.5, j + 0.5).
//!
//! The way of a frame, a file each:
//!
//! | step | file |
//! |---|---|
//! | triangles into the camera's frame, facing, clipping, linear functions over the image | `facet`, `clip` |
//! | which triangle is seen at which pixel, strip by strip of rows | `visibility` |
//! | its texture and light there, each pixel once | `shade`, `sky` |
//! | silhouettes blended by the exact share of each side, bytes out | `smooth` |
//! | strips over threads | `render` |
//! | the lens's distortion | `warp` |
//! | several instants averaged; the sensor's noise | `blur`, `noise` |
//!
//! **Invariant:** a pixel's bytes depend on the scene, the poses, the view and nothing else: not on the number of
//! bands, the optimisation or the instruction set. Arithmetic is integer or IEEE 754 without contraction, and
//! trigonometry is `libm`'s.
//!
//! **Invariant:** no input panics. A triangle or pose that is not finite is not drawn.

mod blur;
mod clip;
mod colour;
mod facet;
mod figure;
mod geometry;
mod image;
mod lens;
mod light;
mod mesh;
mod noise;
mod render;
mod scene;
mod shade;
mod sky;
mod smooth;
mod texture;
mod visibility;
mod warp;

pub use blur::{Exposure, render_blurred};
pub use figure::{Clothes, Figure};
pub use geometry::{Point, Pose, Rotation};
pub use image::Image;
pub use lens::{Lens, LensError};
pub use light::Light;
pub use mesh::{Mesh, Surface};
pub use noise::{noise, noise_in_bands};
pub use render::{Filter, Scratch, View, render};
pub use scene::{PartIndex, PartPose, Scene, TextureIndex};
pub use sky::Sky;
pub use texture::{NAMES, Texture, TextureError};
