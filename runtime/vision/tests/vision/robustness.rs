//! Any bytes as images; the same values again; memory that stays flat.

use proptest::prelude::*;
use soifra_vision::contours::{Contours, verticals};
use soifra_vision::follow::Moment;
use soifra_vision::look::{Looking, Memory, look, nearest};
use soifra_vision::overlay::{Stroke, draw};
use soifra_vision::rectify::Rectification;
use soifra_vision::{Gray, ImageView, Lens, Why};

use crate::scene::{Block, Camera, Gauss, Paint, Room};

fn lens(width: usize, height: usize) -> Lens {
    Lens::ideal(width, height, 1.2).unwrap()
}

#[test]
fn wrong_images_are_refused() {
    let data = [7u8; 64 * 48 * 3];
    let why = |w, h, c, n: usize| ImageView::new(w, h, c, &data[..n]).err();
    assert_eq!(why(64, 48, 3, 64 * 48 * 3), None);
    assert_eq!(why(64, 48, 3, 64 * 48 * 3 - 1), Some(Why::WrongSize));
    assert_eq!(why(64, 48, 2, 64 * 48 * 2), Some(Why::WrongChannels));
    assert_eq!(why(0, 48, 1, 0), Some(Why::Empty));
    assert_eq!(why(8, 8, 1, 64), Some(Why::TooSmall));
    assert_eq!(why(usize::MAX, 2, 1, 64), Some(Why::WrongSize));
}

#[test]
fn dark_bright_and_empty_frames() {
    let lens = lens(64, 48);
    let how = Looking::default();
    for (level, wanted) in [(0u8, Err(Why::Black)), (255, Err(Why::White)), (128, Ok(Err(Why::NoFeatures)))] {
        let data = [level; 64 * 48 * 3];
        let view = ImageView::new(64, 48, 3, &data).unwrap();
        let found = look(&view, &Memory::default(), &Moment::straight(0.0), &lens, &how);
        assert_eq!(found.map(|f| f.0.obstacles.map(|_| ())), wanted);
    }
    let data = [128u8; 64 * 48];
    let view = ImageView::new(64, 48, 1, &data).unwrap();
    let memory = look(&view, &Memory::default(), &Moment::straight(0.0), &lens, &how).unwrap().1;
    let again = |time: f64| look(&view, &memory, &Moment::straight(time), &lens, &how).map(|_| ()).err();
    assert_eq!(again(0.0), Some(Why::ZeroInterval));
    assert_eq!(again(-1.0), Some(Why::NegativeInterval));
    assert_eq!(again(f64::NAN), Some(Why::BadNumber));
    assert_eq!(again(1.0), None);
    let bent = Lens { distortion: Some([0.1; 4]), ..lens };
    assert!(matches!(look(&view, &memory, &Moment::straight(0.0), &bent, &how), Err(Why::BadLens)));
    let other = ImageView::new(48, 64, 1, &data).unwrap();
    let later = Moment::straight(1.0);
    assert!(matches!(look(&other, &memory, &later, &lens, &how), Err(Why::WrongSize)));
    assert_eq!(verticals(&Gray::of(&view).unwrap(), 0.0, &Contours::default()), Err(Why::NoFeatures));
}

#[test]
fn rectified_by_nothing_is_the_same() {
    let lens = lens(64, 48);
    let data: Vec<u8> = (0..64 * 48).map(|k| (k * 7 % 251) as u8).collect();
    let gray = Gray::from_bytes(64, 48, data).unwrap();
    let none = Rectification::new(&lens, (64, 48), &lens, 64, 48).unwrap();
    assert_eq!(none.apply(&gray).unwrap(), gray);
}

fn frame(lens: &Lens, width: usize, height: usize, away: f64, seed: u64) -> Vec<u8> {
    let room = Room {
        back: 10.0,
        sides: 4.0,
        wall: Paint::Bricks,
        floor: Paint::Checker(0.5),
        blocks: vec![Block { x: [6.0, 7.0], y: [-0.5, 0.5], height: 2.0, paint: Paint::Clouds(0.4) }],
    };
    let camera = Camera { at: [6.0 - away, 0.0, 0.6], attitude: Default::default() };
    room.frame(&camera, lens, width, height, 2.0, seed)
}

/// The bytes that this process holds, from the system, where it tells.
fn resident() -> Option<usize> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse::<usize>().ok().map(|pages| pages * 4096)
}

#[test]
fn same_values_and_flat_memory() {
    let (width, height) = (160, 120);
    let lens = lens(width, height);
    let how = Looking::default();
    let frames: Vec<Vec<u8>> =
        (0..20).map(|k| frame(&lens, width, height, 4.0 - 0.04 * k as f64, k)).collect();
    let run = |count: usize| {
        let (mut memory, mut early, mut last) = (Memory::default(), None, None);
        for k in 0..count {
            // There and back, so that frames go on without a jump.
            let at = if (k / 20) % 2 == 0 { k % 20 } else { 19 - k % 20 };
            let view = ImageView::new(width, height, 1, &frames[at]).unwrap();
            let moment = Moment::straight(k as f64 * 0.05);
            let (seen, next) = look(&view, &memory, &moment, &lens, &how).unwrap();
            assert!(next.edges.len() <= how.edges.most);
            assert!(next.edges.iter().all(|e| e.sights.len() <= how.edges.samples));
            assert!(next.points.iter().all(|p| p.sights.len() <= 42));
            memory = next;
            last = Some(seen);
            if k == 500 {
                early = resident();
            }
        }
        (memory, last, early)
    };
    assert_eq!(run(60).0, run(60).0);
    let (_, _, early) = run(3000);
    if let (Some(early), Some(late)) = (early, resident()) {
        assert!(late < early + (4 << 20), "{early} bytes, then {late}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Noise, stripes, anything: no panic, no NaN.
    #[test]
    fn arbitrary_bytes(
        width in 16usize..80, height in 16usize..60, rgb in any::<bool>(), seed in any::<u64>(), period in 1usize..24,
        roll in prop::num::f64::ANY,
    ) {
        let channels = if rgb { 3 } else { 1 };
        let mut draws = Gauss::new(seed);
        let mut make = || -> Vec<u8> {
            (0..width * height * channels)
                .map(|k| {
                    let stripe = if (k / channels % width / period) % 2 == 0 { 40.0 } else { 180.0 };
                    (stripe + 60.0 * draws.uniform()) as u8
                })
                .collect()
        };
        let lens = lens(width, height);
        let how = Looking::default();
        let mut memory = Memory::default();
        for k in 0..10 {
            let data = make();
            let view = ImageView::new(width, height, channels, &data).unwrap();
            let moment = Moment::straight(f64::from(k) * 0.05);
            let (seen, next) = look(&view, &memory, &moment, &lens, &how).unwrap();
            for e in &seen.edges {
                prop_assert!(e.sigma.is_finite() && e.strength.is_finite() && e.x(&lens).is_finite());
            }
            for o in seen.obstacles.iter().flatten() {
                prop_assert!(o.contact.ttc.is_finite() && o.width.is_finite());
            }
            prop_assert!(seen.flows.iter().all(|f| f.track.u.is_finite() && f.quality.is_finite()));
            memory = next;
        }
        let (a, b) = (make(), make());
        let gray = |d: &[u8]| Gray::of(&ImageView::new(width, height, channels, d).unwrap()).unwrap();
        let found = nearest(&gray(&a), &gray(&b), roll, &lens, &how.contours, &how.points);
        prop_assert!(found.is_err() || found.is_ok_and(|f| f.width.is_finite()));
    }

    /// Strokes to anywhere.
    #[test]
    fn strokes(a in prop::num::f64::ANY, b in prop::num::f64::ANY, thickness in any::<u8>()) {
        let mut pixels = vec![0u8; 20 * 10 * 3];
        let stroke = Stroke { from: [a, 3.0], to: [b, a], colour: [9, 9, 9], thickness };
        prop_assert!(draw(&mut pixels, 20, 10, &[stroke]).is_ok());
        prop_assert_eq!(draw(&mut pixels, 20, 11, &[stroke]), Err(Why::WrongSize));
    }
}
