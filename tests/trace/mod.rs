//! Trace files: what is written is read back, whatever happens to the file.

mod file;
mod fuzz;
mod plot;
mod sample;
mod snapshots;
mod viewers;
