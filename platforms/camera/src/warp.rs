//! A distorted image from a straight one.

use crate::image::Image;
use crate::lens::Lens;
use crate::render::each_chunk;

/// Where a pixel is taken from: between four pixels of the straight image.
#[derive(Clone, Copy)]
struct Tap {
    /// The upper left of the four, counted along rows; [`NOWHERE`] if nothing is seen.
    at: u32,
    /// How far between them to the right and down, in 256ths.
    right: u8,
    down: u8,
}

const NOWHERE: u32 = u32::MAX;

/// Rows that a thread takes at a time.
const ROWS: usize = 40;

/// The straight image is at most so many times as large along each side as the distorted one; what lies beyond is
/// black.
const MOST: usize = 4;

/// A lens's map, computed once.
pub(crate) struct Warp {
    lens: Lens,
    source: Lens,
    taps: Vec<Tap>,
}

impl Warp {
    /// The straight image has the lens's scale at the centre and reaches as far as the lens sees.
    pub fn new(lens: &Lens) -> Self {
        // In pixels of the straight image, from the optical centre.
        let places: Vec<_> = (0..lens.height)
            .flat_map(|y| (0..lens.width).map(move |x| (x as f64 + 0.5, y as f64 + 0.5)))
            .map(|(x, y)| {
                let (x, y) = lens.straighten((x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy)?;
                Some([x * lens.fx, y * lens.fy])
            })
            .collect();
        let reach = |axis: usize, side: usize, toward: f64| {
            let farthest = places
                .iter()
                .flatten()
                .map(|p| p[axis] * toward)
                .fold(0.0, |most, p| if p > most { p } else { most });
            // One pixel more on each side to take the mean with.
            farthest.min((MOST * side / 2) as f64) as usize + 2
        };
        let (left, right) = (reach(0, lens.width, -1.0), reach(0, lens.width, 1.0));
        let (up, down) = (reach(1, lens.height, -1.0), reach(1, lens.height, 1.0));
        let (width, height) = (left + right, up + down);
        let source = Lens { width, height, cx: left as f64, cy: up as f64, distortion: None, ..*lens };
        let tap = |place: Option<[f64; 2]>| {
            let nowhere = Tap { at: NOWHERE, right: 0, down: 0 };
            let Some([x, y]) = place else { return nowhere };
            // In 256ths of a pixel, from the centre of the first.
            let fine = |v: f64, centre: f64| ((v + centre - 0.5) * 256.0 + 0.5) as i64;
            let (x, y) = (fine(x, source.cx), fine(y, source.cy));
            let (column, row) = (x >> 8, y >> 8);
            if x < 0 || y < 0 || column + 1 >= width as i64 || row + 1 >= height as i64 {
                return nowhere;
            }
            Tap { at: (row as usize * width + column as usize) as u32, right: x as u8, down: y as u8 }
        };
        let taps = places.into_iter().map(tap).collect();
        Self { lens: *lens, source, taps }
    }

    /// The lens that the map is of.
    pub fn of(&self) -> &Lens {
        &self.lens
    }

    /// The pinhole that the straight image is taken through.
    pub fn source(&self) -> &Lens {
        &self.source
    }

    /// Brings the straight image into the lens's.
    pub fn resample(&self, straight: &Image, bands: usize, image: &mut Image) {
        let width = self.lens.width;
        image.resize(width, self.lens.height);
        let below = 3 * self.source.width;
        let mut workers = vec![(); bands.clamp(1, 64)];
        each_chunk(&mut image.data, 3 * width * ROWS, &mut workers, |(), number, bytes| {
            let taps = self.taps.get(number * ROWS * width..).unwrap_or_default();
            for (bytes, tap) in bytes.chunks_exact_mut(3).zip(taps) {
                let at = 3 * tap.at as usize;
                let upper = straight.data.get(at..at + 6);
                let lower = straight.data.get(at + below..at + below + 6);
                let (Some(upper), Some(lower)) = (upper, lower) else {
                    bytes.fill(0);
                    continue;
                };
                let (right, down) = (u32::from(tap.right), u32::from(tap.down));
                for (channel, byte) in bytes.iter_mut().enumerate() {
                    let mean = |row: &[u8]| {
                        u32::from(row[channel]) * (256 - right) + u32::from(row[channel + 3]) * right
                    };
                    *byte = ((mean(upper) * (256 - down) + mean(lower) * down + 0x8000) >> 16) as u8;
                }
            }
        });
    }
}
