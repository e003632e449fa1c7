//! A drawing as PNG.

use super::drawing::{Drawing, Ink, Segment, Shape};
use std::fmt;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

/// Greatest width and height of a PNG in pixels.
const MAX_PIXELS: u32 = 16_384;

/// Why a PNG could not be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PngError(String);

impl PngError {
    /// With the reason why there is no picture.
    pub(super) fn new(why: &str) -> PngError {
        PngError(why.to_string())
    }
}

impl fmt::Display for PngError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for PngError {}

/// Points of a drawing that share a pixel at most, where a text can still be read.
const LEGIBLE: f64 = 1.4;

impl Drawing {
    /// A width in pixels for a PNG that should have `wanted`: less for a drawing so tall that it would not fit,
    /// more for one so wide that its texts could not be read.
    pub fn png_width(&self, wanted: u32) -> u32 {
        let most = f64::from(MAX_PIXELS);
        let scale = f64::from(wanted).max(self.width / LEGIBLE) / self.width;
        let scale = scale.min(most / self.width).min((most - 1.0) / self.height);
        (self.width * scale.max(1.0 / LEGIBLE)).clamp(1.0, 1e9) as u32
    }

    /// The drawing as a PNG file of a width in pixels.
    pub fn to_png(&self, width: u32) -> Result<Vec<u8>, PngError> {
        let scale = f64::from(width) / self.width;
        let height = (self.height * scale).ceil();
        if width == 0 || width > MAX_PIXELS || !(1.0..=f64::from(MAX_PIXELS)).contains(&height) {
            let most = MAX_PIXELS;
            return Err(PngError(format!(
                "a picture of {width} by {height} pixels cannot be made: each side has 1 to {most}"
            )));
        }
        let mut page = Pixmap::new(width, height as u32)
            .ok_or_else(|| PngError(format!("no memory for a picture of {width} by {height} pixels")))?;
        page.fill(Color::WHITE);
        let transform = Transform::from_scale(scale as f32, scale as f32);
        for item in &self.items {
            let Some(path) = path(&item.shape) else { continue };
            if let Some(fill) = item.style.fill {
                page.fill_path(&path, &paint(fill), FillRule::Winding, transform, None);
            }
            if let Some(line) = item.style.line {
                let stroke = Stroke {
                    width: line.width as f32,
                    line_cap: LineCap::Round,
                    line_join: LineJoin::Round,
                    dash: line.dash.and_then(|d| StrokeDash::new(vec![d as f32, d as f32], 0.0)),
                    ..Stroke::default()
                };
                page.stroke_path(&path, &paint(line.ink), &stroke, transform, None);
            }
        }
        page.encode_png().map_err(|e| PngError(format!("the picture cannot be encoded: {e}")))
    }
}

/// `None` for what has no extent.
fn path(shape: &Shape) -> Option<Path> {
    let mut b = PathBuilder::new();
    let f = |p: &[f64; 2]| (p[0] as f32, p[1] as f32);
    match shape {
        Shape::Circle { at, radius } => {
            let (x, y) = f(at);
            b.push_circle(x, y, *radius as f32);
        }
        Shape::Path(segments) => {
            for segment in segments {
                match segment {
                    Segment::Move(p) => {
                        let (x, y) = f(p);
                        b.move_to(x, y);
                    }
                    Segment::Line(p) => {
                        let (x, y) = f(p);
                        b.line_to(x, y);
                    }
                    Segment::Cubic(p, q, r) => {
                        let ((a, c), (d, e), (x, y)) = (f(p), f(q), f(r));
                        b.cubic_to(a, c, d, e, x, y);
                    }
                    Segment::Close => b.close(),
                }
            }
        }
    }
    b.finish()
}

fn paint(ink: Ink) -> Paint<'static> {
    let [r, g, b] = ink.color;
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, (ink.alpha.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}
