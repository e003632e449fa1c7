//! The integration tests, one binary: `tests/<area>/` are its modules.

mod agents;
mod bars;
mod camera;
mod cli;
mod corpus;
mod fuzz;
mod missions;
mod recording;
mod structure;
mod support;
mod timing;
mod trace;
