//! A texture in all its sizes, laid out for the sampler.

use crate::colour::{Colour, opaque, rgb};

/// The largest side of a level: 2 to this.
const LARGEST: u32 = 12;

/// One size of a texture. Rows are one texel longer than it is wide, and there is one row more than it is high:
/// they hold the opposite side once more, so that four neighbours never wrap.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// Width and height are 2 to these.
    pub log_width: u32,
    pub log_height: u32,
    /// Bottom row first: v goes up.
    pub texels: Vec<Colour>,
}

impl Level {
    /// Texels from one row to the next.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        (1 << self.log_width) + 1
    }

    pub fn size(&self) -> (usize, usize) {
        (1 << self.log_width, 1 << self.log_height)
    }

    /// The texel at the origin.
    pub fn first(&self) -> [u8; 3] {
        self.texels.first().map_or([0; 3], |texel| rgb(*texel))
    }

    pub fn to_rgb8(&self) -> Vec<u8> {
        let (width, _) = self.size();
        let rows = self.texels.chunks_exact(self.stride()).rev().skip(1);
        rows.flat_map(|row| row.iter().take(width)).flat_map(|texel| rgb(*texel)).collect()
    }
}

/// Sixteenths of a grey level, row by row, while the pyramid is built: rounding to bytes at each of twelve levels
/// would add up.
struct Fine {
    log_width: u32,
    log_height: u32,
    colours: Vec<[u16; 3]>,
}

const SIXTEENTHS: u16 = 16;

/// All levels of an image of three bytes a pixel, top row first.
pub(crate) fn build(width: usize, height: usize, rgb: &[u8]) -> Vec<Level> {
    let mut fine = enlarge(width, height, rgb);
    let mut levels = vec![lay_out(&fine)];
    while fine.log_width > 0 || fine.log_height > 0 {
        fine = halve(&fine);
        levels.push(lay_out(&fine));
    }
    levels
}

fn log_of_side(pixels: usize) -> u32 {
    pixels.next_power_of_two().trailing_zeros().min(LARGEST)
}

/// To sides that are powers of two: each new pixel is the mean of the part of the image that it covers.
fn enlarge(width: usize, height: usize, rgb: &[u8]) -> Fine {
    let (log_width, log_height) = (log_of_side(width), log_of_side(height));
    let (across, down) = (covers(width, 1 << log_width), covers(height, 1 << log_height));
    let mut colours = Vec::with_capacity(across.len() * down.len());
    for rows in &down {
        for columns in &across {
            let mut sum = [0_u64; 3];
            for &(y, y_share) in rows {
                for &(x, x_share) in columns {
                    let pixel = rgb[3 * (y * width + x)..].iter();
                    for (sum, channel) in sum.iter_mut().zip(pixel) {
                        *sum += u64::from(*channel) * y_share * x_share;
                    }
                }
            }
            // Shares of a pixel add up to the image's size in each direction.
            let whole = (width * height) as u64;
            colours.push(sum.map(|sum| ((sum * u64::from(SIXTEENTHS) + whole / 2) / whole) as u16));
        }
    }
    Fine { log_width, log_height, colours }
}

/// For each of `new` pixels, which of `old` it covers and by how much, in shares that add up to `old`.
fn covers(old: usize, new: usize) -> Vec<Vec<(usize, u64)>> {
    // On a ruler of old × new steps, an old pixel has `new` of them and a new one `old`.
    let cover = |i: usize| {
        let (from, to) = (i * old, (i + 1) * old);
        (from / new..to.div_ceil(new))
            .map(|j| (j, (to.min((j + 1) * new) - from.max(j * new)) as u64))
            .collect()
    };
    (0..new).map(cover).collect()
}

/// Half as large: each pixel the mean of four, or of two along a side that is already one.
fn halve(fine: &Fine) -> Fine {
    let (log_width, log_height) = (fine.log_width.saturating_sub(1), fine.log_height.saturating_sub(1));
    let (dx, dy) = (usize::from(fine.log_width > 0), usize::from(fine.log_height > 0));
    let at = |x: usize, y: usize| fine.colours[(y << fine.log_width) + x];
    let mut colours = Vec::with_capacity(1 << (log_width + log_height));
    for y in 0..1_usize << log_height {
        for x in 0..1_usize << log_width {
            let (x, y) = (x << dx, y << dy);
            let four = [at(x, y), at(x + dx, y), at(x, y + dy), at(x + dx, y + dy)];
            colours.push(
                [0, 1, 2]
                    .map(|c| (four.iter().map(|pixel| u32::from(pixel[c])).sum::<u32>() + 2) / 4)
                    .map(|c| c as u16),
            );
        }
    }
    Fine { log_width, log_height, colours }
}

fn lay_out(fine: &Fine) -> Level {
    let (width, height) = (1_usize << fine.log_width, 1_usize << fine.log_height);
    let texel = |x: usize, y: usize| {
        // Images have their top row first, textures their bottom row.
        let row = height - 1 - y % height;
        let colour = fine.colours[(row << fine.log_width) + x % width];
        opaque(colour.map(|c| ((c + SIXTEENTHS / 2) / SIXTEENTHS) as u8))
    };
    let texels =
        (0..=height).flat_map(|y| (0..=width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    Level { log_width: fine.log_width, log_height: fine.log_height, texels }
}

#[cfg(test)]
mod tests {
    use super::build;

    #[test]
    fn each_level_keeps_the_mean() {
        let rgb: Vec<u8> = (0..8 * 4).flat_map(|i| [i as u8 * 7, 255 - i as u8, 100]).collect();
        let levels = build(8, 4, &rgb);
        assert_eq!(
            levels.iter().map(super::Level::size).collect::<Vec<_>>(),
            [(8, 4), (4, 2), (2, 1), (1, 1)]
        );
        assert_eq!(levels[0].to_rgb8(), rgb);
        assert_eq!(levels[3].first(), [109, 240, 100]);
    }

    #[test]
    fn other_sizes_are_enlarged_and_keep_their_mean() {
        let rgb: Vec<u8> = [[0, 30, 255], [255, 60, 255], [0, 90, 255]].concat();
        let levels = build(3, 1, &rgb);
        assert_eq!(levels[0].size(), (4, 1));
        // Three thirds of each: 0, then a third of it and two thirds of the next, and so on.
        assert_eq!(
            levels[0].to_rgb8(),
            [[0, 30, 255], [170, 50, 255], [170, 70, 255], [0, 90, 255]].concat()
        );
        assert_eq!(levels[2].first(), [85, 60, 255]);
    }
}
