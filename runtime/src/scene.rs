//! A scene: the graph's world, platforms and robots with every expression evaluated for one seed and
//! one set of parameters. What the platforms are built from.

use crate::time::Time;
use serde::{Deserialize, Serialize};
use soifra_graph::{Name, Type, Value};
use std::{collections::BTreeMap, sync::Arc};

/// Everything that stands, moves or drives, as values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The run's seed; platforms derive their noise streams from it.
    pub seed: u64,
    /// Step of the step clock, if there is one.
    pub step: Option<Time>,
    /// World components; arrays are expanded (`block[0]`, `block[1]`).
    pub world: Vec<Part>,
    /// Platforms, by index.
    pub platforms: Vec<PlatformScene>,
    /// Robots, then hosts; groups are expanded.
    pub robots: Vec<RobotScene>,
    /// What goes wrong on purpose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Part>,
    /// Image files that materials of the world name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<ImageFile>,
}

/// An image file that a material of a world names. Whoever opens files reads it; a trace knows it by its digest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ImageFile {
    /// As materials name it: from the folder of the mission.
    pub name: String,
    /// Where it lies, from the folder in which the run was started.
    pub path: String,
    /// Of its size and pixels, as of the images of a camera, in hexadecimal.
    pub digest: String,
    /// What is in it; nothing as long as nobody has read it.
    #[serde(skip)]
    pub pixels: Option<Arc<Pixels>>,
}

/// An image as RGB, 8 bits each.
#[derive(Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the upper left.
    pub data: Vec<u8>,
}

/// A component with its arguments as values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Role, as `sensor`.
    pub role: Name,
    /// Name; empty for roles that stand alone.
    pub name: String,
    /// Model, as `infrared`.
    pub model: Name,
    /// Arguments by parameter name; optionals are `Value::Some` or `Value::None`.
    pub args: BTreeMap<Name, Value>,
    /// Type of a reading or command.
    pub ty: Option<Type>,
}

/// A platform's parts, in declaration order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlatformScene {
    /// Profile name.
    pub name: Name,
    /// Parts.
    pub parts: Vec<Part>,
}

impl PlatformScene {
    /// The parts of a role, in order; sensors and actuators are numbered so.
    pub fn of_role<'a>(&'a self, role: &'a str) -> impl Iterator<Item = &'a Part> {
        self.parts.iter().filter(move |p| &*p.role == role)
    }
}

/// A robot, or a host.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotScene {
    /// Name; members of arrays are `swarm[3]`.
    pub name: String,
    /// Index of its group in the graph.
    pub group: u32,
    /// Index of its platform.
    pub platform: u32,
    /// Declared start pose in `map`, without scatter.
    pub declared_start: [f64; 7],
    /// Start pose with this seed's scatter.
    pub start: [f64; 7],
    /// Target in `map`.
    pub target: Option<[f64; 3]>,
    /// Which of its platform's sensors somebody reads, by sensor index; others need not be simulated.
    pub consumed: Vec<bool>,
    /// A host: it has no body. Hosts come after robots.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub host: bool,
}

impl Scene {
    /// Robots with a body.
    pub fn bodies(&self) -> &[RobotScene] {
        &self.robots[..self.robots.partition_point(|r| !r.host)]
    }
}

impl Part {
    /// A number in SI units, 0 when the argument is missing.
    pub fn number(&self, name: &str) -> f64 {
        self.args.get(name).and_then(Value::number).unwrap_or(0.0)
    }

    /// An optional number: `None` when it was not given.
    pub fn optional(&self, name: &str) -> Option<f64> {
        match self.args.get(name) {
            Some(Value::Some(v)) => v.number(),
            Some(v) => v.number(),
            None => None,
        }
    }
}
