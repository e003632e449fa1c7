//! The colour of each pixel of a strip: the texture of the facet seen there, in its light.

use crate::colour::{Colour, between, blend, brighten};
use crate::facet::{Facet, Optics, at};
use crate::render::Filter;
use crate::scene::Scene;
use crate::texture::{Level, Texture};
use crate::visibility::{NOTHING, Strip};

/// Pixels that share one level of detail.
const SPAN: usize = 16;

/// Fills in the colours of a strip.
pub(crate) fn shade(
    strip: &mut Strip,
    scene: &Scene,
    facets: &[Facet],
    optics: &Optics,
    exposure: u32,
    filter: Filter,
) {
    let width = strip.width;
    let rows = strip.seen.chunks_exact(width).zip(strip.colours.chunks_exact_mut(width));
    for (y, (seen, colours)) in (strip.first..).zip(rows) {
        let mut x = 0;
        while x < width {
            let number = seen[x];
            let run = seen[x..].iter().take_while(|other| **other == number).count();
            let out = &mut colours[x..x + run];
            let facet = facets.get(number as usize).filter(|_| number != NOTHING);
            match facet.and_then(|facet| Some((facet, scene.textures().get(facet.texture as usize)?))) {
                Some((facet, texture)) => run_of(facet, texture, x, y, filter, out),
                None => scene.sky.fill(optics, y, x, exposure, out),
            }
            x += run;
        }
    }
}

/// Pixels of row `y` from column `x` on that see one facet.
fn run_of(facet: &Facet, texture: &Texture, x: usize, y: usize, filter: Filter, out: &mut [Colour]) {
    let levels = texture.levels();
    let [finest, .., _] = levels else {
        // One colour all over.
        let colour = levels.first().and_then(|level| level.texels.first());
        out.fill(brighten(colour.copied().unwrap_or_default(), facet.shade));
        return;
    };
    let (width, height) = finest.size();
    let size = [width as f64, height as f64];
    let last = levels.len() as i32 - 1;
    let y = y as f64 + 0.5;
    for (out, x) in out.chunks_mut(SPAN).zip((x..).step_by(SPAN)) {
        let here = Here::new(facet, x as f64 + 0.5, y);
        match filter {
            Filter::Bilinear => here.sample(facet, finest, out),
            Filter::Mipmap => {
                let detail = here.detail(facet, size, out.len());
                let nearest = (detail + (1 << (DETAIL_BITS - 1))) >> DETAIL_BITS;
                here.sample(facet, &levels[nearest.clamp(0, last) as usize], out);
            }
            Filter::Trilinear => {
                let detail = here.detail(facet, size, out.len()).clamp(0, last << DETAIL_BITS);
                let finer = detail >> DETAIL_BITS;
                let share = (detail >> (DETAIL_BITS - 8)) as u32 & 0xff;
                here.sample(facet, &levels[finer as usize], out);
                let mut coarse = [Colour::default(); SPAN];
                here.sample(facet, &levels[(finer + 1).min(last) as usize], &mut coarse[..out.len()]);
                for (out, coarse) in out.iter_mut().zip(coarse) {
                    *out = blend(*out, coarse, share);
                }
            }
        }
    }
}

/// Fraction bits of a level of detail.
const DETAIL_BITS: u32 = 23;

/// The state at a span's first pixel.
struct Here {
    inverse_depth: f64,
    /// Texture coordinates in repeats.
    u: f64,
    v: f64,
    /// What u and v grow by a pixel to the right, times the inverse depth there.
    u_step: f64,
    v_step: f64,
}

impl Here {
    #[inline(always)]
    fn new(facet: &Facet, x: f64, y: f64) -> Self {
        let inverse_depth = facet.inverse_depth_at(x, y);
        let depth = 1.0 / inverse_depth;
        let (u, v) = (at(&facet.u, x, y) * depth, at(&facet.v, x, y) * depth);
        let slope = facet.inverse_depth[0];
        Self { inverse_depth, u, v, u_step: facet.u[0] - u * slope, v_step: facet.v[0] - v * slope }
    }

    /// Log 2 of the texels, of a texture of this size, that the middle pixel of a span covers the longer way.
    #[inline(always)]
    fn detail(&self, facet: &Facet, size: [f64; 2], pixels: usize) -> i32 {
        let middle = (pixels - 1) as f64 * 0.5;
        let depth = 1.0 / (self.inverse_depth + facet.inverse_depth[0] * middle);
        let (u, v) = (self.u + self.u_step * middle * depth, self.v + self.v_step * middle * depth);
        let across = self.inverse_depth * depth * depth;
        let (ux, vx) = (self.u_step * across * size[0], self.v_step * across * size[1]);
        let uy = (facet.u[1] - u * facet.inverse_depth[1]) * depth * size[0];
        let vy = (facet.v[1] - v * facet.inverse_depth[1]) * depth * size[1];
        let (by_x, by_y) = (ux * ux + vx * vx, uy * uy + vy * vy);
        let square = if by_x > by_y { by_x } else { by_y };
        let square = if square < MOST_TEXELS { square } else { MOST_TEXELS };
        // The bits of a float are its logarithm, within a few hundredths; half of it for the square root.
        ((square as f32).to_bits() as i32 - 1.0_f32.to_bits() as i32) >> 1
    }

    /// The texture between four texels of a level, in the facet's light, for as many pixels as there are.
    ///
    /// Places are exact for each pixel: i pixels on from the first, u has grown by i·u_step over the inverse depth
    /// there. Such differences are small: single precision is ample for them.
    #[inline(always)]
    fn sample(&self, facet: &Facet, level: &Level, out: &mut [Colour]) {
        let (log_width, log_height) = (level.log_width, level.log_height);
        let (across, down) = (f64::from(256_u32 << log_width), f64::from(256_u32 << log_height));
        // In 256ths of a texel, from the centre of the first.
        let (first_x, first_y) =
            (whole_of_large(self.u * across - 128.0), whole_of_large(self.v * down - 128.0));
        let (x_step, y_step) = ((self.u_step * across) as f32, (self.v_step * down) as f32);
        let (start, slope) = (self.inverse_depth as f32, facet.inverse_depth[0] as f32);
        let (x_mask, y_mask) = ((256 << log_width) - 1, (256 << log_height) - 1);
        let (mut corners, mut rights, mut ups) = ([0_u32; SPAN], [0_u32; SPAN], [0_u32; SPAN]);
        for i in 0..SPAN {
            let inverse_depth = start + slope * ALONG[i];
            let inverse_depth = if inverse_depth > facet.farthest { inverse_depth } else { facet.farthest };
            let along = ALONG[i] / inverse_depth;
            let x = first_x.wrapping_add(whole(along * x_step)) & x_mask;
            let y = first_y.wrapping_add(whole(along * y_step)) & y_mask;
            let row = y >> 8;
            corners[i] = (row << log_width) + row + (x >> 8);
            rights[i] = x & 0xff;
            ups[i] = y & 0xff;
        }
        let stride = level.stride();
        let texels = level.texels.as_slice();
        for (((out, corner), right), up) in out.iter_mut().zip(corners).zip(rights).zip(ups) {
            let Some(near) = texels.get(corner as usize..corner as usize + stride + 2) else { continue };
            *out = between([near[0], near[1]], [near[stride], near[stride + 1]], right, up, facet.shade);
        }
    }
}

/// More texels a pixel, squared, than any texture has.
const MOST_TEXELS: f64 = 1e30;

/// The numbers of a span's pixels.
const ALONG: [f32; SPAN] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// The nearest whole number, modulo 2³², of one that is not beyond ±2²²; else some number.
///
/// The sum has its last bit worth one, so its bits are those of the number, whose lowest count: unlike a
/// conversion, which saturates, this takes no branch.
#[inline(always)]
fn whole(number: f32) -> u32 {
    const MOST: f32 = 4_194_304.0;
    const SHIFT: f32 = 12_582_912.0;
    let held = if number < MOST { number } else { MOST };
    let held = if held > -MOST { held } else { -MOST };
    (held + SHIFT).to_bits().wrapping_sub(SHIFT.to_bits())
}

/// As [`whole`], for numbers not beyond ±2⁵¹.
#[inline(always)]
fn whole_of_large(number: f64) -> u32 {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    (number + SHIFT).to_bits() as u32
}
