//! The marks of a message sequence chart: heads, arrows, boxes, crosses.

use super::{
    Lifeline,
    layout::{BESIDE, LOOP},
};
use crate::plot::{
    drawing::{Align, Color, Drawing, Lettering, Style, faint, filled, ink, stroked},
    font,
    page::{BOLD, DARK, FINE, RED, SMALL, WHITE},
};

/// Height of a head.
pub(super) const HEAD: f64 = 38.0;
/// Height of a box in a row.
const BOX: f64 = 19.0;

/// A head with its name, its middle at a place.
pub(super) fn head(drawing: &mut Drawing, [x, y]: [f64; 2], width: f64, l: &Lifeline) {
    let corner = [x - width / 2.0, y - HEAD / 2.0];
    drawing.rectangle(corner, [width, HEAD], filled(ink(WHITE)));
    drawing.rectangle(corner, [width, HEAD], filled(faint(l.color, 0.14)).outline(ink(l.color), 1.4));
    if l.robot.is_empty() {
        drawing.text([x, y + BOLD.size / 2.0], Align::Middle, BOLD, false, &l.name);
    } else {
        drawing.text([x, y - 2.5], Align::Middle, BOLD, false, &l.name);
        drawing.text([x, y + 12.0], Align::Middle, FINE, false, &l.robot);
    }
}

/// An arrow, or a cross where it was to go.
pub(super) fn arrow(drawing: &mut Drawing, from: f64, to: f64, y: f64, lost: bool, color: Color) {
    let way = if to > from { 1.0 } else { -1.0 };
    if lost {
        drawing.line(&[[from, y], [to - way * 6.0, y]], stroked(color, 1.6).dashed(5.0));
        cross(drawing, [to, y], 5.0);
    } else {
        drawing.line(&[[from, y], [to - way * 8.0, y]], stroked(color, 1.6));
        tip(drawing, [to, y], way, color);
    }
}

/// An arrow from a lifeline back to itself.
pub(super) fn to_itself(drawing: &mut Drawing, [x, y]: [f64; 2], lost: bool, color: Color) {
    let (high, right) = (y - 11.0, x + LOOP);
    let path = [[x, high], [right, high], [right, y], [x + if lost { 14.0 } else { 8.0 }, y]];
    let style = stroked(color, 1.6);
    drawing.line(&path, if lost { style.dashed(5.0) } else { style });
    if lost { cross(drawing, [x + 10.0, y], 5.0) } else { tip(drawing, [x, y], -1.0, color) }
}

fn tip(drawing: &mut Drawing, [x, y]: [f64; 2], way: f64, color: Color) {
    let back = x - way * 9.0;
    drawing.polygon(&[[x - way, y], [back, y - 4.0], [back, y + 4.0]], filled(ink(color)));
}

pub(super) fn cross(drawing: &mut Drawing, [x, y]: [f64; 2], r: f64) {
    for style in [stroked(WHITE, 4.4), stroked(RED, 2.2)] {
        drawing.line(&[[x - r, y - r], [x + r, y + r]], style);
        drawing.line(&[[x - r, y + r], [x + r, y - r]], style);
    }
}

/// A box on a lifeline: filled when something begins.
pub(super) fn boxed(
    drawing: &mut Drawing,
    [x, y]: [f64; 2],
    width: f64,
    begins: bool,
    color: Color,
    text: &str,
) {
    let corner = [x - width / 2.0, y - BOX / 2.0];
    drawing.rectangle(corner, [width, BOX], filled(ink(WHITE)));
    let fill = if begins { filled(faint(color, 0.2)) } else { Style::default() };
    drawing.rectangle(corner, [width, BOX], fill.outline(ink(color), 1.1));
    drawing.text([x, y + SMALL.size / 2.0], Align::Middle, SMALL, false, text);
}

/// A point on a lifeline.
pub(super) fn point(drawing: &mut Drawing, at: [f64; 2], color: Color) {
    drawing.circle(at, 4.0, filled(ink(WHITE)).outline(ink(color), 1.8));
}

/// A stroke across a lifeline, where something is over.
pub(super) fn tick(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x - 6.0, y], [x + 6.0, y]], stroked(DARK, 2.0));
}

/// A text to the right of a lifeline, `beyond` the mark on it.
pub(super) fn beside(drawing: &mut Drawing, [x, y]: [f64; 2], beyond: f64, look: Lettering, text: &str) {
    let left = x + beyond + BESIDE;
    // The hair line of the row does not strike it through.
    let size = [font::width(text, look.size) + 8.0, 16.0];
    drawing.rectangle([left - 4.0, y - 8.0], size, filled(ink(WHITE)));
    drawing.text([left, y + look.size / 2.0], Align::Start, look, false, text);
}
