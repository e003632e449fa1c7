//! Executes a behaviour graph, deterministically, in virtual time.
//!
//! Invariant: knows neither the language nor any robot; touches no file, clock or terminal.

pub mod arbitration;
pub mod engine;
pub mod mission;
pub mod nodes;
pub mod objects;
pub mod ports;
pub mod replay;
pub mod scene;
pub mod seed;
pub mod time;
pub mod trace;

pub use engine::{Engine, Outcome, RunReport, Snapshot};
pub use mission::{Mission, Settings};
pub use ports::{Input, Operation, Pacer, Platform, Reading, Readings, Report, WorldTruth};
pub use scene::Scene;
pub use time::Time;
pub use trace::{Event, NoTrace, Record, Thread, TraceSink};
