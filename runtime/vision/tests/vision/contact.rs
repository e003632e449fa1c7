//! Time to contact on exact geometry: within 1 % without turning, within 5 % with it.

use proptest::prelude::*;
use soifra_vision::attitude::{Attitude, Rates};
use soifra_vision::expansion::{self, Width, Window};
use soifra_vision::flow::{self, Track};
use soifra_vision::follow::Moment;
use soifra_vision::robust::{self, Part, PointTrack, Robust, Sight, sight_ray};
use soifra_vision::{Lens, Why};

use crate::scene::Gauss;

fn lens() -> Lens {
    Lens::ideal(640, 480, 60f64.to_radians()).unwrap()
}

/// Points of a face at distance `z` in the body frame of a camera with `attitude`, as pixels.
fn project(points: &[[f64; 2]], z: f64, attitude: &Attitude) -> Vec<[f64; 2]> {
    points.iter().map(|p| lens().pixel(attitude.body([z, p[0], p[1]])).unwrap()).collect()
}

fn face(seed: u64) -> Vec<[f64; 2]> {
    let mut draws = Gauss::new(seed);
    (0..40).map(|_| [draws.uniform() - 0.4, 1.2 * draws.uniform() - 0.5]).collect()
}

fn tracks(before: &[[f64; 2]], now: &[[f64; 2]]) -> Vec<Track> {
    before.iter().zip(now).map(|(a, b)| Track { x: b[0], y: b[1], u: b[0] - a[0], v: b[1] - a[1] }).collect()
}

fn near(found: f64, truth: f64, share: f64) {
    assert!((found / truth - 1.0).abs() <= share, "{found} for {truth}");
}

#[test]
fn published_flow_on_exact_points() {
    let points = face(1);
    let level = Attitude::default();
    let (speed, dt, z) = (0.5, 0.05, 4.0);
    let found =
        flow::published(&tracks(&project(&points, z + speed * dt, &level), &project(&points, z, &level)), dt)
            .unwrap();
    near(found.ttc, z / speed, 0.01);
    assert!((found.focus[0] - lens().cx).abs() < 0.01 && (found.focus[1] - lens().cy).abs() < 0.01);
}

#[test]
fn expansion_on_exact_widths() {
    let (speed, z) = (0.5, 3.0);
    let history: Vec<Width> = (-30..=0)
        .map(|k| f64::from(k) * 0.05)
        .map(|t| Width { time: t, width: 80.0 / (z - speed * t) })
        .collect();
    let pair = expansion::published(history[29], history[30]).unwrap();
    near(pair.ttc, z / speed, 0.01);
    near(expansion::window(&history, &Window::default()).unwrap().ttc, z / speed, 1e-6);
    // Metres instead of seconds: a distance. One wild width does no harm.
    let mut metres: Vec<Width> = history.iter().map(|w| Width { time: w.time * speed, ..*w }).collect();
    metres[12].width *= 1.3;
    near(expansion::window(&metres, &Window::default()).unwrap().ttc, z, 0.01);
}

const SPEED: f64 = 0.5;

/// A history of points seen from a camera that moves ahead and turns evenly; the gyro's yaw drifts.
fn turning(rates: Rates, drift: f64, noise: f64) -> (Vec<PointTrack>, f64) {
    let points = face(2);
    let mut draws = Gauss::new(5);
    let (speed, z, dt) = (SPEED, 3.0, 0.05);
    let mut found: Vec<PointTrack> = points
        .iter()
        .map(|_| PointTrack {
            part: Part::Interior,
            pixel: [0.0; 2],
            way: [0.0; 2],
            quality: 1.0,
            sights: vec![],
        })
        .collect();
    for k in -20..=0 {
        let t = f64::from(k) * dt;
        let attitude = Attitude { roll: rates.roll * t, pitch: rates.pitch * t, yaw: rates.yaw * t };
        let believed = Attitude { yaw: attitude.yaw + drift * t, ..attitude };
        for (track, pixel) in found.iter_mut().zip(project(&points, z - speed * t, &attitude)) {
            track.pixel = [pixel[0] + noise * draws.next(), pixel[1] + noise * draws.next()];
            let ray = sight_ray(&lens(), &believed, track.pixel).unwrap();
            track.sights.push(Sight { time: t, ray, place: [speed * t, 0.0] });
        }
    }
    (found, z / speed)
}

/// At the end of [`turning`].
fn now(rates: Rates) -> Moment {
    Moment { pace: SPEED, ..Moment::steady(0.0, Attitude::default(), rates, 0.0) }
}

#[test]
fn robust_flow_with_and_without_turning() {
    let how = Robust::default();
    let still = Rates::default();
    let (points, truth) = turning(still, 0.0, 0.0);
    near(robust::history(&points, &now(still), &how).unwrap().ttc, truth, 1e-4);
    let rate = 30f64.to_radians();
    for rates in [
        Rates { yaw: 0.3, ..still },
        Rates { pitch: -0.2, ..still },
        Rates { roll: rate, ..still },
        Rates { roll: 0.2, pitch: 0.1, yaw: -0.25 },
    ] {
        // A second of 30°/s about z would carry the face out of the picture: the body turns there for less.
        let (points, truth) = turning(rates, 0.01, 0.1);
        near(robust::history(&points, &now(rates), &how).unwrap().ttc, truth, 0.05);
    }
    // Two frames, at the full 30°/s about each axis.
    for rates in
        [Rates { yaw: rate, ..still }, Rates { pitch: rate, ..still }, Rates { roll: -rate, ..still }]
    {
        let (dt, speed, z) = (0.05, 0.5, 3.0);
        // The camera was turned back by the whole step before: the later frame is level.
        let before = project(
            &face(3),
            z + speed * dt,
            &Attitude { roll: -rates.roll * dt, pitch: -rates.pitch * dt, yaw: -rates.yaw * dt },
        );
        let now = project(&face(3), z, &Attitude::default());
        let found = robust::pair(&tracks(&before, &now), &lens(), &rates, dt, &how).unwrap();
        near(found.ttc, z / speed, 0.05);
    }
    let fast = Rates { yaw: 1.0, ..still };
    assert_eq!(robust::history(&points, &now(fast), &how), Err(Why::Rotating));
}

#[test]
fn a_fifth_of_wild_points_does_no_harm() {
    let (mut points, truth) = turning(Rates::default(), 0.0, 0.1);
    for p in points.iter_mut().take(8) {
        p.sights[0].ray[1] += 0.05;
        p.sights[0].ray[2] -= 0.08;
    }
    near(robust::history(&points, &now(Rates::default()), &Robust::default()).unwrap().ttc, truth, 0.02);
}

#[test]
fn refusals_are_typed() {
    let w = |time, width| Width { time, width };
    assert_eq!(expansion::published(w(0.0, 10.0), w(0.0, 11.0)), Err(Why::ZeroInterval));
    assert_eq!(expansion::published(w(1.0, 10.0), w(0.0, 11.0)), Err(Why::NegativeInterval));
    assert_eq!(expansion::published(w(0.0, 10.0), w(1.0, 10.0)), Err(Why::NoMotion));
    assert_eq!(expansion::published(w(0.0, 11.0), w(1.0, 10.0)), Err(Why::NotApproaching));
    assert_eq!(expansion::published(w(0.0, 0.0), w(1.0, 10.0)), Err(Why::Degenerate));
    assert_eq!(expansion::published(w(f64::NAN, 1.0), w(1.0, 10.0)), Err(Why::BadNumber));
    assert_eq!(expansion::window(&[], &Window::default()), Err(Why::TooShort));
    let t = |u, v| Track { x: 1.0, y: 2.0, u, v };
    assert_eq!(flow::focus(&[]), Err(Why::NoFeatures));
    assert_eq!(flow::focus(&[t(0.0, 0.0), t(0.0, 0.0)]), Err(Why::NoMotion));
    assert_eq!(flow::focus(&[t(1.0, 0.0), t(2.0, 0.0)]), Err(Why::Degenerate));
    assert_eq!(flow::published(&[t(1.0, 0.0), t(0.0, 2.0)], 0.0), Err(Why::ZeroInterval));
    let none = robust::history(&[], &now(Rates::default()), &Robust::default());
    assert_eq!(none, Err(Why::NoFeatures));
}

proptest! {
    /// The focus comes out wherever it is.
    #[test]
    fn focus_is_found(fx in -200.0..900.0f64, fy in -200.0..700.0f64, rate in 0.002..0.2f64, seed in 0u64..1000) {
        let mut draws = Gauss::new(seed);
        let tracks: Vec<Track> = (0..12)
            .map(|_| {
                let (x, y) = (640.0 * draws.uniform(), 480.0 * draws.uniform());
                let k = rate * (0.5 + draws.uniform());
                Track { x, y, u: k * (x - fx), v: k * (y - fy) }
            })
            .collect();
        let found = flow::focus(&tracks).unwrap();
        prop_assert!((found[0] - fx).abs() < 1e-3 && (found[1] - fy).abs() < 1e-3);
    }

    /// Any numbers give a number or a reason.
    #[test]
    fn no_nan(values in prop::collection::vec(prop::num::f64::ANY, 0..40), dt in prop::num::f64::ANY) {
        let tracks: Vec<Track> =
            values.chunks_exact(4).map(|c| Track { x: c[0], y: c[1], u: c[2], v: c[3] }).collect();
        if let Ok(found) = flow::published(&tracks, dt) {
            prop_assert!(found.ttc.is_finite() && found.focus[0].is_finite());
        }
        let rates = Rates { roll: dt, pitch: 0.0, yaw: dt };
        if let Ok(found) = robust::pair(&tracks, &lens(), &rates, 0.05, &Robust::default()) {
            prop_assert!(found.ttc.is_finite() && found.focus[1].is_finite());
        }
        let widths: Vec<Width> = values.chunks_exact(2).map(|c| Width { time: c[0], width: c[1] }).collect();
        if let Ok(found) = expansion::window(&widths, &Window::default()) {
            prop_assert!(found.ttc.is_finite() && found.sigma.is_finite());
        }
        if let [a, b, ..] = widths[..] && let Ok(found) = expansion::published(a, b) {
            prop_assert!(found.ttc.is_finite());
        }
    }
}
