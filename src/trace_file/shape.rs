//! What the parts of a scene look like: the few shapes that pictures and viewers draw.

use soifra_graph::Value;
use soifra_runtime::scene::{Part, PlatformScene, Scene};

/// A shape in `map`, upright. Lengths in metres, angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// An upright cylinder (a disc when it has no height).
    Cylinder {
        /// Centre of its foot.
        at: [f64; 3],
        /// Radius.
        radius: f64,
        /// Height.
        height: f64,
    },
    /// An upright box.
    Box {
        /// Centre of its foot.
        at: [f64; 3],
        /// Length along its heading, width across it, height.
        size: [f64; 3],
        /// Direction of its length, counter-clockwise from east.
        heading: f64,
    },
}

/// Height and radius of a robot's body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Radius in metres; 0 when the platform declares no body.
    pub radius: f64,
    /// Height in metres.
    pub height: f64,
}

/// The shape of a part of the world; `None` for what has none (materials), whose shape lies with its
/// motion (movers, see [`mover_body`]), and for models this version does not know.
pub fn of_part(part: &Part) -> Option<Shape> {
    let shape = match (&*part.role, &*part.model) {
        ("bounds" | "region", "rectangle") => {
            let (low, high) = (vector(part, "low")?, vector(part, "high")?);
            let at = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]];
            Shape::Box { at, size: [(high[0] - low[0]).abs(), (high[1] - low[1]).abs(), 0.0], heading: 0.0 }
        }
        ("region", "circle") => {
            Shape::Cylinder { at: vector(part, "at")?, radius: part.number("radius"), height: 0.0 }
        }
        ("wall", "segment") => {
            let (from, to) = (vector(part, "from")?, vector(part, "to")?);
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            Shape::Box {
                at: [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0, from[2]],
                size: [libm::hypot(dx, dy), part.number("thickness"), part.number("height")],
                heading: libm::atan2(dy, dx),
            }
        }
        ("obstacle", "cylinder") => Shape::Cylinder {
            at: vector(part, "at")?,
            radius: part.number("radius"),
            height: part.number("height"),
        },
        ("obstacle", "box") => Shape::Box {
            at: vector(part, "at")?,
            size: vector(part, "size")?,
            heading: part.number("heading"),
        },
        _ => return None,
    };
    shape.is_finite().then_some(shape)
}

/// The body of a mover.
pub fn mover_body(part: &Part) -> Option<Body> {
    let body = Body { radius: part.number("radius"), height: part.number("height") };
    (&*part.role == "mover" && body.radius.is_finite() && body.height.is_finite()).then_some(body)
}

/// The body of robot `robot`.
pub fn robot_body(scene: &Scene, robot: usize) -> Body {
    let platform = scene.robots.get(robot).and_then(|r| scene.platforms.get(r.platform as usize));
    platform.map_or(Body { radius: 0.0, height: 0.0 }, platform_body)
}

fn platform_body(platform: &PlatformScene) -> Body {
    let number = |name: &str| {
        let x = platform.of_role("body").next().map_or(0.0, |b| b.number(name));
        if x.is_finite() { x } else { 0.0 }
    };
    Body { radius: number("radius"), height: number("height") }
}

/// Direction a pose faces in the ground plane, counter-clockwise from east.
pub fn yaw(pose: &[f64; 7]) -> f64 {
    let [_, _, _, x, y, z, w] = *pose;
    libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

fn vector(part: &Part, name: &str) -> Option<[f64; 3]> {
    match part.args.get(name) {
        Some(Value::Vector(v)) => Some(*v),
        _ => None,
    }
}

impl Shape {
    fn is_finite(&self) -> bool {
        match self {
            Shape::Cylinder { at, radius, height } => {
                at.iter().chain([radius, height]).all(|x| x.is_finite())
            }
            Shape::Box { at, size, heading } => at.iter().chain(size).chain([heading]).all(|x| x.is_finite()),
        }
    }
}
