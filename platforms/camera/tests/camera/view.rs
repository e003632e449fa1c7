//! Which way up the world is, and how light and motion show.

use soifra_camera::{
    Clothes, Exposure, Figure, Filter, Image, Light, Pose, Scene, Scratch, Sky, Surface, Texture, View,
    render, render_blurred,
};

use crate::support::{FULL, frame, lens, pose};

/// A red post to the left of the way ahead and a green one to the right, on blue ground.
fn posts() -> Scene {
    let mut scene = Scene::new();
    scene.sky = Sky::plain([255; 3]);
    let mut plain = |colour| Surface { texture: scene.add_texture(Texture::plain(colour)), repeat: 1.0 };
    let (red, green, blue) = (plain([255, 0, 0]), plain([0, 255, 0]), plain([0, 0, 255]));
    scene.fixed.cuboid([4.0, 1.0, 0.5], [0.4, 0.4, 1.0], 0.0, red);
    scene.fixed.cuboid([4.0, -1.0, 0.5], [0.4, 0.4, 1.0], 0.0, green);
    scene.fixed.ground([-50.0, -50.0], [50.0, 50.0], 0.0, blue);
    scene
}

/// Where the middle of a colour is.
fn middle(image: &Image, colour: [u8; 3]) -> Option<[f64; 2]> {
    let places: Vec<_> = (0..image.height)
        .flat_map(|y| (0..image.width).map(move |x| (x, y)))
        .filter(|(x, y)| image.pixel(*x, *y) == Some(colour))
        .collect();
    let count = places.len() as f64;
    let mean =
        |of: fn(&(usize, usize)) -> usize| places.iter().map(|p| of(p) as f64 + 0.5).sum::<f64>() / count;
    (!places.is_empty()).then(|| [mean(|p| p.0), mean(|p| p.1)])
}

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];

#[test]
fn left_is_left_and_down_is_down() {
    let image = frame(&posts(), &[], &lens(), Pose::upright([0.0, 0.0, 0.5], 0.0), Filter::Mipmap, 1);
    let [red, green, blue] = [RED, GREEN, BLUE].map(|c| middle(&image, c).unwrap());
    // The faces are 3.8 m away; each post shows its inner side too.
    assert!((red[0] - (320.0 - 500.0 / 3.8)).abs() < 10.0 && (green[0] - (320.0 + 500.0 / 3.8)).abs() < 10.0);
    assert!((red[1] - 240.0).abs() < 2.0 && blue[1] > 300.0);
    assert_eq!(image.pixel(320, 10), Some([255; 3]));
}

#[test]
fn turns_of_the_camera_move_the_image_as_they_should() {
    let red = |roll, pitch, yaw| {
        middle(
            &frame(&posts(), &[], &lens(), pose([0.0, 0.0, 0.5], roll, pitch, yaw), Filter::Mipmap, 1),
            RED,
        )
        .unwrap()
    };
    let straight = red(0.0, 0.0, 0.0);
    // To the left: what is ahead goes right. Nose down: it goes up.
    assert!(red(0.0, 0.0, 0.1)[0] > straight[0] + 40.0);
    assert!(red(0.0, 0.1, 0.0)[1] < straight[1] - 40.0);
    // Right side down: what is left of the middle goes down.
    let rolled = red(0.3, 0.0, 0.0);
    assert!(rolled[1] > straight[1] + 30.0);
    let turn = libm::atan2(rolled[1] - 240.0, 320.0 - rolled[0]);
    assert!((turn - 0.3).abs() < 0.01, "{turn}");
}

#[test]
fn exposure_saturates_and_the_sun_makes_sides_differ() {
    let scene = posts();
    let lens = lens();
    let shot = |light: &Light| {
        let mut image = Image::default();
        let view =
            View { lens: &lens, pose: Pose::upright([0.0, 0.0, 0.5], 0.0), light, filter: Filter::Mipmap };
        render(&scene, &[], &view, 1, &mut image, &mut Scratch::new());
        image
    };
    assert!(shot(&Light { gain: 1e6, ..FULL }).pixel(320, 400) == Some(BLUE));
    assert_eq!(shot(&Light { gain: 0.5, ..FULL }).pixel(320, 10), Some([128; 3]));
    assert!(shot(&Light { gain: 0.0, ..FULL }).data.iter().all(|byte| *byte == 0));
    // The post's front and its inner side, which faces right.
    let lit = shot(&Light { ambient: 0.2, sun: [-1.0, 0.0, 0.0], strength: 0.8, gain: 1.0 });
    let front = lit.pixel(185, 240).unwrap()[0];
    let side = lit.pixel(216, 240).unwrap()[0];
    assert_eq!((front, side), (255, 153));
}

#[test]
fn motion_blurs_along_its_way() {
    let scene = posts();
    let lens = lens();
    let (mut image, mut scratch) = (Image::default(), Scratch::new());
    let view =
        View { lens: &lens, pose: Pose::upright([0.0, 0.0, 0.5], 0.0), light: &FULL, filter: Filter::Mipmap };
    render(&scene, &[], &view, 1, &mut image, &mut scratch);
    let sharp = image.clone();
    let exposure = Exposure { pose: view.pose, parts: &[], instants: 5 };
    render_blurred(&scene, &[], &view, &exposure, 1, &mut image, &mut scratch);
    assert!(image == sharp);
    // Turning by ten pixels smears the post's edge over about as many.
    let exposure = Exposure { pose: Pose::upright([0.0, 0.0, 0.5], 0.02), parts: &[], instants: 21 };
    render_blurred(&scene, &[], &view, &exposure, 1, &mut image, &mut scratch);
    let between = |image: &Image| {
        (0..320).filter(|x| image.pixel(*x, 230).is_some_and(|[_, g, _]| g > 5 && g < 250)).count()
    };
    assert!(between(&sharp) <= 2);
    assert!((16..=24).contains(&between(&image)), "{}", between(&image));
}

#[test]
fn a_figure_stands_upright_and_its_legs_swing() {
    let mut scene = Scene::new();
    scene.sky = Sky::plain([0; 3]);
    let figure = Figure::new(&mut scene, 1.75, &Clothes::default());
    let lens = lens();
    let rows = |phase: f64, heading: f64| {
        let mut parts = Vec::new();
        figure.place([4.0, 0.0, 0.0], heading, phase, &mut parts);
        let image = frame(&scene, &parts, &lens, Pose::upright([0.0, 0.0, 1.0], 0.0), Filter::Mipmap, 1);
        let lit = |y: usize| {
            (0..640).filter(|x| image.pixel(*x, y).is_some_and(|p| p != [0; 3])).collect::<Vec<_>>()
        };
        (0..480).map(lit).collect::<Vec<_>>()
    };
    let standing = rows(0.0, 0.0);
    let first = standing.iter().position(|row| !row.is_empty()).unwrap() as f64;
    let last = standing.iter().rposition(|row| !row.is_empty()).unwrap() as f64;
    // 0.75 m above the eye and 1 m below it, about 4 m away.
    assert!((first - (240.0 - 0.75 / 4.0 * 500.0)).abs() < 6.0, "{first}");
    assert!((last - (240.0 + 1.0 / 4.0 * 500.0)).abs() < 10.0, "{last}");
    // Seen from the side, near the ground, the feet of a stride are wider apart than those of one who stands.
    let width = |rows: &[Vec<usize>]| rows[355].last().unwrap_or(&0) - rows[355].first().unwrap_or(&0);
    let side = core::f64::consts::FRAC_PI_2;
    assert!(width(&rows(0.25, side)) > width(&rows(0.0, side)) + 40);
}
