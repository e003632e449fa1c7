//! A drawing: shapes on a page, y down, in points. What SVG and PNG are both made from.

use super::font;
pub use crate::trace_file::palette::Color;

/// A finished picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width of the page.
    pub width: f64,
    /// Height of the page.
    pub height: f64,
    /// What it shows, in a line, for readers who do not see it.
    pub description: String,
    pub(super) items: Vec<Item>,
}

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Item {
    pub shape: Shape,
    pub style: Style,
    /// The text that the shape writes.
    pub text: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Path(Vec<Segment>),
    Circle { at: [f64; 2], radius: f64 },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Segment {
    Move([f64; 2]),
    Line([f64; 2]),
    /// Two control points and the end.
    Cubic([f64; 2], [f64; 2], [f64; 2]),
    Close,
}

/// How a shape is filled and outlined.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Style {
    pub fill: Option<Ink>,
    pub line: Option<Line>,
}

/// A colour and its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ink {
    pub color: Color,
    pub alpha: f64,
}

/// Lines have round ends and corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub ink: Ink,
    pub width: f64,
    /// Length of dashes and of gaps.
    pub dash: Option<f64>,
}

/// Where a text lies to its point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Align {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lettering {
    /// Height of capital letters.
    pub size: f64,
    pub color: Color,
    pub bold: bool,
}

pub(super) fn ink(color: Color) -> Ink {
    Ink { color, alpha: 1.0 }
}

pub(super) fn faint(color: Color, alpha: f64) -> Ink {
    Ink { color, alpha }
}

pub(super) fn filled(fill: Ink) -> Style {
    Style { fill: Some(fill), line: None }
}

pub(super) fn stroked(color: Color, width: f64) -> Style {
    Style { fill: None, line: Some(Line { ink: ink(color), width, dash: None }) }
}

impl Style {
    pub(super) fn outline(self, ink: Ink, width: f64) -> Style {
        Style { line: Some(Line { ink, width, dash: None }), ..self }
    }

    pub(super) fn dashed(self, dash: f64) -> Style {
        Style { line: self.line.map(|l| Line { dash: Some(dash), ..l }), ..self }
    }
}

impl Drawing {
    pub(super) fn new(width: f64, height: f64, description: String) -> Self {
        Drawing { width, height, description, items: Vec::new() }
    }

    pub(super) fn circle(&mut self, at: [f64; 2], radius: f64, style: Style) {
        self.items.push(Item { shape: Shape::Circle { at, radius }, style, text: None });
    }

    pub(super) fn path(&mut self, segments: Vec<Segment>, style: Style) {
        self.items.push(Item { shape: Shape::Path(segments), style, text: None });
    }

    pub(super) fn line(&mut self, points: &[[f64; 2]], style: Style) {
        self.path(polyline(points), style);
    }

    pub(super) fn polygon(&mut self, points: &[[f64; 2]], style: Style) {
        let mut segments = polyline(points);
        segments.push(Segment::Close);
        self.path(segments, style);
    }

    /// A rectangle from its upper left corner.
    pub(super) fn rectangle(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], style: Style) {
        self.polygon(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]], style);
    }

    /// A text on the base line through `at`, turned by quarter turns counter-clockwise.
    pub(super) fn text(&mut self, at: [f64; 2], align: Align, look: Lettering, upright: bool, text: &str) {
        let width = font::width(text, look.size);
        let shift = match align {
            Align::Start => 0.0,
            Align::Middle => -width / 2.0,
            Align::End => -width,
        };
        let place = |[x, y]: [f64; 2]| {
            let (along, up) = (x + shift, y);
            if upright { [at[0] - up, at[1] - along] } else { [at[0] + along, at[1] - up] }
        };
        let weight = if look.bold { 0.17 } else { 0.115 };
        let style = stroked(look.color, weight * look.size);
        let segments = font::outline(text, look.size, place);
        self.items.push(Item { shape: Shape::Path(segments), style, text: Some(text.to_string()) });
    }
}

fn polyline(points: &[[f64; 2]]) -> Vec<Segment> {
    let first = points.first().map(|p| Segment::Move(*p));
    first.into_iter().chain(points.iter().skip(1).map(|p| Segment::Line(*p))).collect()
}
