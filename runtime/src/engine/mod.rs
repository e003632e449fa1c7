//! The engine: runs a mission on a platform.

pub mod report;

use crate::{Mission, Platform, Scene, Settings, TraceSink};
pub use report::{Outcome, RunReport};
use soifra_graph::Diagnostic;
use std::sync::atomic::AtomicBool;

/// One run of a mission.
pub struct Engine<'m> {
    _mission: &'m Mission,
    _platform: &'m mut dyn Platform,
    _sink: &'m mut dyn TraceSink,
    _stop: &'m AtomicBool,
}

impl<'m> Engine<'m> {
    /// Prepares a run. `stop` is the operator's stop: once it is true, the run ends after the current
    /// instant with every robot's safe action.
    ///
    /// # Errors
    /// When an initial value, an argument or a duration cannot be computed.
    pub fn new(
        mission: &'m Mission,
        settings: &Settings,
        scene: &'m Scene,
        platform: &'m mut dyn Platform,
        sink: &'m mut dyn TraceSink,
        stop: &'m AtomicBool,
    ) -> Result<Engine<'m>, Diagnostic> {
        let _ = (settings, scene);
        Ok(Engine { _mission: mission, _platform: platform, _sink: sink, _stop: stop })
    }

    /// Runs to the end.
    pub fn run(self) -> RunReport {
        RunReport {
            mission: String::new(),
            seed: 0,
            outcome: Outcome::Aborted,
            reason: "the engine is being written".into(),
            sim_time_s: 0.0,
            collisions: 0,
            expectations: Vec::new(),
            goals: Vec::new(),
            robots: Vec::new(),
            metrics: std::collections::BTreeMap::new(),
            faults: Vec::new(),
        }
    }
}
