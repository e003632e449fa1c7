//! Images in which there is nothing to be timed: none, with the reason, and never a number.

use super::{look, metric, support::SIZE};
use crate::support::{file, folder, soifra, stdout};

/// The grey value of a pixel of an image: number, column, row.
pub type Scene = fn(usize, usize, usize) -> u8;

/// Something that is the same from run to run and has no edges.
fn grain(column: usize, row: usize) -> u8 {
    ((row * 7919 + column * 104_729 + row * column % 31) % 4) as u8
}

/// What can be followed, on something dark.
fn pattern(column: usize, row: usize) -> u8 {
    let (x, y) = (column / 5, row / 5);
    (40 + (x * 37 + y * 101 + x * y * 13) % 7 * 6) as u8
}

/// A video of a scene.
pub fn video(scene: Scene, images: usize) -> Vec<u8> {
    let (width, height) = SIZE;
    let mut out = format!("YUV4MPEG2 W{width} H{height} F20:1 Cmono XCOLORRANGE=FULL\n").into_bytes();
    for number in 0..images {
        out.extend(b"FRAME\n");
        out.extend((0..width * height).map(|i| scene(number, i % width, i / width)));
    }
    out
}

#[test]
fn there_is_a_reason() {
    let cases: [(&str, Scene, f64, &str); 7] = [
        ("black", |_, _, _| 0, 20.0, "blind: image all black"),
        ("white", |_, _, _| 255, 20.0, "blind: image all white"),
        ("blank", |_, c, r| 120 + grain(c, r), 0.0, "no time to contact: no features"),
        (
            "one edge",
            |n, c, r| if c > 180 + n { 60 } else { 160 + grain(c, r) },
            0.0,
            "no time to contact: one edge only",
        ),
        // It stands before a box.
        (
            "still",
            |_, c, r| if (120..200).contains(&c) { 60 } else { 160 + grain(c, r) },
            0.0,
            "no time to contact:",
        ),
        // It goes past a box: nothing grows.
        (
            "aside",
            |n, c, r| if (40 + 3 * n..120 + 3 * n).contains(&c) { 60 } else { 160 + grain(c, r) },
            0.0,
            "no time to contact:",
        ),
        // It goes away from a box.
        (
            "away",
            |n, c, r| if c.abs_diff(160) < 80 - n { 60 } else { 160 + grain(c, r) },
            0.0,
            "no time to contact:",
        ),
    ];
    let dir = folder("recording_reasons");
    for (name, scene, blind, says) in cases {
        let path = file(&dir, "seen.y4m", video(scene, 20));
        for ttc in ["expansion", "flow", "flow_robust"] {
            let set = format!("ttc={ttc}");
            let (report, trace) = look(&dir, &path, &["--set", &set]);
            let seen = ["images", "blind", "answers"].map(|m| metric(&report, m));
            assert_eq!(seen, [20.0, blind, 0.0], "{name} by {ttc}: {report}");
            assert!(report["metrics"]["least_contact"].is_null(), "{name} by {ttc}: {report}");
            let log = stdout(&soifra(&["log", &trace]));
            assert!(log.contains(says), "{name} by {ttc}: {log}");
        }
    }
}

/// Scenes that two images alone tell nothing of, and why: name, scene, note.
pub const SCENES: &[(&str, Scene, &str)] = &[
    ("black", |_, _, _| 0, "blind: image all black"),
    ("blank", |_, c, r| 120 + grain(c, r), "no time to contact: no features"),
    (
        "one edge",
        |n, c, r| if c > 180 + n { 60 } else { 160 + grain(c, r) },
        "no time to contact: one edge only",
    ),
    // Nothing moves, but for a little noise in following it.
    (
        "still",
        |_, c, r| if (120..200).contains(&c) { pattern(c, r) } else { 160 + grain(c, r) },
        "no time to contact:",
    ),
    // It goes past: all flows are nearly parallel.
    (
        "aside",
        |n, c, r| {
            if (100 + 2 * n..180 + 2 * n).contains(&c) { pattern(c - 2 * n, r) } else { 160 + grain(c, r) }
        },
        "no time to contact:",
    ),
    // It comes nearer, and nobody knows how fast the camera is.
    (
        "nearer",
        |n, c, r| {
            let half = 40 + 2 * n;
            match c.abs_diff(160) < half {
                true => pattern((c + half - 160) * 80 / (2 * half), r.abs_diff(120) * 40 / half),
                false => 160 + grain(c, r),
            }
        },
        "speed unknown",
    ),
];
