//! Has images again that a trace tells of, whether they were rendered or recorded.

use super::{Care, Written, open_at};
use crate::image_files;
use soifra_platforms::{recording::Footage, sim::camera::Rendered};
use soifra_runtime::{
    Scene, Time,
    objects::{Cameras, Frame, Retake},
};
use std::{collections::BTreeMap, sync::Arc};

/// Cameras of simulated and of recorded robots.
#[derive(Debug, Clone, Copy, Default)]
pub struct Everywhere {
    /// How many recordings this is inside of.
    pub(super) depth: u32,
}

struct Again {
    /// By robot and sensor.
    films: BTreeMap<(u32, u32), Box<dyn Footage>>,
}

impl Cameras for Everywhere {
    fn of(&self, scene: &Scene) -> Option<Box<dyn Retake>> {
        let Some(opened) = open_at(scene, Care::WhenWanted, self.depth).ok()? else {
            // What has changed since shows other images, which is noticed by their digests.
            let images = image_files::again(&scene.images).ok()?;
            return Rendered.of(&Scene { images, ..scene.clone() });
        };
        let film = |(robot, sensor, written): &(u32, u32, Written)| match written {
            Written::Images { shots, .. } => Some(((*robot, *sensor), shots.show().ok()?)),
            Written::Numbers { .. } => None,
        };
        Some(Box::new(Again { films: opened.written.iter().filter_map(film).collect() }))
    }
}

impl Retake for Again {
    fn retake(&mut self, robot: u32, sensor: u32, captured: Time, view: &[f64]) -> Option<Arc<Frame>> {
        let [number] = view else { return None };
        let number = *number as usize;
        let picture = self.films.get_mut(&(robot, sensor))?.image(number).ok()?;
        Some(Arc::new(picture.into_frame(number, captured)))
    }
}
