//! The lens: pixels to directions and back.
//!
//! Pixel positions are OpenCV's: the centre of the pixel in column i and row j is (i, j). A renderer that puts it
//! at (i + 0.5, j + 0.5) has a `cx` and `cy` greater by 0.5.

use crate::why::Why;

/// A pinhole with Brown-Conrady distortion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Focal length along x, pixels.
    pub fx: f64,
    /// Focal length along y, pixels.
    pub fy: f64,
    /// Column of the optical centre, pixels.
    pub cx: f64,
    /// Row of the optical centre, pixels.
    pub cy: f64,
    /// k1, k2 (radial), p1, p2 (tangential), dimensionless; `None` is an ideal pinhole.
    pub distortion: Option<[f64; 4]>,
}

/// Steps of the fixed-point iteration that undoes the distortion.
const STEPS: usize = 20;

impl Lens {
    /// An ideal lens for `width` x `height` pixels with the horizontal field of view `fov` in radians.
    ///
    /// # Errors
    /// [`Why::BadLens`] when the field of view is not within (0, π).
    pub fn ideal(width: usize, height: usize, fov: f64) -> Result<Self, Why> {
        if !(fov > 0.0 && fov < std::f64::consts::PI) {
            return Err(Why::BadLens);
        }
        let f = width as f64 / 2.0 / libm::tan(fov / 2.0);
        let lens = Self {
            fx: f,
            fy: f,
            cx: (width as f64 - 1.0) / 2.0,
            cy: (height as f64 - 1.0) / 2.0,
            distortion: None,
        };
        lens.check()?;
        Ok(lens)
    }

    /// Refuses what no lens has.
    ///
    /// # Errors
    /// [`Why::BadLens`].
    pub fn check(&self) -> Result<(), Why> {
        let finite = [self.fx, self.fy, self.cx, self.cy].iter().all(|v| v.is_finite() && v.abs() < 1e7)
            && self.distortion.is_none_or(|d| d.iter().all(|v| v.is_finite()));
        if finite && self.fx > 1e-3 && self.fy > 1e-3 { Ok(()) } else { Err(Why::BadLens) }
    }

    /// The normalised position (X/Z, Y/Z; x right, y down) of a pixel, undistorted. `None` where the distortion
    /// cannot be undone (outside of its one-to-one range).
    pub fn normalise(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        let seen = [(x - self.cx) / self.fx, (y - self.cy) / self.fy];
        let Some(d) = self.distortion else { return finite(seen) };
        let mut at = seen;
        for _ in 0..STEPS {
            let (radial, tangential) = distort(d, at);
            at = [(seen[0] - tangential[0]) / radial, (seen[1] - tangential[1]) / radial];
        }
        let (radial, tangential) = distort(d, at);
        let back = [at[0] * radial + tangential[0], at[1] * radial + tangential[1]];
        let error = (back[0] - seen[0]).abs().max((back[1] - seen[1]).abs());
        if error < 1e-6 { finite(at) } else { None }
    }

    /// The pixel of a normalised position, distorted as the lens does.
    pub fn project(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let at = match self.distortion {
            None => at,
            Some(d) => {
                let (radial, tangential) = distort(d, at);
                [at[0] * radial + tangential[0], at[1] * radial + tangential[1]]
            }
        };
        finite([at[0] * self.fx + self.cx, at[1] * self.fy + self.cy])
    }

    /// The direction of a pixel in the body frame (x forward, y left, z up), with x = 1. The optical axis is the
    /// body's x axis.
    pub fn ray(&self, x: f64, y: f64) -> Option<[f64; 3]> {
        self.normalise(x, y).map(|[a, b]| [1.0, -a, -b])
    }

    /// The pixel at which a direction of the body frame is seen; `None` when it is not ahead.
    pub fn pixel(&self, ray: [f64; 3]) -> Option<[f64; 2]> {
        if ray[0] > 1e-6 { self.project([-ray[1] / ray[0], -ray[2] / ray[0]]) } else { None }
    }
}

/// The radial factor and the tangential offset at a normalised position.
fn distort([k1, k2, p1, p2]: [f64; 4], [x, y]: [f64; 2]) -> (f64, [f64; 2]) {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * k2);
    (radial, [2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y])
}

fn finite(at: [f64; 2]) -> Option<[f64; 2]> {
    (at[0].abs() < 1e9 && at[1].abs() < 1e9).then_some(at)
}
