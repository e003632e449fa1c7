//! The commands, one file each.

pub mod check;
pub mod completions;
pub mod explain;
pub mod fmt;
pub mod graph;
pub mod log;
pub mod measure;
pub mod plot;
pub mod replay;
pub mod run;
pub mod sweep;
pub mod test;
