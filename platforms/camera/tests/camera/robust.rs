//! No scene, pose or lens makes it panic.

use proptest::prelude::*;
use soifra_camera::{
    Exposure, Filter, Image, Lens, Light, PartPose, Pose, Rotation, Scene, Scratch, Surface, Texture, View,
    render, render_blurred,
};

/// Ordinary numbers, zero, huge ones and what is no number.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -5.0..5.0_f64,
        1 => Just(0.0),
        1 => -1e6..1e6_f64,
        1 => prop::num::f64::ANY,
    ]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(number())
}

fn rotation() -> impl Strategy<Value = Rotation> {
    prop::array::uniform4(number()).prop_map(Rotation::from_quaternion)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn arbitrary_triangles_and_poses(
        triangles in prop::collection::vec((point(), point(), point(), prop::array::uniform3(prop::array::uniform2(number()))), 1..8),
        eye in point(), turn in rotation(), part in point(), part_turn in rotation(),
        light in prop::array::uniform4(number()), sun in point(),
        filter in prop::sample::select(vec![Filter::Bilinear, Filter::Mipmap, Filter::Trilinear]),
    ) {
        let mut scene = Scene::new();
        let texture = scene.add_texture(Texture::by_name("checker").unwrap());
        let mut mesh = soifra_camera::Mesh::new();
        for (a, b, c, uv) in triangles {
            mesh.triangle([a, b, c], uv, texture);
            mesh.triangle([a, c, b], uv, texture);
        }
        scene.fixed = mesh.clone();
        let part = PartPose { part: scene.add_part(mesh), pose: Pose { position: part, rotation: part_turn } };
        let [ambient, strength, gain, focal] = light;
        let light = Light { ambient, sun, strength, gain };
        let (mut image, mut scratch) = (Image::default(), Scratch::new());
        for fx in [40.0, focal] {
            let lens = Lens { width: 64, height: 48, fx, fy: 40.0, cx: 32.0, cy: 24.0, distortion: None };
            let view = View { lens: &lens, pose: Pose { position: eye, rotation: turn }, light: &light, filter };
            render(&scene, &[part], &view, 2, &mut image, &mut scratch);
        }
    }

    #[test]
    fn arbitrary_lenses(
        size in prop::array::uniform2(0..70_usize),
        numbers in prop::array::uniform4(number()), distortion in prop::option::of(prop::array::uniform4(number())),
    ) {
        let [fx, fy, cx, cy] = numbers;
        let lens = Lens { width: size[0], height: size[1], fx, fy, cx, cy, distortion };
        let mut scene = Scene::new();
        let texture = scene.add_texture(Texture::by_name("checker").unwrap());
        scene.fixed.ground([-5.0, -5.0], [5.0, 5.0], -1.0, Surface { texture, repeat: 1.0 });
        let view = View { lens: &lens, pose: Pose::upright([0.0; 3], 0.3), light: &Light::default(), filter: Filter::Mipmap };
        let mut image = Image::default();
        render(&scene, &[], &view, 1, &mut image, &mut Scratch::new());
        prop_assert!(image.data.is_empty() == lens.check().is_err());
    }

    /// Walking through walls: vertices before, behind and in the camera's plane.
    #[test]
    fn through_the_camera_plane(x in -2.0..2.0_f64, y in -2.0..2.0_f64, yaw in -3.2..3.2_f64, pitch in -1.6..1.6_f64) {
        let mut scene = Scene::new();
        let texture = scene.add_texture(Texture::by_name("bricks").unwrap());
        let surface = Surface { texture, repeat: 1.0 };
        scene.fixed.cuboid([0.0; 3], [2.0, 2.0, 2.0], 0.3, surface);
        scene.fixed.ground([-1e7, -1e7], [1e7, 1e7], -1.0, surface);
        let lens = Lens::from_field_of_view(80, 60, 1.2).unwrap();
        let pose = Pose { position: [x, y, 0.0], rotation: Rotation::from_roll_pitch_yaw(0.2, pitch, yaw) };
        let view = View { lens: &lens, pose, light: &Light::default(), filter: Filter::Mipmap };
        let exposure = Exposure { pose: Pose::upright([x, y, f64::NAN], yaw), parts: &[], instants: 3 };
        render_blurred(&scene, &[], &view, &exposure, 2, &mut Image::default(), &mut Scratch::new());
    }
}
