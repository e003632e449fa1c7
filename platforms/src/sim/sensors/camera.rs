//! A camera: its reading is an image, which is taken when somebody wants it.

use super::{Sensor, View};

/// One register, which counts for nothing: the image comes beside it.
#[derive(Debug)]
pub struct Camera;

impl Sensor for Camera {
    fn capture(&mut self, _seat: usize, _robot: usize, _view: &View<'_>, out: &mut Vec<f64>) {
        out.push(0.0);
    }

    fn takes_images(&self) -> bool {
        true
    }
}
