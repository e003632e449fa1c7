//! The ground that a camera looks over: pixels to places on it and back.

use crate::{attitude::Attitude, image::Gray, lens::Lens};

/// A camera over level ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Its lens.
    pub lens: Lens,
    /// How it is turned in the level frame; a yaw of 0 makes places count from straight ahead.
    pub attitude: Attitude,
    /// Metres over the ground.
    pub height: f64,
}

impl Ground {
    /// The place on the ground that a pixel shows: metres ahead and left of the camera's foot. `None` at the horizon and above.
    pub fn place(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let [ahead, left, up] = self.attitude.level(self.lens.ray(x, y)?);
        (up < -1e-4 && ahead > 0.0).then(|| [-ahead / up * self.height, -left / up * self.height])
    }

    /// The pixel that shows a point: metres ahead, left and over the ground. `None` when it is not ahead.
    pub fn pixel(&self, [ahead, left, up]: [f64; 3]) -> Option<[f64; 2]> {
        self.lens.pixel(self.attitude.body([ahead, left, up - self.height]))
    }

    /// The box of pixels around an upright rectangle that faces the camera: its place on the ground, metres to either side, from
    /// and to which height. Columns then rows, the latter excluded; `None` when nothing of it is in the image.
    pub fn upright(
        &self,
        size: (usize, usize),
        [ahead, left]: [f64; 2],
        aside: [f64; 2],
        up: [f64; 2],
    ) -> Option<[usize; 4]> {
        let range = libm::hypot(ahead, left);
        if !(range > 0.0) {
            return None;
        }
        // To the left, seen from the camera.
        let side = [-left / range, ahead / range];
        let corner = |a: f64, z: f64| self.pixel([ahead + a * side[0], left + a * side[1], z]);
        let (a, b) = (corner(aside[1], up[1])?, corner(aside[0], up[0])?);
        let within = |v: f64, most: usize| v.clamp(0.0, most as f64).round() as usize;
        let found = [within(a[0], size.0), within(b[0], size.0), within(a[1], size.1), within(b[1], size.1)];
        (found[0] < found[1] && found[2] < found[3]).then_some(found)
    }
}

/// Width and height.
pub(crate) fn size(image: &Gray) -> (usize, usize) {
    (image.width(), image.height())
}
