//! The allocation of agents to tasks, against trying everything.

mod cost;
mod preference;
mod refusals;
mod repairs;
mod solve;
mod support;
