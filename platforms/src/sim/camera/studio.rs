//! What cameras see of a scene: its world with textures, its robots and movers.

use crate::sim::{args::Args, body::Body, scene};
use soifra_camera::{
    Clothes, Figure, Lens, Light, Mesh, PartIndex, PartPose, Point, Pose, Rotation, Scene as Pictured,
    Surface, Texture,
};
use soifra_runtime::{
    Scene, Time,
    objects::Optics,
    scene::{ImageFile, Part, PlatformScene},
};
use std::collections::BTreeMap;

const WORLD: &str = "the world";

/// The ground is seen that far beyond the bounds, m.
const AROUND: f64 = 20.0;

/// Of a cylinder.
const SIDES: usize = 24;

/// What robots look like: nobody has said.
const ROBOT: [u8; 3] = [70, 78, 92];

/// Everything that can be seen, and the cameras that see it.
#[derive(Debug)]
pub struct Studio {
    pub(super) scene: Pictured,
    pub(super) light: Light,
    /// One for each body, robots first.
    looks: Vec<Look>,
    /// By platform and sensor.
    cameras: BTreeMap<(u32, u32), Mounted>,
    /// Platform of each robot.
    platforms: Vec<u32>,
    seed: u64,
    names: Vec<String>,
}

/// What a body looks like.
#[derive(Debug, Clone)]
enum Look {
    /// An upright cylinder.
    Solid(PartIndex),
    /// A person who walks.
    Figure(Box<Figure>),
}

impl Look {
    fn figure(&self) -> Option<&Figure> {
        match self {
            Look::Figure(figure) => Some(figure),
            Look::Solid(_) => None,
        }
    }
}

/// A camera of a platform.
#[derive(Debug, Clone)]
pub struct Mounted {
    pub(super) lens: Lens,
    /// In base_link.
    pub(super) mount: Pose,
    /// How far down it looks, rad.
    tilt: f64,
    /// Standard deviation, of 255.
    pub(super) noise: f64,
    pub(super) gain: f64,
    /// How long the shutter is open, s.
    pub(super) exposure: f64,
    name: String,
}

/// Materials of a world as surfaces.
struct Materials<'s> {
    declared: BTreeMap<&'s str, &'s Part>,
    known: BTreeMap<String, Surface>,
    images: &'s [ImageFile],
}

impl Materials<'_> {
    fn surface(&mut self, scene: &mut Pictured, name: &str) -> Result<Surface, String> {
        if let Some(surface) = self.known.get(name) {
            return Ok(*surface);
        }
        let (texture, repeat) = match self.declared.get(name) {
            Some(part) => {
                let args = Args { part, of: WORLD };
                match &*part.model {
                    "textured" => {
                        let pattern = args.text("texture");
                        let texture = Texture::by_name(pattern);
                        (
                            texture.ok_or_else(|| args.wrong("there is no such pattern"))?,
                            args.positive("repeat")?,
                        )
                    }
                    "image" => (self.image(args)?, args.positive("width")?),
                    _ => (Texture::cloth(colour(args, "color")?), 1.0),
                }
            }
            None => (Texture::by_name(name).unwrap_or_else(|| Texture::plain([200; 3])), 1.0),
        };
        let surface = Surface { texture: scene.add_texture(texture), repeat };
        self.known.insert(name.to_string(), surface);
        Ok(surface)
    }

    /// What is in the image file of a material.
    fn image(&self, args: Args<'_>) -> Result<Texture, String> {
        let name = args.text("file");
        let file = self.images.iter().find(|f| f.name == name);
        let pixels = file.and_then(|f| f.pixels.as_deref());
        let pixels = pixels.ok_or_else(|| args.wrong(format_args!("nobody has read the image `{name}`")))?;
        Texture::from_rgb8(pixels.width, pixels.height, &pixels.data).map_err(|e| args.wrong(e))
    }
}

/// `#rrggbb`
fn colour(args: Args<'_>, name: &str) -> Result<[u8; 3], String> {
    let text = args.text(name);
    let digits = text.strip_prefix('#').filter(|d| d.len() == 6);
    let value = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
    let value = value.ok_or_else(|| args.wrong(format_args!("`{name}` is not as #rrggbb")))?;
    Ok([(value >> 16) as u8, (value >> 8) as u8, value as u8])
}

impl Studio {
    /// Of a scene in which somebody reads a camera; none otherwise.
    pub fn of(scene: &Scene, bodies: &[Body]) -> Result<Option<Studio>, String> {
        let mut cameras = BTreeMap::new();
        for (p, platform) in scene.platforms.iter().enumerate() {
            for (s, part) in platform.of_role("sensor").enumerate().filter(|(_, p)| &*p.model == "camera") {
                let reads = |r: &&soifra_runtime::scene::RobotScene| {
                    r.platform as usize == p && r.consumed.get(s).copied().unwrap_or(false)
                };
                if scene.bodies().iter().any(|r| reads(&r)) {
                    cameras.insert((p as u32, s as u32), Mounted::new(platform, part)?);
                }
            }
        }
        if cameras.is_empty() {
            return Ok(None);
        }
        let mut pictured = Pictured::new();
        let declared = scene.world.iter().filter(|p| &*p.role == "material").map(|p| (p.name.as_str(), p));
        let mut materials =
            Materials { declared: declared.collect(), known: BTreeMap::new(), images: &scene.images };
        let mut fixed = Mesh::new();
        for part in &scene.world {
            build(part, scene, &mut pictured, &mut materials, &mut fixed)?;
        }
        let has_floor = scene.world.iter().any(|p| &*p.role == "floor");
        if !has_floor {
            let surface = materials.surface(&mut pictured, "concrete")?;
            ground(scene, surface, &mut fixed)?;
        }
        pictured.fixed = fixed;
        let own = pictured.add_texture(Texture::cloth(ROBOT));
        let movers: Vec<&Part> = scene.world.iter().filter(|p| &*p.role == "mover").collect();
        let mut looks = Vec::new();
        for (i, body) in bodies.iter().enumerate() {
            let mover = i.checked_sub(scene.bodies().len()).and_then(|m| movers.get(m));
            let [low, high] = body.span(0);
            if let Some(part) = mover.filter(|p| &*p.model == "walker") {
                let figure = Figure::new(&mut pictured, high - low, &clothes(Args { part, of: WORLD })?);
                looks.push(Look::Figure(Box::new(figure)));
                continue;
            }
            let surface = match mover {
                Some(part) => materials.surface(&mut pictured, Args { part, of: WORLD }.text("material"))?,
                None => Surface { texture: own, repeat: 1.0 },
            };
            let mut mesh = Mesh::new();
            mesh.cylinder([0.0; 3], body.radius, high - low, SIDES, surface);
            looks.push(Look::Solid(pictured.add_part(mesh)));
        }
        Ok(Some(Studio {
            light: light(scene)?,
            scene: pictured,
            looks,
            cameras,
            platforms: scene.bodies().iter().map(|r| r.platform).collect(),
            seed: scene.seed,
            names: scene.bodies().iter().map(|r| r.name.clone()).collect(),
        }))
    }

    /// The camera of a robot that is its sensor of this number.
    pub fn camera(&self, robot: u32, sensor: u32) -> Option<&Mounted> {
        self.cameras.get(&(*self.platforms.get(robot as usize)?, sensor))
    }

    /// What a camera of a robot sees at an instant, as numbers: the robot's pose, those of all other bodies, and how far each
    /// figure is in its stride. Where the shutter is open for a while, all of them as it opens, then all of them as it
    /// closes.
    pub fn view(&self, robot: u32, sensor: u32, bodies: &[Body], at: Time) -> Vec<f64> {
        let exposure = self.camera(robot, sensor).map_or(0.0, |c| c.exposure);
        let poses = |b: &Body| match exposure > 0.0 {
            true => b.poses_around(at, exposure),
            false => [b.pose(at); 2],
        };
        let around: Vec<[[f64; 7]; 2]> = bodies.iter().map(poses).collect();
        let moments = if exposure > 0.0 { 2 } else { 1 };
        let mut view = Vec::with_capacity(8 * moments * bodies.len());
        for moment in 0..moments {
            let others = around.iter().enumerate().filter(|(i, _)| *i != robot as usize).map(|(_, p)| p);
            view.extend(around.get(robot as usize).into_iter().chain(others).flat_map(|p| p[moment]));
            for ((body, look), [open, close]) in bodies.iter().zip(&self.looks).zip(&around) {
                let way = libm::hypot(close[0] - open[0], close[1] - open[1]);
                let since = if moments == 2 { way * (moment as f64 - 0.5) } else { 0.0 };
                let phase = |f: &Figure| ((body.place(at.0).path + since) / f.stride()).rem_euclid(1.0);
                view.extend(look.figure().map(phase));
            }
        }
        view
    }

    /// The poses of a view, without how far figures are in their strides.
    pub(super) fn poses<'v>(&self, view: &'v [f64]) -> &'v [f64] {
        view.get(..7 * self.looks.len()).unwrap_or_default()
    }

    /// The pose of the robot, and the parts that a view places; none when it is no view of this scene.
    pub(super) fn placed(&self, robot: u32, view: &[f64]) -> Option<(Pose, Vec<PartPose>)> {
        let (poses, phases) = view.split_at_checked(7 * self.looks.len())?;
        let (own, others) = poses.as_chunks::<7>().0.split_first()?;
        let known = self.looks.iter().enumerate().filter(|(i, _)| *i != robot as usize).map(|(_, l)| l);
        let (mut parts, mut phases) = (Vec::new(), phases.iter());
        for (look, p) in known.zip(others) {
            match look {
                Look::Solid(part) => parts.push(PartPose { part: *part, pose: pose(p) }),
                Look::Figure(figure) => {
                    let [x, y, z, _, _, qz, qw] = *p;
                    figure.place([x, y, z], 2.0 * libm::atan2(qz, qw), *phases.next()?, &mut parts);
                }
            }
        }
        phases.next().is_none().then(|| (pose(own), parts))
    }

    /// Names the noise of a robot's camera.
    pub(super) fn key(&self, robot: u32, camera: &Mounted) -> u64 {
        let name = self.names.get(robot as usize).map_or("", String::as_str);
        crate::sim::noise::source(self.seed, &format!("{name}/{}", camera.name))
    }
}

/// From x y z qx qy qz qw.
fn pose(p: &[f64; 7]) -> Pose {
    let [x, y, z, qx, qy, qz, qw] = *p;
    Pose { position: [x, y, z], rotation: Rotation::from_quaternion([qw, qx, qy, qz]) }
}

/// How long the shutter is open, s: no longer than until the next image.
fn exposure(args: Args<'_>) -> Result<f64, String> {
    if !args.has("exposure") {
        return Ok(0.0);
    }
    let exposure = args.duration("exposure")?;
    match args.has("period") && exposure > args.duration("period")? {
        true => Err(args.wrong("`exposure` is longer than `period`")),
        false => Ok(exposure.seconds()),
    }
}

impl Mounted {
    fn new(platform: &PlatformScene, part: &Part) -> Result<Mounted, String> {
        let of = format!("platform `{}`", platform.name);
        let args = Args { part, of: &of };
        let side = |name| args.count(name, Lens::MOST_PIXELS as i64);
        let (width, height) = (side("width")?, side("height")?);
        let [k1, k2] = [args.number("k1")?, args.number("k2")?];
        let distortion = ([k1, k2] != [0.0; 2]).then_some([k1, k2, 0.0, 0.0]);
        let lens =
            Lens::from_distorted_field_of_view(width, height, args.positive("field_of_view")?, distortion)
                .map_err(|_| args.wrong("there is no such lens"))?;
        let tilt = args.number("tilt")?;
        let rotation = Rotation::from_roll_pitch_yaw(0.0, tilt, 0.0);
        Ok(Mounted {
            tilt,
            lens,
            mount: Pose { position: args.vector("at")?, rotation },
            noise: 255.0 * args.at_least_zero("noise")?,
            gain: args.at_least_zero("gain")?,
            exposure: exposure(args)?,
            name: part.name.clone(),
        })
    }

    /// For whoever measures in its images.
    pub fn optics(&self) -> Optics {
        let l = &self.lens;
        Optics {
            focal: [l.fx, l.fy],
            centre: [l.cx, l.cy],
            distortion: l.distortion,
            at: self.mount.position,
            tilt: self.tilt,
        }
    }
}

/// What a walker wears and is.
fn clothes(args: Args<'_>) -> Result<Clothes, String> {
    Ok(Clothes {
        skin: colour(args, "skin")?,
        hair: colour(args, "hair")?,
        shirt: colour(args, "shirt")?,
        trousers: colour(args, "trousers")?,
        shoes: colour(args, "shoes")?,
    })
}

fn light(scene: &Scene) -> Result<Light, String> {
    let Some(part) = scene.world.iter().find(|p| &*p.role == "light") else { return Ok(Light::default()) };
    let args = Args { part, of: WORLD };
    let ((sa, ca), (se, ce)) =
        (libm::sincos(args.number("azimuth")?), libm::sincos(args.number("elevation")?));
    Ok(Light {
        ambient: args.at_least_zero("ambient")?,
        sun: [ca * ce, sa * ce, se],
        strength: args.at_least_zero("strength")?,
        gain: args.at_least_zero("gain")?,
    })
}

/// The ground under everything.
fn ground(scene: &Scene, surface: Surface, mesh: &mut Mesh) -> Result<(), String> {
    let bounds = scene::bounds(scene)?;
    let starts = scene.bodies().iter().map(|r| [r.start[0], r.start[1]]);
    let (low, high) = match bounds {
        Some(b) => (b.low, b.high),
        None => starts.fold(([0.0f64; 2], [0.0f64; 2]), |(l, h), p| {
            ([l[0].min(p[0]), l[1].min(p[1])], [h[0].max(p[0]), h[1].max(p[1])])
        }),
    };
    mesh.ground(low.map(|x| x - AROUND), high.map(|x| x + AROUND), 0.0, surface);
    Ok(())
}

fn build(
    part: &Part,
    scene: &Scene,
    pictured: &mut Pictured,
    materials: &mut Materials<'_>,
    mesh: &mut Mesh,
) -> Result<(), String> {
    let args = Args { part, of: WORLD };
    if !matches!(&*part.role, "floor" | "wall" | "obstacle") {
        return Ok(());
    }
    let surface = materials.surface(pictured, args.text("material"))?;
    match (&*part.role, &*part.model) {
        ("floor", _) => ground(scene, surface, mesh)?,
        ("wall", _) => {
            let ([x, y, z], [to_x, to_y, _]): (Point, Point) = (args.vector("from")?, args.vector("to")?);
            let (height, thickness) = (args.positive("height")?, args.positive("thickness")?);
            let (dx, dy) = (to_x - x, to_y - y);
            let size = [libm::hypot(dx, dy), thickness, height];
            let centre = [x + 0.5 * dx, y + 0.5 * dy, z + 0.5 * height];
            mesh.cuboid(centre, size, libm::atan2(dy, dx), surface);
        }
        (_, "cylinder") => {
            let height = args.positive("height")?;
            mesh.cylinder(args.vector("at")?, args.positive("radius")?, height, SIDES, surface);
        }
        _ => {
            let ([x, y, z], size) = (args.vector("at")?, args.vector("size")?);
            mesh.cuboid([x, y, z + 0.5 * size[2]], size, args.number("heading")?, surface);
        }
    }
    Ok(())
}
