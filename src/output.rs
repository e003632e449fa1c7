//! Standard output and standard error: who may write there, and what a closed pipe means.
//!
//! Standard output carries results only: text for a person, or exactly one JSON document. Everything
//! else goes to standard error. A reader that goes away (`soifra … | head`) is no error.

use crate::exit::Exit;
use clap::ValueEnum;
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// What a command prints on standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Format {
    /// Tables and sentences
    #[default]
    Human,
    /// One JSON document
    Json,
}

/// Version of the JSON documents; readers refuse others.
pub const SCHEMA: u32 = 1;

/// Writes text to standard output. A closed pipe counts as written.
pub fn print(text: &str) -> Result<(), Exit> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            note(&format!("error[S9013]: standard output cannot be written: {e}"));
            Err(Exit::Aborted)
        }
        _ => Ok(()),
    }
}

/// Writes one JSON document to standard output. Numbers that are not finite become `null`.
pub fn print_json(document: &impl Serialize) -> Result<(), Exit> {
    match serde_json::to_string_pretty(document) {
        Ok(text) => print(&(text + "\n")),
        Err(e) => {
            note(&format!("error[S9999]: the JSON document cannot be made: {e}"));
            Err(Exit::Internal)
        }
    }
}

/// Writes a line to standard error; nobody is told when that fails.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}
