//! Which facet is seen at each pixel of a strip of rows.
//!
//! A pixel belongs to an outline if its centre is inside; on an edge, if the inside is to the right or below. Edges
//! are followed in whole numbers, always from their upper end, so that two outlines that share one share out its
//! pixels: none twice, none left over.

use crate::facet::{Facet, SUBPIXELS, first_centre};

/// No facet: the sky.
pub(crate) const NOTHING: u32 = u32::MAX;

/// Rows of a frame while they are drawn. Memory is kept from strip to strip.
#[derive(Default)]
pub(crate) struct Strip {
    /// The frame's row that is the strip's first, and how many there are.
    pub first: usize,
    pub count: usize,
    pub width: usize,
    /// Number of the facet seen at each pixel, or [`NOTHING`].
    pub seen: Vec<u32>,
    /// Its inverse depth.
    depth: Vec<f32>,
    /// For each row, the first column of the outline at hand and the one after its last.
    spans: Vec<(i32, i32)>,
    /// For the next steps: the colours.
    pub colours: Vec<crate::colour::Colour>,
}

impl Strip {
    /// Empties the strip and makes it `count` rows from `first` on.
    pub fn begin(&mut self, first: usize, count: usize, width: usize) {
        (self.first, self.count, self.width) = (first, count, width);
        let pixels = count * width;
        self.seen.clear();
        self.seen.resize(pixels, NOTHING);
        self.depth.clear();
        self.depth.resize(pixels, 0.0);
        self.colours.resize(pixels, crate::colour::Colour::default());
        self.spans.resize(count, (0, 0));
    }

    /// Draws the outline of a facet where nothing nearer has been drawn.
    pub fn cover(&mut self, number: u32, facet: &Facet) {
        let first = self.first as i32;
        let from = facet.rows.0.max(first);
        let to = facet.rows.1.min(first + self.count as i32);
        if from >= to {
            return;
        }
        let spans = &mut self.spans[(from - first) as usize..(to - first) as usize];
        spans.fill((i32::MAX, i32::MIN));
        let corners = facet.corners();
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners[if i + 1 == corners.len() { 0 } else { i + 1 }];
            // Corners go round to the left: down on the left, up on the right.
            if corner[1] < next[1] {
                follow(corner, next, from, spans, |span, column| span.0 = span.0.min(column));
            } else {
                follow(next, corner, from, spans, |span, column| span.1 = span.1.max(column));
            }
        }
        let step = facet.inverse_depth[0] as f32;
        for (row, span) in (from..to).zip(spans.iter()) {
            let (left, right) = (span.0.max(0), span.1.min(self.width as i32));
            if left >= right {
                continue;
            }
            let here = (row - first) as usize * self.width;
            let pixels = here + left as usize..here + right as usize;
            let start =
                crate::facet::at(&facet.inverse_depth, f64::from(left) + 0.5, f64::from(row) + 0.5) as f32;
            let (depth, seen) = (&mut self.depth[pixels.clone()], &mut self.seen[pixels]);
            fill(depth, seen, number, start, step, facet.farthest, facet.nearest);
        }
    }
}

/// Calls `meet` for each row from `top` on that an edge crosses, with the first column whose centre is at or right
/// of it.
#[inline(always)]
fn follow(
    upper: [i32; 2],
    lower: [i32; 2],
    top: i32,
    spans: &mut [(i32, i32)],
    meet: impl Fn(&mut (i32, i32), i32),
) {
    let from = first_centre(upper[1]).max(top);
    let to = first_centre(lower[1]).min(top + spans.len() as i32);
    if from >= to {
        return;
    }
    // The column is (x - half) / SUBPIXELS rounded up, where x - x0 = (y - y0) dx / dy: all over SUBPIXELS dy.
    let half = i64::from(SUBPIXELS / 2);
    let (dx, dy) = (i64::from(lower[0] - upper[0]), i64::from(lower[1] - upper[1]));
    let y = i64::from(from) * i64::from(SUBPIXELS) + half;
    let over = dy * i64::from(SUBPIXELS);
    let place = (i64::from(upper[0]) - half) * dy + (y - i64::from(upper[1])) * dx + over - 1;
    let (mut column, mut rest) = (place.div_euclid(over), place.rem_euclid(over));
    let (step, step_rest) = (dx.div_euclid(dy), dx.rem_euclid(dy) * i64::from(SUBPIXELS));
    for span in &mut spans[(from - top) as usize..(to - top) as usize] {
        meet(span, column as i32);
        column += step;
        rest += step_rest;
        if rest >= over {
            rest -= over;
            column += 1;
        }
    }
}

/// One row of an outline. Written without branches, for the compiler to take several pixels at once.
#[inline(always)]
fn fill(
    depth: &mut [f32],
    seen: &mut [u32],
    number: u32,
    start: f32,
    step: f32,
    farthest: f32,
    nearest: f32,
) {
    for (i, (depth, seen)) in depth.iter_mut().zip(seen.iter_mut()).enumerate() {
        let here = start + step * (i as i32 as f32);
        let here = if here < nearest { here } else { nearest };
        let here = if here > farthest { here } else { farthest };
        let nearer = here > *depth;
        *depth = if nearer { here } else { *depth };
        *seen = if nearer { number } else { *seen };
    }
}
