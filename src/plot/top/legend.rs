//! The legend: robots by colour and name, what the marks mean, the scale.

use super::{
    Scene,
    frame::{LEFT, RIGHT, TOP},
    world,
};
use crate::{
    plot::{
        axis,
        drawing::{Align, Drawing, Lettering, filled, ink, stroked},
        font,
        page::{DARK, MILD, SMALL},
    },
    trace_file::palette,
};

/// Height of a row.
const ROW: f64 = 21.0;
/// Greatest number of robots that are named.
const NAMED: usize = 16;
/// Space between the picture and the legend, and from there to the texts.
const SPACE: f64 = 22.0;
const INDENT: f64 = 34.0;

/// A mark and what it means.
type Entry = (fn(&mut Drawing, [f64; 2]), &'static str);

/// The marks that are in the picture.
fn entries(scene: &Scene) -> Vec<Entry> {
    let has = |role: &str| scene.header.scene.world.iter().any(|p| &*p.role == role);
    let mut entries: Vec<Entry> = Vec::new();
    if !scene.header.scene.bodies().is_empty() {
        entries.push((|d, at| world::start(d, at, 1.0, MILD), "start"));
    }
    if !scene.tracks.robots.is_empty() {
        entries.push((|d, at| world::body(d, at, 6.0, 0.0, MILD), "end, with heading"));
    }
    if scene.header.scene.bodies().iter().any(|r| r.target.is_some()) {
        entries.push((|d, at| world::target(d, at, 1.0, MILD), "target"));
    }
    if !scene.tracks.movers.is_empty() {
        entries.push((
            |d, [x, y]| {
                d.line(&[[x - 12.0, y], [x + 12.0, y]], world::mover_track_style());
                d.circle([x + 5.0, y], 5.5, world::mover_style());
            },
            "mover, at the end",
        ));
    }
    if !scene.tracks.contacts.is_empty() {
        entries.push((world::contact, "contact"));
    }
    if has("obstacle") {
        entries.push((
            |d, [x, y]| d.rectangle([x - 7.0, y - 5.0], [14.0, 10.0], world::obstacle_style()),
            "obstacle",
        ));
    }
    if has("wall") {
        entries
            .push((|d, [x, y]| d.rectangle([x - 10.0, y - 1.2], [20.0, 2.4], world::wall_style()), "wall"));
    }
    if has("region") {
        entries.push((
            |d, [x, y]| d.rectangle([x - 9.0, y - 5.5], [18.0, 11.0], world::region_style()),
            "region",
        ));
    }
    entries
}

fn robot_rows(scene: &Scene) -> usize {
    let robots = scene.header.scene.bodies().len();
    if robots > NAMED { NAMED + 1 } else { robots }
}

/// Height of the legend, from the top of the picture.
pub(super) fn height(scene: &Scene) -> f64 {
    (robot_rows(scene) + entries(scene).len()) as f64 * ROW + 96.0
}

pub(super) fn draw(drawing: &mut Drawing, scene: &Scene) {
    let left = LEFT + scene.view.size()[0] + SPACE;
    let room = RIGHT - SPACE - INDENT - 10.0;
    let mut y = TOP + 10.0;
    let base = |y: f64| [left + INDENT, y + SMALL.size / 2.0];
    let robots = scene.header.scene.bodies();
    let named = if robots.len() > NAMED { NAMED } else { robots.len() };
    for (i, robot) in robots.iter().take(named).enumerate() {
        let color = palette::robot(i);
        drawing.line(&[[left, y], [left + 24.0, y]], world::path_style(color));
        drawing.circle([left + 12.0, y], 3.2, filled(ink(color)));
        drawing.text(base(y), Align::Start, SMALL, false, &font::fit(&robot.name, SMALL.size, room));
        y += ROW;
    }
    if robots.len() > named {
        let rest = format!("and {} more robots", robots.len() - named);
        drawing.text(
            [left, y + SMALL.size / 2.0],
            Align::Start,
            Lettering { color: MILD, ..SMALL },
            false,
            &rest,
        );
        y += ROW;
    }
    y += 12.0;
    for (mark, meaning) in entries(scene) {
        mark(drawing, [left + 12.0, y]);
        drawing.text(base(y), Align::Start, SMALL, false, meaning);
        y += ROW;
    }
    scale_bar(drawing, scene, [left, y + 26.0]);
}

/// A bar of a round length.
fn scale_bar(drawing: &mut Drawing, scene: &Scene, [x, y]: [f64; 2]) {
    let unit = scene.view.unit();
    let length = axis::nice(60.0 / scene.view.scale / unit.metres);
    let end = x + length * unit.metres * scene.view.scale;
    drawing.line(&[[x, y], [end, y]], stroked(DARK, 2.0));
    for at in [x, end] {
        drawing.line(&[[at, y - 4.0], [at, y + 4.0]], stroked(DARK, 2.0));
    }
    let label = format!("{length} {}", unit.name);
    drawing.text([(x + end) / 2.0, y - 9.0], Align::Middle, SMALL, false, &label);
}
