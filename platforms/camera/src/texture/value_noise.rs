//! Noise that repeats: random values on a lattice, smoothly between.

/// Mixes a counter into 64 random bits (the finaliser of SplitMix64).
#[inline(always)]
pub(crate) const fn mix(counter: u64) -> u64 {
    let z = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A seed of a name.
pub(crate) fn seed_of(name: &str) -> u64 {
    name.bytes().fold(0x736f_6966_7261, |seed, byte| mix(seed ^ u64::from(byte)))
}

/// A random value from 0 to 1 for a place of a lattice.
pub(crate) fn random(seed: u64, x: usize, y: usize) -> f64 {
    let bits = mix(seed ^ mix((x as u64) << 32 | y as u64));
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Values about -1 to 1 of `side` × `side` pixels, row by row, that repeat: octaves from a lattice of `coarsest`
/// cells a side to one of `finest`, each with `falloff` of the amplitude of the one before. Cells may be narrower
/// than they are high: `stretch` times as many of them fit in a row.
pub(crate) fn octaves(
    seed: u64,
    side: usize,
    coarsest: usize,
    finest: usize,
    falloff: f64,
    stretch: usize,
) -> Vec<f32> {
    let mut sum = vec![0.0_f32; side * side];
    let (mut cells, mut amplitude, mut total) = (coarsest, 1.0, 0.0);
    while cells <= finest {
        let across = (cells * stretch).min(side);
        add_octave(mix(seed ^ cells as u64), side, across, cells, amplitude as f32, &mut sum);
        total += amplitude * amplitude;
        amplitude *= falloff;
        cells *= 2;
    }
    // Octaves are independent: their squares add up.
    let scale = (1.0 / f64::max(total, f64::MIN_POSITIVE).sqrt()) as f32;
    for value in &mut sum {
        *value *= scale;
    }
    sum
}

/// Adds smooth noise of a lattice of `across` × `down` cells.
fn add_octave(seed: u64, side: usize, across: usize, down: usize, amplitude: f32, sum: &mut [f32]) {
    let lattice: Vec<f32> =
        (0..down).flat_map(|y| (0..across).map(move |x| (2.0 * random(seed, x, y) - 1.0) as f32)).collect();
    // The cell left of each pixel, the next one, and how far between them, smoothed.
    let places = |cells: usize| -> Vec<(usize, usize, f32)> {
        let place = |i: usize| {
            let at = i * cells;
            let t = (at % side) as f32 / side as f32;
            (at / side, (at / side + 1) % cells, t * t * (3.0 - 2.0 * t))
        };
        (0..side).map(place).collect()
    };
    let columns = places(across);
    for (row, (y0, y1, ty)) in sum.chunks_exact_mut(side).zip(places(down)) {
        let (low, high) = (&lattice[y0 * across..][..across], &lattice[y1 * across..][..across]);
        for (value, &(x0, x1, tx)) in row.iter_mut().zip(&columns) {
            let below = low[x0] + (low[x1] - low[x0]) * tx;
            let above = high[x0] + (high[x1] - high[x0]) * tx;
            *value += amplitude * (below + (above - below) * ty);
        }
    }
}
