//! Builds what is simulated from a scene.

use super::{
    Actuator,
    args::Args,
    body::{Body, Place},
    geometry::{Aabb, Shape, Vec2, norm, sub},
    index::Grid,
    motion::{self, Drive, DriveModel},
    movers::{Along, End, Mover, Wanderer},
    noise::Stream,
    power::Battery,
};
use soifra_graph::component::model;
use soifra_runtime::{
    Scene,
    scene::{Part, PlatformScene, RobotScene},
};
use std::collections::BTreeMap;

/// Infrared reflectance of what has no material of its own: robots, and things whose material the world
/// does not declare. Ranges of infrared sensors are stated for it.
pub const REFLECTANCE: f64 = 0.8;

/// Something that never moves.
#[derive(Debug, Clone)]
pub struct Thing {
    /// Name.
    pub name: String,
    /// Footprint.
    pub shape: Shape,
    /// Height of its base and its top.
    pub span: [f64; 2],
    /// How much infrared it reflects.
    pub reflectance: f64,
}

/// All that never moves.
#[derive(Debug, Default)]
pub struct Things {
    /// In order of declaration.
    pub all: Vec<Thing>,
    /// Over [`Things::all`].
    pub grid: Grid,
}

/// What a platform's robots have in common.
#[derive(Debug)]
pub struct Chassis {
    /// Radius of the body.
    pub radius: f64,
    /// Its height.
    pub height: f64,
    /// Its drive.
    pub drive: Box<dyn DriveModel>,
    /// What moves it; none for one that never tires.
    pub battery: Option<Battery>,
}

/// Bodies and what makes them move. Robots come first, then movers.
#[derive(Debug)]
pub struct Population {
    /// Robots, then movers.
    pub bodies: Vec<Body>,
    /// One for each robot.
    pub drives: Vec<Box<dyn Drive>>,
    /// One for each mover.
    pub movers: Vec<Mover>,
}

const WORLD: &str = "the world";

/// Water that is faster (m/s) than any tidal stream is a mistake; the hydrodynamics are not made for it.
const SWIFTEST: f64 = 20.0;

/// Walls and obstacles.
pub fn things(scene: &Scene) -> Result<Things, String> {
    let reflectances = reflectances(scene)?;
    let mut things = Things::default();
    for part in scene.world.iter().filter(|p| matches!(&*p.role, "wall" | "obstacle")) {
        let args = Args { part, of: WORLD };
        let (shape, span) = match (&*part.role, &*part.model) {
            ("wall", "segment") => wall(args)?,
            ("obstacle", "cylinder") => {
                let [x, y, z] = args.vector("at")?;
                (
                    Shape::Disc { at: [x, y], radius: args.positive("radius")? },
                    [z, z + args.positive("height")?],
                )
            }
            ("obstacle", "box") => {
                let ([x, y, z], size) = (args.vector("at")?, args.vector("size")?);
                if size.iter().any(|s| *s <= 0.0) {
                    return Err(args.wrong("every side of `size` must be greater than zero"));
                }
                let (s, c) = libm::sincos(args.number("heading")?);
                let half = [0.5 * size[0], 0.5 * size[1]];
                (Shape::Box { at: [x, y], axis: [c, s], half }, [z, z + size[2]])
            }
            _ => return Err(args.wrong("the simulator has no such model")),
        };
        let reflectance = *reflectances.get(args.text("material")).unwrap_or(&REFLECTANCE);
        things.all.push(Thing { name: part.name.clone(), shape, span, reflectance });
    }
    things.grid.fill(things.all.iter().map(|t| t.shape.aabb()));
    Ok(things)
}

fn wall(args: Args<'_>) -> Result<(Shape, [f64; 2]), String> {
    let (a, b) = (args.vector("from")?, args.vector("to")?);
    let d = sub([b[0], b[1]], [a[0], a[1]]);
    let length = norm(d);
    let axis = if length > 0.0 { [d[0] / length, d[1] / length] } else { [1.0, 0.0] };
    let at = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let half = [0.5 * length, 0.5 * args.positive("thickness")?];
    Ok((Shape::Box { at, axis, half }, [a[2], a[2] + args.positive("height")?]))
}

/// Reflectance by name of material.
fn reflectances(scene: &Scene) -> Result<BTreeMap<&str, f64>, String> {
    let materials = scene.world.iter().filter(|p| &*p.role == "material");
    materials.map(|part| Ok((part.name.as_str(), Args { part, of: WORLD }.chance("reflectance")?))).collect()
}

pub fn bounds(scene: &Scene) -> Result<Option<Aabb>, String> {
    let Some(part) = scene.world.iter().find(|p| &*p.role == "bounds") else { return Ok(None) };
    let args = Args { part, of: WORLD };
    let (low, high) = (args.vector("low")?, args.vector("high")?);
    Ok(Some(Aabb { low: [low[0], low[1]], high: [high[0], high[1]] }))
}

/// Velocity of the water over the ground (m/s, in map); none without a current.
fn current(scene: &Scene) -> Result<Vec2, String> {
    let mut all = scene.world.iter().filter(|p| &*p.role == "current");
    let Some(part) = all.next() else { return Ok([0.0; 2]) };
    let args = Args { part, of: WORLD };
    let [x, y, z] = args.vector("velocity")?;
    if z != 0.0 {
        return Err(args.wrong("`velocity` is not level"));
    }
    if norm([x, y]) > SWIFTEST {
        return Err(args.wrong(format_args!("`velocity` is above {SWIFTEST} m/s")));
    }
    match all.next() {
        Some(_) => Err(args.wrong("there is a second one")),
        None => Ok([x, y]),
    }
}

/// The body and drive of a platform.
pub fn chassis(platform: &PlatformScene) -> Result<Chassis, String> {
    let of = format!("platform `{}`", platform.name);
    let one = |role: &'static str| -> Result<&Part, String> {
        platform.of_role(role).next().ok_or_else(|| format!("{of} has no {role}"))
    };
    let args = Args { part: one("body")?, of: &of };
    if &*args.part.model != "cylinder" {
        return Err(args.wrong("the simulator has no such body"));
    }
    let take_off = platform.of_role("prepare").find(|p| &*p.model == "take_off");
    let height = take_off.map(|part| Args { part, of: &of }.positive("height")).transpose()?;
    let drive = motion::build(Args { part: one("drive")?, of: &of }, args.positive("mass")?, height)?;
    let battery = Battery::of(platform)?;
    Ok(Chassis { radius: args.positive("radius")?, height: args.positive("height")?, drive, battery })
}

/// The actuators of each platform, and whether it can be made safe.
pub fn actuators(scene: &Scene, chassis: &[Chassis]) -> Result<Vec<Vec<Actuator>>, String> {
    let one = |(platform, chassis): (&PlatformScene, &Chassis)| -> Result<Vec<Actuator>, String> {
        let of = format!("platform `{}`", platform.name);
        for part in ["safe", "prepare", "finish"].into_iter().flat_map(|role| platform.of_role(role)) {
            let args = Args { part, of: &of };
            match (&*part.role, &*part.model) {
                ("safe" | "finish", "stop") | ("prepare", "stand") => {}
                ("safe", "hover" | "land") | ("prepare", "take_off") | ("finish", "land")
                    if chassis.drive.leaves_ground() => {}
                ("safe", "hover" | "land") | ("prepare", "take_off") | ("finish", "land") => {
                    return Err(args.wrong("its drive does not leave the ground"));
                }
                _ => return Err(args.wrong("the simulator has no such action")),
            }
        }
        let actuator = |part| -> Result<Actuator, String> {
            let args = Args { part, of: &of };
            match &*part.model {
                "twist" => Ok(Actuator::Twist),
                "gripper" => Ok(Actuator::Gripper { reach: args.at_least_zero("reach")? }),
                "strides" if chassis.drive.strides() => {
                    Ok(Actuator::Strides { duration: args.period("duration")?.0 })
                }
                "strides" => Err(args.wrong("a stride needs a drive that moves in any direction")),
                _ => Err(args.wrong("the simulator has no such actuator")),
            }
        };
        platform.of_role("actuator").map(actuator).collect()
    };
    scene.platforms.iter().zip(chassis).map(one).collect()
}

/// What a robot does when in doubt, and at the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Endings {
    /// The safe action.
    pub safe: &'static str,
    /// At the end of a run.
    pub finish: &'static str,
}

/// By platform.
pub fn endings(platforms: &[PlatformScene]) -> Vec<Endings> {
    let named = |p: &PlatformScene, role: &'static str| {
        let part = p.of_role(role).next();
        part.and_then(|part| model(role, &part.model)).map(|m| &*m.signature.name)
    };
    let of = |p: &PlatformScene| {
        let safe = named(p, "safe").unwrap_or("stop");
        Endings { safe, finish: named(p, "finish").unwrap_or(safe) }
    };
    platforms.iter().map(of).collect()
}

/// Robots and movers.
pub fn population(scene: &Scene, chassis: &[Chassis]) -> Result<Population, String> {
    let mut all = Population { bodies: Vec::new(), drives: Vec::new(), movers: Vec::new() };
    let current = current(scene)?;
    for robot in scene.bodies() {
        let c = chassis
            .get(robot.platform as usize)
            .ok_or_else(|| format!("robot `{}` has no platform", robot.name))?;
        let (place, z) = start(robot)?;
        let span = [z, z + c.height];
        let body = Body::new(robot.name.clone(), c.radius, span, REFLECTANCE, place);
        all.bodies.push(if c.drive.leaves_ground() { body.flying() } else { body });
        all.drives.push(c.drive.drive(scene.seed, &format!("{}/drive", robot.name), current));
    }
    let reflectances = reflectances(scene)?;
    let bounds = bounds(scene)?;
    for part in scene.world.iter().filter(|p| &*p.role == "mover") {
        let args = Args { part, of: WORLD };
        let (mover, place) = match &*part.model {
            "disc" | "walker" => {
                let end = if &*part.model == "disc" { End::Back } else { End::Round };
                let (path, place) = Along::new(args, end)?;
                (Mover::Path(path), place)
            }
            "wanderer" => {
                let noise = Stream::new(scene.seed, &format!("mover/{}", part.name));
                let (wanderer, place) = Wanderer::new(args, bounds, &anchors(scene), noise)?;
                (Mover::Wanderer(Box::new(wanderer)), place)
            }
            _ => return Err(args.wrong("the simulator has no such mover")),
        };
        let radius = args.positive("radius")?;
        let span = [0.0, args.positive("height")?];
        let reflectance = *reflectances.get(args.text("material")).unwrap_or(&REFLECTANCE);
        let mut body = Body::new(part.name.clone(), radius, span, reflectance, place);
        body.cut(0);
        all.bodies.push(body);
        all.movers.push(mover);
    }
    Ok(all)
}

/// Where robots start and want to go: what wanderers keep out of.
fn anchors(scene: &Scene) -> Vec<[f64; 2]> {
    let starts = scene.bodies().iter().map(|r| [r.start[0], r.start[1]]);
    let targets = scene.bodies().iter().filter_map(|r| r.target).map(|t| [t[0], t[1]]);
    starts.chain(targets).filter(|p| p.iter().all(|x| x.is_finite())).collect()
}

/// Start of a robot on the ground, and its height. Roll and pitch of the pose are left out: on the floor a
/// robot stands upright.
fn start(robot: &RobotScene) -> Result<(Place, f64), String> {
    let [x, y, z, qx, qy, qz, qw] = robot.start;
    if !robot.start.iter().all(|v| v.is_finite()) {
        return Err(format!("robot `{}`: the start is not finite", robot.name));
    }
    let heading = libm::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
    Ok((Place { at: [x, y], heading, path: 0.0 }, z))
}
