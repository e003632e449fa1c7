//! Where something is on the ground, and which way it faces.

use std::f64::consts::{PI, TAU};

/// A pose in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// x and y, m.
    pub at: [f64; 2],
    /// Counter-clockwise from x, rad.
    pub yaw: f64,
}

impl Place {
    /// From its numbers.
    pub fn new(x: f64, y: f64, yaw: f64) -> Place {
        Place { at: [x, y], yaw }
    }

    /// A point of the frame of this pose in the frame in which the pose is.
    pub fn outward(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = libm::sincos(self.yaw);
        [self.at[0] + c * x - s * y, self.at[1] + s * x + c * y]
    }

    /// A point of the frame in which the pose is, as this pose sees it.
    pub fn inward(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = libm::sincos(self.yaw);
        let (x, y) = (x - self.at[0], y - self.at[1]);
        [c * x + s * y, c * y - s * x]
    }

    /// `other`, given in the frame of this pose, in the frame in which this pose is.
    pub fn then(&self, other: Place) -> Place {
        Place { at: self.outward(other.at), yaw: wrap(self.yaw + other.yaw) }
    }

    /// The pose that undoes this one.
    pub fn inverse(&self) -> Place {
        let (s, c) = libm::sincos(self.yaw);
        let [x, y] = self.at;
        Place { at: [-c * x - s * y, s * x - c * y], yaw: wrap(-self.yaw) }
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.at.iter().all(|x| x.is_finite()) && self.yaw.is_finite()
    }
}

/// The same direction within -pi .. pi.
pub fn wrap(angle: f64) -> f64 {
    let turned = (angle + PI).rem_euclid(TAU) - PI;
    if turned.is_finite() { turned } else { 0.0 }
}

/// How far apart two points are, m.
pub fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_pose_and_its_inverse_are_nothing(x in -50.0..50.0, y in -50.0..50.0, yaw in -4.0..4.0) {
            let p = Place::new(x, y, yaw);
            let nothing = p.then(p.inverse());
            prop_assert!(apart(nothing.at, [0.0, 0.0]) < 1e-9 && wrap(nothing.yaw).abs() < 1e-9);
            let q = p.inward(p.outward([1.0, 2.0]));
            prop_assert!(apart(q, [1.0, 2.0]) < 1e-9);
        }
    }
}
