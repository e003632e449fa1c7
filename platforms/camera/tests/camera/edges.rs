//! Where edges are seen, measured on the rendered image as a vision algorithm would: the place along a row at which
//! the colour has gone half the way, from the sum of the row.

use proptest::prelude::*;
use soifra_camera::{Filter, Image, Pose, Scene, Sky, Surface, Texture};

use crate::support::{frame, lens, pose};

/// A white box before black, 2 m wide and high and 1 m deep, its face 4 m before the origin and its middle at
/// `aside` to the left and `up`.
fn boxed(aside: f64, up: f64) -> Scene {
    let mut scene = Scene::new();
    scene.sky = Sky::plain([0; 3]);
    let white = Surface { texture: scene.add_texture(Texture::plain([255; 3])), repeat: 1.0 };
    scene.fixed.cuboid([4.5, aside, up], [1.0, 2.0, 2.0], 0.0, white);
    scene
}

/// White's share of the pixels of a row between two columns, and of a column between two rows.
fn white(image: &Image, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> f64 {
    let pixels = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
    pixels.filter_map(|(x, y)| image.pixel(x, y)).map(|[r, ..]| f64::from(r) / 255.0).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// The face's left, right, upper and lower edge.
    #[test]
    fn a_face_has_its_edges_where_geometry_says(aside in -0.45..0.45_f64, up in -0.25..0.25_f64) {
        let image = frame(&boxed(aside, up), &[], &lens(), Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 1);
        let left = 320.0 - 500.0 * (aside + 1.0) / 4.0;
        let right = 320.0 - 500.0 * (aside - 1.0) / 4.0;
        let top = 240.0 - 500.0 * (up + 1.0) / 4.0;
        let bottom = 240.0 - 500.0 * (up - 1.0) / 4.0;
        prop_assert!((320.0 - white(&image, 0..320, 240..241) - left).abs() < 0.05);
        prop_assert!((320.0 + white(&image, 320..640, 240..241) - right).abs() < 0.05);
        prop_assert!((240.0 - white(&image, 320..321, 0..240) - top).abs() < 0.05);
        prop_assert!((240.0 + white(&image, 320..321, 240..480) - bottom).abs() < 0.05);
    }

    /// With the camera rolled, the left edge crosses each row at its place.
    #[test]
    fn a_slanted_edge_is_at_its_place_in_every_row(roll in -0.4..0.4_f64, aside in -0.3..0.3_f64) {
        let image = frame(&boxed(aside, 0.0), &[], &lens(), pose([0.0; 3], roll, 0.0, 0.0), Filter::Mipmap, 1);
        let (sin, cos) = (libm::sin(roll), libm::cos(roll));
        // The edge in the upright camera's coordinates, in focal lengths to the right and down.
        let edge = -(aside + 1.0) / 4.0;
        for y in 210..270 {
            let down = (f64::from(y) + 0.5 - 240.0) / 500.0;
            // Rolled to the right, the camera sees the world turned to the left: (x, y) = (cos X + sin Y, cos Y - sin X).
            let x = (edge + sin * down) / cos;
            let place = 320.0 + 500.0 * x;
            let y = y as usize;
            let measured = 320.0 - white(&image, 0..320, y..y + 1);
            prop_assert!((measured - place).abs() < 0.06, "row {y}: {measured} instead of {place}");
        }
    }

    /// Beside the face, the box shows a side so narrow that few pixels' centres see it, or none: the silhouette is
    /// that side's far edge all the same.
    #[test]
    fn a_narrow_side_belongs_to_the_silhouette(aside in 1.0..1.05_f64, yaw in -0.05..0.2_f64) {
        let eye = Pose::upright([0.0; 3], yaw);
        let image = frame(&boxed(aside, 0.0), &[], &lens(), eye, Filter::Mipmap, 1);
        // The right edge of the front and of the back; the farther right of them is the silhouette.
        let seen = |x: f64| {
            let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
            let y = aside - 1.0;
            320.0 - 500.0 * (cos * y - sin * x) / (cos * x + sin * y)
        };
        let right = seen(4.0).max(seen(5.0));
        let measured = white(&image, 0..640, 240..241);
        let left = 320.0 - 500.0 * {
            let (sin, cos) = (libm::sin(yaw), libm::cos(yaw));
            (cos * (aside + 1.0) - sin * 4.0) / (cos * 4.0 + sin * (aside + 1.0))
        };
        prop_assert!((measured - (right - left)).abs() < 0.05, "{measured} {}", right - left);
    }

    /// Two faces that share a silhouette or hide each other leave no crack and no seam.
    #[test]
    fn a_closed_box_around_the_camera_has_no_cracks(
        roll in -3.0..3.0_f64, pitch in -1.5..1.5_f64, yaw in -3.0..3.0_f64,
        x in -0.9..0.9_f64, y in -0.9..0.9_f64, z in -0.9..0.9_f64,
    ) {
        let mut scene = Scene::new();
        scene.sky = Sky::plain([255, 0, 255]);
        let grey = Surface { texture: scene.add_texture(Texture::plain([90; 3])), repeat: 1.0 };
        scene.fixed.room([-1.0, -1.0], [1.0, 1.0], 2.0, [grey; 4], grey, Some(grey));
        let image = frame(&scene, &[], &lens(), pose([x, y, z + 1.0], roll, pitch, yaw), Filter::Mipmap, 1);
        prop_assert!(image.data.iter().all(|byte| *byte == 90));
    }
}

#[test]
fn a_pattern_is_where_geometry_says() {
    // The checker's squares are 0.5 m on a wall 3 m ahead: the border between the two in the middle is at x = 320.
    let mut scene = Scene::new();
    let texture = scene.add_texture(Texture::by_name("checker").unwrap());
    let surface = Surface { texture, repeat: 4.0 };
    scene.fixed.quad([[3.0, 4.0, -4.0], [3.0, -4.0, -4.0], [3.0, -4.0, 4.0], [3.0, 4.0, 4.0]], surface);
    let image = frame(&scene, &[], &lens(), Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 1);
    let row: Vec<u8> = (0..640).filter_map(|x| image.pixel(x, 220)).map(|[r, ..]| r).collect();
    let borders: Vec<f64> = (1..640)
        .filter(|x| (row[x - 1] < 130) != (row[*x] < 130))
        .map(|x| {
            let (a, b) = (f64::from(row[x - 1]), f64::from(row[x]));
            x as f64 - 0.5 + (130.0 - a) / (b - a)
        })
        .collect();
    // 500 / 3 / 2 pixels apart.
    let expected: Vec<f64> = (-3..=3).map(|i| 320.0 + f64::from(i) * 250.0 / 3.0).collect();
    assert_eq!(borders.len(), expected.len());
    for (found, expected) in borders.iter().zip(&expected) {
        assert!((found - expected).abs() < 0.5, "{found} instead of {expected}");
    }
}
