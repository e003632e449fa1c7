//! A map as an object: its grid, and the distances in it once somebody has asked for them.

use soifra_graph::Value;
use soifra_mapping::{
    Beam, Field, Grid, Hits, Layout, Place, Why,
    hits::Blurred,
    matching::{Matching, Near, match_scan},
    observe::observe,
    shape::Shape,
};
use soifra_runtime::{objects::Object, scene::Part};
use std::{any::Any, sync::OnceLock};

/// Deviation of the end of a beam from what it met, m, and of the pose from which it was sent.
const BLUR: f64 = 0.02;

/// A map.
#[derive(Debug)]
pub struct Map {
    /// What is where.
    pub grid: Grid,
    field: OnceLock<Field>,
    /// Where beams have ended, on a map that is made from nothing.
    hits: Option<Hits>,
    blurred: OnceLock<Blurred>,
}

impl Object for Map {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl Map {
    /// Of a grid.
    pub fn new(grid: Grid) -> Map {
        Map { grid, field: OnceLock::new(), hits: None, blurred: OnceLock::new() }
    }

    /// Of which nothing is known.
    pub fn empty(low: [f64; 2], high: [f64; 2], resolution: f64) -> Result<Map, Why> {
        let layout = Layout::covering(low, high, resolution)?;
        Ok(Map { hits: Some(Hits::none(layout)), ..Map::new(Grid::unknown(layout)) })
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

    /// With a scan from a pose, as far as `reach`, m.
    pub fn with(&self, at: Place, scan: &[Beam], reach: f64) -> Map {
        let hits = self.hits.as_ref().map(|h| h.with(at, scan, reach));
        Map { hits, ..Map::new(observe(&self.grid, at, scan, reach)) }
    }

    /// Where a scan fits best: to where beams have ended, or, on a map that was known, to what is occupied.
    pub fn fit(&self, scan: &[Beam], guess: Place, how: &Matching) -> Result<Place, Why> {
        match &self.hits {
            Some(hits) => match_scan(self.blurred.get_or_init(|| hits.blurred(BLUR)), scan, guess, how),
            None => match_scan(&Near::new(self.field()), scan, guess, how),
        }
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
