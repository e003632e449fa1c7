//! Silhouettes: a pixel that an edge passes through shows both sides, each by the share that it covers.
//!
//! Which facet is seen is decided at the centres of pixels, so an edge would jump from pixel to pixel and what is
//! measured on it would too. Where two neighbours see different facets, the edge between them is known exactly: the
//! side of the nearer facet. The pixel that it passes through takes its share of the neighbour's colour. An edge
//! nearer to upright is followed along rows, others along columns, where a box of one pixel is exact.

use crate::colour::{Colour, WHOLE, opaque, rgb};
use crate::facet::{Facet, Linear, at};
use crate::visibility::Strip;

/// Pixels that are looked at together for whether there is an edge at all.
const GROUP: usize = 8;

/// Writes a strip's rows from `from` on as bytes; rows before and after are looked at only.
pub(crate) fn write(strip: &Strip, facets: &[Facet], from: usize, bytes: &mut [u8]) {
    let width = strip.width;
    for (row, bytes) in (from..strip.count).zip(bytes.chunks_exact_mut(3 * width)) {
        let here = &strip.seen[row * width..(row + 1) * width];
        // Beyond the frame it goes on as it is.
        let above = if row == 0 { here } else { &strip.seen[(row - 1) * width..row * width] };
        let below =
            if row + 1 == strip.count { here } else { &strip.seen[(row + 1) * width..(row + 2) * width] };
        let colours = &strip.colours[row * width..(row + 1) * width];
        for x in (0..width).step_by(GROUP) {
            let end = (x + GROUP).min(width);
            let bytes = &mut bytes[3 * x..3 * end];
            let plain = x > 0 && end < width && {
                let (left, right) = (&here[x - 1..end - 1], &here[x + 1..end + 1]);
                uniform(&here[x..end], left, right, &above[x..end], &below[x..end])
            };
            let colours = &colours[x..end];
            if let (true, Ok(colours), Ok(bytes)) = (plain, colours.try_into(), bytes.as_mut().try_into()) {
                pack(colours, bytes);
                continue;
            }
            for ((x, colour), bytes) in (x..end).zip(colours).zip(bytes.chunks_exact_mut(3)) {
                let colour = if plain { *colour } else { mixed(strip, facets, row, x) };
                bytes.copy_from_slice(&rgb(colour));
            }
        }
    }
}

/// Bytes of a group, three words at a time.
#[inline(always)]
fn pack(colours: &[Colour; GROUP], bytes: &mut [u8; 3 * GROUP]) {
    let [a, b, c, d, e, f, g, h] = colours.map(u64::from);
    let words = [a | b << 24 | c << 48, c >> 16 | d << 8 | e << 32 | f << 56, f >> 8 | g << 16 | h << 40];
    let (eights, _) = bytes.as_chunks_mut::<8>();
    for (eight, word) in eights.iter_mut().zip(words) {
        *eight = word.to_le_bytes();
    }
}

/// Whether a group sees what all its neighbours see.
#[inline(always)]
fn uniform(here: &[u32], left: &[u32], right: &[u32], above: &[u32], below: &[u32]) -> bool {
    let rows = here.iter().zip(left).zip(right).zip(above).zip(below);
    rows.fold(0, |any, ((((h, l), r), a), b)| any | (h ^ l) | (h ^ r) | (h ^ a) | (h ^ b)) == 0
}

/// The colour of a pixel with its share of its neighbours'.
fn mixed(strip: &Strip, facets: &[Facet], row: usize, x: usize) -> Colour {
    let width = strip.width;
    let index = row * width + x;
    let (own, number) = (strip.colours[index], strip.seen[index]);
    let centre = [x as f64 + 0.5, (strip.first + row) as f64 + 0.5];
    let neighbours = [
        (x > 0).then(|| (index - 1, [-1.0, 0.0])),
        (x + 1 < width).then(|| (index + 1, [1.0, 0.0])),
        (row > 0).then(|| (index - width, [0.0, -1.0])),
        (row + 1 < strip.count).then(|| (index + width, [0.0, 1.0])),
    ];
    let (mut sum, mut given) = ([0; 3], 0);
    for (neighbour, toward) in neighbours.into_iter().flatten() {
        let other = strip.seen[neighbour];
        if other == number {
            continue;
        }
        let share = share(facets, facets.get(number as usize), facets.get(other as usize), centre, toward);
        // Of a pixel with edges on all sides there is no more to give than there is.
        let share = share.min(WHOLE - given);
        add(&mut sum, strip.colours[neighbour], share);
        given += share;
    }
    add(&mut sum, own, WHOLE - given);
    opaque(sum.map(|channel| ((channel + WHOLE / 2) / WHOLE) as u8))
}

fn add(sum: &mut [u32; 3], colour: Colour, share: u32) {
    for (sum, channel) in sum.iter_mut().zip(rgb(colour)) {
        *sum += u32::from(channel) * share;
    }
}

/// The share of the neighbour's colour in a pixel: what lies beyond the edge between them.
fn share(
    facets: &[Facet],
    own: Option<&Facet>,
    other: Option<&Facet>,
    centre: [f64; 2],
    toward: [f64; 2],
) -> u32 {
    if let (Some(own), Some(other)) = (own, other)
        && own.continues(other)
    {
        return 0;
    }
    let next = [centre[0] + toward[0], centre[1] + toward[1]];
    let middle = [(centre[0] + next[0]) / 2.0, (centre[1] + next[1]) / 2.0];
    let depth = |facet: Option<&Facet>| facet.map_or(0.0, |f| f.inverse_depth_at(middle[0], middle[1]));
    let leaving = || leave(facets, own?, other, centre, next);
    let entering = || leave(facets, other?, own, next, centre).map(|(way, edge)| (1.0 - way, edge));
    // Behind, a facet goes on unseen: only the nearer one's edge is the silhouette.
    let met =
        if depth(own) >= depth(other) { leaving().or_else(entering) } else { entering().or_else(leaving) };
    let Some((way, edge)) = met.or_else(|| pass(own?, other?, centre, next)) else { return 0 };
    let upright = edge[0].abs() >= edge[1].abs();
    let along_row = toward[0] != 0.0;
    if upright != along_row || way >= 0.5 {
        return 0;
    }
    ((0.5 - way) * f64::from(WHOLE) + 0.5) as u32
}

/// Pixels by which a centre may seem to be on the other side of an edge: corners were rounded when it was decided.
const TRACE: f64 = 1.0 / 64.0;

/// Facets that a way of one pixel leads over before it is given up.
const MOST_FACETS: usize = 8;

/// How far on the way from inside a facet to a place that sees another one its surface ends, and by which edge.
///
/// The surface goes on over the facet's side if there is a facet beyond that faces the camera too, though it may be
/// so narrow that no pixel's centre sees it, as at the limb of a cylinder.
fn leave(
    facets: &[Facet],
    facet: &Facet,
    other: Option<&Facet>,
    inside: [f64; 2],
    outside: [f64; 2],
) -> Option<(f64, Linear)> {
    let (mut facet, mut from) = (facet, 0.0);
    for _ in 0..MOST_FACETS {
        let (way, side) = cross(facet, inside, outside)?;
        from = if way > from { way } else { from };
        let edge = facet.sides[side];
        match facets.get(facet.beyond[side] as usize) {
            Some(next) if !other.is_some_and(|other| next.continues(other)) => facet = next,
            _ => return Some((from, edge)),
        }
    }
    None
}

/// How far on the way out of a facet its first side is met, and which side.
fn cross(facet: &Facet, inside: [f64; 2], outside: [f64; 2]) -> Option<(f64, usize)> {
    let mut first = None;
    for (number, side) in facet.sides.iter().enumerate() {
        let beyond = at(side, outside[0], outside[1]);
        let within = at(side, inside[0], inside[1]);
        if beyond < TRACE && beyond < within {
            let way = (within / (within - beyond)).clamp(0.0, 1.0);
            if first.is_none_or(|(nearest, _)| way < nearest) {
                first = Some((way, number));
            }
        }
    }
    first
}

/// How far on the way one facet passes through another.
fn pass(own: &Facet, other: &Facet, centre: [f64; 2], next: [f64; 2]) -> Option<(f64, Linear)> {
    let ahead = [0, 1, 2].map(|i| own.inverse_depth[i] - other.inverse_depth[i]);
    let (here, there) = (at(&ahead, centre[0], centre[1]), at(&ahead, next[0], next[1]));
    (here > 0.0 && there < 0.0).then(|| (here / (here - there), ahead))
}
