//! Are the materials of things declared? What is of no declared material would reflect like plaster, and
//! nobody would notice.

use crate::{code, decls};
use soifra_graph::{Diagnostic, Graph, Value};

/// The material of what names none; a world need not declare it.
const DEFAULT: &str = "plaster";

/// Checks every thing of the world.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let known: Vec<&str> =
        g.world.iter().filter(|c| &*c.role == "material").map(|c| &*c.name).chain([DEFAULT]).collect();
    let named = g.world.iter().flat_map(|c| &c.args).filter(|(name, _)| &**name == "material");
    named
        .filter_map(|(_, e)| match e.as_const() {
            Some(Value::Text(name)) if !known.contains(&&**name) => {
                Some(decls::unknown(code::UNKNOWN_NAME, "material", name, e.span, known.iter().copied()))
            }
            _ => None,
        })
        .collect()
}
