//! Angles, vectors, quaternions, poses, circles. Metres and radians; quaternions are x y z w.

use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

/// The same direction in (-π, π].
pub(super) fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    // The remainder is exact and in [-π, π].
    let r = libm::remainder(angle, TAU);
    if r <= -PI { PI } else { r }
}

/// The direction of (x, y); that of the origin is 0.
pub(super) fn direction(y: f64, x: f64) -> f64 {
    if x == 0.0 && y == 0.0 { 0.0 } else { wrap(libm::atan2(y, x)) }
}

pub(super) fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

pub(super) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `v` at length one; the zero vector stays. Not finite when the length of `v` is not.
pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let n = norm(v);
    match n {
        0.0 => v,
        n if n.is_finite() => v.map(|x| x / n),
        n => [n; 3],
    }
}

/// The level vector of a length and a heading.
pub(super) fn polar(length: f64, heading: f64) -> [f64; 3] {
    let (s, c) = libm::sincos(heading);
    [length * c, length * s, 0.0]
}

/// `v` turned about z.
pub(super) fn turn(v: [f64; 3], by: f64) -> [f64; 3] {
    turned(v, turn_of(by))
}

/// Cosine and sine of a turn.
pub(super) fn turn_of(by: f64) -> [f64; 2] {
    let (s, c) = libm::sincos(by);
    [c, s]
}

/// `v` turned about z by a turn of which cosine and sine are given.
pub(super) fn turned([x, y, z]: [f64; 3], [c, s]: [f64; 2]) -> [f64; 3] {
    [x * c - y * s, x * s + y * c, z]
}

/// The level pose at a point that faces a heading.
pub(super) fn level_pose([x, y, z]: [f64; 3], heading: f64) -> [f64; 7] {
    let (s, c) = libm::sincos(heading / 2.0);
    [x, y, z, 0.0, 0.0, s, c]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `v` rotated by a unit quaternion: v + 2 u × (u × v + w v), with u the vector part.
pub(super) fn rotate([x, y, z, w]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let u = [x, y, z];
    let t = cross(u, v);
    let t = cross(u, [t[0] + w * v[0], t[1] + w * v[1], t[2] + w * v[2]]);
    [v[0] + 2.0 * t[0], v[1] + 2.0 * t[1], v[2] + 2.0 * t[2]]
}

/// The inverse of a unit quaternion.
pub(super) fn conjugate([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, -y, -z, w]
}

/// First `b`, then `a`, at length one.
pub(super) fn product([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    let q = [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ];
    let n = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.map(|c| c / n)
}

pub(super) fn position(pose: [f64; 7]) -> [f64; 3] {
    [pose[0], pose[1], pose[2]]
}

pub(super) fn orientation(pose: [f64; 7]) -> [f64; 4] {
    [pose[3], pose[4], pose[5], pose[6]]
}

/// `pose`, given in a frame whose origin is at `origin`, in the frame of `origin`.
pub(super) fn place(pose: [f64; 7], origin: [f64; 7]) -> [f64; 7] {
    let p = point_from_body(position(pose), origin);
    let q = product(orientation(origin), orientation(pose));
    [p[0], p[1], p[2], q[0], q[1], q[2], q[3]]
}

pub(super) fn point_from_body(p: [f64; 3], pose: [f64; 7]) -> [f64; 3] {
    add(position(pose), rotate(orientation(pose), p))
}

pub(super) fn point_to_body(p: [f64; 3], pose: [f64; 7]) -> [f64; 3] {
    rotate(conjugate(orientation(pose)), sub(p, position(pose)))
}

/// Where a point is seen from a pose, counter-clockwise from straight ahead.
pub(super) fn bearing(of: [f64; 3], from: [f64; 7]) -> f64 {
    let p = point_to_body(of, from);
    direction(p[1], p[0])
}

/// Roll, pitch and yaw of a unit quaternion: rotations about x, then y, then z of the fixed frame
/// (REP-103); the pitch is within ±90°.
pub(super) fn yaw([x, y, z, w]: [f64; 4]) -> f64 {
    direction(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// See [`yaw`].
pub(super) fn pitch([x, y, z, w]: [f64; 4]) -> f64 {
    libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0))
}

/// See [`yaw`].
pub(super) fn roll([x, y, z, w]: [f64; 4]) -> f64 {
    direction(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
}

/// Where two circles in the xy-plane cross: count and points, at the height of `a`. Of two points the
/// first is to the left of the way from `a` to `b`.
///
/// Weisstein, E. W., Circle-Circle Intersection, MathWorld, equations (5) to (7). Circles with one
/// centre have no point in common here, also when they are equal; nor has one with a negative radius.
pub(super) fn circle_intersections(a: [f64; 3], ra: f64, b: [f64; 3], rb: f64) -> (usize, [[f64; 3]; 2]) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let d = libm::hypot(dx, dy);
    if d == 0.0 || ra < 0.0 || rb < 0.0 || d > ra + rb || d < (ra - rb).abs() {
        return (0, [[0.0; 3]; 2]);
    }
    let (ux, uy) = (dx / d, dy / d);
    let along = (d * d - rb * rb + ra * ra) / (2.0 * d);
    let across = (ra * ra - along * along).max(0.0).sqrt();
    let (x, y) = (a[0] + along * ux, a[1] + along * uy);
    let points = [[x - across * uy, y + across * ux, a[2]], [x + across * uy, y - across * ux, a[2]]];
    (if across > 0.0 { 2 } else { 1 }, points)
}

/// The fraction of `motion` at which a point that starts at `from` first comes within `radius` of
/// `center`, in the xy-plane: the lesser root of |from + t motion - center|² = radius². 0 for a point that is
/// inside already, or on the rim and approaching.
pub(super) fn first_contact(from: [f64; 3], motion: [f64; 3], center: [f64; 3], radius: f64) -> Option<f64> {
    if radius < 0.0 {
        return None;
    }
    let (fx, fy) = (from[0] - center[0], from[1] - center[1]);
    let (mx, my) = (motion[0], motion[1]);
    let (a, b, c) = (mx * mx + my * my, fx * mx + fy * my, fx * fx + fy * fy - radius * radius);
    if c < 0.0 || (c == 0.0 && b < 0.0) {
        return Some(0.0);
    }
    if a == 0.0 || b >= 0.0 {
        return None;
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    // c / (−b + √…) is (−b − √…) / a without cancellation.
    let t = c / (discriminant.sqrt() - b);
    (t <= 1.0).then_some(t)
}

/// The inverse of an n × n matrix, row by row, into `out`; false when a pivot is below 1e-13 of the largest
/// entry.
pub(super) fn inverse(n: usize, matrix: &[f64], out: &mut [f64]) -> bool {
    if n > 8 || matrix.len() < n * n || out.len() < n * n {
        return false;
    }
    let m = DMatrix::from_row_slice(n, n, &matrix[..n * n]);
    let limit = 1e-13 * m.amax();
    let lu = m.lu();
    if lu.u().diagonal().iter().any(|pivot| pivot.abs() <= limit) {
        return false;
    }
    let Some(inverse) = lu.try_inverse() else { return false };
    // Its columns are our rows.
    out[..n * n].copy_from_slice(inverse.transpose().as_slice());
    true
}
