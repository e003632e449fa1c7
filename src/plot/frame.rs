//! What is around the picture: axes, grid, titles.

use super::{
    Scene,
    drawing::{Align, Color, Drawing, Lettering, faint, stroked},
    font,
};

/// Margins of the page around the picture, and the room for the picture.
pub(super) const LEFT: f64 = 76.0;
pub(super) const TOP: f64 = 74.0;
pub(super) const RIGHT: f64 = 206.0;
pub(super) const BOTTOM: f64 = 62.0;
pub(super) const ROOM: [f64; 2] = [680.0, 680.0];

/// Colour of letters and axes.
pub(super) const DARK: Color = [38, 42, 50];
/// Colour of what matters less.
pub(super) const MILD: Color = [96, 104, 116];
/// Colour of the grid.
const GRID: Color = [120, 130, 145];

pub(super) const SMALL: Lettering = Lettering { size: 9.2, color: DARK, bold: false };

/// Ticks at least so far apart.
const TICK_DISTANCE: f64 = 62.0;

/// What the picture shows, in a line.
pub(super) fn description(scene: &Scene) -> String {
    format!("Top view of {}. {}", title(scene), subtitle(scene))
}

fn title<'a>(scene: &Scene<'a>) -> &'a str {
    let header = scene.header;
    if header.title.is_empty() { &header.mission } else { &header.title }
}

fn subtitle(scene: &Scene) -> String {
    let (header, t) = (scene.header, scene.tracks.last.seconds());
    let t = format!("{t:.3}");
    let t = t.trim_end_matches('0').trim_end_matches('.');
    let end = match &scene.tracks.outcome {
        // A success needs no reason.
        Some((outcome, reason)) if reason.is_empty() || outcome == "success" => format!("{outcome} at {t} s"),
        Some((outcome, reason)) => format!("{outcome} at {t} s: {reason}"),
        None if scene.complete => format!("no outcome recorded, last record at {t} s"),
        None => format!("the trace is cut off at {t} s"),
    };
    let set: String = header.params_set().iter().map(|p| format!(", {p}")).collect();
    format!("{}, seed {}{set}: {end}", header.mission, header.seed())
}

pub(super) fn titles(drawing: &mut Drawing, scene: &Scene) {
    let room = drawing.width - LEFT - 16.0;
    let large = Lettering { size: 13.5, color: DARK, bold: true };
    drawing.text([LEFT, 34.0], Align::Start, large, false, &font::fit(title(scene), large.size, room));
    let small = Lettering { color: MILD, size: 9.6, ..SMALL };
    drawing.text([LEFT, 56.0], Align::Start, small, false, &font::fit(&subtitle(scene), small.size, room));
}

pub(super) fn grid(drawing: &mut Drawing, scene: &Scene) {
    let (view, [w, h]) = (&scene.view, scene.view.size());
    let unit = view.unit();
    let step = view.step(unit, TICK_DISTANCE);
    let style = super::drawing::Style::default().outline(faint(GRID, 0.22), 0.8);
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
