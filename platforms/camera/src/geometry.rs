//! Points, rotations and poses.

/// Metres, or a direction: x, y, z.
pub type Point = [f64; 3];

/// A rotation from a body's frame (x forward, y left, z up) into the world's (ENU): a unit quaternion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    w: f64,
    x: f64,
    y: f64,
    z: f64,
}

/// Where a camera or a part is: its position in the world and the rotation of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Metres, in the world.
    pub position: Point,
    /// From the body's frame into the world's.
    pub rotation: Rotation,
}

impl Rotation {
    /// Body and world agree: it looks east.
    pub const IDENTITY: Self = Self { w: 1.0, x: 0.0, y: 0.0, z: 0.0 };

    /// From w, x, y, z of any length; the identity if they are not finite or all zero.
    #[must_use]
    pub fn from_quaternion(wxyz: [f64; 4]) -> Self {
        let largest = wxyz.iter().fold(0.0_f64, |most, c| if c.abs() > most { c.abs() } else { most });
        if !wxyz.iter().all(|c| c.is_finite()) || largest < f64::MIN_POSITIVE {
            return Self::IDENTITY;
        }
        // Scaled first, so that no square overflows.
        let [w, x, y, z] = wxyz.map(|c| c / largest);
        let length = (w * w + x * x + y * y + z * z).sqrt();
        Self { w: w / length, x: x / length, y: y / length, z: z / length }
    }

    /// From radians about the body's x (positive: right side down), y (positive: nose down) and z (positive: to
    /// the left), turned in the order yaw, pitch, roll.
    #[must_use]
    pub fn from_roll_pitch_yaw(roll: f64, pitch: f64, yaw: f64) -> Self {
        let half = |angle: f64| if angle.is_finite() { libm::sincos(angle / 2.0) } else { (0.0, 1.0) };
        let ((sr, cr), (sp, cp), (sy, cy)) = (half(roll), half(pitch), half(yaw));
        Self::from_quaternion([
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ])
    }

    /// Upright, turned by so many radians from east to the left.
    #[must_use]
    pub fn from_heading(heading: f64) -> Self {
        Self::from_roll_pitch_yaw(0.0, 0.0, heading)
    }

    /// w, x, y, z, of unit length.
    #[must_use]
    pub fn quaternion(self) -> [f64; 4] {
        [self.w, self.x, self.y, self.z]
    }

    /// `self` after `inner`: what `inner` brings into an intermediate frame goes on into the world.
    #[must_use]
    pub fn after(self, inner: Self) -> Self {
        let (a, b) = (self, inner);
        Self::from_quaternion([
            a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        ])
    }

    /// Rows of the matrix from the body's frame into the world's.
    #[must_use]
    pub fn matrix(self) -> [[f64; 3]; 3] {
        let Self { w, x, y, z } = self;
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    }

    /// A direction of the body's frame as the world's.
    #[must_use]
    pub fn apply(self, direction: Point) -> Point {
        self.matrix().map(|row| dot(row, direction))
    }

    /// Between two rotations, the shorter way: at 0 `self`, at 1 `to`.
    #[must_use]
    pub fn toward(self, to: Self, share: f64) -> Self {
        let (a, mut b) = (self.quaternion(), to.quaternion());
        let agree: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        if agree < 0.0 {
            b = b.map(|c| -c);
        }
        let mix = |i: usize| a[i] + (b[i] - a[i]) * share;
        Self::from_quaternion([mix(0), mix(1), mix(2), mix(3)])
    }
}

impl Pose {
    /// At this position, upright, turned by so many radians from east to the left.
    #[must_use]
    pub fn upright(position: Point, heading: f64) -> Self {
        Self { position, rotation: Rotation::from_heading(heading) }
    }

    /// A point of the body's frame in the world.
    #[must_use]
    pub fn apply(&self, point: Point) -> Point {
        add(self.position, self.rotation.apply(point))
    }

    /// The pose in the world of what has the pose `inner` in this body's frame.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        Self { position: self.apply(inner.position), rotation: self.rotation.after(inner.rotation) }
    }

    /// Between two poses: at 0 `self`, at 1 `to`.
    #[must_use]
    pub fn toward(&self, to: &Self, share: f64) -> Self {
        let mix = |i: usize| self.position[i] + (to.position[i] - self.position[i]) * share;
        Self { position: [mix(0), mix(1), mix(2)], rotation: self.rotation.toward(to.rotation, share) }
    }
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn subtract(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(a: Point, by: f64) -> Point {
    a.map(|c| c * by)
}

/// Of unit length, or none if the length is zero or not finite.
pub(crate) fn unit(a: Point) -> Option<Point> {
    let length = dot(a, a).sqrt();
    (length.is_finite() && length > 0.0).then(|| scale(a, 1.0 / length))
}

#[cfg(test)]
mod tests {
    use super::{Pose, Rotation};

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn each_angle_turns_as_it_says() {
        let quarter = core::f64::consts::FRAC_PI_2;
        assert!(near(Rotation::from_heading(quarter).apply([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
        assert!(near(
            Rotation::from_roll_pitch_yaw(0.0, quarter, 0.0).apply([1.0, 0.0, 0.0]),
            [0.0, 0.0, -1.0]
        ));
        assert!(near(
            Rotation::from_roll_pitch_yaw(quarter, 0.0, 0.0).apply([0.0, -1.0, 0.0]),
            [0.0, 0.0, -1.0]
        ));
        let (roll, pitch, yaw) = (0.3, -0.2, 1.1);
        let whole = Rotation::from_roll_pitch_yaw(roll, pitch, yaw);
        let steps = Rotation::from_heading(yaw)
            .after(Rotation::from_roll_pitch_yaw(0.0, pitch, 0.0))
            .after(Rotation::from_roll_pitch_yaw(roll, 0.0, 0.0));
        assert!(near(whole.apply([1.0, 2.0, 3.0]), steps.apply([1.0, 2.0, 3.0])));
    }

    #[test]
    fn what_is_not_a_rotation_is_the_identity() {
        for bad in [[0.0; 4], [f64::NAN, 0.0, 0.0, 0.0], [f64::INFINITY, 1.0, 0.0, 0.0]] {
            assert_eq!(Rotation::from_quaternion(bad), Rotation::IDENTITY);
        }
        assert_eq!(Rotation::from_quaternion([1e200, 0.0, 0.0, 0.0]), Rotation::IDENTITY);
    }

    #[test]
    fn half_way_is_half_the_turn() {
        let a = Pose::upright([0.0, 0.0, 0.0], 0.0);
        let b = Pose::upright([2.0, 0.0, 0.0], 0.4);
        let middle = a.toward(&b, 0.5);
        assert!(near(middle.position, [1.0, 0.0, 0.0]));
        assert!(near(
            middle.apply([1.0, 0.0, 0.0]),
            Pose::upright([1.0, 0.0, 0.0], 0.2).apply([1.0, 0.0, 0.0])
        ));
    }
}
