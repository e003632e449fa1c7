//! The top view: the world, who went where, what touched.

mod frame;
mod legend;
mod tracks;
mod view;
mod world;

use super::Drawing;
use crate::trace_file::{Header, Reader, Trace, TraceError, shape};
use frame::{LEFT, RIGHT, ROOM, TOP};
use std::io::Read;
use tracks::Tracks;
use view::{Extent, View};

/// Everything that the parts of a picture are drawn from.
struct Scene<'a> {
    header: &'a Header,
    tracks: Tracks,
    view: View,
    complete: bool,
}

/// The top view of a trace in memory.
pub fn top_view(trace: &Trace) -> Drawing {
    let mut tracks = Tracks::default();
    trace.records.iter().for_each(|r| tracks.take(r));
    draw(&trace.header, tracks, trace.complete)
}

/// The top view of a trace of any length, which is read to its end with the memory of a chunk and of the
/// paths.
pub fn top_view_of<R: Read>(mut reader: Reader<R>) -> Result<Drawing, TraceError> {
    let mut tracks = Tracks::default();
    for record in reader.by_ref() {
        tracks.take(&record?);
    }
    Ok(draw(reader.header(), tracks, reader.complete()))
}

fn draw(header: &Header, tracks: Tracks, complete: bool) -> Drawing {
    let view = View::new(extent(header, &tracks), [LEFT, TOP], ROOM);
    let scene = Scene { header, tracks, view, complete };
    let [w, h] = view.size();
    let bottom = f64::max(TOP + h + frame::BOTTOM, TOP + legend::height(&scene));
    let mut drawing = Drawing::new(LEFT + w + RIGHT, bottom, frame::description(&scene));
    world::ground(&mut drawing, &scene);
    frame::grid(&mut drawing, &scene);
    world::things(&mut drawing, &scene);
    world::movers(&mut drawing, &scene);
    world::robots(&mut drawing, &scene);
    world::contacts(&mut drawing, &scene);
    frame::axes(&mut drawing, &scene);
    frame::titles(&mut drawing, &scene);
    legend::draw(&mut drawing, &scene);
    drawing
}

/// Everything there is to see.
fn extent(header: &Header, tracks: &Tracks) -> Extent {
    let mut extent = Extent::NOTHING;
    for shape in header.scene.world.iter().filter_map(shape::of_part) {
        match shape {
            shape::Shape::Cylinder { at, radius, .. } => extent.take([at[0], at[1]], radius),
            shape::Shape::Box { .. } => world::corners(&shape).into_iter().for_each(|c| extent.take(c, 0.0)),
        }
    }
    for (i, robot) in header.scene.bodies().iter().enumerate() {
        let radius = shape::robot_body(&header.scene, i).radius;
        extent.take([robot.start[0], robot.start[1]], radius);
        if let Some(target) = robot.target {
            extent.take([target[0], target[1]], 0.0);
        }
        if let Some(track) = tracks.robots.get(&i) {
            track.points.iter().for_each(|(_, p)| extent.take(*p, radius));
        }
    }
    for (name, track) in &tracks.movers {
        let radius = world::mover_radius(header, name);
        track.points.iter().for_each(|(_, p)| extent.take(*p, radius));
    }
    extent
}
