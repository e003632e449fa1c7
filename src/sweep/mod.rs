//! Sweeps: one mission over seeds, parameters and platforms. What is to be run is a plan; its runs are
//! independent and are put back in the plan's order, so that threads and shards change nothing.

pub mod document;
mod plan;
mod runs;

pub use document::{Document, summarise};
pub use plan::{Case, Plan, values};
pub use runs::execute;
