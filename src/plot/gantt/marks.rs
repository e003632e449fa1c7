//! The marks of a schedule, and the legend that explains those in use.

use super::Gantt;
use crate::plot::{
    drawing::{Align, Color, Drawing, Style, faint, filled, ink, stroked},
    font,
    page::{DARK, MILD, RED, SMALL, WHITE},
};

/// Height of the bars of what runs.
pub(super) const BAR: f64 = 12.0;
/// Height of the arrow of a release, from the foot of the bars.
const ARROW: f64 = 21.0;
/// Width of the lines of marks that stand close together.
const THIN: f64 = 0.75;
/// Space between entries of the legend.
const SPACE: f64 = 26.0;
/// Height of a row of the legend.
const ROW: f64 = 30.0;

/// A bar of what runs; `y` is its foot.
pub(super) fn bar(drawing: &mut Drawing, from: f64, to: f64, y: f64, color: Color) {
    drawing.rectangle([from, y - BAR], [f64::max(to - from, 0.5), BAR], filled(ink(color)));
}

/// A bar of what is released and not done.
pub(super) fn pending(drawing: &mut Drawing, from: f64, to: f64, y: f64, color: Color) {
    drawing.rectangle([from, y - BAR], [to - from, BAR], filled(faint(color, 0.2)));
}

/// A bar of a device that is used.
pub(super) fn used(drawing: &mut Drawing, from: f64, to: f64, y: f64, color: Color) {
    let style = filled(faint(color, 0.35)).outline(ink(color), 0.8);
    drawing.rectangle([from, y - BAR - 2.0], [f64::max(to - from, 0.5), BAR + 2.0], style);
}

pub(super) fn release(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x, y], [x, y - ARROW]], stroked(DARK, THIN));
    tip(drawing, [x, y - ARROW], filled(ink(DARK)));
}

/// What is released later than it was asked for; without its beginning when that is not in the picture.
pub(super) fn deferral(drawing: &mut Drawing, [x, y]: [f64; 2], until: f64, begins: bool) {
    let (high, from) = (y - ARROW + 2.5, if begins { x + 5.0 } else { x });
    if until > from + 3.0 {
        drawing.line(&[[from, high], [until - 3.0, high]], stroked(MILD, 1.0).dashed(2.5));
    }
    if begins {
        drawing.line(&[[x, y], [x, y - ARROW + 5.0]], stroked(DARK, THIN));
        tip(drawing, [x, y - ARROW], filled(ink(WHITE)).outline(ink(DARK), THIN));
    }
}

/// The upper end of an arrow.
fn tip(drawing: &mut Drawing, [x, y]: [f64; 2], style: Style) {
    drawing.polygon(&[[x, y], [x - 2.6, y + 5.5], [x + 2.6, y + 5.5]], style);
}

pub(super) fn completion(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x, y], [x, y - BAR - 4.0]], stroked(DARK, THIN));
    drawing.line(&[[x - 2.2, y - BAR - 4.0], [x + 2.2, y - BAR - 4.0]], stroked(DARK, THIN));
}

/// A deadline at which something was not done.
pub(super) fn miss(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x, y], [x, y - ARROW]], stroked(RED, 1.4));
    let middle = y - BAR / 2.0;
    for style in [stroked(WHITE, 3.6), stroked(RED, 1.8)] {
        drawing.line(&[[x - 3.6, middle - 3.6], [x + 3.6, middle + 3.6]], style);
        drawing.line(&[[x - 3.6, middle + 3.6], [x + 3.6, middle - 3.6]], style);
    }
}

/// A release that was passed over: no arrow, a ring.
pub(super) fn skip(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x, y], [x, y - ARROW + 6.0]], stroked(MILD, THIN));
    drawing.circle([x, y - ARROW + 3.0], 3.4, filled(ink(WHITE)).outline(ink(MILD), 1.2));
}

/// Draws a mark at a place, its foot at `y`.
type Mark = fn(&mut Drawing, [f64; 2]);

/// The marks that are in the picture, their widths and what they mean.
fn entries(gantt: &Gantt) -> Vec<(Mark, f64, &'static str)> {
    let has = |what: fn(&super::Lane) -> bool| gantt.lanes().any(what);
    let device = |l: &super::Lane| l.kind == super::Kind::Device;
    let mut entries: Vec<(Mark, f64, &'static str)> = Vec::new();
    if has(|l| l.kind != super::Kind::Device && !l.bars.is_empty()) {
        entries.push((|d, [x, y]| bar(d, x, x + 22.0, y, MILD), 22.0, "runs"));
    }
    if has(|l| !l.pending.is_empty()) {
        entries.push((|d, [x, y]| pending(d, x, x + 22.0, y, MILD), 22.0, "released, not done"));
    }
    if has(|l| !l.releases.is_empty()) {
        entries.push((|d, [x, y]| release(d, [x + 3.0, y]), 6.0, "release"));
    }
    if has(|l| !l.completions.is_empty()) {
        entries.push((|d, [x, y]| completion(d, [x + 3.0, y]), 6.0, "done"));
    }
    if has(|l| !l.misses.is_empty()) {
        entries.push((|d, [x, y]| miss(d, [x + 4.0, y]), 8.0, "deadline, missed"));
    }
    if has(|l| !l.deferrals.is_empty()) {
        entries.push((|d, [x, y]| deferral(d, [x + 3.0, y], x + 30.0, true), 28.0, "too soon, deferred"));
    }
    if has(|l| !l.skips.is_empty()) {
        entries.push((|d, [x, y]| skip(d, [x + 3.0, y]), 6.0, "skipped"));
    }
    if gantt.lanes().any(|l| device(l) && !l.bars.is_empty()) {
        entries.push((|d, [x, y]| used(d, x, x + 22.0, y, MILD), 22.0, "device in use"));
    }
    if has(|l| l.waiting.iter().any(|w| w.1 > 0)) {
        entries.push((
            |d, [x, y]| d.text([x, y], Align::Start, SMALL, false, "2"),
            9.0,
            "so many wait for the device",
        ));
    }
    entries
}

/// Places of the legend's entries in a room of a width, and its height.
fn flow(gantt: &Gantt, room: f64) -> (Vec<[f64; 2]>, f64) {
    let (mut x, mut y, mut places) = (0.0, 0.0, Vec::new());
    for (_, width, text) in entries(gantt) {
        let width = width + 8.0 + font::width(text, SMALL.size);
        if x > 0.0 && x + width > room {
            (x, y) = (0.0, y + ROW);
        }
        places.push([x, y]);
        x += width + SPACE;
    }
    (places, y + ROW)
}

/// Height of the legend.
pub(super) fn height(gantt: &Gantt, room: f64) -> f64 {
    flow(gantt, room).1
}

/// The legend below a picture.
pub(super) fn legend(drawing: &mut Drawing, gantt: &Gantt, [left, top]: [f64; 2], room: f64) {
    for ((mark, width, text), [x, y]) in entries(gantt).into_iter().zip(flow(gantt, room).0) {
        let foot = top + y + ARROW;
        mark(drawing, [left + x, foot]);
        let base = foot - BAR / 2.0 + SMALL.size / 2.0;
        drawing.text([left + x + width + 8.0, base], Align::Start, SMALL, false, text);
    }
}
