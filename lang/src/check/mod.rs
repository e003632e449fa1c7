//! What can be known before anything moves: checks on the graph, one file for each question. They run on
//! graphs from sources and from files alike.

pub mod walk;

use soifra_graph::{Diagnostic, Graph};

/// All checks.
pub fn verify(graph: &Graph) -> Vec<Diagnostic> {
    let _ = graph;
    Vec::new()
}
