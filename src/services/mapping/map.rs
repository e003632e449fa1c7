//! A map as an object: its grid, and the distances in it once somebody has asked for them.

use soifra_graph::Value;
use soifra_mapping::{Field, Grid, Layout, Why, shape::Shape};
use soifra_runtime::{objects::Object, scene::Part};
use std::{any::Any, sync::OnceLock};

/// A map.
#[derive(Debug)]
pub struct Map {
    /// What is where.
    pub grid: Grid,
    field: OnceLock<Field>,
}

impl Object for Map {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl Map {
    /// Of a grid.
    pub fn new(grid: Grid) -> Map {
        Map { grid, field: OnceLock::new() }
    }

    /// Of which nothing is known.
    pub fn empty(low: [f64; 2], high: [f64; 2], resolution: f64) -> Result<Map, Why> {
        Ok(Map::new(Grid::unknown(Layout::covering(low, high, resolution)?)))
    }

    /// Of walls and obstacles, over the bounds.
    pub fn known(parts: &[&Part], resolution: f64) -> Result<Map, Why> {
        let bounds = parts.iter().find(|p| &*p.role == "bounds").ok_or(Why::NoBounds)?;
        let (low, high) = (point(bounds, "low"), point(bounds, "high"));
        let (Some(low), Some(high)) = (low, high) else { return Err(Why::NoBounds) };
        let layout = Layout::covering(low, high, resolution)?;
        let shapes: Vec<Shape> = parts.iter().filter_map(|p| shape(p)).collect();
        Ok(Map::new(Grid::known(layout, &shapes)))
    }

    /// How far from each cell the nearest occupied one is.
    pub fn field(&self) -> &Field {
        self.field.get_or_init(|| Field::of(&self.grid))
    }
}

/// The footprint of a thing.
fn shape(part: &Part) -> Option<Shape> {
    Some(match (&*part.role, &*part.model) {
        ("wall", "segment") => {
            Shape::wall(point(part, "from")?, point(part, "to")?, part.number("thickness"))
        }
        ("obstacle", "cylinder") => Shape::Disc { at: point(part, "at")?, radius: part.number("radius") },
        ("obstacle", "box") => Shape::block(point(part, "at")?, point(part, "size")?, part.number("heading")),
        _ => return None,
    })
}

fn point(part: &Part, name: &str) -> Option<[f64; 2]> {
    match part.args.get(name) {
        Some(Value::Vector([x, y, _])) => Some([*x, *y]),
        _ => None,
    }
}
