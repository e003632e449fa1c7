//! Do robots stand in one another, or in things, at the start?

use super::constants::Constants;
use crate::code;
use soifra_graph::{Component, Diagnostic, Graph, Span, Value};

/// A body on the ground: name, centre, height above it, radius, place.
struct Body {
    name: String,
    at: [f64; 2],
    above: f64,
    radius: f64,
    span: Span,
}

/// Something that stands still.
struct Thing {
    name: String,
    /// Centre, half the length and width along its own axes, rounding of the corners.
    at: [f64; 2],
    half: [f64; 2],
    heading: f64,
    round: f64,
    height: f64,
    span: Span,
}

/// Most robots of one mission that are compared.
const MOST: usize = 2000;
/// Most pairs of robots and things that are compared.
const PAIRS: usize = 1_000_000;
/// Reports enough to see what is wrong.
const REPORTS: usize = 8;

/// Checks declared starts with parameters at their defaults; what is drawn is not known yet.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut known = Constants::new(g);
    let Some(bodies) = bodies(g, &mut known) else { return Vec::new() };
    let mut out = among(&bodies);
    let things: Vec<Thing> = g.world.iter().flat_map(|c| things(c, &mut known)).collect();
    if things.len().saturating_mul(bodies.len()) > PAIRS {
        return out;
    }
    for b in &bodies {
        let Some((t, depth)) = things.iter().filter_map(|t| Some((t, t.overlap(b)?))).next() else {
            continue;
        };
        if out.len() >= REPORTS {
            break;
        }
        out.push(
            Diagnostic::error(code::PLACEMENT, format!("`{}` stands in `{}` at the start", b.name, t.name))
                .at(b.span, format!("`{}` overlaps by {depth:.4} m", b.name))
                .at(t.span, format!("`{}` stands here", t.name))
                .hint("move one of them; a start is where the centre of the robot is"),
        );
    }
    out
}

/// The robots; `None` when there are too many.
fn bodies(g: &Graph, known: &mut Constants<'_>) -> Option<Vec<Body>> {
    let mut out: Vec<Body> = Vec::new();
    for r in g.bodies() {
        let body = g.platforms.get(r.platform as usize).and_then(|p| p.of_role("body").next());
        let Some(radius) = body.and_then(|c| number(c, "radius", known, 0)) else { continue };
        let Some(count) = known.count(r.count.as_ref()) else { continue };
        if count > MOST || out.len() + count > MOST {
            return None;
        }
        for i in 0..count {
            if let Some(Value::Pose(p)) = known.value(&r.start, i as i64) {
                let name = if r.count.is_some() { format!("{}[{i}]", r.name) } else { r.name.to_string() };
                out.push(Body { name, at: [p[0], p[1]], above: p[2], radius, span: r.start.span });
            }
        }
    }
    // Sorted by their left edge, so that only neighbours are compared.
    out.sort_by(|a, b| (a.at[0] - a.radius).total_cmp(&(b.at[0] - b.radius)));
    Some(out)
}

/// Robots against robots.
fn among(bodies: &[Body]) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for (i, a) in bodies.iter().enumerate() {
        for b in bodies[i + 1..].iter().take_while(|b| b.at[0] - b.radius < a.at[0] + a.radius) {
            let gap = libm::hypot(a.at[0] - b.at[0], a.at[1] - b.at[1]) - a.radius - b.radius;
            if gap < 0.0 {
                let (a, b) = if a.span <= b.span { (a, b) } else { (b, a) };
                out.push(
                    Diagnostic::error(
                        code::PLACEMENT,
                        format!("`{}` and `{}` stand in each other at the start", a.name, b.name),
                    )
                    .at(b.span, format!("`{}` overlaps by {:.4} m", b.name, -gap))
                    .at(a.span, format!("`{}` stands here", a.name))
                    .hint("move one of them; a start is where the centre of the robot is"),
                );
                break;
            }
        }
        if out.len() >= REPORTS {
            break;
        }
    }
    out
}

/// The walls and obstacles that a declaration stands for, and wanderers where they begin.
fn things(c: &Component, known: &mut Constants<'_>) -> Vec<Thing> {
    if !matches!(&*c.role, "wall" | "obstacle" | "mover") {
        return Vec::new();
    }
    let count = known.count(c.count.as_ref()).unwrap_or(0).min(MOST);
    (0..count).filter_map(|i| thing(c, known, i as i64)).collect()
}

fn thing(c: &Component, known: &mut Constants<'_>, index: i64) -> Option<Thing> {
    let name = if c.count.is_some() { format!("{}[{index}]", c.name) } else { c.name.to_string() };
    let height = number(c, "height", known, index);
    let (at, half, heading, round, height) = match &*c.model {
        "segment" => {
            let (a, b) = (point(c, "from", known, index)?, point(c, "to", known, index)?);
            let way = [b[0] - a[0], b[1] - a[1]];
            let half = [libm::hypot(way[0], way[1]) / 2.0, number(c, "thickness", known, index)? / 2.0];
            ([a[0] + way[0] / 2.0, a[1] + way[1] / 2.0], half, libm::atan2(way[1], way[0]), 0.0, height?)
        }
        "box" => {
            let (at, size) = (point(c, "at", known, index)?, point(c, "size", known, index)?);
            let heading = number(c, "heading", known, index)?;
            ([at[0], at[1]], [size[0] / 2.0, size[1] / 2.0], heading, 0.0, size[2])
        }
        "cylinder" | "wanderer" => {
            let at = point(c, "at", known, index)?;
            ([at[0], at[1]], [0.0; 2], 0.0, number(c, "radius", known, index)?, height?)
        }
        _ => return None,
    };
    Some(Thing { name, at, half, heading, round, height, span: c.at })
}

impl Thing {
    /// How deep a body stands in it, if it does.
    fn overlap(&self, b: &Body) -> Option<f64> {
        if b.above >= self.height {
            return None;
        }
        let (dx, dy) = (b.at[0] - self.at[0], b.at[1] - self.at[1]);
        let (sin, cos) = (libm::sin(self.heading), libm::cos(self.heading));
        // In its own axes, how far beyond each side.
        let beyond = [(dx * cos + dy * sin).abs() - self.half[0], (dy * cos - dx * sin).abs() - self.half[1]];
        let outside = libm::hypot(beyond[0].max(0.0), beyond[1].max(0.0));
        let inside = beyond[0].max(beyond[1]).min(0.0);
        let gap = outside + inside - self.round - b.radius;
        (gap < 0.0).then_some(-gap)
    }
}

fn argument<'a>(c: &'a Component, name: &str) -> Option<&'a soifra_graph::Expr> {
    c.args.iter().find(|(n, _)| &**n == name).map(|(_, e)| e)
}

fn number(c: &Component, name: &str, known: &mut Constants<'_>, index: i64) -> Option<f64> {
    known.number(argument(c, name)?, index)
}

fn point(c: &Component, name: &str, known: &mut Constants<'_>, index: i64) -> Option<[f64; 3]> {
    match known.value(argument(c, name)?, index)? {
        Value::Vector(v) => Some(v),
        _ => None,
    }
}
