//! Arithmetic on colours, all channels at once.
//!
//! A colour's channels are spread to 16 bits each in one word, where a share in 256ths of a grey level from 0 to 255
//! does not reach the next channel: one multiplication weighs them all.

use crate::light::FULL;

/// Red, green and blue from the lowest byte on; the highest is zero.
pub(crate) type Colour = u32;

/// Shares and brightness are in 256ths.
pub(crate) const WHOLE: u32 = 256;

/// Red, blue and green, 16 bits each.
type Lanes = u64;

/// The low byte of each channel.
const BYTES: Lanes = 0x00ff_00ff_00ff;

/// A half, in 256ths, of each channel.
const HALVES: Lanes = 0x0080_0080_0080;

#[inline(always)]
pub(crate) fn opaque([r, g, b]: [u8; 3]) -> Colour {
    u32::from_le_bytes([r, g, b, 0])
}

#[inline(always)]
pub(crate) fn rgb(colour: Colour) -> [u8; 3] {
    let [r, g, b, _] = colour.to_le_bytes();
    [r, g, b]
}

#[inline(always)]
fn spread(colour: Colour) -> Lanes {
    let colour = u64::from(colour);
    (colour | colour << 24) & BYTES
}

#[inline(always)]
fn gather(lanes: Lanes) -> Colour {
    (lanes | lanes >> 24) as u32 & 0x00ff_ffff
}

#[inline(always)]
fn blend_lanes(a: Lanes, b: Lanes, share: u32) -> Lanes {
    // A channel of `b - a` may borrow from the next; the sum gives it back.
    let sum = (a << 8).wrapping_add(b.wrapping_sub(a).wrapping_mul(u64::from(share)));
    (sum.wrapping_add(HALVES) >> 8) & BYTES
}

#[inline(always)]
fn brighten_lanes(lanes: Lanes, shade: u32) -> Lanes {
    if shade <= FULL {
        return ((lanes * u64::from(shade) + HALVES) >> 8) & BYTES;
    }
    let channel = |at: u32| ((((lanes >> at) & 0xff) * u64::from(shade) + 128) >> 8).min(255) << at;
    channel(0) | channel(16) | channel(32)
}

/// From `a` to `b` by a share in 256ths, each channel to the nearest grey level.
#[inline(always)]
pub(crate) fn blend(a: Colour, b: Colour, share: u32) -> Colour {
    gather(blend_lanes(spread(a), spread(b), share))
}

/// Between four, `right` of the way from left to right and `up` from below to above, then times `shade`.
#[inline(always)]
pub(crate) fn between(below: [Colour; 2], above: [Colour; 2], right: u32, up: u32, shade: u32) -> Colour {
    let below = blend_lanes(spread(below[0]), spread(below[1]), right);
    let above = blend_lanes(spread(above[0]), spread(above[1]), right);
    gather(brighten_lanes(blend_lanes(below, above, up), shade))
}

/// A colour times 256ths, saturating.
#[inline(always)]
pub(crate) fn brighten(colour: Colour, shade: u32) -> Colour {
    gather(brighten_lanes(spread(colour), shade))
}

#[cfg(test)]
mod tests {
    use super::{between, blend, brighten, opaque};

    #[test]
    fn shares_are_exact_at_their_ends_and_rounded_between() {
        let (a, b) = (opaque([0, 255, 10]), opaque([255, 0, 20]));
        assert_eq!(blend(a, b, 0), a);
        assert_eq!(blend(a, b, 256), b);
        assert_eq!(blend(a, b, 128), opaque([128, 128, 15]));
        assert_eq!(between([a, b], [b, a], 0, 0, 256), a);
        assert_eq!(between([a, b], [b, a], 0, 255, 256), blend(a, b, 255));
        assert_eq!(between([a, b], [b, a], 128, 77, 256), opaque([128, 128, 15]));
    }

    #[test]
    fn brightness_saturates() {
        let colour = opaque([1, 100, 200]);
        assert_eq!(brighten(colour, 256), colour);
        assert_eq!(brighten(colour, 128), opaque([1, 50, 100]));
        assert_eq!(brighten(colour, 512), opaque([2, 200, 255]));
        assert_eq!(brighten(opaque([1, 0, 200]), 255 * 256), opaque([255, 0, 255]));
    }
}
