//! Ratios that the benches measured, as a table.

use crate::{
    files,
    report::{Refusal, table::figure},
};
use serde::Deserialize;
use std::{fmt::Write, fs};

/// What a bench writes: a ratio to a reference that was measured in the same run.
#[derive(Debug, Deserialize)]
struct Ratio {
    name: String,
    what: String,
    ratio: f64,
    /// The most it may be; none when it is only reported.
    bar: Option<f64>,
    held: Option<bool>,
}

/// The ratios in `folder` as Markdown; a word on how to get them when there are none.
pub fn markdown(folder: &str) -> Result<String, Refusal> {
    let mut paths: Vec<_> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|e| Some(e.ok()?.path().to_string_lossy().into_owned()))
        .filter(|p| p.ends_with(".json"))
        .collect();
    paths.sort();
    let mut s = String::from("### Speed\n\n");
    if paths.is_empty() {
        return Ok(s + "Not measured; `make bench` does it.\n\n");
    }
    s += "Each against a reference measured in the same run: machines are noisy, ratios less so. `make bench`.\n\n";
    s += "| bench | what | ratio | bar | |\n|---|---|---|---|---|\n";
    for path in &paths {
        let ratio: Result<Ratio, _> = serde_json::from_str(&files::read_text(path)?);
        let r = ratio.map_err(|e| {
            Refusal::about(path, "S9005", "the file cannot be read", e.to_string(), "run `make bench` again")
        })?;
        let met = match r.held {
            Some(true) => "met",
            Some(false) => "**missed**",
            None => "",
        };
        let bar = r.bar.map_or(String::new(), |b| format!("≤ {}", figure(Some(b))));
        let _ = writeln!(s, "| {} | {} | {} | {bar} | {met} |", r.name, r.what, figure(Some(r.ratio)));
    }
    Ok(s + "\n")
}
