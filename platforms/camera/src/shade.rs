//! The colour of each pixel of a strip: the texture of the facet seen there, in its light.

use crate::facet::{Facet, Optics, at};
use crate::light::FULL;
use crate::render::Filter;
use crate::scene::Scene;
use crate::texture::{Level, REPEAT_BITS, Texture};
use crate::visibility::{NOTHING, Strip};

/// A colour as three numbers of 16 bits in one word, red lowest: one multiplication weighs all channels.
pub(crate) type Lanes = u64;

/// The low byte of each channel.
pub(crate) const BYTES: Lanes = 0x00ff_00ff_00ff;

/// A half, in 256ths, of each channel.
pub(crate) const HALVES: Lanes = 0x0080_0080_0080;

pub(crate) fn lanes([r, g, b]: [u8; 3]) -> Lanes {
    u64::from(r) | u64::from(g) << 16 | u64::from(b) << 32
}

#[inline(always)]
pub(crate) fn unlanes(colour: Lanes) -> [u8; 3] {
    [colour as u8, (colour >> 16) as u8, (colour >> 32) as u8]
}

/// A colour times 256ths, saturating.
#[inline(always)]
pub(crate) fn brighten(colour: Lanes, shade: u32) -> Lanes {
    if shade <= FULL {
        return ((colour * u64::from(shade) + HALVES) >> 8) & BYTES;
    }
    let channel = |at: u32| ((((colour >> at) & 0xff) * u64::from(shade) + 0x80) >> 8).min(255) << at;
    channel(0) | channel(16) | channel(32)
}

/// `a` and `b` in 256ths of the way between them.
#[inline(always)]
fn blend(a: Lanes, b: Lanes, share: u32) -> Lanes {
    ((a * u64::from(256 - share) + b * u64::from(share) + HALVES) >> 8) & BYTES
}

/// Pixels that share one level of detail.
const SPAN: usize = 8;

/// Texture coordinates of the pixels of a span, in 2 to the minus [`REPEAT_BITS`] of a repeat.
type Places = [u32; SPAN];

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
fn run_of(facet: &Facet, texture: &Texture, x: usize, y: usize, filter: Filter, out: &mut [Lanes]) {
    let levels = texture.levels();
    let [finest, .., _] = levels else {
        // One colour all over.
        let colour = levels.first().and_then(|level| level.texels.first());
        out.fill(brighten(colour.copied().unwrap_or(0), facet.shade));
        return;
    };
    let (width, height) = finest.size();
    let size = [width as f64, height as f64];
    let y = y as f64 + 0.5;
    for (out, x) in out.chunks_mut(SPAN).zip((x..).step_by(SPAN)) {
        let x = x as f64 + 0.5;
        let here = Here::new(facet, x, y);
        let (us, vs) = here.places(facet);
        let detail = if filter == Filter::Bilinear { 0 } else { here.detail(facet, size, out.len()) };
        let last = levels.len() as i32 - 1;
        if filter == Filter::Trilinear {
            let coarser = (detail >> DETAIL_BITS).clamp(0, last);
            let share = if detail < 0 { 0 } else { (detail >> (DETAIL_BITS - 8)) as u32 & 0xff };
            let (fine, coarse) = (&levels[coarser as usize], &levels[(coarser + 1).min(last) as usize]);
            for (i, out) in out.iter_mut().enumerate() {
                let colour = blend(sample(fine, us[i], vs[i]), sample(coarse, us[i], vs[i]), share);
                *out = brighten(colour, facet.shade);
            }
        } else {
            let level = &levels[((detail + (1 << (DETAIL_BITS - 1))) >> DETAIL_BITS).clamp(0, last) as usize];
            sample_span(level, us, vs, facet.shade, out);
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

    /// Exact for each pixel: from the first one's u, i pixels on it has grown by i·u_step over the inverse depth
    /// there. Differences are small, so single precision is ample for them.
    #[inline(always)]
    fn places(&self, facet: &Facet) -> (Places, Places) {
        let repeat = f64::from(1_u32 << REPEAT_BITS);
        let (u, v) = ((self.u * repeat) as i64 as u32, (self.v * repeat) as i64 as u32);
        let (u_step, v_step) = ((self.u_step * repeat) as f32, (self.v_step * repeat) as f32);
        let (start, slope) = (self.inverse_depth as f32, facet.inverse_depth[0] as f32);
        let (mut us, mut vs) = ([0; SPAN], [0; SPAN]);
        for i in 0..SPAN {
            let along = i as f32 / (start + slope * i as f32);
            us[i] = u.wrapping_add((along * u_step) as i32 as u32);
            vs[i] = v.wrapping_add((along * v_step) as i32 as u32);
        }
        (us, vs)
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
        // The bits of a float are its logarithm, within a few hundredths; half of it for the square root.
        ((square as f32).to_bits() as i32).wrapping_sub(1.0_f32.to_bits() as i32) >> 1
    }
}

/// The texture between four texels, each channel to the nearest grey level.
#[inline(always)]
fn sample(level: &Level, u: u32, v: u32) -> Lanes {
    let place = |coordinate: u32, log: u32| {
        // In 256ths of a texel, from the centre of the first.
        let fine = coordinate >> (REPEAT_BITS - 8 - log);
        fine.wrapping_sub(128) & ((256 << log) - 1)
    };
    let (x, y) = (place(u, level.log_width), place(v, level.log_height));
    let (column, row) = ((x >> 8) as usize, (y >> 8) as usize);
    let stride = level.stride();
    let corner = row * stride + column;
    let Some(near) = level.texels.get(corner..corner + stride + 2) else { return 0 };
    let below = blend(near[0], near[1], x & 0xff);
    let above = blend(near[stride], near[stride + 1], x & 0xff);
    blend(below, above, y & 0xff)
}

#[inline(always)]
fn sample_span(level: &Level, us: Places, vs: Places, shade: u32, out: &mut [Lanes]) {
    for (i, out) in out.iter_mut().enumerate().take(SPAN) {
        *out = brighten(sample(level, us[i], vs[i]), shade);
    }
}
