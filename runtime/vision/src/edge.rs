//! Edges and the published way to the obstacle: split left and right of the optical centre, take the nearest pair.

use crate::attitude::{Attitude, cross, wrap};
use crate::lens::Lens;
use crate::segment::Segment;
use crate::why::Why;

/// A refined near-vertical edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The fitted line from its upper to its lower end, pixels.
    pub line: Segment,
    /// Standard error of the line's x from the scatter of its rows, pixels.
    pub sigma: f64,
    /// Mean gradient across, grey levels over two pixels.
    pub strength: f64,
    /// Mean sign of the gradient: 1 brighter on the right on every row, −1 on the left.
    pub polarity: f64,
    /// Share of its rows that show it, 0 to 1.
    pub support: f64,
}

/// Where a vertical edge stands in the level frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upright {
    /// Azimuth, radians, left positive, from the level frame's heading.
    pub bearing: f64,
    /// Angle between the edge's image plane and the vertical plane through it, radians: zero for a vertical thing.
    pub tilt: f64,
    /// Tangent of the elevation of the upper end, up positive.
    pub upper: f64,
    /// Tangent of the elevation of the lower end, up positive.
    pub lower: f64,
}

impl Edge {
    /// x at the optical row (the row of the optical centre), pixels, on the line or its continuation.
    pub fn x(&self, lens: &Lens) -> f64 {
        self.line.x_at(lens.cy)
    }

    /// The edge in the level frame: the plane through the eye and the edge, turned level, cut with the horizontal.
    /// Exact for any roll, pitch and yaw. `None` where the lens or the geometry gives none.
    pub fn upright(&self, lens: &Lens, attitude: &Attitude) -> Option<Upright> {
        upright(&self.line, lens, attitude)
    }
}

/// [`Edge::upright`] of a plain segment.
pub fn upright(line: &Segment, lens: &Lens, attitude: &Attitude) -> Option<Upright> {
    let top = attitude.level(lens.ray(line.top[0], line.top[1])?);
    let bottom = attitude.level(lens.ray(line.bottom[0], line.bottom[1])?);
    let normal = cross(top, bottom);
    let size = libm::sqrt(normal.iter().map(|v| v * v).sum());
    let flat = libm::hypot(normal[0], normal[1]);
    if !(size > 1e-12 && flat > 1e-9 * size) {
        return None;
    }
    // normal × up lies in the edge's plane and is horizontal; of its two senses the one the camera looks at.
    let (mut x, mut y) = (normal[1], -normal[0]);
    if x * (top[0] + bottom[0]) + y * (top[1] + bottom[1]) < 0.0 {
        (x, y) = (-x, -y);
    }
    let elevation = |ray: [f64; 3]| ray[2] / libm::hypot(ray[0], ray[1]).max(1e-9);
    let found = Upright {
        bearing: libm::atan2(y, x),
        tilt: libm::asin((normal[2] / size).clamp(-1.0, 1.0)),
        upper: elevation(top),
        lower: elevation(bottom),
    };
    [found.bearing, found.tilt, found.upper, found.lower].iter().all(|v| v.is_finite()).then_some(found)
}

/// The segment at which an upright edge is seen; `None` when it is not ahead.
pub fn seen(edge: &Upright, lens: &Lens, attitude: &Attitude) -> Option<Segment> {
    let (s, c) = libm::sincos(wrap(edge.bearing));
    let end = |elevation: f64| lens.pixel(attitude.body([c, s, elevation]));
    Some(Segment::new(end(edge.upper)?, end(edge.lower)?))
}

/// The image side of the optical centre on which an edge stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// x smaller than that of the optical centre.
    Left,
    /// x greater than or equal to that of the optical centre.
    Right,
}

/// Left or right of the optical centre, by x at the optical row.
pub fn side(line: &Segment, lens: &Lens) -> Side {
    if line.x_at(lens.cy) < lens.cx { Side::Left } else { Side::Right }
}

/// The published pair (SOIFRA, Algorithm 1): of the edges on each side of the optical centre the nearest to it.
/// Indices into `edges`: left, right.
///
/// # Errors
/// [`Why::NoFeatures`] without edges, [`Why::OneEdge`] when one side has none.
pub fn nearest_pair(edges: &[Edge], lens: &Lens) -> Result<(usize, usize), Why> {
    let nearest = |wanted: Side| {
        let away = |e: &Edge| (e.x(lens) - lens.cx).abs();
        edges
            .iter()
            .enumerate()
            .filter(|(_, e)| side(&e.line, lens) == wanted && away(e).is_finite())
            .min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)))
            .map(|(k, _)| k)
    };
    match (nearest(Side::Left), nearest(Side::Right)) {
        (Some(l), Some(r)) => Ok((l, r)),
        (None, None) => Err(Why::NoFeatures),
        _ => Err(Why::OneEdge),
    }
}
