//! The scene as MCAP viewers draw it: one `foxglove.SceneUpdate`, at the start.
//!
//! What stands is drawn in `map`; robots and movers are drawn in their own frames, which the poses move.

use super::{
    palette,
    shape::{self, Shape},
    transform::robot_frame,
};
use serde::Serialize;
use soifra_runtime::Scene;

/// Always empty.
type Nothing = [(); 0];

#[derive(Serialize)]
pub(crate) struct SceneUpdate {
    deletions: Nothing,
    entities: Vec<Entity>,
}

#[derive(Serialize, Default)]
struct Entity {
    timestamp: Stamp,
    frame_id: String,
    id: String,
    lifetime: Stamp,
    frame_locked: bool,
    metadata: Nothing,
    arrows: Vec<Arrow>,
    cubes: Vec<Cube>,
    spheres: Nothing,
    cylinders: Vec<Cylinder>,
    lines: Nothing,
    triangles: Nothing,
    texts: Nothing,
    models: Nothing,
}

#[derive(Serialize, Default)]
struct Stamp {
    sec: u32,
    nsec: u32,
}

#[derive(Serialize)]
struct Arrow {
    pose: Pose,
    shaft_length: f64,
    shaft_diameter: f64,
    head_length: f64,
    head_diameter: f64,
    color: Rgba,
}

#[derive(Serialize)]
struct Cube {
    pose: Pose,
    size: Xyz,
    color: Rgba,
}

#[derive(Serialize)]
struct Cylinder {
    pose: Pose,
    size: Xyz,
    bottom_scale: f64,
    top_scale: f64,
    color: Rgba,
}

#[derive(Serialize)]
struct Pose {
    position: Xyz,
    orientation: Xyzw,
}

#[derive(Serialize)]
struct Xyz {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize)]
struct Xyzw {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Serialize)]
struct Rgba {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

impl SceneUpdate {
    /// Everything in a scene that has a body, and the targets.
    pub(crate) fn of(scene: &Scene) -> SceneUpdate {
        let mut entities = Vec::new();
        for (i, part) in scene.world.iter().enumerate() {
            // Entities are told apart by id; parts that stand alone have no name.
            let id = if part.name.is_empty() { format!("{}/{i}", part.role) } else { part.name.clone() };
            if let Some(body) = shape::mover_body(part) {
                entities.push(Entity::new(&part.name, id).with(&upright(body), rgba([150, 150, 160], 0.9)));
            } else if let Some(shape) = shape::of_part(part) {
                let color = match &*part.role {
                    "bounds" => rgba([225, 228, 232], 1.0),
                    "region" => rgba([90, 180, 110], 0.35),
                    "wall" => rgba([70, 75, 85], 1.0),
                    _ => rgba([110, 115, 125], 1.0),
                };
                entities.push(Entity::new("map", id).with(&shape, color));
            }
        }
        let mut targets = Entity::new("map", "targets".into());
        for (i, robot) in scene.bodies().iter().enumerate() {
            let (body, color) = (shape::robot_body(scene, i), palette::robot(i));
            let mut entity = Entity::new(&robot_frame(&robot.name), robot.name.clone());
            entity = entity.with(&upright(body), rgba(color, 0.9));
            entity.arrows.push(Arrow {
                pose: pose([0.0, 0.0, body.height], 0.0),
                shaft_length: body.radius,
                shaft_diameter: 0.2 * body.radius,
                head_length: 0.4 * body.radius,
                head_diameter: 0.5 * body.radius,
                color: rgba([30, 30, 35], 1.0),
            });
            entities.push(entity);
            if let Some(at) = robot.target.filter(|t| t.iter().all(|x| x.is_finite())) {
                let mark = Shape::Cylinder { at, radius: body.radius / 2.0, height: 0.0 };
                targets = targets.with(&mark, rgba(color, 0.6));
            }
        }
        entities.push(targets);
        SceneUpdate { deletions: [], entities }
    }
}

impl Entity {
    fn new(frame: &str, id: String) -> Entity {
        Entity { frame_id: frame.to_string(), id, frame_locked: true, ..Entity::default() }
    }

    fn with(mut self, shape: &Shape, color: Rgba) -> Entity {
        // Viewers do not draw bodies without height; a sheet has a tenth of a millimetre.
        let sheet = |height: f64| f64::max(height, 1e-4);
        match *shape {
            Shape::Cylinder { at: [x, y, z], radius, height } => self.cylinders.push(Cylinder {
                pose: pose([x, y, z + height / 2.0], 0.0),
                size: Xyz { x: 2.0 * radius, y: 2.0 * radius, z: sheet(height) },
                bottom_scale: 1.0,
                top_scale: 1.0,
                color,
            }),
            Shape::Box { at: [x, y, z], size: [length, width, height], heading } => self.cubes.push(Cube {
                pose: pose([x, y, z + height / 2.0], heading),
                size: Xyz { x: length, y: width, z: sheet(height) },
                color,
            }),
        }
        self
    }
}

/// A body around the origin of its frame.
fn upright(body: shape::Body) -> Shape {
    Shape::Cylinder { at: [0.0; 3], radius: body.radius, height: body.height }
}

fn pose([x, y, z]: [f64; 3], heading: f64) -> Pose {
    let (sin, cos) = (libm::sin(heading / 2.0), libm::cos(heading / 2.0));
    Pose { position: Xyz { x, y, z }, orientation: Xyzw { x: 0.0, y: 0.0, z: sin, w: cos } }
}

fn rgba(color: palette::Color, a: f64) -> Rgba {
    let [r, g, b] = color.map(|c| f64::from(c) / 255.0);
    Rgba { r, g, b, a }
}
