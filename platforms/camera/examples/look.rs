//! Renders a 20 × 20 m room with obstacles and a figure from a few poses, to PNG files in the directory given (or
//! `out/camera`): what to look at after a change.

use std::fs;
use std::path::{Path, PathBuf};

use soifra_camera::{
    Clothes, Exposure, Figure, Filter, Image, Lens, Light, NAMES, PartPose, Pose, Rotation, Scene, Scratch,
    Surface, Texture, View, noise, render, render_blurred,
};

type Failure = Box<dyn std::error::Error>;

struct Room {
    scene: Scene,
    parts: Vec<PartPose>,
}

fn room() -> Result<Room, Failure> {
    let mut scene = Scene::new();
    let mut surface = |name: &str, repeat: f64| {
        let texture = Texture::by_name(name).ok_or(format!("no texture {name}"))?;
        Ok::<_, Failure>(Surface { texture: scene.add_texture(texture), repeat })
    };
    let plaster = surface("plaster", 3.0)?;
    let bricks = surface("bricks", 1.0)?;
    let concrete = surface("concrete", 3.0)?;
    let tiles = surface("tiles", 2.0)?;
    let planks = surface("planks", 1.6)?;
    let speckle = surface("speckle", 1.5)?;
    let checker = surface("checker", 1.2)?;
    let carpet = surface("carpet", 1.5)?;
    let stripes = surface("stripes", 0.6)?;
    let red = surface("red", 1.0)?;
    let fixed = &mut scene.fixed;
    fixed.room([-10.0, -10.0], [10.0, 10.0], 3.0, [plaster, bricks, plaster, concrete], tiles, None);
    fixed.cuboid([3.0, 0.6, 0.6], [0.6, 0.8, 1.2], 0.2, planks);
    fixed.cuboid([5.0, -1.6, 0.75], [1.0, 1.0, 1.5], 0.6, speckle);
    fixed.cuboid([7.0, 2.5, 0.5], [1.0, 2.0, 1.0], -0.3, checker);
    fixed.cuboid([-4.0, 4.0, 0.5], [1.0, 1.0, 1.0], 0.3, carpet);
    fixed.cuboid([2.0, 3.0, 0.3], [0.4, 0.4, 0.6], 0.0, red);
    fixed.cylinder([4.0, 1.8, 0.0], 0.25, 2.0, 24, stripes);
    fixed.wall([6.0, -6.0], [9.0, -3.0], 0.0, 2.0, 0.15, bricks);
    let mut parts = Vec::new();
    let figure = Figure::new(&mut scene, 1.75, &Clothes::default());
    figure.place([4.0, -0.4, 0.0], 2.2, 0.2, &mut parts);
    let green = Clothes { shirt: [50, 130, 70], ..Clothes::default() };
    Figure::new(&mut scene, 1.6, &green).place([6.0, 0.6, 0.0], -1.2, 0.7, &mut parts);
    Ok(Room { scene, parts })
}

fn save(path: &Path, image: &Image) -> Result<(), Failure> {
    let file = std::io::BufWriter::new(fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&image.data)?;
    Ok(())
}

/// All named textures side by side.
fn textures() -> Image {
    const SIDE: usize = 192;
    const COLUMNS: usize = 5;
    let mut sheet = Image::new(SIDE * COLUMNS, SIDE * NAMES.len().div_ceil(COLUMNS));
    for (i, texture) in NAMES.iter().filter_map(|name| Texture::by_name(name)).enumerate() {
        let ((width, height), rgb) = (texture.size(), texture.to_rgb8());
        for y in 0..SIDE - 4 {
            for x in 0..SIDE - 4 {
                let from = 3 * (y * height / SIDE * width + x * width / SIDE);
                let to = 3 * ((i / COLUMNS * SIDE + y) * sheet.width + i % COLUMNS * SIDE + x);
                sheet.data[to..to + 3].copy_from_slice(&rgb[from..from + 3]);
            }
        }
    }
    sheet
}

fn main() -> Result<(), Failure> {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or("out/camera".into()));
    fs::create_dir_all(&directory)?;
    let Room { scene, parts } = room()?;
    let light = Light::default();
    let lens = Lens::from_field_of_view(640, 480, 62.0_f64.to_radians())?;
    let wide = Lens::from_distorted_field_of_view(
        752,
        480,
        131.0_f64.to_radians(),
        Some([-0.035, 0.0006, 1e-3, -5e-4]),
    )?;
    let look = |x: f64, y: f64, z: f64, roll: f64, pitch: f64, yaw: f64| Pose {
        position: [x, y, z],
        rotation: Rotation::from_roll_pitch_yaw(roll, pitch, yaw),
    };
    let shots = [
        ("ahead", &lens, look(-1.0, 0.0, 0.4, 0.0, 0.0, 0.0), Filter::Mipmap),
        ("bilinear", &lens, look(-1.0, 0.0, 0.4, 0.0, 0.0, 0.0), Filter::Bilinear),
        ("trilinear", &lens, look(-1.0, 0.0, 0.4, 0.0, 0.0, 0.0), Filter::Trilinear),
        ("rolled", &lens, look(-1.0, 0.0, 0.8, 0.25, 0.1, 0.1), Filter::Mipmap),
        ("above", &lens, look(-9.0, -9.0, 6.0, 0.0, 0.45, 0.7), Filter::Mipmap),
        ("near", &lens, look(2.2, 0.7, 0.5, 0.0, 0.0, 0.1), Filter::Mipmap),
        ("wall", &lens, look(8.5, 9.3, 0.4, 0.0, 0.0, 3.0), Filter::Mipmap),
        ("wide", &wide, look(1.2, 0.2, 0.4, 0.0, 0.0, 0.1), Filter::Mipmap),
        ("person", &lens, look(2.4, -1.8, 1.0, 0.0, 0.0, 0.7), Filter::Mipmap),
    ];
    let (mut image, mut scratch) = (Image::default(), Scratch::new());
    for (name, lens, pose, filter) in shots {
        let view = View { lens, pose, light: &light, filter };
        render(&scene, &parts, &view, 2, &mut image, &mut scratch);
        save(&directory.join(format!("{name}.png")), &image)?;
    }
    let pose = look(-1.0, 0.0, 0.4, 0.0, 0.0, 0.0);
    let view = View { lens: &lens, pose, light: &light, filter: Filter::Mipmap };
    let exposure = Exposure { pose: look(-1.0, 0.0, 0.4, 0.0, 0.0, 0.03), parts: &parts, instants: 8 };
    render_blurred(&scene, &parts, &view, &exposure, 2, &mut image, &mut scratch);
    noise(&mut image, 4.0, 1, 1);
    save(&directory.join("blurred.png"), &image)?;
    save(&directory.join("textures.png"), &textures())?;
    Ok(())
}
