//! What textures are like, near and far.

use soifra_camera::{Filter, Image, NAMES, Pose, Scene, Surface, Texture, TextureError};

use crate::support::{frame, lens, surface};

fn variance(values: impl Iterator<Item = u8> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().map(f64::from).sum::<f64>() / count;
    values.map(|v| (f64::from(v) - mean) * (f64::from(v) - mean)).sum::<f64>() / count
}

/// The green of an image's pixels in a range of rows.
fn green(image: &Image, rows: std::ops::Range<usize>) -> impl Iterator<Item = u8> + Clone {
    image.data[3 * image.width * rows.start..3 * image.width * rows.end].iter().skip(1).step_by(3).copied()
}

const PROCEDURES: usize = 9;

#[test]
fn every_name_is_a_texture_and_no_other() {
    for name in NAMES {
        assert!(Texture::by_name(name).is_some());
    }
    assert!(Texture::by_name("no such").is_none());
}

/// Enough to find edges and corners by, from near and from far.
#[test]
fn procedures_have_contrast_at_every_distance() {
    for name in &NAMES[..PROCEDURES] {
        for (distance, least) in [(0.7, 2.0), (2.0, 4.0), (8.0, 3.0)] {
            let mut scene = Scene::new();
            let wall = surface(&mut scene, name, 2.0);
            scene.fixed.wall([distance, -20.0], [distance, 20.0], -20.0, 40.0, 0.1, wall);
            let image = frame(&scene, &[], &lens(), Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 1);
            // Between pixels eight apart: a gradient that is there within a window of optical flow.
            let rows = 0..480;
            let values: Vec<f64> = green(&image, rows).map(f64::from).collect();
            let steps = values
                .chunks_exact(640)
                .flat_map(|row| row.iter().zip(&row[8..]).map(|(a, b)| (a - b) * (a - b)));
            let count = (480 * 632) as f64;
            let contrast = (steps.sum::<f64>() / count).sqrt();
            assert!(contrast > least, "{name} at {distance} m: {contrast}");
        }
    }
}

#[test]
fn mipmaps_take_the_moire_from_a_distant_floor() {
    let mut scene = Scene::new();
    let checker = surface(&mut scene, "checker", 0.8);
    scene.fixed.ground([-100.0, -100.0], [100.0, 100.0], 0.0, checker);
    let eye = Pose::upright([0.0, 0.0, 0.6], 0.1);
    // From 9 to 30 m away.
    let far = |filter| variance(green(&frame(&scene, &[], &lens(), eye, filter, 1), 250..272));
    let (bilinear, mipmap, trilinear) = (far(Filter::Bilinear), far(Filter::Mipmap), far(Filter::Trilinear));
    assert!(mipmap < 0.25 * bilinear && trilinear < 0.25 * bilinear, "{bilinear} {mipmap} {trilinear}");
    // And near, they leave it sharp.
    let near = |filter| variance(green(&frame(&scene, &[], &lens(), eye, filter, 1), 440..480));
    assert!(near(Filter::Mipmap) > 0.8 * near(Filter::Bilinear));
}

#[test]
fn an_image_is_neither_mirrored_nor_upside_down() {
    // Red upper left, green upper right, blue lower left, white lower right.
    let rgb = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]].concat();
    let mut scene = Scene::new();
    let texture = scene.add_texture(Texture::from_rgb8(2, 2, &rgb).unwrap());
    scene.fixed.quad(
        [[2.0, 1.0, -1.0], [2.0, -1.0, -1.0], [2.0, -1.0, 1.0], [2.0, 1.0, 1.0]],
        Surface { texture, repeat: 2.0 },
    );
    let image = frame(&scene, &[], &lens(), Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 1);
    let corners = [(195, 115), (445, 115), (195, 365), (445, 365)]
        .map(|(x, y)| image.pixel(x, y).map(|p| p.map(|c| c > 128)));
    let (yes, no) = (true, false);
    assert_eq!(corners, [[yes, no, no], [no, yes, no], [no, no, yes], [yes; 3]].map(Some));
}

#[test]
fn bytes_that_are_no_image_are_refused() {
    assert_eq!(Texture::from_rgb8(0, 4, &[]).err(), Some(TextureError::Size));
    assert_eq!(Texture::from_rgb8(1, 20_000, &[]).err(), Some(TextureError::Size));
    assert_eq!(
        Texture::from_rgb8(2, 2, &[0; 11]).err(),
        Some(TextureError::Length { expected: 12, found: 11 })
    );
    assert_eq!(Texture::from_rgb8(5000, 1, &[9; 15_000]).map(|t| t.size()), Ok((4096, 1)));
}

#[test]
fn an_image_keeps_its_proportions() {
    // Black over white, twice as wide as high.
    let rgb = [[0; 3], [0; 3], [0; 3], [0; 3], [255; 3], [255; 3], [255; 3], [255; 3]].concat();
    let mut scene = Scene::new();
    let texture = scene.add_texture(Texture::from_rgb8(4, 2, &rgb).unwrap());
    scene.fixed.quad(
        [[2.0, 1.0, -1.0], [2.0, -1.0, -1.0], [2.0, -1.0, 1.0], [2.0, 1.0, 1.0]],
        Surface { texture, repeat: 2.0 },
    );
    let image = frame(&scene, &[], &lens(), Pose::upright([0.0; 3], 0.0), Filter::Mipmap, 1);
    // From the top of the face down: dark, light, dark, light.
    let quarters = [-0.75, -0.25, 0.25, 0.75].map(|at| (240.0 + at * lens().fy / 2.0) as usize);
    let light = quarters.map(|y| image.pixel(320, y).map(|p| p[0] > 128));
    assert_eq!(light, [false, true, false, true].map(Some));
}
