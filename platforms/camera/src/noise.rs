//! The sensor's noise.
//!
//! Counter-based: what is added to a channel depends on the key, the frame, the row and the place in the row alone,
//! so rows may be done in any order. A hash gives 64 bits, five channels take 12 of them each, and a table of the
//! normal distribution's quantiles makes whole grey levels of them.

use std::sync::LazyLock;

use crate::image::Image;
use crate::render::each_chunk;
use crate::texture::mix;

/// Bits that choose a quantile.
const BITS: u32 = 12;

const QUANTILES: usize = 1 << BITS;

/// Channels that one hash serves.
const SERVED: usize = 5;

/// Rows that a thread takes at a time.
const ROWS: usize = 32;

/// Grey levels; more would be nothing but noise.
const MOST_SIGMA: f64 = 255.0;

/// Adds noise of a normal distribution with a standard deviation of `sigma` grey levels (of 255), independent for
/// each channel, saturating. The same key, frame number and image give the same bytes. A sigma that is zero,
/// negative or not a number adds nothing.
pub fn noise(image: &mut Image, sigma: f64, key: u64, frame: u64) {
    noise_in_bands(image, sigma, key, frame, 1);
}

/// As [`noise`], by so many threads; the bytes are the same.
pub fn noise_in_bands(image: &mut Image, sigma: f64, key: u64, frame: u64, bands: usize) {
    if sigma.is_nan() || sigma <= 0.0 || image.width == 0 {
        return;
    }
    let table = table(if sigma < MOST_SIGMA { sigma } else { MOST_SIGMA });
    let stream = mix(mix(key) ^ frame);
    let length = 3 * image.width;
    each_chunk(&mut image.data, length * ROWS, &mut vec![(); bands.clamp(1, 64)], |(), number, bytes| {
        for (row, bytes) in (number * ROWS..).zip(bytes.chunks_mut(length)) {
            add(bytes, &table, mix(stream ^ row as u64));
        }
    });
}

/// Adds noise to a row.
fn add(row: &mut [u8], table: &[i16; QUANTILES], stream: u64) {
    let mut counter = stream;
    let mut next = || {
        let bits = mix(counter);
        counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
        bits
    };
    let (fives, rest) = row.as_chunks_mut::<SERVED>();
    for five in fives {
        add_to(five, table, next());
    }
    add_to(rest, table, next());
}

/// Adds noise to channels that one hash serves.
#[inline(always)]
fn add_to(channels: &mut [u8], table: &[i16; QUANTILES], mut bits: u64) {
    for channel in channels {
        let sum = i16::from(*channel) + table[bits as usize % QUANTILES];
        *channel = sum.clamp(0, 255) as u8;
        bits >>= BITS;
    }
}

/// Whole grey levels at equally likely quantiles, with a standard deviation of `sigma`.
fn table(sigma: f64) -> [i16; QUANTILES] {
    static UNIT: LazyLock<Vec<f64>> =
        LazyLock::new(|| (0..QUANTILES / 2).map(|i| quantile((i as f64 + 0.5) / QUANTILES as f64)).collect());
    let scale = scale_for(sigma, &UNIT);
    let mut table = [0; QUANTILES];
    for (i, unit) in UNIT.iter().enumerate() {
        let level = rounded(unit * scale) as i16;
        table[i] = level;
        table[QUANTILES - 1 - i] = -level;
    }
    table
}

/// To the nearest whole number, halves away from zero.
fn rounded(level: f64) -> i32 {
    (if level < 0.0 { level - 0.5 } else { level + 0.5 }) as i32
}

/// What to multiply quantiles by so that they have the standard deviation asked for after rounding, which adds to
/// it a little when it is large and takes most of it away when it is small.
fn scale_for(sigma: f64, unit: &[f64]) -> f64 {
    let mean_square = |of: &dyn Fn(f64) -> f64| unit.iter().map(|u| of(*u)).sum::<f64>() / unit.len() as f64;
    if sigma >= 1.0 {
        // Rounding adds a twelfth of a level squared.
        return ((sigma * sigma - 1.0 / 12.0) / mean_square(&|u| u * u)).sqrt();
    }
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..24 {
        let scale = (low + high) / 2.0;
        let square = mean_square(&|u| {
            let level = f64::from(rounded(u * scale));
            level * level
        });
        if square < sigma * sigma { low = scale } else { high = scale }
    }
    (low + high) / 2.0
}

/// The normal distribution's quantile for a probability up to a half (P. J. Acklam's rational approximation,
/// relative error below 2e-9).
fn quantile(probability: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969683028665376e1,
        2.209460984245205e2,
        -2.759285104469687e2,
        1.383_577_518_672_69e2,
        -3.066479806614716e1,
        2.506628277459239,
    ];
    const B: [f64; 6] = [
        -5.447609879822406e1,
        1.615858368580409e2,
        -1.556989798598866e2,
        6.680131188771972e1,
        -1.328068155288572e1,
        1.0,
    ];
    const C: [f64; 6] = [
        -7.784894002430293e-3,
        -3.223964580411365e-1,
        -2.400758277161838,
        -2.549732539343734,
        4.374664141464968,
        2.938163982698783,
    ];
    const D: [f64; 5] =
        [7.784695709041462e-3, 3.224671290700398e-1, 2.445134137142996, 3.754408661907416, 1.0];
    let polynomial = |of: &[f64], x: f64| of.iter().fold(0.0, |sum, c| sum * x + c);
    if probability < 0.02425 {
        let q = (-2.0 * libm::log(probability)).sqrt();
        return polynomial(&C, q) / polynomial(&D, q);
    }
    let q = probability - 0.5;
    q * polynomial(&A, q * q) / polynomial(&B, q * q)
}

#[cfg(test)]
mod tests {
    use super::{quantile, table};

    #[test]
    fn quantiles_are_the_normal_distributions() {
        for (probability, known) in [(0.5, 0.0), (0.158_655_253_931_457, -1.0), (0.001_349_898_031_630, -3.0)]
        {
            assert!((quantile(probability) - known).abs() < 1e-7);
        }
    }

    #[test]
    fn the_table_has_the_sigma_asked_for() {
        for sigma in [0.2, 0.5, 0.9, 1.0, 2.0, 5.0, 40.0] {
            let table = table(sigma);
            let square: f64 = table.iter().map(|level| f64::from(*level) * f64::from(*level)).sum();
            let found = (square / table.len() as f64).sqrt();
            assert!((found / sigma - 1.0).abs() < 0.01, "{sigma}: {found}");
            assert_eq!(table.iter().map(|level| i64::from(*level)).sum::<i64>(), 0);
        }
    }
}
