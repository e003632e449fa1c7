//! Trace files: what is written is read back, whatever happens to the file.

mod file;
mod fuzz;
mod gantt;
mod plot;
mod sample;
mod sequence;
mod snapshots;
mod viewers;
mod well_formed;
