//! A schedule as a picture: a lane below the other on one axis of time.

use super::{Gantt, Kind, Lane, marks};
use crate::{
    plot::{
        Drawing,
        axis::{TimeUnit, instants},
        drawing::{Align, Color, Lettering, Style, faint, filled, ink, stroked},
        font,
        page::{self, BOLD, DARK, FINE, GRID, MILD, SMALL},
    },
    trace_file::palette,
};
use soifra_runtime::Time;

const MARGIN: f64 = 24.0;
/// Width of the page, and of its right margin.
const WIDTH: f64 = 1200.0;
const RIGHT: f64 = 30.0;
/// Names of lanes are cut at this length.
const NAME: f64 = 210.0;
/// Space above the lanes: titles and an axis.
const TOP: f64 = 104.0;
/// Height of a lane, and its foot within.
const LANE: f64 = 31.0;
const FOOT: f64 = 27.0;
const HEADING: f64 = 30.0;
/// Ticks of the axis are at least so far apart, besides their texts.
const TICK_DISTANCE: f64 = 44.0;
const ZEBRA: Color = [246, 247, 249];

/// Where things are on the page.
struct Frame {
    from: Time,
    to: Time,
    left: f64,
    right: f64,
    bottom: f64,
    /// Places and texts of the axis.
    ticks: Vec<(f64, String)>,
    unit: TimeUnit,
}

impl Frame {
    fn new(gantt: &Gantt) -> Frame {
        let names = gantt.lanes().map(|l| font::width(&l.name, SMALL.size)).fold(80.0, f64::max);
        let rows = gantt.lanes().count() as f64 * LANE + gantt.groups.len() as f64 * HEADING;
        let unit = TimeUnit::of(Time((gantt.to.0).saturating_sub(gantt.from.0)));
        let mut frame = Frame {
            from: gantt.from,
            to: gantt.to,
            left: MARGIN + 12.0 + names.min(NAME) + 16.0,
            right: WIDTH - RIGHT,
            bottom: TOP + f64::max(rows, LANE),
            ticks: Vec::new(),
            unit,
        };
        // Texts as wide as those of the ends have to fit between ticks.
        let widest = [gantt.from, gantt.to].map(|t| font::width(&unit.write(t, 0), SMALL.size));
        let mut least = TICK_DISTANCE + widest[0].max(widest[1]);
        for _ in 0..4 {
            let times = instants(gantt.from, gantt.to, least / frame.scale());
            let decimals = unit.decimals(times.iter().copied());
            frame.ticks = times.iter().map(|t| (frame.place(*t), unit.write(*t, decimals))).collect();
            let widest = frame.ticks.iter().map(|t| font::width(&t.1, SMALL.size)).fold(0.0, f64::max);
            if widest + 16.0 <= least {
                break;
            }
            least = widest + 24.0;
        }
        frame
    }

    /// Points on the page for a nanosecond.
    fn scale(&self) -> f64 {
        (self.right - self.left) / (self.to.0 as f64 - self.from.0 as f64).max(1.0)
    }

    /// Place of an instant; of what lies outside the nearer end.
    fn place(&self, t: Time) -> f64 {
        let x = self.left + (t.0 as f64 - self.from.0 as f64) * self.scale();
        x.clamp(self.left, self.right)
    }

    fn shows(&self, t: Time) -> bool {
        t >= self.from && t <= self.to
    }
}

pub(super) fn draw(gantt: &Gantt) -> Drawing {
    let frame = Frame::new(gantt);
    let room = WIDTH - 2.0 * MARGIN;
    let notes: Vec<String> = nothing(gantt).into_iter().chain(gantt.rest()).collect();
    let below = frame.bottom + 56.0;
    let legend = below + 24.0 * notes.len() as f64;
    let height = legend + marks::height(gantt, room) + 10.0;
    let description = format!("Schedule of {}. {}", gantt.title, gantt.subtitle);
    let mut drawing = Drawing::new(WIDTH, height, description);
    page::titles(&mut drawing, MARGIN, &gantt.title, &gantt.subtitle);
    ground(&mut drawing, gantt, &frame);
    axes(&mut drawing, &frame);
    let mut y = TOP;
    for group in &gantt.groups {
        let base = [MARGIN, y + HEADING - 9.0];
        drawing.text(base, Align::Start, BOLD, false, &font::fit(&group.heading, BOLD.size, room));
        y += HEADING;
        for lane in &group.lanes {
            self::lane(&mut drawing, &frame, lane, y, palette::robot(group.robot));
            y += LANE;
        }
    }
    for (i, note) in notes.iter().enumerate() {
        drawing.text([MARGIN, below + 24.0 * i as f64], Align::Start, SMALL, false, note);
    }
    marks::legend(&mut drawing, gantt, [MARGIN, legend], room);
    drawing
}

/// What is said when there is nothing to see.
fn nothing(gantt: &Gantt) -> Option<String> {
    gantt.groups.is_empty().then(|| "nothing took time: no unit is on a core".to_string())
}

/// Every other lane is shaded.
fn ground(drawing: &mut Drawing, gantt: &Gantt, frame: &Frame) {
    let mut y = TOP;
    for group in &gantt.groups {
        y += HEADING;
        for i in 0..group.lanes.len() {
            if i % 2 == 0 {
                let size = [frame.right - MARGIN, LANE];
                drawing.rectangle([MARGIN, y], size, filled(ink(ZEBRA)));
            }
            y += LANE;
        }
    }
}

/// The axis of time, above and below.
fn axes(drawing: &mut Drawing, frame: &Frame) {
    let (left, right, bottom) = (frame.left, frame.right, frame.bottom);
    let style = Style::default().outline(faint(GRID, 0.3), 0.8);
    for (x, text) in &frame.ticks {
        drawing.line(&[[*x, TOP], [*x, bottom]], style);
        for (y, end, base) in [(TOP, TOP - 5.0, TOP - 10.0), (bottom, bottom + 5.0, bottom + 19.5)] {
            drawing.line(&[[*x, y], [*x, end]], stroked(DARK, 1.2));
            drawing.text([*x, base], Align::Middle, SMALL, false, text);
        }
    }
    for y in [TOP, bottom] {
        drawing.line(&[[left, y], [right, y]], stroked(DARK, 1.2));
    }
    let name = format!("time ({})", frame.unit.name);
    let mild = Lettering { color: MILD, ..SMALL };
    drawing.text([MARGIN, TOP - 10.0], Align::Start, mild, false, &name);
}

/// What lies below comes first: what was pending, bars, then marks.
fn lane(drawing: &mut Drawing, frame: &Frame, lane: &Lane, top: f64, color: Color) {
    let foot = top + FOOT;
    let name = font::fit(&lane.name, SMALL.size, NAME);
    drawing.text([MARGIN + 12.0, foot - 2.0], Align::Start, SMALL, false, &name);
    drawing.line(&[[frame.left, foot], [frame.right, foot]], stroked(MILD, 0.6));
    let within = |from: Time, to: Time| to > frame.from && from < frame.to;
    for (from, to) in lane.pending.iter().filter(|(from, to)| within(*from, *to)) {
        marks::pending(drawing, frame.place(*from), frame.place(*to), foot, color);
    }
    for bar in lane.bars.iter().filter(|b| within(b.from, b.to)) {
        let (from, to) = (frame.place(bar.from), frame.place(bar.to));
        if lane.kind == Kind::Device {
            marks::used(drawing, from, to, foot, color);
            if font::width(&bar.text, FINE.size) + 8.0 <= to - from {
                let look = Lettering { color: DARK, ..FINE };
                drawing.text([(from + to) / 2.0, foot - 2.8], Align::Middle, look, false, &bar.text);
            }
        } else {
            marks::bar(drawing, from, to, foot, color);
        }
    }
    let shown = |t: &&Time| frame.shows(**t);
    for (t, until) in lane.deferrals.iter().filter(|(t, until)| within(*t, *until)) {
        let (from, until) = (frame.place(*t), frame.place(*until));
        marks::deferral(drawing, [from, foot], until, frame.shows(*t));
    }
    for t in lane.releases.iter().filter(shown) {
        marks::release(drawing, [frame.place(*t), foot]);
    }
    for t in lane.completions.iter().filter(shown) {
        marks::completion(drawing, [frame.place(*t), foot]);
    }
    for t in lane.skips.iter().filter(shown) {
        marks::skip(drawing, [frame.place(*t), foot]);
    }
    for t in lane.misses.iter().filter(shown) {
        marks::miss(drawing, [frame.place(*t), foot]);
    }
    waiting(drawing, frame, lane, foot);
}

/// How many wait for a device, above its bars, where there is room for it.
fn waiting(drawing: &mut Drawing, frame: &Frame, lane: &Lane, foot: f64) {
    let mut free = frame.left;
    for (t, n) in lane.waiting.iter().filter(|(t, n)| *n > 0 && frame.shows(*t)) {
        let (x, text) = (frame.place(*t), n.to_string());
        if x >= free {
            let base = foot - marks::BAR - 5.0;
            drawing.text([x, base], Align::Start, FINE, false, &text);
            free = x + font::width(&text, FINE.size) + 4.0;
        }
    }
}
