//! Do robots stand in one another, or outside the bounds, at the start?

use crate::code;
use soifra_graph::{Component, Diagnostic, Expr, Graph, Span, Texts, Type, Value, eval};

/// A body on the ground: name, centre, radius, place.
struct Body {
    name: String,
    at: [f64; 2],
    radius: f64,
    span: Span,
}

/// Most robots of one mission that are compared.
const MOST: usize = 2000;

/// Checks declared starts with parameters at their defaults; what is drawn is not known yet.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut texts = g.texts.clone();
    let params: Vec<(Type, Value)> = g.params.iter().map(|p| (p.ty.clone(), p.default.clone())).collect();
    let mut bodies: Vec<Body> = Vec::new();
    for r in &g.robots {
        let Some(radius) = g.platforms.get(r.platform as usize).and_then(|p| p.of_role("body").next()).and_then(|c| number(g, c, "radius", &params, &mut texts)) else {
            continue;
        };
        let count = match &r.count {
            Some(c) => match value(g, c, 0, &params, &mut texts) {
                Some(Value::Int(n)) => usize::try_from(n).unwrap_or(0),
                _ => continue,
            },
            None => 1,
        };
        if bodies.len() + count > MOST {
            return Vec::new();
        }
        for i in 0..count {
            if let Some(Value::Pose(p)) = value(g, &r.start, i as i64, &params, &mut texts) {
                let name = if r.count.is_some() { format!("{}[{i}]", r.name) } else { r.name.to_string() };
                bodies.push(Body { name, at: [p[0], p[1]], radius, span: r.start.span });
            }
        }
    }
    let mut out = Vec::new();
    // Sorted by their left edge, so that only neighbours are compared.
    bodies.sort_by(|a, b| (a.at[0] - a.radius).total_cmp(&(b.at[0] - b.radius)));
    for (i, a) in bodies.iter().enumerate() {
        for b in bodies[i + 1..].iter().take_while(|b| b.at[0] - b.radius < a.at[0] + a.radius) {
            let gap = libm::hypot(a.at[0] - b.at[0], a.at[1] - b.at[1]) - a.radius - b.radius;
            if gap < 0.0 {
                let (a, b) = if a.span <= b.span { (a, b) } else { (b, a) };
                out.push(
                    Diagnostic::error(code::PLACEMENT, format!("`{}` and `{}` stand in each other at the start", a.name, b.name))
                        .at(b.span, format!("`{}` overlaps by {:.4} m", b.name, -gap))
                        .at(a.span, format!("`{}` stands here", a.name))
                        .hint("move one of them"),
                );
                break;
            }
        }
        if out.len() > 8 {
            break;
        }
    }
    out
}

fn number(g: &Graph, c: &Component, name: &str, params: &[(Type, Value)], texts: &mut Texts) -> Option<f64> {
    let (_, e) = c.args.iter().find(|(n, _)| &**n == name)?;
    value(g, e, 0, params, texts)?.number()
}

/// The value of a scene expression, when it does not depend on draws.
fn value(g: &Graph, e: &Expr, index: i64, params: &[(Type, Value)], texts: &mut Texts) -> Option<Value> {
    if let Some(v) = e.as_const() {
        return Some(v.clone());
    }
    let mut locals: Vec<(Type, Option<Value>)> = e.local_types(&[Type::Int]).into_iter().map(|t| (t, None)).collect();
    locals[0].1 = Some(Value::Int(index));
    let known = eval::Known { types: &g.types, functions: &g.functions, params, locals: &locals };
    eval::constant(e, &known, texts).ok()
}
