//! The shell around the language and the runtime: reads arguments, opens files, draws on the terminal.
//! Everything below it is pure or talks through traits.

pub mod bars;
mod bench_ratios;
pub mod cli;
pub mod codes;
pub mod commands;
pub mod compile;
pub mod execute;
pub mod exit;
pub mod files;
pub mod fuzz;
pub mod golden;
pub mod graph_file;
pub mod graph_view;
pub mod image_files;
pub mod interrupt;
mod last_resort;
mod mermaid;
pub mod output;
pub mod plot;
pub mod realtime;
pub mod recording;
pub mod relative;
pub mod report;
pub mod seeds;
mod services;
pub mod statistics;
pub mod sweep;
pub mod trace_file;
pub mod wall_clock;

use std::process::ExitCode;

/// The program.
pub fn main() -> ExitCode {
    let arguments = std::env::args_os().collect();
    last_resort::guarded(move || cli::run(arguments)).into()
}
