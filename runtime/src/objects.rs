//! What agents pass around and never look into: images, and what services keep for later. It lies here, and
//! registers hold its number.

use crate::{Scene, Time, scene::Part};
use soifra_graph::{Function, Value, eval::FaultKind};
use std::{any::Any, fmt::Debug, sync::Arc};

/// Something that only services look into. It never changes.
pub trait Object: Any + Debug + Send + Sync {
    /// For services, who know what it is.
    fn as_any(&self) -> &dyn Any;
}

/// An image that a camera took.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// RGB, 8 bits each, row by row from the upper left.
    pub data: Vec<u8>,
    /// The lens that took it.
    pub optics: Optics,
    /// When it was taken.
    pub captured: Time,
    /// From what it can be taken again, in the camera's own terms; of a real camera nothing.
    pub view: Vec<f64>,
    /// Of width, height and pixels; see [`digest`].
    pub digest: u64,
}

/// A fingerprint of an image, 64 bits: whether two are the same, not whether somebody made them so.
pub fn digest(width: u32, height: u32, data: &[u8]) -> u64 {
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    let mix = |h: u64, x: u64| {
        let h = (h ^ x).wrapping_mul(PRIME);
        h ^ h >> 29
    };
    let size = u64::from(width) << 32 | u64::from(height);
    let (words, rest) = data.as_chunks::<8>();
    let h = words.iter().fold(mix(0xcbf2_9ce4_8422_2325, size), |h, w| mix(h, u64::from_le_bytes(*w)));
    rest.iter().fold(h, |h, b| mix(h, u64::from(*b)))
}

/// How a camera maps directions to pixels, pinhole with Brown and Conrady's distortion, and where it sits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Focal lengths in pixels, along x and y.
    pub focal: [f64; 2],
    /// Optical centre in pixels; pixel centres are at halves.
    pub centre: [f64; 2],
    /// k1, k2, p1, p2.
    pub distortion: Option<[f64; 4]>,
    /// Where it is in `base_link`, m.
    pub at: [f64; 3],
    /// How far it looks down, rad.
    pub tilt: f64,
}

impl Optics {
    /// How far the camera is ahead of the origin of `base_link`, along a direction that the robot's x axis is `off`
    /// (rad, to the left) of; m.
    pub fn ahead(&self, off: f64) -> f64 {
        let (s, c) = libm::sincos(off);
        self.at[0] * c - self.at[1] * s
    }

    /// How far it is to the left of the origin, likewise.
    pub fn aside(&self, off: f64) -> f64 {
        let (s, c) = libm::sincos(off);
        self.at[0] * s + self.at[1] * c
    }
}

impl Object for Frame {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Computes the functions that are services: see [`Function::is_service`]. The same arguments give the same values,
/// on every thread.
pub trait Services: Debug + Send + Sync {
    /// Computes one of them from arguments that lie one after the other.
    ///
    /// # Errors
    /// That it is not available here, or that the arguments are none of its.
    fn call(
        &self,
        which: Function,
        args: &[f64],
        shelf: &mut dyn Shelf,
        out: &mut [f64],
    ) -> Result<(), FaultKind>;
}

/// Sets up cameras that take images of a scene again.
pub trait Cameras: Debug + Send + Sync {
    /// Those of a scene; none where nothing can be taken again.
    fn of(&self, scene: &Scene) -> Option<Box<dyn Retake>>;
}

/// Takes images again from what a trace says of them, so that a trace need not hold them.
pub trait Retake {
    /// The image that a camera took from there; nothing where it cannot be the same.
    fn retake(&mut self, robot: u32, sensor: u32, captured: Time, view: &[f64]) -> Option<Arc<Frame>>;
}

/// Where services find objects, and put what they make.
pub trait Shelf {
    /// The object that a register means.
    fn get(&self, register: f64) -> Option<Arc<dyn Object>>;
    /// Keeps an object; the register for it. It stays as long as a state of an agent means it.
    fn put(&mut self, object: Arc<dyn Object>) -> f64;
    /// What of the world is on the map that missions may know: bounds, and the walls and obstacles that are `mapped`.
    fn mapped(&self) -> Vec<&Part>;
    /// The same of all walls and obstacles that there are: for judgements, nothing for agents.
    fn standing(&self) -> Option<Vec<&Part>>;
    /// How many threads a service may make use of, the calling one included. What it computes does not depend on them.
    fn threads(&self) -> usize;
}

/// Bounds, walls and obstacles of a scene; all, or those on the map.
pub(crate) fn standing(scene: &Scene, all: bool) -> Vec<&Part> {
    let stands = |p: &&Part| match &*p.role {
        "bounds" => true,
        "wall" | "obstacle" => all || p.args.get("mapped") != Some(&Value::Bool(false)),
        _ => false,
    };
    scene.world.iter().filter(stands).collect()
}
