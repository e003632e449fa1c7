//! What is around the top view: axes, grid, titles.

use super::Scene;
use crate::plot::{
    drawing::{Align, Drawing, Style, faint, stroked},
    font,
    page::{self, DARK, GRID, SMALL},
};

/// Margins of the page around the picture, and the room for the picture.
pub(super) const LEFT: f64 = 76.0;
pub(super) const TOP: f64 = 74.0;
pub(super) const RIGHT: f64 = 206.0;
pub(super) const BOTTOM: f64 = 62.0;
pub(super) const ROOM: [f64; 2] = [680.0, 680.0];

/// Ticks at least so far apart.
const TICK_DISTANCE: f64 = 62.0;

/// What the picture shows, in a line.
pub(super) fn description(scene: &Scene) -> String {
    format!("Top view of {}. {}", page::title(scene.header), subtitle(scene))
}

fn subtitle(scene: &Scene) -> String {
    page::subtitle(scene.header, &scene.tracks.ending, scene.complete)
}

pub(super) fn titles(drawing: &mut Drawing, scene: &Scene) {
    page::titles(drawing, LEFT, page::title(scene.header), &subtitle(scene));
}

pub(super) fn grid(drawing: &mut Drawing, scene: &Scene) {
    let (view, [w, h]) = (&scene.view, scene.view.size());
    let unit = view.unit();
    let step = view.step(unit, TICK_DISTANCE);
    let style = Style::default().outline(faint(GRID, 0.22), 0.8);
    for (x, _) in view.ticks(0, unit, step) {
        drawing.line(&[[x, TOP], [x, TOP + h]], style);
    }
    for (y, _) in view.ticks(1, unit, step) {
        drawing.line(&[[LEFT, y], [LEFT + w, y]], style);
    }
}

pub(super) fn axes(drawing: &mut Drawing, scene: &Scene) {
    let (view, [w, h]) = (&scene.view, scene.view.size());
    let (right, bottom) = (LEFT + w, TOP + h);
    drawing.rectangle([LEFT, TOP], [w, h], stroked(DARK, 1.2));
    let unit = view.unit();
    let step = view.step(unit, TICK_DISTANCE);
    for (x, label) in view.ticks(0, unit, step) {
        drawing.line(&[[x, bottom], [x, bottom + 5.0]], stroked(DARK, 1.2));
        drawing.text([x, bottom + 19.5], Align::Middle, SMALL, false, &label);
    }
    let mut widest: f64 = 0.0;
    for (y, label) in view.ticks(1, unit, step) {
        widest = widest.max(font::width(&label, SMALL.size));
        drawing.line(&[[LEFT - 5.0, y], [LEFT, y]], stroked(DARK, 1.2));
        drawing.text([LEFT - 11.0, y + SMALL.size / 2.0], Align::End, SMALL, false, &label);
    }
    let name = |axis: &str| format!("{axis} ({})", unit.name);
    drawing.text([(LEFT + right) / 2.0, bottom + 42.0], Align::Middle, SMALL, false, &name("x"));
    drawing.text([LEFT - 11.0 - widest - 14.0, (TOP + bottom) / 2.0], Align::Middle, SMALL, true, &name("y"));
}
