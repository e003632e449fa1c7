//! A mission that is ready to run: the graph with all its code compiled.

use crate::Scene;
use soifra_graph::{Diagnostic, Graph, Value};
use std::collections::BTreeMap;

/// What a run is a function of, besides the graph and recorded inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Seed of all randomness.
    pub seed: u64,
    /// Parameters that differ from their defaults, of their declared types.
    pub params: BTreeMap<String, Value>,
    /// Threads that evaluate large batches; changes nothing but the speed.
    pub threads: usize,
}

/// A loaded graph.
pub struct Mission {
    pub(crate) graph: Graph,
}

impl Mission {
    /// Compiles all code of a graph.
    ///
    /// # Errors
    /// Everything that does not fit together in a graph that was not written by the checker.
    pub fn load(graph: Graph) -> Result<Mission, Vec<Diagnostic>> {
        Ok(Mission { graph })
    }

    /// The graph.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// World, platforms and robots for one seed and one set of parameters.
    ///
    /// # Errors
    /// A parameter that does not exist or has another type, or an expression that cannot be computed.
    pub fn scene(&self, settings: &Settings) -> Result<Scene, Diagnostic> {
        let _ = settings;
        Err(Diagnostic::error("S0900", "the engine is being written"))
    }
}
