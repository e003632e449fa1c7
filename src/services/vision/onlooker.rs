//! What is seen in the images of a camera, one after the other, drawn into them for people.

use super::{
    super::{Overlay, Readings},
    eye,
    sight::Sight,
};
use soifra_runtime::objects::{Frame, Optics};
use soifra_vision::{
    Lens,
    edge::Edge,
    flow::{Track, focus},
    overlay::{Stroke, arrow, draw, edge},
};

/// An upright edge; the left and the right one of an obstacle; points that move; the optical centre; the focus of expansion.
const UPRIGHT: [u8; 3] = [255, 220, 0];
const LEFT: [u8; 3] = [0, 80, 255];
const RIGHT: [u8; 3] = [255, 0, 0];
const FLOW: [u8; 3] = [0, 255, 0];
const CENTRE: [u8; 3] = [255, 255, 255];
const FOCUS: [u8; 3] = [255, 0, 255];
/// The flow from one image to the next is short: it is drawn so many times as long.
const GAIN: f64 = 8.0;
/// Half the size of a mark, pixels.
const MARK: f64 = 9.0;
/// What a lens bends is drawn in so many straight pieces.
const PIECES: usize = 12;

/// Looks at one image of a camera after the other.
#[derive(Debug, Default)]
pub struct Onlooker {
    sight: Option<Sight>,
    /// Whether anything came of the latest image.
    seen: bool,
}

impl Onlooker {
    /// Looks at the next image as `look` does with its defaults. Whether it could.
    pub fn look(&mut self, frame: &Frame, readings: &Readings) -> bool {
        let sight = eye::look_on(frame, self.sight.as_ref(), readings);
        self.seen = sight.is_ok();
        // As a mission does: what could not be looked at is left out, and what is remembered stays.
        self.sight = sight.ok().or(self.sight.take());
        self.seen
    }

    /// Draws what was seen in the latest image, which this is, into it.
    pub fn draw(&self, frame: &mut Frame, what: Overlay) {
        let Some(sight) = self.sight.as_ref().filter(|_| self.seen) else { return };
        let strokes: Vec<Stroke> = strokes(sight, what).iter().flat_map(|s| bent(s, &frame.optics)).collect();
        // A frame is of its own size: nothing can be wrong with that.
        let _ = draw(&mut frame.data, frame.width as usize, frame.height as usize, &strokes);
    }
}

/// What is drawn, as a lens without distortion sees it; what comes later lies above.
fn strokes(sight: &Sight, what: Overlay) -> Vec<Stroke> {
    let lens = eye::straight(&sight.optics);
    let mut out = Vec::new();
    if what.edges {
        let along = |e: &Edge, colour, thickness| edge(&e.line, colour, thickness);
        out.extend(sight.seen.edges.iter().map(|e| along(e, UPRIGHT, 1)));
        let obstacles = sight.seen.obstacles.as_deref().unwrap_or_default();
        for (i, o) in obstacles.iter().enumerate() {
            let thickness = if sight.seen.first == Ok(i) { 5 } else { 1 };
            out.extend([along(&o.left, LEFT, thickness), along(&o.right, RIGHT, thickness)]);
        }
        out.extend(cross([lens.cx, lens.cy], CENTRE));
    }
    if what.flow {
        let tracks: Vec<Track> = sight.seen.flows.iter().map(|f| f.track).collect();
        out.extend(tracks.iter().map(|t| arrow(t, GAIN, FLOW)));
        if let Ok(at) = focus(&tracks) {
            out.extend(cross(at, FOCUS));
        }
    }
    out
}

fn cross([x, y]: [f64; 2], colour: [u8; 3]) -> [Stroke; 2] {
    let line =
        |dx: f64, dy: f64| Stroke { from: [x - dx, y - dy], to: [x + dx, y + dy], colour, thickness: 3 };
    [line(MARK, 0.0), line(0.0, MARK)]
}

/// A stroke as the lens that took the image shows it.
fn bent(stroke: &Stroke, optics: &Optics) -> Vec<Stroke> {
    if optics.distortion.is_none() {
        return vec![*stroke];
    }
    let straight = eye::straight(optics);
    let lens = Lens { distortion: optics.distortion, ..straight };
    let at = |k: usize| {
        let share = k as f64 / PIECES as f64;
        let [x, y] = [0, 1].map(|a| stroke.from[a] + share * (stroke.to[a] - stroke.from[a]));
        lens.project(straight.normalise(x, y)?)
    };
    (0..PIECES).filter_map(|k| Some(Stroke { from: at(k)?, to: at(k + 1)?, ..*stroke })).collect()
}
