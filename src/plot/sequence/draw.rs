//! A message sequence chart as a picture.

use super::{
    Sequence,
    layout::{AIR, LOOP, LOST, Layout, MARGIN, box_width, head_width, time_title},
    marks::{self, HEAD},
    rows::{Arrow, Turn, What},
};
use crate::plot::{
    Drawing,
    drawing::{Align, faint, filled, stroked},
    font,
    page::{self, FINE, GRID, MILD, SMALL, WHITE},
};

/// Middle of the heads, and of the first row.
const HEADS: f64 = 98.0;
const FIRST: f64 = HEADS + 46.0;
/// Height of a row, and of one that matters less.
const ROW: f64 = 29.0;
const LOW: f64 = 19.0;
/// After so many rows the lifelines are named again.
const REMIND: usize = 30;

/// Where rows lie on the page.
struct Places {
    layout: Layout,
    rows: Vec<f64>,
    /// Where lifelines are named again.
    reminders: Vec<f64>,
    end: f64,
}

impl Places {
    fn new(chart: &Sequence) -> Places {
        let (mut y, mut rows, mut reminders) = (FIRST, Vec::new(), Vec::new());
        for (i, row) in chart.rows.iter().enumerate() {
            let remind = i > 0 && i % REMIND == 0;
            if i > 0 {
                let low = matches!(row.what, What::Over { .. }) && !remind;
                y += if low { LOW } else { ROW };
            }
            if remind {
                reminders.push(y + HEAD / 2.0 - ROW / 2.0);
                y += HEAD + ROW / 2.0;
            }
            rows.push(y);
        }
        y += ROW;
        Places { layout: Layout::new(chart), rows, reminders, end: y }
    }
}

pub(super) fn draw(chart: &Sequence) -> Drawing {
    let places = Places::new(chart);
    let notes: Vec<String> = nothing(chart).into_iter().chain(chart.rest()).collect();
    let height = places.end + 24.0 * notes.len() as f64 + 14.0;
    let description = format!("Message sequence chart of {}. {}", chart.title, chart.subtitle);
    let mut drawing = Drawing::new(places.layout.width, height, description);
    page::titles(&mut drawing, MARGIN, &chart.title, &chart.subtitle);
    times(&mut drawing, chart, &places);
    lifelines(&mut drawing, chart, &places);
    for (row, y) in chart.rows.iter().zip(&places.rows) {
        self::row(&mut drawing, chart, &places.layout, &row.what, *y);
    }
    for (i, note) in notes.iter().enumerate() {
        let at = [MARGIN, places.end + 24.0 * i as f64 + 12.0];
        drawing.text(at, Align::Start, SMALL, false, note);
    }
    drawing
}

/// What is said when there is nothing to see.
fn nothing(chart: &Sequence) -> Option<String> {
    (chart.rows.is_empty() && chart.cut == 0).then(|| "nothing was said".to_string())
}

/// Times at the left margin, with a hair line to what happens then.
fn times(drawing: &mut Drawing, chart: &Sequence, places: &Places) {
    let layout = &places.layout;
    if chart.rows.is_empty() {
        return;
    }
    let title = time_title(chart.unit);
    drawing.text([layout.times, HEADS + FINE.size / 2.0], Align::End, FINE, false, &title);
    for (i, y) in places.rows.iter().enumerate() {
        if let Some(t) = chart.time_of(i, layout.decimals) {
            drawing.text([layout.times, y + SMALL.size / 2.0], Align::End, SMALL, false, &t);
            let hair = stroked(GRID, 0.6);
            let hair = hair.outline(faint(GRID, 0.3), 0.6);
            drawing.line(&[[layout.times + 8.0, *y], [layout.width - MARGIN, *y]], hair);
        }
    }
}

/// Lifelines with their heads; from death to restart there is none.
fn lifelines(drawing: &mut Drawing, chart: &Sequence, places: &Places) {
    for (i, l) in chart.lifelines.iter().enumerate() {
        let x = places.layout.lifelines[i];
        let mut since = Some(HEADS);
        let mut line = |from: f64, to: f64| {
            drawing.line(&[[x, from], [x, to]], stroked(MILD, 1.0).dashed(4.0));
        };
        for (row, y) in chart.rows.iter().zip(&places.rows) {
            match row.what {
                What::Life { of, turn: Turn::Dead, .. } if of == i => {
                    since.take().into_iter().for_each(|from| line(from, *y));
                }
                What::Life { of, turn: Turn::Restarted, .. } if of == i => {
                    since.get_or_insert(*y);
                }
                _ => {}
            }
        }
        since.into_iter().for_each(|from| line(from, places.end - ROW / 3.0));
        let width = head_width(chart, i);
        marks::head(drawing, [x, HEADS], width, l);
        for y in &places.reminders {
            marks::head(drawing, [x, *y], width, l);
        }
    }
}

fn row(drawing: &mut Drawing, chart: &Sequence, layout: &Layout, what: &What, y: f64) {
    let at = |i: usize| [layout.lifelines[i], y];
    let short = |text: &str| font::fit(text, SMALL.size, layout.longest);
    match what {
        What::Arrow(a) => arrow(drawing, chart, layout, a, y),
        What::Service { of, running, text } => {
            let text = short(text);
            let width = box_width(font::width(&text, SMALL.size));
            marks::boxed(drawing, at(*of), width, *running, chart.lifelines[*of].color, &text);
        }
        What::Life { of, turn, text } => {
            let width = head_width(chart, *of);
            let beyond = match turn {
                Turn::Dead => {
                    marks::cross(drawing, at(*of), 7.0);
                    0.0
                }
                Turn::Restarted => {
                    let l = &chart.lifelines[*of];
                    marks::boxed(drawing, at(*of), width, true, l.color, &l.name);
                    width / 2.0
                }
                Turn::Other => {
                    marks::point(drawing, at(*of), chart.lifelines[*of].color);
                    0.0
                }
            };
            marks::beside(drawing, at(*of), beyond, SMALL, &short(text));
        }
        What::Over { of, text } => {
            marks::tick(drawing, at(*of));
            let text = font::fit(text, FINE.size, layout.longest);
            marks::beside(drawing, at(*of), 0.0, FINE, &text);
        }
    }
}

fn arrow(drawing: &mut Drawing, chart: &Sequence, layout: &Layout, a: &Arrow, y: f64) {
    let (from, to) = (layout.lifelines[a.from], layout.lifelines[a.to]);
    let (text, color, lost) = (chart.arrow_text(a), chart.lifelines[a.from].color, a.is_lost());
    if a.from == a.to {
        let text = font::fit(&text, SMALL.size, layout.longest);
        marks::to_itself(drawing, [from, y + 5.0], lost, color);
        marks::beside(drawing, [from, y], LOOP, SMALL, &text);
        return;
    }
    // What is lost does not get as far, and its text keeps away from the cross.
    let end = if lost { to - (to - from).signum() * LOST } else { to };
    let text = font::fit(&text, SMALL.size, (end - from).abs() - 2.0 * AIR + 0.01);
    let width = font::width(&text, SMALL.size);
    let middle = (from + end) / 2.0;
    // Lifelines do not strike the text through.
    drawing.rectangle(
        [middle - width / 2.0 - 3.0, y - 17.0],
        [width + 6.0, 15.0],
        filled(faint(WHITE, 0.85)),
    );
    drawing.text([middle, y - 6.0], Align::Middle, SMALL, false, &text);
    marks::arrow(drawing, from, end, y, lost, color);
}
