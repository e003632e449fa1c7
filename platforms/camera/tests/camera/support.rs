//! What tests share.

use soifra_camera::{
    Filter, Image, Lens, Light, PartPose, Pose, Rotation, Scene, Scratch, Surface, Texture, View, render,
};

/// The light of full colours.
pub const FULL: Light = Light { ambient: 1.0, sun: [0.0, 0.0, 1.0], strength: 0.0, gain: 1.0 };

/// 640 × 480 with a focal length of 500 pixels.
pub fn lens() -> Lens {
    Lens { width: 640, height: 480, fx: 500.0, fy: 500.0, cx: 320.0, cy: 240.0, distortion: None }
}

/// A surface of the scene with a texture that has a name.
pub fn surface(scene: &mut Scene, name: &str, repeat: f64) -> Surface {
    let texture = Texture::by_name(name).unwrap_or_else(|| Texture::plain([128; 3]));
    Surface { texture: scene.add_texture(texture), repeat }
}

/// A camera's pose by its roll, pitch and yaw.
pub fn pose(position: [f64; 3], roll: f64, pitch: f64, yaw: f64) -> Pose {
    Pose { position, rotation: Rotation::from_roll_pitch_yaw(roll, pitch, yaw) }
}

/// A frame, in full light if no other is given.
pub fn frame(
    scene: &Scene,
    parts: &[PartPose],
    lens: &Lens,
    pose: Pose,
    filter: Filter,
    bands: usize,
) -> Image {
    let mut image = Image::default();
    let view = View { lens, pose, light: &FULL, filter };
    render(scene, parts, &view, bands, &mut image, &mut Scratch::new());
    image
}

/// A room with boxes, a cylinder, a person and something through the camera's plane.
pub fn room() -> (Scene, Vec<PartPose>) {
    let mut scene = Scene::new();
    let plaster = surface(&mut scene, "plaster", 3.0);
    let bricks = surface(&mut scene, "bricks", 1.0);
    let tiles = surface(&mut scene, "tiles", 2.0);
    let speckle = surface(&mut scene, "speckle", 1.5);
    scene.fixed.room([-5.0, -5.0], [5.0, 5.0], 2.5, [plaster, bricks, plaster, bricks], tiles, None);
    scene.fixed.cuboid([2.0, 0.5, 0.5], [0.5, 0.8, 1.0], 0.4, speckle);
    scene.fixed.cuboid([0.5, -1.2, 0.5], [2.0, 0.3, 1.0], 0.0, bricks);
    scene.fixed.cylinder([3.0, -1.0, 0.0], 0.3, 1.7, 12, speckle);
    let figure = soifra_camera::Figure::new(&mut scene, 1.7, &soifra_camera::Clothes::default());
    let mut parts = Vec::new();
    figure.place([3.0, 1.6, 0.0], 1.0, 0.3, &mut parts);
    (scene, parts)
}

/// FNV-1a of bytes.
pub fn digest(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}
