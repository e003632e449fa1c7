//! How the camera is turned, and what turning does to the image.
//!
//! Body frame: x forward (the optical axis), y left, z up. Level frame: z against gravity, x along a heading that
//! stays the same from frame to frame (any heading; yaw counts from it).

use crate::lens::Lens;

/// Attitude of the body in the level frame, radians: first yaw about z (left positive), then pitch about y (nose
/// down positive), then roll about x (to the right positive).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// About x, to the right positive.
    pub roll: f64,
    /// About y, nose down positive.
    pub pitch: f64,
    /// About z, to the left positive, from the level frame's heading; an integrated gyro will do.
    pub yaw: f64,
}

/// Rates of turning about the body's axes, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// About x (forward).
    pub roll: f64,
    /// About y (left).
    pub pitch: f64,
    /// About z (up).
    pub yaw: f64,
}

impl Attitude {
    /// Is every angle a number?
    pub fn is_finite(&self) -> bool {
        self.roll.is_finite() && self.pitch.is_finite() && self.yaw.is_finite()
    }

    /// The attitude of a camera that looks down by `tilt` (rad) on a body of this attitude.
    pub fn looking_down(&self, tilt: f64) -> Self {
        if tilt == 0.0 {
            return *self;
        }
        // The body's rotation times that of the mount, taken apart again.
        let m = self.rotation();
        let (s, c) = libm::sincos(tilt);
        let x = [0, 1, 2].map(|k| m[k][0] * c - m[k][2] * s);
        let z = m[2][0] * s + m[2][2] * c;
        Self {
            roll: libm::atan2(m[2][1], z),
            pitch: libm::asin((-x[2]).clamp(-1.0, 1.0)),
            yaw: libm::atan2(x[1], x[0]),
        }
    }

    /// The rotation from the body frame to the level frame, row after row.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let (sr, cr) = libm::sincos(self.roll);
        let (sp, cp) = libm::sincos(self.pitch);
        let (sy, cy) = libm::sincos(self.yaw);
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    }

    /// A direction of the body frame in the level frame.
    pub fn level(&self, ray: [f64; 3]) -> [f64; 3] {
        self.rotation().map(|row| dot(row, ray))
    }

    /// A direction of the level frame in the body frame.
    pub fn body(&self, ray: [f64; 3]) -> [f64; 3] {
        let m = self.rotation();
        [0, 1, 2].map(|k| m[0][k] * ray[0] + m[1][k] * ray[1] + m[2][k] * ray[2])
    }
}

impl Rates {
    /// Is every rate a number?
    pub fn is_finite(&self) -> bool {
        self.roll.is_finite() && self.pitch.is_finite() && self.yaw.is_finite()
    }

    /// The rates about the axes of a camera that looks down by `tilt` (rad).
    pub fn looking_down(&self, tilt: f64) -> Self {
        let (s, c) = libm::sincos(tilt);
        Self { roll: self.roll * c - self.yaw * s, pitch: self.pitch, yaw: self.roll * s + self.yaw * c }
    }

    /// The largest of the three, rad/s.
    pub fn largest(&self) -> f64 {
        self.roll.abs().max(self.pitch.abs()).max(self.yaw.abs())
    }

    /// Where the point seen at the pixel (x, y) would have been seen `dt` seconds later if the camera had only
    /// turned: exact for rates constant over `dt` (Rodrigues), so that subtracting it leaves the flow of the
    /// translation alone. Pixels; `None` outside of the lens.
    pub fn turned(&self, lens: &Lens, x: f64, y: f64, dt: f64) -> Option<[f64; 2]> {
        let ray = lens.ray(x, y)?;
        // The scene turns against the camera.
        let axis = [-self.roll * dt, -self.pitch * dt, -self.yaw * dt];
        lens.pixel(rotate(ray, axis))
    }
}

/// `ray` turned about `axis` by its length in radians.
pub(crate) fn rotate(ray: [f64; 3], axis: [f64; 3]) -> [f64; 3] {
    let angle = libm::sqrt(dot(axis, axis));
    if angle < 1e-12 {
        return ray;
    }
    let unit = axis.map(|v| v / angle);
    let (s, c) = libm::sincos(angle);
    let cross = cross(unit, ray);
    let along = dot(unit, ray) * (1.0 - c);
    [0, 1, 2].map(|k| ray[k] * c + cross[k] * s + unit[k] * along)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// An angle brought into (-π, π].
pub fn wrap(angle: f64) -> f64 {
    libm::atan2(libm::sin(angle), libm::cos(angle))
}
