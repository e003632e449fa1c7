//! What is in the top view: the world, the robots, the movers, the contacts.

use super::{Scene, tracks::simplify, view::in_sight};
use crate::{
    plot::{
        drawing::{Color, Drawing, Style, faint, filled, ink, stroked},
        page::{DARK, MILD, RED, WHITE},
    },
    trace_file::{
        Header, palette,
        shape::{self, Shape},
    },
};

const WALL: Color = [62, 67, 77];
const OBSTACLE: Color = [168, 175, 186];
const REGION: Color = [46, 160, 87];
const MOVER: Color = [140, 148, 160];
const OUTSIDE: Color = [240, 242, 245];

/// Paths are drawn to a fifth of a point.
const TOLERANCE: f64 = 0.2;
/// Up to so many places of a path are marked by dots: they are steps.
const STEPS: usize = 120;

/// Corners of a box, counter-clockwise; none of another shape.
pub(super) fn corners(shape: &Shape) -> Vec<[f64; 2]> {
    let Shape::Box { at, size, heading } = shape else { return Vec::new() };
    let (sin, cos) = (libm::sin(*heading), libm::cos(*heading));
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
        .map(|(u, v)| (u * size[0], v * size[1]))
        .map(|(u, v)| [at[0] + u * cos - v * sin, at[1] + u * sin + v * cos])
        .to_vec()
}

/// Radius of a mover in metres.
pub(super) fn mover_radius(header: &Header, name: &str) -> f64 {
    let part = header.scene.world.iter().find(|p| matches!(&*p.role, "mover" | "parcel") && p.name == name);
    if let Some(parcel) = part.filter(|p| &*p.role == "parcel") {
        return parcel.number("radius").clamp(0.0, 1e9);
    }
    part.and_then(shape::mover_body).map_or(0.0, |b| b.radius).clamp(0.0, 1e9)
}

pub(super) fn region_style() -> Style {
    filled(faint(REGION, 0.14)).outline(faint(REGION, 0.9), 1.2).dashed(4.0)
}

pub(super) fn obstacle_style() -> Style {
    filled(ink(OBSTACLE)).outline(ink(WALL), 1.2)
}

pub(super) fn wall_style() -> Style {
    filled(ink(WALL)).outline(ink(WALL), 1.2)
}

pub(super) fn mover_style() -> Style {
    filled(faint(MOVER, 0.45)).outline(ink(MILD), 1.2)
}

pub(super) fn mover_track_style() -> Style {
    Style::default().outline(faint(MOVER, 0.5), 1.6)
}

fn add(drawing: &mut Drawing, scene: &Scene, shape: &Shape, style: Style) {
    let view = &scene.view;
    match shape {
        Shape::Cylinder { at, radius, .. } if in_sight(at) && in_sight(&[*radius]) => {
            // Never smaller than can be seen.
            drawing.circle(view.place([at[0], at[1]]), f64::max(radius.abs() * view.scale, 1.5), style);
        }
        Shape::Box { at, size, .. } if in_sight(at) && in_sight(size) => {
            let corners: Vec<_> = corners(shape).into_iter().map(|c| view.place(c)).collect();
            drawing.polygon(&corners, style);
        }
        _ => {}
    }
}

/// The ground: the bounds are white, what lies outside is grey.
pub(super) fn ground(drawing: &mut Drawing, scene: &Scene) {
    let bounds: Vec<Shape> =
        scene.header.scene.world.iter().filter(|p| &*p.role == "bounds").filter_map(shape::of_part).collect();
    let outside = if bounds.is_empty() { WHITE } else { OUTSIDE };
    drawing.rectangle(scene.view.origin, scene.view.size(), filled(ink(outside)));
    for shape in &bounds {
        add(drawing, scene, shape, filled(ink(WHITE)).outline(faint(MILD, 0.6), 0.8));
    }
}

/// Regions below, then obstacles and walls.
pub(super) fn things(drawing: &mut Drawing, scene: &Scene) {
    for (role, style) in [("region", region_style()), ("obstacle", obstacle_style()), ("wall", wall_style())]
    {
        for part in scene.header.scene.world.iter().filter(|p| &*p.role == role) {
            if let Some(shape) = shape::of_part(part) {
                add(drawing, scene, &shape, style);
            }
        }
    }
}

pub(super) fn movers(drawing: &mut Drawing, scene: &Scene) {
    for track in scene.tracks.movers.values() {
        let places: Vec<_> = track.points.iter().map(|(_, p)| scene.view.place(*p)).collect();
        drawing.line(&simplify(&places, TOLERANCE), mover_track_style());
    }
    for (name, track) in &scene.tracks.movers {
        if let Some(end) = track.end() {
            let radius = f64::max(mover_radius(scene.header, name) * scene.view.scale, 2.5);
            drawing.circle(scene.view.place(end), radius, mover_style());
        }
    }
}

/// Paths below, then starts and targets, then bodies, through which a reached target shows.
pub(super) fn robots(drawing: &mut Drawing, scene: &Scene) {
    let (view, robots) = (&scene.view, scene.header.scene.bodies());
    // Many robots are drawn finer.
    let grain = if robots.len() > 60 { 0.5 } else { 1.0 };
    for (i, track) in &scene.tracks.robots {
        let color = palette::robot(*i);
        let mut places: Vec<_> = track.points.iter().map(|(_, p)| view.place(*p)).collect();
        drawing.line(&simplify(&places, TOLERANCE), stroked(color, 1.9 * grain));
        places.dedup();
        if places.len() <= STEPS {
            // Dots that run into each other say nothing.
            let mut last = None;
            for p in places {
                if last.is_none_or(|q: [f64; 2]| libm::hypot(p[0] - q[0], p[1] - q[1]) > 6.0) {
                    drawing.circle(p, 2.1, filled(ink(color)));
                    last = Some(p);
                }
            }
        }
    }
    for (i, robot) in robots.iter().enumerate() {
        let (first, color) = (scene.tracks.robots.get(&i).and_then(|t| t.points.first()), palette::robot(i));
        let first = first.map_or([robot.start[0], robot.start[1]], |p| p.1);
        if in_sight(&first) {
            start(drawing, view.place(first), grain, color);
        }
        if let Some(t) = robot.target.filter(|t| in_sight(t)) {
            target(drawing, view.place([t[0], t[1]]), grain, color);
        }
    }
    for (i, track) in &scene.tracks.robots {
        if let Some(end) = track.end() {
            let radius = shape::robot_body(&scene.header.scene, *i).radius * view.scale;
            let radius = radius.clamp(4.0 * grain, 1e4);
            body(drawing, view.place(end), radius, track.heading, palette::robot(*i));
        }
    }
}

pub(super) fn path_style(color: Color) -> Style {
    stroked(color, 1.9)
}

/// A ring.
pub(super) fn start(drawing: &mut Drawing, at: [f64; 2], grain: f64, color: Color) {
    drawing.circle(at, 4.6 * grain, filled(ink(WHITE)).outline(ink(color), 2.0 * grain));
}

/// A disc with a tick, beyond its rim, to where it faces.
pub(super) fn body(drawing: &mut Drawing, at: [f64; 2], radius: f64, heading: f64, color: Color) {
    drawing.circle(at, radius, filled(faint(color, 0.35)).outline(ink(color), 1.6));
    let tip = f64::max(1.3 * radius, f64::min(radius + 3.0, 2.0 * radius));
    let [from, to] =
        [0.55 * radius, tip].map(|r| [at[0] + r * libm::cos(heading), at[1] - r * libm::sin(heading)]);
    drawing.line(&[from, to], stroked(DARK, 2.0));
}

/// An upright cross.
pub(super) fn target(drawing: &mut Drawing, [x, y]: [f64; 2], grain: f64, color: Color) {
    let reach = 6.0 * grain;
    for style in [stroked(WHITE, 4.4 * grain), stroked(color, 2.0 * grain)] {
        drawing.line(&[[x - reach, y], [x + reach, y]], style);
        drawing.line(&[[x, y - reach], [x, y + reach]], style);
    }
}

pub(super) fn contacts(drawing: &mut Drawing, scene: &Scene) {
    let mut places: Vec<[f64; 2]> = Vec::new();
    for (t, robot) in &scene.tracks.contacts {
        let at = scene.tracks.robots.get(robot).and_then(|track| track.at(*t));
        let Some(at) = at.map(|p| scene.view.place(p)) else { continue };
        // Two robots that touch each other many times over are one mark.
        if !places.iter().rev().take(64).any(|p| libm::hypot(p[0] - at[0], p[1] - at[1]) < 2.0) {
            contact(drawing, at);
            places.push(at);
        }
    }
}

/// A red cross in a ring.
pub(super) fn contact(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    let r = 4.2;
    for style in [stroked(WHITE, 4.6), stroked(RED, 2.2)] {
        drawing.circle([x, y], 7.2, style);
        drawing.line(&[[x - r, y - r], [x + r, y + r]], style);
        drawing.line(&[[x - r, y + r], [x + r, y - r]], style);
    }
}
