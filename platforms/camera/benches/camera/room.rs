//! What is rendered: a room with twenty objects, about 860 triangles.

use soifra_camera::{Image, Lens, Light, Pose, Rotation, Scene, Surface, Texture};

/// The textures of walls and floor, and then of objects in turn, with metres a repeat.
const TEXTURES: [(&str, f64); 8] = [
    ("plaster", 3.0),
    ("bricks", 1.0),
    ("tiles", 2.0),
    ("planks", 1.6),
    ("speckle", 1.5),
    ("concrete", 3.0),
    ("carpet", 1.5),
    ("checker", 1.2),
];

/// The room, and the images of its textures in the order of their indices.
pub struct Room {
    pub scene: Scene,
    pub textures: Vec<Image>,
}

pub fn room() -> Room {
    let mut scene = Scene::new();
    let mut textures = Vec::new();
    let surfaces: Vec<Surface> = TEXTURES
        .iter()
        .filter_map(|(name, repeat)| {
            let texture = Texture::by_name(name)?;
            let (width, height) = texture.size();
            textures.push(Image { width, height, data: texture.to_rgb8() });
            Some(Surface { texture: scene.add_texture(texture), repeat: *repeat })
        })
        .collect();
    let walls = [surfaces[0], surfaces[1], surfaces[0], surfaces[5]];
    scene.fixed.room([-10.0, -10.0], [10.0, 10.0], 3.0, walls, surfaces[2], Some(surfaces[5]));
    for i in 0..20_u32 {
        // Scattered by the golden angle, as seeds in a sunflower.
        let turn = f64::from(i) * 2.399_963;
        let far = 2.0 + 7.0 * (f64::from(i) / 20.0).sqrt();
        let (x, y) = (far * libm::cos(turn), far * libm::sin(turn));
        let surface = surfaces[3 + i as usize % 5];
        if i % 2 == 0 {
            scene.fixed.cuboid([x, y, 0.6], [0.8, 1.0, 1.2], turn, surface);
        } else {
            scene.fixed.cylinder([x, y, 0.0], 0.3, 1.7, 18, surface);
        }
    }
    Room { scene, textures }
}

pub fn lens() -> Lens {
    Lens::from_field_of_view(640, 480, 60.0_f64.to_radians()).expect("a camera of a robot")
}

/// The light of full colours: the reference has none.
pub fn light() -> Light {
    Light { ambient: 1.0, strength: 0.0, ..Light::default() }
}

/// Ways of looking into the room: along walls, into a corner, near an object.
pub fn poses() -> Vec<Pose> {
    let pose =
        |x, y, yaw| Pose { position: [x, y, 0.8], rotation: Rotation::from_roll_pitch_yaw(0.02, 0.1, yaw) };
    vec![pose(-8.0, 0.0, 0.0), pose(-7.0, -8.0, 0.8), pose(0.5, 0.3, 2.0), pose(8.0, 7.0, -2.2)]
}
