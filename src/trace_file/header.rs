//! The header of a trace: everything the run was a function of, besides the readings.

use super::{SCHEMA, TraceError, shape};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use soifra_graph::{Param, Type, Value};
use soifra_runtime::Scene;
use std::collections::BTreeMap;

/// What a trace begins with.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Mission name.
    pub mission: String,
    /// Mission title; empty when it has none.
    pub title: String,
    /// Versions of what made the run, as `soifra: 0.1.0`.
    pub versions: BTreeMap<String, String>,
    /// Parameters as the run began, all of them.
    pub params: BTreeMap<String, Value>,
    /// The evaluated scene: seed, world, platforms, robots with their starts and targets.
    pub scene: Scene,
    /// The graph with its source spans, as JSON text.
    pub graph_json: String,
}

/// A robot as the header knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot<'a> {
    /// Name.
    pub name: &'a str,
    /// Name of its platform.
    pub platform: &'a str,
    /// Radius of its body in metres, 0 when its platform declares none.
    pub radius: f64,
}

impl Header {
    /// The run's seed.
    pub fn seed(&self) -> u64 {
        self.scene.seed
    }

    /// The robots, by index.
    pub fn robots(&self) -> impl Iterator<Item = Robot<'_>> {
        self.scene.bodies().iter().enumerate().map(|(i, r)| Robot {
            name: &r.name,
            platform: self.scene.platforms.get(r.platform as usize).map_or("", |p| &*p.name),
            radius: shape::robot_body(&self.scene, i).radius,
        })
    }

    /// Parameters that were given another value than their default, as `rules=safe`; numbers in SI units.
    pub fn params_set(&self) -> Vec<String> {
        #[derive(Deserialize)]
        struct Graph {
            params: Vec<Param>,
        }
        let Ok(graph) = serde_json::from_str::<Graph>(&self.graph_json) else { return Vec::new() };
        let set = graph.params.iter().filter_map(|p| {
            let value = self.params.get(&*p.name).filter(|v| **v != p.default)?;
            Some(format!("{}={}", p.name, written(value, &p.ty)))
        });
        set.collect()
    }

    /// The message that carries it. An error means that `graph_json` is no JSON.
    pub(crate) fn to_message(&self) -> serde_json::Result<Vec<u8>> {
        serde_json::to_vec(&Written {
            schema: SCHEMA,
            mission: &self.mission,
            title: &self.title,
            versions: &self.versions,
            params: &self.params,
            scene: &self.scene,
            graph: serde_json::from_str(&self.graph_json)?,
        })
    }

    /// Back from its message, which lies at byte `at` of the file.
    pub(crate) fn from_message(data: &[u8], at: u64) -> Result<Header, TraceError> {
        let damaged = |e: serde_json::Error| TraceError::Damaged { at, what: format!("its header: {e}") };
        // The version first, by itself: another version's header may have other members.
        let Version { schema } = serde_json::from_slice(data).map_err(damaged)?;
        if schema != u64::from(SCHEMA) {
            return Err(TraceError::Schema(schema));
        }
        let read: Read = serde_json::from_slice(data).map_err(damaged)?;
        Ok(Header {
            mission: read.mission,
            title: read.title,
            versions: read.versions,
            params: read.params,
            scene: read.scene,
            graph_json: read.graph.get().to_string(),
        })
    }
}

fn written(value: &Value, ty: &Type) -> String {
    match (value, ty) {
        (Value::Bool(b), _) => b.to_string(),
        (Value::Int(i), _) => i.to_string(),
        (Value::Number(x), Type::Quantity(d)) => format!("{x} {}", d.si_unit()).trim_end().to_string(),
        (Value::Variant(name), _) => name.to_string(),
        (Value::Text(text), _) => format!("{text:?}"),
        _ => "…".to_string(),
    }
}

#[derive(Serialize)]
struct Written<'a> {
    schema: u32,
    mission: &'a str,
    title: &'a str,
    versions: &'a BTreeMap<String, String>,
    params: &'a BTreeMap<String, Value>,
    scene: &'a Scene,
    graph: &'a RawValue,
}

#[derive(Deserialize)]
struct Version {
    schema: u64,
}

#[derive(Deserialize)]
struct Read {
    mission: String,
    title: String,
    versions: BTreeMap<String, String>,
    params: BTreeMap<String, Value>,
    scene: Scene,
    graph: Box<RawValue>,
}
