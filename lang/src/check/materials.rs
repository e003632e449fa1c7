//! Are the materials of things declared? What is of no declared material would reflect like plaster, and
//! nobody would notice.

use crate::{code, decls};
use soifra_graph::{Diagnostic, Graph, Value, component::TEXTURES};

/// Checks every thing of the world.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let declared = g.world.iter().filter(|c| &*c.role == "material");
    // What is called as a pattern is one; a world need not declare it.
    let known: Vec<&str> = declared.clone().map(|c| &*c.name).chain(TEXTURES.iter().copied()).collect();
    let named = g.world.iter().flat_map(|c| &c.args).filter(|(name, _)| &**name == "material");
    let patterns = declared.flat_map(|c| &c.args).filter(|(name, _)| &**name == "texture");
    let unknown = patterns.filter_map(|(_, e)| match e.as_const() {
        Some(Value::Text(name)) if !TEXTURES.contains(&&**name) => {
            Some(decls::unknown(code::UNKNOWN_NAME, "texture", name, e.span, TEXTURES.iter().copied()))
        }
        _ => None,
    });
    named
        .filter_map(|(_, e)| match e.as_const() {
            Some(Value::Text(name)) if !known.contains(&&**name) => {
                Some(decls::unknown(code::UNKNOWN_NAME, "material", name, e.span, known.iter().copied()))
            }
            _ => None,
        })
        .chain(unknown)
        .collect()
}
