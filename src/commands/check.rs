//! `soifra check`: compiles missions and tells everything that was found.

use crate::{
    compile,
    exit::Exit,
    output::{self, Format},
    report::{
        JsonDiagnostic, Refusal,
        matrix::{self, Cell},
        timing::{JsonTiming, timing},
    },
};
use clap::{Args, ValueEnum, ValueHint};
use serde::Serialize;
use soifra_lang::CheckOptions;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Mission sources (.soi) or behaviour graphs (.yaml, .json)
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    files: Vec<String>,
    /// Check every robot on this platform profile
    #[arg(long, value_name = "PROFILE")]
    platform: Option<String>,
    /// Make these findings count as errors
    #[arg(long, value_enum, value_name = "WHAT")]
    deny: Option<Deny>,
    /// Print what is asked of each core, and the longest response times
    #[arg(long)]
    timing: bool,
    /// Print which missions work on which platforms, and why not
    #[arg(long)]
    matrix: bool,
    /// What to print on standard output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Deny {
    /// Every warning
    Warnings,
}

#[derive(Serialize)]
struct Document {
    schema: u32,
    outcome: &'static str,
    errors: usize,
    warnings: usize,
    files: Vec<File>,
    diagnostics: Vec<JsonDiagnostic>,
}

#[derive(Serialize)]
struct File {
    path: String,
    sound: bool,
    mission: Option<String>,
    missions: Vec<String>,
    graph_digest: Option<String>,
    errors: usize,
    warnings: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    timing: Option<Vec<JsonTiming>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    matrix: Option<Vec<Cell>>,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let mut document = Document {
        schema: output::SCHEMA,
        outcome: "success",
        errors: 0,
        warnings: 0,
        files: Vec::new(),
        diagnostics: Vec::new(),
    };
    let mut tables: Vec<String> = Vec::new();
    for path in &a.files {
        let options =
            CheckOptions { platform: a.platform.clone(), timing: a.timing, ..CheckOptions::default() };
        let mut timings = Vec::new();
        let (findings, sound, graph, missions) = match compile::check_with(path, &options, &mut timings) {
            Ok(c) => (c.findings, true, c.graph, c.missions),
            Err(r) => (r.findings, false, None, Vec::new()),
        };
        findings.print();
        if !findings.diagnostics.is_empty() {
            output::note(&format!("{path}: {}", findings.count()));
        }
        let cells = if a.matrix { matrix::cells(path)? } else { Vec::new() };
        let digest = graph.as_ref().filter(|_| a.format == Format::Json).map(crate::graph_file::digest);
        let mission = graph.map(|g| g.name.to_string());
        document.errors += findings.errors();
        document.warnings += findings.warnings();
        document.diagnostics.extend(findings.to_json());
        let (errors, warnings) = (findings.errors(), findings.warnings());
        document.files.push(File {
            path: path.clone(),
            sound,
            mission,
            missions,
            graph_digest: digest,
            errors,
            warnings,
            matrix: a.matrix.then(|| cells.clone()),
            timing: a.timing.then(|| timings.iter().map(|(m, t)| JsonTiming::new(m, t)).collect()),
        });
        tables.extend(a.matrix.then(|| matrix::table(&cells)));
        tables.extend(timings.iter().map(|(m, t)| timing(m, t)));
    }
    let denied = a.deny == Some(Deny::Warnings) && document.warnings > 0;
    let refused = denied || document.files.iter().any(|f| !f.sound);
    if refused {
        document.outcome = "refused";
    }
    match a.format {
        Format::Json => output::print_json(&document)?,
        Format::Human if !refused => output::print(&format!("{}{}", passed(&document), tables.concat()))?,
        Format::Human => output::print(&tables.concat())?,
    }
    Ok(if refused { Exit::WrongInput } else { Exit::Success })
}

fn passed(d: &Document) -> String {
    let line = |f: &File| match f.missions.as_slice() {
        [] => format!("{}: sound; no mission in it\n", f.path),
        [one] => format!("{}: mission `{one}` is sound\n", f.path),
        several => format!("{}: missions `{}` are sound\n", f.path, several.join("`, `")),
    };
    d.files.iter().map(line).collect()
}
