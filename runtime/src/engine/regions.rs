//! Regions of the world, by number: `inside(point, region)`.

use crate::Scene;
use soifra_graph::{Graph, Value, eval::FaultKind};

#[derive(Debug, Clone, Copy)]
enum Shape {
    Circle { center: [f64; 3], radius: f64 },
    Rectangle { low: [f64; 3], high: [f64; 3] },
}

/// Regions, numbered as the graph declares them; an array is the union of its members.
#[derive(Debug, Default)]
pub(crate) struct Regions(Vec<Vec<Shape>>);

impl Regions {
    pub fn new(graph: &Graph, scene: &Scene) -> Self {
        let regions = graph.world.iter().filter(|c| &*c.role == "region");
        Regions(
            regions
                .map(|c| {
                    let member = |name: &str| {
                        let rest = name.strip_prefix(&*c.name);
                        rest.is_some_and(|r| r.is_empty() || (c.count.is_some() && r.starts_with('[')))
                    };
                    let parts = scene.world.iter().filter(|p| &*p.role == "region" && member(&p.name));
                    parts
                        .filter_map(|p| {
                            let point = |name: &str| match p.args.get(name) {
                                Some(Value::Vector(v)) => Some(*v),
                                _ => None,
                            };
                            Some(match &*p.model {
                                "circle" => {
                                    Shape::Circle { center: point("at")?, radius: p.number("radius") }
                                }
                                _ => Shape::Rectangle { low: point("low")?, high: point("high")? },
                            })
                        })
                        .collect()
                })
                .collect(),
        )
    }

    /// Whether a point lies in region `number`, borders included; heights do not matter.
    pub fn inside(&self, [x, y, _]: [f64; 3], number: u32) -> Result<bool, FaultKind> {
        let shapes = self.0.get(number as usize).ok_or(FaultKind::Malformed)?;
        Ok(shapes.iter().any(|s| match *s {
            Shape::Circle { center: c, radius } => libm::hypot(x - c[0], y - c[1]) <= radius,
            Shape::Rectangle { low, high } => {
                let within = |x: f64, a: usize| low[a].min(high[a]) <= x && x <= low[a].max(high[a]);
                within(x, 0) && within(y, 1)
            }
        }))
    }
}
