//! Drawings on frames: edges and flow, for people to look at.

use crate::flow::Track;
use crate::image::ImageView;
use crate::segment::Segment;
use crate::why::Why;

/// A line to draw, pixels, RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// One end (x, y).
    pub from: [f64; 2],
    /// The other end.
    pub to: [f64; 2],
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Pixels.
    pub thickness: u8,
}

/// A stroke along a segment.
pub fn edge(segment: &Segment, colour: [u8; 3], thickness: u8) -> Stroke {
    Stroke { from: segment.top, to: segment.bottom, colour, thickness }
}

/// A stroke along a point's flow, lengthened `gain` times: it ends at the point's present place.
pub fn arrow(track: &Track, gain: f64, colour: [u8; 3]) -> Stroke {
    Stroke {
        from: [track.x - gain * track.u, track.y - gain * track.v],
        to: [track.x, track.y],
        colour,
        thickness: 1,
    }
}

/// A copy of the image as RGB, `width * height * 3` bytes.
pub fn rgb(image: &ImageView<'_>) -> Vec<u8> {
    match image.channels() {
        1 => image.data().iter().flat_map(|&level| [level; 3]).collect(),
        _ => image.data().to_vec(),
    }
}

/// Draws strokes into an RGB buffer; what lies outside is not drawn.
///
/// # Errors
/// [`Why::WrongSize`] when the buffer is not `width * height * 3` bytes.
pub fn draw(pixels: &mut [u8], width: usize, height: usize, strokes: &[Stroke]) -> Result<(), Why> {
    if width.checked_mul(height).and_then(|n| n.checked_mul(3)) != Some(pixels.len()) {
        return Err(Why::WrongSize);
    }
    for stroke in strokes {
        let Some((from, to)) = clip(stroke, width as f64, height as f64) else { continue };
        let length = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let steps = length.ceil().max(1.0) as usize;
        let half = i64::from(stroke.thickness.max(1)) / 2;
        for k in 0..=steps {
            let share = k as f64 / steps as f64;
            let x = (from[0] + share * (to[0] - from[0])).round() as i64;
            let y = (from[1] + share * (to[1] - from[1])).round() as i64;
            for (i, j) in (-half..=half).flat_map(|i| (-half..=half).map(move |j| (x + i, y + j))) {
                if (0..width as i64).contains(&i) && (0..height as i64).contains(&j) {
                    let at = 3 * (j as usize * width + i as usize);
                    pixels[at..at + 3].copy_from_slice(&stroke.colour);
                }
            }
        }
    }
    Ok(())
}

/// The part of a stroke near the picture (Liang-Barsky), so that far ends cost nothing.
fn clip(stroke: &Stroke, width: f64, height: f64) -> Option<([f64; 2], [f64; 2])> {
    let (a, b) = (stroke.from, stroke.to);
    if ![a[0], a[1], b[0], b[1]].iter().all(|v| v.abs() < 1e12) {
        return None;
    }
    let margin = 256.0;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for (k, size) in [(0, width), (1, height)] {
        let way = b[k] - a[k];
        for (p, q) in [(-way, a[k] + margin), (way, size + margin - a[k])] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                enter = enter.max(q / p);
            } else {
                leave = leave.min(q / p);
            }
        }
    }
    let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
    (enter <= leave).then(|| (at(enter), at(leave)))
}
