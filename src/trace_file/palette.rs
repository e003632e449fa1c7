//! Colours of robots, the same in every picture and viewer.

/// Red, green, blue.
pub type Color = [u8; 3];

/// Told apart by colour-blind readers too (after Okabe and Ito, "Color Universal Design", 2008), without
/// their reds: red is for contacts.
const FIRST: [Color; 7] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [160, 70, 160],
    [86, 180, 233],
    [130, 90, 60],
    [90, 100, 115],
];

/// Colour of robot `index`: the fixed ones first, then hues a golden angle apart.
pub fn robot(index: usize) -> Color {
    match FIRST.get(index) {
        Some(c) => *c,
        None => hue((index as f64 * 137.507_764) % 360.0),
    }
}

/// A hue in degrees at saturation 0.65 and lightness 0.42 (HSL).
fn hue(degrees: f64) -> Color {
    let (saturation, lightness) = (0.65, 0.42);
    let chroma = saturation * f64::min(lightness, 1.0 - lightness);
    [0.0, 8.0, 4.0].map(|offset| {
        let k = (offset + degrees / 30.0) % 12.0;
        let level = lightness - chroma * f64::min(k - 3.0, 9.0 - k).clamp(-1.0, 1.0);
        (level * 255.0).round() as u8
    })
}
