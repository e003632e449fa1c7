//! Takes the images of a recorded run again.

use super::{Order, Studio, shot::Desk};
use crate::sim::scene;
use soifra_runtime::{
    Scene, Time,
    objects::{Cameras, Frame, Retake},
};
use std::sync::Arc;

/// Cameras of the simulator, for replays: a trace says from where an image was taken.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rendered;

struct Again {
    studio: Studio,
    desk: Desk,
}

impl Cameras for Rendered {
    fn of(&self, scene: &Scene) -> Option<Box<dyn Retake>> {
        let bodied = scene.platforms.iter().take_while(|p| !p.parts.is_empty());
        let chassis = bodied.map(scene::chassis).collect::<Result<Vec<_>, _>>().ok()?;
        let population = scene::population(scene, &chassis).ok()?;
        let studio = Studio::of(scene, &population.bodies).ok()??;
        Some(Box::new(Again { studio, desk: Desk::default() }))
    }
}

impl Retake for Again {
    fn retake(&mut self, robot: u32, sensor: u32, captured: Time, view: &[f64]) -> Option<Arc<Frame>> {
        let order = Order { robot, sensor, captured, view: view.to_vec() };
        self.studio.take(&order, &mut self.desk).map(Arc::new)
    }
}
