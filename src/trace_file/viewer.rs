//! The messages that MCAP viewers draw: poses as transforms, the scene as primitives.
//!
//! A pose is recorded once: its `foxglove.FrameTransform` carries the record's number and causes as
//! further members, so that the record can be read back from it.

use super::{
    palette,
    shape::{self, Shape},
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};
use soifra_runtime::{Event, Record, Scene, Time};
use std::borrow::Cow;

const NANOS: i64 = 1_000_000_000;

/// Frame of a robot's body.
pub(crate) fn robot_frame(name: &str) -> String {
    format!("{name}/base_link")
}

/// A record of a pose as `foxglove.FrameTransform`.
#[derive(Serialize, Deserialize)]
pub(crate) struct Transform<'a> {
    timestamp: Stamp,
    #[serde(borrow)]
    parent_frame_id: Cow<'a, str>,
    #[serde(borrow)]
    child_frame_id: Cow<'a, str>,
    translation: Translation,
    rotation: Rotation,
    n: u64,
    #[serde(default, skip_serializing_if = "no_causes")]
    causes: Cow<'a, [u64]>,
    /// Index and path length of a robot; a mover has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    robot: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    path_m: Option<f64>,
}

fn no_causes(causes: &[u64]) -> bool {
    causes.is_empty()
}

#[derive(Serialize, Deserialize)]
struct Stamp {
    sec: i64,
    nsec: i64,
}

#[derive(Serialize, Deserialize)]
struct Translation {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize, Deserialize)]
struct Rotation {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl<'a> Transform<'a> {
    /// The transform of a record of a pose; `None` for other records and for poses a transform cannot
    /// carry (not finite, or of an unknown robot). `frames` are the frames of the robots.
    pub(crate) fn of(record: &'a Record, frames: &'a [String]) -> Option<Self> {
        let (child, robot, pose, path_m) = match &record.event {
            Event::Pose { robot, pose, path_m } => {
                (frames.get(*robot as usize)?, Some(*robot), pose, Some(*path_m))
            }
            Event::Mover { name, pose } => (name, None, pose, None),
            _ => return None,
        };
        let [x, y, z, qx, qy, qz, qw] = *pose;
        pose.iter().chain(&path_m).all(|x| x.is_finite()).then(|| Transform {
            timestamp: Stamp { sec: record.t.0 / NANOS, nsec: record.t.0 % NANOS },
            parent_frame_id: "map".into(),
            child_frame_id: child.as_str().into(),
            translation: Translation { x, y, z },
            rotation: Rotation { x: qx, y: qy, z: qz, w: qw },
            n: record.n,
            causes: (&*record.causes).into(),
            robot,
            path_m,
        })
    }

    /// The record back; `None` when the time does not fit.
    pub(crate) fn into_record(self) -> Option<Record> {
        let Transform { translation: p, rotation: q, .. } = self;
        let pose = [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
        Some(Record {
            n: self.n,
            t: Time(self.timestamp.sec.checked_mul(NANOS)?.checked_add(self.timestamp.nsec)?),
            causes: self.causes.into_owned(),
            event: match self.robot {
                Some(robot) => Event::Pose { robot, pose, path_m: self.path_m.unwrap_or_default() },
                None => Event::Mover { name: self.child_frame_id.into_owned(), pose },
            },
        })
    }
}

/// The scene as one `foxglove.SceneUpdate`: what stands in `map`, robots and movers in their own frames.
pub(crate) fn scene_update(scene: &Scene) -> Json {
    let mut entities = Vec::new();
    for (i, part) in scene.world.iter().enumerate() {
        // Entities are told apart by id; parts that stand alone have no name.
        let id = if part.name.is_empty() { format!("{}/{i}", part.role) } else { part.name.clone() };
        if let Some(body) = shape::mover_body(part) {
            let shape = Shape::Cylinder { at: [0.0; 3], radius: body.radius, height: body.height };
            entities.push(entity(&part.name, &id, primitives(&shape, [150, 150, 160], 0.9)));
        } else if let Some(shape) = shape::of_part(part) {
            let (color, alpha) = match &*part.role {
                "bounds" => ([225, 228, 232], 1.0),
                "region" => ([90, 180, 110], 0.35),
                "wall" => ([70, 75, 85], 1.0),
                _ => ([110, 115, 125], 1.0),
            };
            entities.push(entity("map", &id, primitives(&shape, color, alpha)));
        }
    }
    for (i, robot) in scene.robots.iter().enumerate() {
        let (body, color) = (shape::robot_body(scene, i), palette::robot(i));
        let shape = Shape::Cylinder { at: [0.0; 3], radius: body.radius, height: body.height };
        let mut parts = primitives(&shape, color, 0.9);
        parts.arrows.push(json!({
            "pose": pose([0.0, 0.0, body.height], 0.0),
            "shaft_length": body.radius,
            "shaft_diameter": 0.2 * body.radius,
            "head_length": 0.4 * body.radius,
            "head_diameter": 0.5 * body.radius,
            "color": rgba([30, 30, 35], 1.0),
        }));
        entities.push(entity(&robot_frame(&robot.name), &robot.name, parts));
        if let Some(at) = robot.target.filter(|t| t.iter().all(|x| x.is_finite())) {
            let shape = Shape::Cylinder { at, radius: body.radius / 2.0, height: 0.0 };
            entities.push(entity("map", &format!("{} target", robot.name), primitives(&shape, color, 0.6)));
        }
    }
    json!({ "deletions": [], "entities": entities })
}

#[derive(Default)]
struct Primitives {
    cubes: Vec<Json>,
    cylinders: Vec<Json>,
    arrows: Vec<Json>,
}

fn primitives(shape: &Shape, color: palette::Color, alpha: f64) -> Primitives {
    // Viewers do not draw bodies without height; a sheet has a tenth of a millimetre.
    let sheet = |height: f64| f64::max(height, 1e-4);
    let mut out = Primitives::default();
    match *shape {
        Shape::Cylinder { at: [x, y, z], radius, height } => out.cylinders.push(json!({
            "pose": pose([x, y, z + height / 2.0], 0.0),
            "size": { "x": 2.0 * radius, "y": 2.0 * radius, "z": sheet(height) },
            "bottom_scale": 1.0,
            "top_scale": 1.0,
            "color": rgba(color, alpha),
        })),
        Shape::Box { at: [x, y, z], size: [length, width, height], heading } => out.cubes.push(json!({
            "pose": pose([x, y, z + height / 2.0], heading),
            "size": { "x": length, "y": width, "z": sheet(height) },
            "color": rgba(color, alpha),
        })),
    }
    out
}

fn entity(frame: &str, id: &str, parts: Primitives) -> Json {
    json!({
        "timestamp": { "sec": 0, "nsec": 0 },
        "frame_id": frame,
        "id": id,
        "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": true,
        "metadata": [],
        "arrows": parts.arrows,
        "cubes": parts.cubes,
        "spheres": [],
        "cylinders": parts.cylinders,
        "lines": [],
        "triangles": [],
        "texts": [],
        "models": [],
    })
}

fn pose(at: [f64; 3], heading: f64) -> Json {
    let (sin, cos) = (libm::sin(heading / 2.0), libm::cos(heading / 2.0));
    json!({
        "position": { "x": at[0], "y": at[1], "z": at[2] },
        "orientation": { "x": 0.0, "y": 0.0, "z": sin, "w": cos },
    })
}

fn rgba(color: palette::Color, alpha: f64) -> Json {
    let [r, g, b] = color.map(|c| f64::from(c) / 255.0);
    json!({ "r": r, "g": g, "b": b, "a": alpha })
}
