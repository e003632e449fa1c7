//! Is it in the way? The clearance-aware test on analytic edges: two things with a gap between them, approached straight on, over
//! gaps, lateral offsets and distances. What is true follows from where the edges are.

use std::collections::BTreeMap;

use soifra_vision::Why;
use soifra_vision::course::{Bearing, Body, Reach, course};
use soifra_vision::expansion::{Width, Window, window};
use soifra_vision::sweep::Tangent;

use crate::scene::Gauss;

/// What the services would know of a thing between two lateral offsets, from noisy bearings of an approach.
pub fn watched(left: f64, right: f64, z: f64, speed: f64, draws: &mut Gauss) -> Result<Reach, Why> {
    let noise = 0.1 / 554.0;
    let mut history = [Vec::new(), Vec::new()];
    let drift = 0.001 * draws.next();
    for k in -30..=0 {
        let t = f64::from(k) * 0.05;
        for (h, y) in history.iter_mut().zip([left, right]) {
            let tangent = y / (z - speed * t) + drift * t + noise * draws.next();
            h.push(Tangent { time: t, aside: 0.0, tangent });
        }
    }
    let widths: Vec<Width> = history[0]
        .iter()
        .zip(&history[1])
        .map(|(a, b)| Width { time: a.time, width: a.tangent - b.tangent })
        .collect();
    let ttc = window(&widths, &Window::default())?.ttc;
    Reach::predict(&Bearing::fit(&history[0], 1.0 / ttc)?, &Bearing::fit(&history[1], 1.0 / ttc)?, ttc, speed)
}

/// So near to the limit nothing is counted, metres: what a direction known to half a degree leaves open at 3 m.
const BORDERLINE: f64 = 0.03;

/// By band of gaps (so many body widths), band of offsets (half a half width each), and whether the body meets nothing: how
/// many were right, and how many asked; and how many were borderline.
type Table = (BTreeMap<(u32, u32, bool), [usize; 2]>, usize);

fn table(body: &Body, draws: &mut Gauss) -> Table {
    let (mut classes, mut borderline) = (BTreeMap::new(), 0);
    for (i, j, k) in (0..70).flat_map(|i| (0..40).flat_map(move |j| (0..8).map(move |k| (i, j, k)))) {
        let gap = 0.5 + 0.05 * f64::from(i) + 0.05 * draws.uniform();
        let offset = 0.05 * f64::from(j) + 0.05 * draws.uniform();
        let distance = 2.0 + 0.25 * f64::from(k);
        let middle = offset * body.half_width * if (i + j + k) % 2 == 0 { 1.0 } else { -1.0 };
        let half = gap * body.half_width;
        let (left, right) = (middle + half, middle - half);
        let room = left.min(-right) - body.half_width - body.margin;
        if room.abs() < BORDERLINE {
            borderline += 1;
            continue;
        }
        let speed = 0.3 + 0.5 * draws.uniform();
        let seen: Vec<Reach> = [(left + 1.0, left), (right, right - 1.0)]
            .iter()
            .filter_map(|(l, r)| watched(*l, *r, distance, speed, draws).ok())
            .collect();
        let class = classes.entry((gap as u32, (2.0 * offset) as u32, room > 0.0)).or_insert([0; 2]);
        class[0] += usize::from(course(&seen, body).is_ok_and(|c| c.collision == (room < 0.0)));
        class[1] += 1;
    }
    (classes, borderline)
}

/// Gaps of 0.5 to 4 body widths, lateral offsets of 0 to 2 half widths, 2 m to 4 m away: right in at least 95 % of each class.
#[test]
fn gaps_and_offsets() {
    let body = Body { half_width: 0.25, margin: 0.05 };
    let (classes, borderline) = table(&body, &mut Gauss::new(11));
    for ((gap, offset, free), [right, asked]) in &classes {
        println!("gap {gap} offset {} free {free}: {right} of {asked}", 0.5 * f64::from(*offset));
    }
    println!("borderline: {borderline}");
    // A class is what is true with a band of gaps, and what is true with a band of offsets.
    let mut bands: BTreeMap<(&str, u32, bool), [usize; 2]> = BTreeMap::new();
    for ((gap, offset, free), [right, asked]) in &classes {
        for class in [("gap", *gap, *free), ("offset", *offset, *free)] {
            let band = bands.entry(class).or_default();
            band[0] += right;
            band[1] += asked;
        }
    }
    assert_eq!(bands.len(), 4 + 3 + 4 + 4, "{bands:?}");
    for (class, [right, asked]) in &bands {
        println!("{class:?}: {right} of {asked}");
        assert!(100 * right >= 95 * asked, "{class:?}: {right} of {asked}");
    }
    assert!(borderline < 70 * 40 * 8 / 10, "{borderline}");
}
