//! What the range sensors share: what could be in sight, and the form of a beam.

use super::View;
use crate::sim::geometry::{Aabb, Shape, Vec2};
use soifra_graph::reason;

/// Something that a beam at one height could meet.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// Footprint.
    pub shape: Shape,
    /// How much infrared it reflects.
    pub reflectance: f64,
}

/// The most beams a sensor may have.
pub const MOST_BEAMS: i64 = 65_536;

/// Gathers all that comes within `reach` of `from` and stands in the way of a beam at a height over the
/// ground of the world: walls, obstacles, movers, and all robots but the one that looks.
pub fn in_sight(view: &View<'_>, robot: usize, from: Vec2, reach: f64, height: f64, out: &mut Vec<Seen>) {
    out.clear();
    let area = Aabb::around(from, reach);
    let stands = |span: [f64; 2]| span[0] <= height && height <= span[1];
    view.things.grid.query(&area, |i| {
        let t = &view.things.all[i as usize];
        if stands(t.span) {
            out.push(Seen { shape: t.shape, reflectance: t.reflectance });
        }
    });
    let mut body = |i: usize| {
        let b = &view.bodies[i];
        if i != robot && stands(b.span(view.at.0)) {
            let shape = Shape::Disc { at: b.place(view.at.0).at, radius: b.radius };
            out.push(Seen { shape, reflectance: b.reflectance });
        }
    };
    view.nearby.robots.query(&area, |i| body(i as usize));
    view.nearby.movers.query(&area, |i| body((view.nearby.count + i) as usize));
}

/// Appends a beam: bearing, tag, range. A surface nearer than the low end of the range reads as the low
/// end, and noise does not carry a reading out of the range.
pub fn beam(out: &mut Vec<f64>, bearing: f64, range: Option<f64>, within: (f64, f64)) {
    match range {
        Some(r) => out.extend_from_slice(&[bearing, 0.0, r.clamp(within.0, within.1)]),
        None => out.extend_from_slice(&[bearing, reason::tag(reason::NOTHING_IN_RANGE), 0.0]),
    }
}
