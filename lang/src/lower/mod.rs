//! Declarations to the graph.

mod agent;
mod arbiter;
mod component;
mod conversation;
mod declarations;
mod function;
mod goals;
mod judgement;
mod machine;
mod mission;
mod plan;
mod robot;
mod unit;

pub use mission::{Choice, lower};
