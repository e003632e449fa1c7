//! Roll, pitch and yaw compensation, the split, the lens, merging, and what is in the way.

use proptest::prelude::*;
use soifra_vision::attitude::{Attitude, Rates};
use soifra_vision::course::{Bearing, Body, Freer, Reach, course, diverging};
use soifra_vision::edge::{Edge, Side, Upright, nearest_pair, seen, side, upright};
use soifra_vision::flow::Track;
use soifra_vision::segment::{Merging, Segment, merge};
use soifra_vision::{Lens, Why};

use crate::gaps::watched;
use crate::scene::Gauss;

fn lens() -> Lens {
    Lens::ideal(640, 480, 60f64.to_radians()).unwrap()
}

fn edge(x: f64) -> Edge {
    let line = Segment::new([x, 100.0], [x, 300.0]);
    Edge { line, sigma: 0.0, strength: 50.0, polarity: 1.0, support: 1.0 }
}

#[test]
fn the_nearest_edge_on_each_side() {
    let edges = [edge(100.0), edge(300.0), edge(330.0), edge(500.0)];
    assert_eq!(nearest_pair(&edges, &lens()), Ok((1, 2)));
    assert_eq!(nearest_pair(&edges[..2], &lens()), Err(Why::OneEdge));
    assert_eq!(nearest_pair(&[], &lens()), Err(Why::NoFeatures));
}

#[test]
fn pieces_of_a_line_become_one() {
    let how = Merging { across: 2.0, gap: 60.0 };
    let pieces = [
        Segment::new([100.0, 50.0], [101.0, 120.0]),
        Segment::new([101.0, 150.0], [102.0, 240.0]),
        Segment::new([140.0, 50.0], [140.0, 240.0]),
    ];
    let merged = merge(&pieces, &how);
    assert_eq!(merged.len(), 2);
    assert_eq!((merged[0].top, merged[0].bottom), ([100.0, 50.0], [102.0, 240.0]));
    let mut turned = pieces;
    turned.reverse();
    assert_eq!(merge(&turned, &how), merged);
}

#[test]
fn the_published_test_of_the_flow() {
    let t = |x, u, v| Track { x, y: 240.0, u, v };
    assert_eq!(diverging(&[t(300.0, -1.0, 0.0)], &[t(340.0, 1.0, 0.0)]), Ok(true));
    assert_eq!(diverging(&[t(300.0, -1.0, 0.5)], &[t(340.0, 1.0, 0.5)]), Ok(true));
    assert_eq!(diverging(&[t(300.0, 1.0, 0.3)], &[t(340.0, -1.0, 0.3)]), Ok(false));
    assert_eq!(diverging(&[t(300.0, 1.0, 0.0)], &[t(340.0, -1.0, 0.0)]), Ok(false));
    assert_eq!(diverging(&[], &[t(340.0, 1.0, 0.0)]), Err(Why::NoFeatures));
    assert_eq!(diverging(&[t(300.0, 0.0, 0.0)], &[t(340.0, 1.0, 0.0)]), Err(Why::NoMotion));
}

/// A single obstacle, both edges on one side included; the freer side is the one with the shorter way round.
#[test]
fn one_obstacle_at_the_shoulder() {
    let body = Body { half_width: 0.25, margin: 0.05 };
    let mut draws = Gauss::new(12);
    for (left, right, hit, freer) in [
        (0.5, -0.5, true, None),
        (1.2, 0.2, true, Some(Freer::Right)),
        (-0.2, -1.2, true, Some(Freer::Left)),
        (1.5, 0.5, false, Some(Freer::Right)),
        (-0.6, -1.0, false, Some(Freer::Left)),
    ] {
        for _ in 0..20 {
            let found = course(&[watched(left, right, 3.0, 0.5, &mut draws).unwrap()], &body).unwrap();
            assert_eq!(found.collision, hit, "{left} {right}");
            assert!(freer.is_none_or(|f| f == found.freer), "{left} {right}");
        }
    }
    let still = Bearing { tangent: 0.1, rate: 0.1 };
    assert_eq!(Reach::predict(&still, &still, 3.0, 0.0), Err(Why::SpeedZero));
    assert_eq!(Reach::predict(&still, &still, -3.0, 1.0), Err(Why::NotApproaching));
    assert_eq!(course(&[], &body), Err(Why::NoObstacle));
}

proptest! {
    /// α + roll = 90° for what is vertical in the world, seen near the optical axis.
    #[test]
    fn roll_is_compensated(roll in -0.6..0.6f64, bearing in -0.05..0.05f64) {
        let attitude = Attitude { roll, ..Attitude::default() };
        let line = seen(&Upright { bearing, tilt: 0.0, upper: 0.2, lower: -0.2 }, &lens(), &attitude).unwrap();
        prop_assert!(line.off_vertical(roll) < 0.01, "{:?}", line);
        prop_assert!(roll.abs() < 0.1 || line.off_vertical(0.0) > 0.08);
    }

    /// Whatever the attitude, an upright edge is found again at its bearing, upright.
    #[test]
    fn attitude_is_undone(
        roll in -0.5..0.5f64, pitch in -0.3..0.3f64, yaw in -3.0..3.0f64, off in -0.4..0.4f64,
    ) {
        let attitude = Attitude { roll, pitch, yaw };
        let edge = Upright { bearing: yaw + off, tilt: 0.0, upper: 0.25, lower: -0.15 };
        let line = seen(&edge, &lens(), &attitude).unwrap();
        let found = upright(&line, &lens(), &attitude).unwrap();
        prop_assert!(libm::sin(found.bearing - edge.bearing).abs() < 1e-9);
        prop_assert!(found.tilt.abs() < 1e-9);
        let (a, b) = (found.upper.max(found.lower), found.upper.min(found.lower));
        prop_assert!((a - 0.25).abs() < 1e-9 && (b + 0.15).abs() < 1e-9);
    }

    /// Left of the optical centre is left, whichever way the segment was given.
    #[test]
    fn left_and_right(x in 0.0..640.0f64, lean in -20.0..20.0f64) {
        let lens = lens();
        let (a, b) = ([x - lean, lens.cy - 100.0], [x + lean, lens.cy + 100.0]);
        let wanted = if x < lens.cx { Side::Left } else { Side::Right };
        prop_assume!((x - lens.cx).abs() > 1e-6);
        prop_assert_eq!(side(&Segment::new(a, b), &lens), wanted);
        prop_assert_eq!(side(&Segment::new(b, a), &lens), wanted);
    }

    /// A distorting lens is undone where its distortion can be.
    #[test]
    fn the_lens_is_undone(x in 0.0..640.0f64, y in 0.0..480.0f64) {
        let lens = Lens { distortion: Some([-0.2, 0.05, 0.001, -0.001]), ..lens() };
        let at = lens.normalise(x, y).unwrap();
        let back = lens.project(at).unwrap();
        prop_assert!((back[0] - x).abs() < 1e-3 && (back[1] - y).abs() < 1e-3);
    }

    /// Turning the camera moves a point as its rates say: there and back is nothing.
    #[test]
    fn turning_there_and_back(x in 100.0..540.0f64, y in 100.0..380.0f64, r in -0.5..0.5f64, p in -0.5..0.5f64, w in -0.5..0.5f64) {
        let rates = Rates { roll: r, pitch: p, yaw: w };
        let there = rates.turned(&lens(), x, y, 0.1).unwrap();
        let back = rates.turned(&lens(), there[0], there[1], -0.1).unwrap();
        prop_assert!((back[0] - x).abs() < 1e-6 && (back[1] - y).abs() < 1e-6);
    }
}

/// A camera that looks down on a tilted body sees what the two rotations together say, and turns as the body does.
#[test]
fn a_tilted_mount_is_a_rotation() {
    let body = Attitude { roll: 0.1, pitch: -0.05, yaw: 0.7 };
    for tilt in [0.0, 0.3, -0.2] {
        let camera = body.looking_down(tilt);
        let (s, c) = libm::sincos(tilt);
        for ray in [[1.0, 0.0, 0.0], [0.9, 0.3, -0.2], [0.5, -0.7, 0.4]] {
            let of_body = [c * ray[0] + s * ray[2], ray[1], c * ray[2] - s * ray[0]];
            for (a, b) in camera.level(ray).iter().zip(body.level(of_body)) {
                assert!((a - b).abs() < 1e-12, "{tilt} {ray:?}");
            }
        }
        let rates = Rates { roll: 0.2, pitch: -0.1, yaw: 0.4 }.looking_down(tilt);
        let size = |r: Rates| r.roll * r.roll + r.pitch * r.pitch + r.yaw * r.yaw;
        assert!((size(rates) - 0.21).abs() < 1e-12);
    }
}
