//! Projection and its inverse, with and without distortion.

use proptest::prelude::*;
use soifra_camera::{Filter, Lens, LensError, Pose, Scene, Sky, Surface, Texture};

use crate::support::frame;

fn wide() -> Lens {
    let distortion = Some([-0.035, 0.0006, 0.001, -0.0005]);
    Lens::from_distorted_field_of_view(752, 480, 131.0_f64.to_radians(), distortion).unwrap()
}

proptest! {
    #[test]
    fn what_a_pixel_looks_at_is_seen_there(x in 0.0..752.0_f64, y in 0.0..480.0_f64, far in 0.01..100.0_f64) {
        for lens in [wide(), Lens { distortion: None, ..wide() }] {
            let direction = lens.unproject([x, y]).unwrap();
            prop_assert!((direction.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-12);
            let seen = lens.project(direction.map(|c| c * far)).unwrap();
            prop_assert!((seen[0] - x).abs() < 1e-6 && (seen[1] - y).abs() < 1e-6);
        }
    }

    #[test]
    fn nothing_is_not_a_number(
        point in prop::array::uniform3(prop::num::f64::ANY),
        pixel in prop::array::uniform2(prop::num::f64::ANY),
        k in prop::array::uniform4(-10.0..10.0_f64),
    ) {
        let lens = Lens { distortion: Some(k), ..wide() };
        for seen in [lens.project(point), wide().project(point)].into_iter().flatten() {
            prop_assert!(seen.iter().all(|c| c.is_finite()));
        }
        for direction in [lens.unproject(pixel), wide().unproject(pixel)].into_iter().flatten() {
            prop_assert!(direction.iter().all(|c| c.is_finite()));
        }
    }
}

#[test]
fn the_distortion_is_opencvs() {
    let lens = Lens {
        width: 640,
        height: 480,
        fx: 400.0,
        fy: 410.0,
        cx: 330.0,
        cy: 235.0,
        distortion: Some([-0.3, 0.1, 0.002, -0.001]),
    };
    // x = 0.2, y = -0.1, r² = 0.05: radial 0.98525, tangential (2 p1 x y + p2 (r² + 2 x²), …).
    let x = 0.2 * 0.98525 + 2.0 * 0.002 * 0.2 * -0.1 - 0.001 * (0.05 + 0.08);
    let y = -0.1 * 0.98525 + 0.002 * (0.05 + 0.02) + 2.0 * -0.001 * 0.2 * -0.1;
    let seen = lens.project([5.0, -1.0, 0.5]).unwrap();
    assert!((seen[0] - (400.0 * x + 330.0)).abs() < 1e-9 && (seen[1] - (410.0 * y + 235.0)).abs() < 1e-9);
}

#[test]
fn the_field_of_view_is_what_was_asked_for() {
    let straight = Lens::from_field_of_view(752, 480, 131.0_f64.to_radians()).unwrap();
    let bent = Lens { distortion: Some([-0.035, 0.0006, 0.0, 0.0]), ..wide() };
    for lens in [straight, bent] {
        let [forward, left, _] = lens.unproject([0.0, 240.0]).unwrap();
        assert!((libm::atan2(left, forward).to_degrees() - 65.5).abs() < 1e-6);
    }
}

#[test]
fn lenses_that_cannot_be_are_refused() {
    assert_eq!(Lens::from_field_of_view(0, 480, 1.0), Err(LensError::Size));
    assert_eq!(Lens::from_field_of_view(640, 100_000, 1.0), Err(LensError::Size));
    for view in [0.0, -1.0, 4.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Lens::from_field_of_view(640, 480, view), Err(LensError::FieldOfView));
    }
    let folding = Lens::from_distorted_field_of_view(640, 480, 2.2, Some([-0.3, 0.0, 0.0, 0.0]));
    assert_eq!(folding, Err(LensError::FieldOfView));
    let wrong = Lens::from_distorted_field_of_view(640, 480, 1.0, Some([f64::NAN, 0.0, 0.0, 0.0]));
    assert_eq!(wrong, Err(LensError::Parameters));
    let image = frame(
        &Scene::new(),
        &[],
        &Lens { fx: 0.0, ..wide() },
        Pose::upright([0.0; 3], 0.0),
        Filter::Mipmap,
        1,
    );
    assert!(image.data.is_empty());
}

/// A small white board is seen through the wide lens where [`Lens::project`] says.
#[test]
fn distorted_frames_show_points_where_projection_says() {
    let lens = wide();
    for (left, up) in [(0.0, 0.0), (1.5, 0.6), (-2.5, -0.5), (3.0, 1.2), (-1.0, 1.8)] {
        let mut scene = Scene::new();
        scene.sky = Sky::plain([0; 3]);
        let white = Surface { texture: scene.add_texture(Texture::plain([255; 3])), repeat: 1.0 };
        let half = 0.05;
        let corner = |y: f64, z: f64| [2.0, left + y * half, up + z * half];
        scene.fixed.quad([corner(1.0, -1.0), corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)], white);
        let image = frame(&scene, &[], &lens, Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 2);
        let (mut sum, mut x_sum, mut y_sum) = (0.0, 0.0, 0.0);
        for y in 0..image.height {
            for x in 0..image.width {
                let weight = image.pixel(x, y).map_or(0.0, |[r, ..]| f64::from(r));
                sum += weight;
                x_sum += weight * (x as f64 + 0.5);
                y_sum += weight * (y as f64 + 0.5);
            }
        }
        let expected = lens.project([2.0, left, up]).unwrap();
        let (x, y) = (x_sum / sum, y_sum / sum);
        // The middle of a small board is not quite the projected middle: hence a tenth of a pixel.
        assert!((x - expected[0]).abs() < 0.1 && (y - expected[1]).abs() < 0.1, "{x} {y} {expected:?}");
    }
}
