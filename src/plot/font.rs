//! A stroke font, so that a picture needs no font to be installed and looks the same everywhere.
//!
//! A glyph is its width and its strokes on a grid where capitals are 14 high and small letters 10.
//! Strokes are written like SVG paths: `M`ove, `L`ine, `C`ubic, and two for round letters: a quarter of
//! an ellipse to a point, leaving `H`orizontally or `V`ertically.

use super::drawing::Segment;

const CAPITAL: f64 = 14.0;
const GAP: f64 = 3.1;
/// Control points of a quarter of a circle.
const KAPPA: f64 = 0.552_284_75;
/// What stands for characters that are not in the font.
const UNKNOWN: (f64, &str) = (7.0, "M0 0L7 0L7 12L0 12L0 0");

const GLYPHS: &[(char, f64, &str)] = &[
    (' ', 2.6, ""),
    ('!', 0.0, "M0 14L0 4.5M0 0L0 0.3"),
    ('"', 3.2, "M0 14L0 10M3.2 14L3.2 10"),
    ('#', 9.0, "M2.2 0L4 14M6 0L7.8 14M0 9.5L9 9.5M-0.6 4.5L8.4 4.5"),
    ('$', 8.6, "M8 11V4.3 13H0.5 10V4.3 7H8.6 3.8V4.3 1H0 3M4.3 15L4.3 -1"),
    ('%', 12.0, "M2.6 14H5.2 11.2V2.6 8.4H0 11.2V2.6 14M9.4 5.6H12 2.8V9.4 0H6.8 2.8V9.4 5.6M9.8 14L2.2 0"),
    ('&', 10.0, "M10 0L2.2 9.4V4.4 14H7 11.4C7 8 0 7.6 0 3.6V3.8 0H9.4 6"),
    ('\'', 0.0, "M0 14L0 10"),
    ('(', 3.0, "M3 15.5C-1 11 -1 2 3 -2.6"),
    (')', 3.0, "M0 15.5C4 11 4 2 0 -2.6"),
    ('*', 6.0, "M3 14L3 7M0 12.2L6 8.8M0 8.8L6 12.2"),
    ('+', 8.0, "M0 5.5L8 5.5M4 1.5L4 9.5"),
    (',', 0.8, "M0.8 0.3L0 -2.6"),
    ('-', 5.0, "M0 5.4L5 5.4"),
    ('.', 0.0, "M0 0L0 0.3"),
    ('/', 6.0, "M0 -1.5L6 15"),
    ('0', 8.8, "M4.4 14H8.8 7V4.4 0H0 7V4.4 14"),
    ('1', 8.8, "M1.4 11.2L5 14L5 0"),
    ('2', 8.8, "M0.5 10.4V4.4 14H8.4 10.4C8.4 7.2 4.5 5.2 0.3 0L8.8 0"),
    ('3', 8.8, "M0.7 11V4.3 14H8.1 10.7V4.3 7.5L3.2 7.5M4.3 7.5H8.8 3.7V4.3 0H0.2 3.1"),
    ('4', 8.8, "M6.6 0L6.6 14L0 4.2L8.8 4.2"),
    ('5', 8.8, "M8 14L1.5 14L0.9 7.7C1.8 8.6 3 9 4.4 9H8.8 4.5V4.3 0H0.2 2.9"),
    ('6', 8.8, "M7.9 11.6C7.3 13.2 6.2 14 4.8 14C1.6 14 0 11 0 6.4L0 4.5V4.4 9H8.8 4.5V4.4 0H0 4.5"),
    ('7', 8.8, "M0 14L8.6 14L3 0"),
    ('8', 8.8, "M4.4 14H8.1 10.8V4.4 7.6H0.7 10.8V4.4 14M4.4 7.6H8.8 3.8V4.4 0H0 3.8V4.4 7.6"),
    ('9', 8.8, "M0.9 2.4C1.5 0.8 2.6 0 4 0C7.2 0 8.8 3 8.8 7.6L8.8 9.5V4.4 14H0 9.5V4.4 5H8.8 9.5"),
    (':', 0.0, "M0 0L0 0.3M0 7.4L0 7.7"),
    (';', 0.8, "M0.8 0.3L0 -2.6M0.8 7.4L0.8 7.7"),
    ('<', 7.0, "M7 10L0 5.5L7 1"),
    ('=', 8.0, "M0 7.6L8 7.6M0 3.4L8 3.4"),
    ('>', 7.0, "M0 10L7 5.5L0 1"),
    ('?', 7.6, "M0 10.8V3.8 14H7.6 10.6C7.6 7.6 3.8 7.6 3.8 4.2M3.8 0L3.8 0.3"),
    (
        '@',
        13.0,
        "M9.4 8.2V6.4 9.6H3.6 6V6.4 2.6H9.4 5M9.4 9.4L9.4 4.4V11 2.6H13 6.6V6.5 13.4H0 6V6.5 -1.8L9.6 -1.2",
    ),
    ('A', 10.0, "M0 0L5 14L10 0M1.8 4.8L8.2 4.8"),
    ('B', 9.0, "M0 0L0 14L5 14H8.3 10.75V5 7.5H9 3.75V5 0L0 0M0 7.5L5 7.5"),
    ('C', 9.8, "M9.8 10.6V5.2 14H0 7V5.2 0H9.8 3.4"),
    ('D', 10.0, "M0 0L0 14L4 14H10 7V4 0L0 0"),
    ('E', 8.3, "M8.3 14L0 14L0 0L8.3 0M0 7.3L7 7.3"),
    ('F', 8.0, "M8 14L0 14L0 0M0 7.2L6.8 7.2"),
    ('G', 10.0, "M9.8 10.8V5.2 14H0 7V5.2 0H10 4L10 6.6L6 6.6"),
    ('H', 9.5, "M0 0L0 14M9.5 0L9.5 14M0 7.3L9.5 7.3"),
    ('I', 0.0, "M0 0L0 14"),
    ('J', 6.5, "M6.5 14L6.5 4V3.2 0H0 3.4"),
    ('K', 9.3, "M0 0L0 14M9 14L0 5.5M3.2 8.5L9.3 0"),
    ('L', 7.6, "M0 14L0 0L7.6 0"),
    ('M', 12.0, "M0 0L0 14L6 4L12 14L12 0"),
    ('N', 9.5, "M0 0L0 14L9.5 0L9.5 14"),
    ('O', 11.0, "M5.5 14H11 7V5.5 0H0 7V5.5 14"),
    ('P', 9.0, "M0 0L0 14L5 14H9 10.1V5 6.2L0 6.2"),
    ('Q', 11.0, "M5.5 14H11 7V5.5 0H0 7V5.5 14M6.8 3.4L10.6 -0.8"),
    ('R', 9.3, "M0 0L0 14L5 14H9 10.2V5 6.4L0 6.4M5 6.4L9.3 0"),
    ('S', 9.0, "M8.6 11V4.6 14H0.5 10.6V4.6 7.3H9 3.7V4.6 0H0 3.2"),
    ('T', 10.0, "M0 14L10 14M5 14L5 0"),
    ('U', 9.6, "M0 14L0 4.7V4.8 0H9.6 4.7L9.6 14"),
    ('V', 10.0, "M0 14L5 0L10 14"),
    ('W', 14.0, "M0 14L3.5 0L7 13L10.5 0L14 14"),
    ('X', 9.5, "M0 0L9.5 14M0 14L9.5 0"),
    ('Y', 10.0, "M0 14L5 6.8L10 14M5 6.8L5 0"),
    ('Z', 9.2, "M0 14L9 14L0 0L9.2 0"),
    ('[', 3.0, "M3 15.5L0 15.5L0 -2.6L3 -2.6"),
    ('\\', 6.0, "M0 15L6 -1.5"),
    (']', 3.0, "M0 15.5L3 15.5L3 -2.6L0 -2.6"),
    ('^', 6.0, "M0 10L3 14L6 10"),
    ('_', 8.0, "M0 -2.4L8 -2.4"),
    ('`', 2.0, "M0 14L2 12"),
    ('a', 8.0, "M8 10L8 0M8 5V4 10H0 5V4 0H8 5"),
    ('b', 8.0, "M0 14L0 0M0 5V4 10H8 5V4 0H0 5"),
    ('c', 7.6, "M7.6 7.6V4.2 10H0 5V4.2 0H7.6 2.4"),
    ('d', 8.0, "M8 14L8 0M8 5V4 10H0 5V4 0H8 5"),
    ('e', 8.0, "M0 5.3L8 5.3V4.1 10H0 5V4.2 0H7.7 2.3"),
    ('f', 5.0, "M5.2 14H2 11L2 0M0 9.6L4.8 9.6"),
    ('g', 8.0, "M8 10L8 0V4 -4.2H0.4 -2.2M8 5V4 10H0 5V4 0H8 5"),
    ('h', 7.4, "M0 14L0 0M0 6V4 10H7.4 6L7.4 0"),
    ('i', 0.0, "M0 10L0 0M0 13.4L0 13.7"),
    ('j', 2.0, "M2 10L2 -1.4V-0.8 -4.2M2 13.4L2 13.7"),
    ('k', 7.2, "M0 14L0 0M6.9 10L0 3.6M2.6 6L7.2 0"),
    ('l', 2.0, "M0 14L0 2.4V2 0"),
    ('m', 12.0, "M0 10L0 0M0 6.4V3.3 10H6 6.6L6 0M6 6.4V9.3 10H12 6.6L12 0"),
    ('n', 7.4, "M0 10L0 0M0 6V4 10H7.4 6L7.4 0"),
    ('o', 8.4, "M4.2 10H8.4 5V4.2 0H0 5V4.2 10"),
    ('p', 8.0, "M0 10L0 -4.2M0 5V4 10H8 5V4 0H0 5"),
    ('q', 8.0, "M8 10L8 -4.2M8 5V4 10H0 5V4 0H8 5"),
    ('r', 4.4, "M0 10L0 0M0 5.6V4.4 10"),
    ('s', 7.0, "M6.7 7.9V3.6 10H0.4 7.6V3.6 5.2H7 2.6V3.6 0H0 2.2"),
    ('t', 5.2, "M2.2 13.4L2.2 2.8V5.2 0M0 9.8L5 9.8"),
    ('u', 7.4, "M0 10L0 4V3.4 0H7.4 4M7.4 10L7.4 0"),
    ('v', 8.0, "M0 10L4 0L8 10"),
    ('w', 11.6, "M0 10L2.9 0L5.8 9.2L8.7 0L11.6 10"),
    ('x', 7.4, "M0 0L7.4 10M0 10L7.4 0"),
    ('y', 8.0, "M0 10L4.1 0M8 10L4.1 0L3 -2.6C2.5 -3.7 1.7 -4.2 0.6 -4.2"),
    ('z', 7.2, "M0 10L7 10L0 0L7.2 0"),
    ('{', 4.0, "M4 15.5H2 13L2 8.6V0 6.5M0 6.5H2 4.4L2 0V4 -2.6"),
    ('|', 0.0, "M0 -2.6L0 15.5"),
    ('}', 4.0, "M0 15.5H2 13L2 8.6V4 6.5M4 6.5H2 4.4L2 0V0 -2.6"),
    ('~', 8.0, "M0 4.6C1.6 8.4 3.2 6.6 4 5.6C4.8 4.6 6.4 2.8 8 6.6"),
    ('°', 3.8, "M1.9 14H3.8 12.1V1.9 10.2H0 12.1V1.9 14"),
    ('±', 8.0, "M0 7.5L8 7.5M4 3.5L4 11.5M0 0.6L8 0.6"),
    ('²', 4.4, "M0.2 12.2V2.2 14H4.2 12.3C4.2 10.8 2 9.8 0.1 7.4L4.4 7.4"),
    ('³', 4.4, "M0.3 12.6V2.1 14H4 12.5V2.1 11L1.6 11M2.1 11H4.4 9.2V2.1 7.4H0 8.8"),
    ('µ', 7.4, "M0 10L0 -4.2M0 4V3.4 0H7.4 4M7.4 10L7.4 0"),
    ('·', 0.0, "M0 5.3L0 5.6"),
    ('×', 6.6, "M0 2.2L6.6 8.8M0 8.8L6.6 2.2"),
    ('ß', 8.0, "M0 0L0 10.4V3.8 14H7.4 10.9V4.2 7.7H8 3.9V4.4 0L2.6 0"),
    ('–', 8.0, "M0 5.4L8 5.4"),
    ('—', 13.0, "M0 5.4L13 5.4"),
    ('‘', 0.8, "M0.8 14L0 11"),
    ('’', 0.8, "M0.8 14L0 11"),
    ('“', 4.0, "M0.8 14L0 11M4 14L3.2 11"),
    ('”', 4.0, "M0.8 14L0 11M4 14L3.2 11"),
    ('…', 9.6, "M0 0L0 0.3M4.8 0L4.8 0.3M9.6 0L9.6 0.3"),
    ('→', 11.0, "M0 5.4L11 5.4M7.4 9L11 5.4L7.4 1.8"),
    ('−', 8.0, "M0 5.5L8 5.5"),
    ('≤', 7.0, "M7 11.4L0 7.4L7 3.4M0 0.4L7 0.4"),
    ('≥', 7.0, "M0 11.4L7 7.4L0 3.4M0 0.4L7 0.4"),
    ('▪', 6.0, "M0 2.4L6 2.4L6 8.4L0 8.4L0 2.4M1.5 4L4.5 4M1.5 5.4L4.5 5.4M1.5 6.8L4.5 6.8"),
    ('▸', 6.4, "M0 0.8L6.4 5.4L0 10L0 0.8M1.4 3.6L1.4 7.2M2.8 4.6L2.8 6.2"),
];

/// Letters with a mark: the letters, what they are without it, the mark (in the middle of small letters,
/// its lowest point at 0).
const MARKED: &[(&str, &str, &str)] = &[
    ("áéíóúýÁÉÍÓÚÝ", "aeiouyAEIOUY", "M-1 0L1 2.4"),
    ("àèìòùÀÈÌÒÙ", "aeiouAEIOU", "M1 0L-1 2.4"),
    ("âêîôûÂÊÎÔÛ", "aeiouAEIOU", "M-2 0L0 2.2L2 0"),
    ("äëïöüÿÄËÏÖÜ", "aeiouyAEIOU", "M-1.9 0.8L-1.9 1.1M1.9 0.8L1.9 1.1"),
    ("ãñõÃÑÕ", "anoANO", "M-2.4 0.4C-1.2 2.6 1.2 -0.4 2.4 1.8"),
    ("åÅ", "aA", "M0 2.8H1.3 1.5V0 0.2H-1.3 1.5V0 2.8"),
    ("çÇ", "cC", ""),
    ("šžčěřňŠŽČĚŘŇ", "szcernSZCERN", "M-2 2.2L0 0L2 2.2"),
];

fn glyph(c: char) -> (f64, &'static str, &'static str) {
    if let Ok(i) = GLYPHS.binary_search_by_key(&c, |g| g.0) {
        return (GLYPHS[i].1, GLYPHS[i].2, "");
    }
    for (letters, bases, mark) in MARKED {
        if let Some(i) = letters.chars().position(|l| l == c) {
            let (width, strokes, _) = bases.chars().nth(i).map_or((UNKNOWN.0, UNKNOWN.1, ""), glyph);
            return (width, strokes, mark);
        }
    }
    (UNKNOWN.0, UNKNOWN.1, "")
}

/// Width of a text whose capitals are `size` high.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let units: f64 = text.chars().map(|c| glyph(c).0 + GAP).sum();
    (units - GAP).max(0.0) * size / CAPITAL
}

/// As much of a text as fits into a width, with an ellipsis if that is not all.
pub(super) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_string();
    }
    let room = room - width("…", size) - GAP * size / CAPITAL;
    let mut used = 0.0;
    let part = text.chars().take_while(|c| {
        used += (glyph(*c).0 + GAP) * size / CAPITAL;
        used <= room
    });
    let mut part: String = part.collect();
    part.truncate(part.trim_end().len());
    part.push('…');
    part
}

/// The strokes of a text from the origin, y up, each point put through `place`.
pub(super) fn outline(text: &str, size: f64, place: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Segment> {
    let scale = size / CAPITAL;
    let mut segments = Vec::new();
    let mut x = 0.0;
    for c in text.chars() {
        let (width, strokes, mark) = glyph(c);
        add(strokes, &mut segments, &|p| place([(x + p[0]) * scale, p[1] * scale]));
        let above = if c.is_uppercase() { 15.4 } else { 11.6 };
        add(mark, &mut segments, &|p| place([(x + width / 2.0 + p[0]) * scale, (above + p[1]) * scale]));
        x += width + GAP;
    }
    segments
}

/// Translates strokes into segments.
fn add(strokes: &str, out: &mut Vec<Segment>, place: &dyn Fn([f64; 2]) -> [f64; 2]) {
    let mut from = [0.0; 2];
    for (i, command) in strokes.char_indices().filter(|(_, c)| c.is_ascii_alphabetic()) {
        let rest = &strokes[i + 1..];
        let numbers = &rest[..rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len())];
        let mut numbers = numbers.split(' ').filter_map(|n| n.parse::<f64>().ok());
        let mut point = || [numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)];
        let first = point();
        let (dx, dy) = (first[0] - from[0], first[1] - from[1]);
        let (segment, end) = match command {
            'M' => (Segment::Move(place(first)), first),
            'L' => (Segment::Line(place(first)), first),
            'H' => {
                let (a, b) = ([from[0] + KAPPA * dx, from[1]], [first[0], first[1] - KAPPA * dy]);
                (Segment::Cubic(place(a), place(b), place(first)), first)
            }
            'V' => {
                let (a, b) = ([from[0], from[1] + KAPPA * dy], [first[0] - KAPPA * dx, first[1]]);
                (Segment::Cubic(place(a), place(b), place(first)), first)
            }
            _ => {
                let (second, end) = (point(), point());
                (Segment::Cubic(place(first), place(second), place(end)), end)
            }
        };
        out.push(segment);
        from = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glyphs_are_in_order_and_every_printable_ascii_character_is_there() {
        assert!(GLYPHS.is_sorted_by_key(|g| g.0));
        for c in ' '..='~' {
            assert!(GLYPHS.iter().any(|g| g.0 == c), "{c}");
        }
        for (letters, bases, _) in MARKED {
            assert_eq!(letters.chars().count(), bases.chars().count(), "{letters}");
        }
    }

    #[test]
    fn a_fitted_text_fits() {
        let text = "a rather long title that does not fit";
        let fitted = fit(text, 10.0, 120.0);
        assert!(width(&fitted, 10.0) <= 120.0 && fitted.ends_with('…'), "{fitted}");
        assert_eq!(fit("short", 10.0, 120.0), "short");
    }
}
