//! Procedural textures. Each is seeded by its own name and repeats without a seam.
//!
//! They have structure at every scale, from the whole repeat down to a texel: what edges, corners and flow are
//! found by has to be there from half a metre as from ten.

use super::value_noise::{mix, octaves, random, seed_of};
use super::{Texture, pyramid};

/// Texels along a side of the large ones.
const LARGE: usize = 512;

/// Texels along a side of those that are regular.
const SMALL: usize = 256;

type Colour = [f32; 3];

/// A square texture, pixel by pixel.
fn paint(side: usize, colour: impl Fn(usize, usize) -> Colour) -> Texture {
    let mut rgb = Vec::with_capacity(3 * side * side);
    for y in 0..side {
        for x in 0..side {
            rgb.extend(colour(x, y).map(|c| (c + 0.5).clamp(0.0, 255.0) as u8));
        }
    }
    Texture { levels: pyramid::build(side, side, &rgb).into(), proportion: 1.0 }
}

fn mixed(a: Colour, b: Colour, share: f32) -> Colour {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share)
}

fn brighter(colour: Colour, by: f32) -> Colour {
    colour.map(|c| c + by)
}

/// From -1 to 1 for a cell.
fn tint(seed: u64, x: usize, y: usize) -> f32 {
    (2.0 * random(seed, x, y) - 1.0) as f32
}

/// A painted wall: broad stains, grain, and scattered chips where the paint has come off.
pub(super) fn plaster() -> Texture {
    let seed = seed_of("plaster");
    let stains = octaves(seed, LARGE, 4, 128, 0.75, 1);
    let chips = octaves(mix(seed), LARGE, 16, 64, 0.7, 1);
    paint(LARGE, |x, y| {
        let at = y * LARGE + x;
        let wall = brighter([200.0, 192.0, 172.0], 42.0 * stains[at]);
        // Where the chips' noise is high; a steep ramp keeps their outline sharp without a jagged one.
        let chipped = ((chips[at] - 0.52) * 14.0).clamp(0.0, 1.0);
        mixed(wall, [118.0, 108.0, 98.0], chipped * 0.8)
    })
}

/// Courses of red bricks, each burnt a little differently, in light mortar.
pub(super) fn bricks() -> Texture {
    let seed = seed_of("bricks");
    let grain = octaves(seed, LARGE, 16, 256, 0.8, 1);
    // Four bricks in a course, eight courses.
    let (long, high, mortar) = (LARGE / 4, LARGE / 8, 6);
    paint(LARGE, |x, y| {
        let course = y / high;
        let x = (x + (course % 2) * long / 2) % LARGE;
        let grain = grain[y * LARGE + x];
        if x % long < mortar || y % high < mortar {
            return brighter([196.0, 190.0, 180.0], 18.0 * grain);
        }
        let burnt = tint(seed, x / long, course);
        let brick = mixed([150.0, 66.0, 48.0], [112.0, 46.0, 40.0], 0.5 + 0.5 * burnt);
        brighter(brick, 24.0 * grain + 12.0 * tint(mix(seed), x / long, course))
    })
}

/// Boards standing upright, with grain along them, joints and knots.
pub(super) fn planks() -> Texture {
    let seed = seed_of("planks");
    let grain = octaves(seed, LARGE, 4, 64, 0.85, 8);
    let rough = octaves(mix(seed), LARGE, 32, 256, 0.8, 1);
    let (wide, long) = (LARGE / 8, LARGE / 2);
    paint(LARGE, |x, y| {
        let board = x / wide;
        // Boards end at different heights.
        let y_of_board = (y + (random(seed, board, 1) * LARGE as f64) as usize) % LARGE;
        let at = y * LARGE + x;
        if x % wide < 3 || y_of_board % long < 3 {
            return brighter([58.0, 38.0, 24.0], 8.0 * rough[at]);
        }
        let wood = brighter([168.0, 122.0, 76.0], 26.0 * tint(seed, board, y_of_board / long));
        brighter(wood, 34.0 * grain[at] + 10.0 * rough[at])
    })
}

/// A floor of square tiles, 4 × 4 to a repeat, with dark joints.
pub(super) fn tiles() -> Texture {
    let seed = seed_of("tiles");
    let veins = octaves(seed, LARGE, 8, 256, 0.8, 1);
    let (tile, joint) = (LARGE / 4, 5);
    paint(LARGE, |x, y| {
        let vein = veins[y * LARGE + x];
        if x % tile < joint || y % tile < joint {
            return brighter([84.0, 82.0, 80.0], 10.0 * vein);
        }
        let (column, row) = (x / tile, y / tile);
        let base = if (column + row) % 2 == 0 { [168.0, 172.0, 170.0] } else { [140.0, 148.0, 152.0] };
        brighter(base, 26.0 * vein + 16.0 * tint(seed, column, row))
    })
}

/// Dark and light squares, 8 × 8 to a repeat, slightly worn.
pub(super) fn checker() -> Texture {
    let worn = octaves(seed_of("checker"), SMALL, 16, 128, 0.8, 1);
    let square = SMALL / 8;
    paint(SMALL, |x, y| {
        let base = if (x / square + y / square).is_multiple_of(2) { [225.0; 3] } else { [35.0; 3] };
        brighter(base, 12.0 * worn[y * SMALL + x])
    })
}

/// Black and white blots of all sizes: corners everywhere.
pub(super) fn speckle() -> Texture {
    let seed = seed_of("speckle");
    let noise = octaves(seed, LARGE, 16, 128, 0.9, 1);
    paint(LARGE, |x, y| {
        let share = (noise[y * LARGE + x] * 9.0 + 0.5).clamp(0.0, 1.0);
        mixed([30.0, 32.0, 38.0], [232.0, 230.0, 222.0], share)
    })
}

/// Grey, cast in panels, with stains and pores.
pub(super) fn concrete() -> Texture {
    let seed = seed_of("concrete");
    let stains = octaves(seed, LARGE, 4, 256, 0.8, 1);
    let pores = octaves(mix(seed), LARGE, 64, 128, 0.8, 1);
    paint(LARGE, |x, y| {
        let at = y * LARGE + x;
        let grey = brighter([136.0, 137.0, 134.0], 34.0 * stains[at]);
        let pore = ((pores[at] - 0.72) * 12.0).clamp(0.0, 1.0);
        let panel = if x % (LARGE / 2) < 4 || y % LARGE < 4 { -30.0 } else { 0.0 };
        brighter(mixed(grey, [70.0, 70.0, 68.0], pore), panel)
    })
}

/// Blue and grey tufts in a loose pattern.
pub(super) fn carpet() -> Texture {
    let seed = seed_of("carpet");
    let tufts = octaves(seed, LARGE, 64, 256, 1.0, 1);
    let pattern = octaves(mix(seed), LARGE, 8, 32, 0.8, 1);
    paint(LARGE, |x, y| {
        let at = y * LARGE + x;
        let share = (pattern[at] * 5.0 + 0.5).clamp(0.0, 1.0);
        brighter(mixed([52.0, 62.0, 92.0], [112.0, 106.0, 104.0], share), 30.0 * tufts[at])
    })
}

/// Yellow and black, slanted, as on what one should not run into.
pub(super) fn stripes() -> Texture {
    let dirt = octaves(seed_of("stripes"), SMALL, 8, 128, 0.8, 1);
    paint(SMALL, |x, y| {
        let base = if (x + y) % (SMALL / 2) < SMALL / 4 { [224.0, 180.0, 30.0] } else { [30.0, 28.0, 26.0] };
        brighter(base, 18.0 * dirt[y * SMALL + x])
    })
}

/// Woven cloth of a colour, with broad folds.
pub(super) fn cloth(colour: [u8; 3]) -> Texture {
    let seed = seed_of("cloth");
    let folds = octaves(seed, SMALL, 4, 32, 0.7, 1);
    let threads = octaves(mix(seed), SMALL, 64, 128, 1.0, 1);
    let base = colour.map(f32::from);
    paint(SMALL, |x, y| {
        let at = y * SMALL + x;
        let weave = if (x / 4 + y / 4) % 2 == 0 { 6.0 } else { -6.0 };
        brighter(base, 34.0 * folds[at] + 16.0 * threads[at] + weave)
    })
}
