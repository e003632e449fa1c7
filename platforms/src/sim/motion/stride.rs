//! A stride: straight, at constant speed, then rest.

use super::Stride;
use crate::sim::body::{Body, Piece, seconds};

/// Plans a stride of a robot that turns freely: it faces the heading at once, walks, and then rests. Longer
/// strides than `top_speed` allows fall short; `scale` is the error of the drive. A stride that would go
/// on beyond `expires` is broken off there.
///
/// Returns the commanded speed and when the walking ends.
pub fn walk(
    body: &mut Body,
    now: i64,
    stride: Stride,
    expires: i64,
    top_speed: f64,
    scale: f64,
    checked: i64,
) -> (f64, i64) {
    let mut from = body.place(now);
    from.heading = stride.heading;
    let end = now.saturating_add(stride.duration).min(expires);
    let speed = (stride.length / seconds(0, stride.duration)).clamp(-top_speed, top_speed);
    let ground = speed * scale;
    body.push(Piece::sliding(now, end, from, [ground, 0.0], ground.abs()), checked);
    (speed, end)
}
