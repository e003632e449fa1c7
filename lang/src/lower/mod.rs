//! Declarations to the graph.

mod agent;
mod arbiter;
mod component;
mod function;
mod machine;
mod mission;
mod plan;
mod robot;
mod unit;

pub use mission::{Choice, lower};
