//! `soifra test`: the `test` blocks and goldens of missions.

use crate::{
    compile, execute,
    exit::Exit,
    files,
    golden::{Gatherer, Golden},
    graph_file, interrupt,
    output::{self, Format},
    report::{Findings, Refusal},
};
use clap::{Args, ValueHint};
use rayon::prelude::*;
use serde::Serialize;
use soifra_graph::{Binary, Diagnostic, Span, Value, span::Source};
use soifra_lang::TestCase;
use soifra_runtime::{Mission, RunReport};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Arguments.
#[derive(Debug, Args)]
#[command(
    after_help = "A golden is the accepted run of a mission with seed 1 and its default parameters; it lies in the folder `golden` beside the mission."
)]
pub struct Arguments {
    /// Mission sources, or folders of them
    #[arg(default_value = "missions", value_hint = ValueHint::AnyPath)]
    paths: Vec<String>,
    /// Accept how the missions run now: write their goldens
    #[arg(long)]
    accept: bool,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// What to print on standard output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

#[derive(Serialize)]
struct Document {
    schema: u32,
    outcome: &'static str,
    passed: usize,
    failed: usize,
    tests: Vec<Entry>,
}

/// What became of a test or golden.
#[derive(Serialize)]
struct Entry {
    path: String,
    name: String,
    passed: bool,
    /// What is wrong, one line each.
    failures: Vec<String>,
    #[serde(skip)]
    exit: Exit,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    interrupt::flag();
    let mut sources = Vec::new();
    for path in &a.paths {
        gather(Path::new(path), &mut sources)?;
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(execute::threads(a.threads))
        .stack_size(16 << 20)
        .build()
        .ok();
    let mut document =
        Document { schema: output::SCHEMA, outcome: "success", passed: 0, failed: 0, tests: Vec::new() };
    let mut worst = Exit::Success;
    for path in &sources {
        let path = path.to_string_lossy();
        match file(&path, a, pool.as_ref()) {
            Ok(entries) => document.tests.extend(entries),
            // A file that does not pass the check fails as a whole; the others are still run.
            Err(refusal) => {
                refusal.findings.print();
                let failures =
                    refusal.findings.diagnostics.iter().map(|d| format!("{}: {}", d.code, d.title)).collect();
                document.tests.push(Entry {
                    path: path.into(),
                    name: "check".into(),
                    passed: false,
                    failures,
                    exit: refusal.exit,
                });
            }
        }
        if interrupt::requested() {
            return Ok(Exit::Interrupted);
        }
    }
    if document.tests.is_empty() && !a.accept {
        let named = a.paths.join(" ");
        let hint = "write a `test`, or make a golden with `soifra test --accept`";
        return Err(Refusal::about(
            &named,
            "S9021",
            "there is nothing to test",
            "no mission here has a test or a golden",
            hint,
        ));
    }
    for t in &document.tests {
        worst = worst.max(t.exit);
        document.passed += usize::from(t.passed);
        document.failed += usize::from(!t.passed);
    }
    if document.failed > 0 {
        document.outcome = "failed";
    }
    match a.format {
        Format::Human => output::print(&human(&document))?,
        Format::Json => output::print_json(&document)?,
    }
    Ok(worst)
}

/// Every `.soi` file at or below `path` that may hold a mission, by path.
fn gather(path: &Path, out: &mut Vec<PathBuf>) -> Result<(), Refusal> {
    let name = path.to_string_lossy();
    let meta = fs::metadata(path).map_err(|e| {
        Refusal::about(
            &name,
            "S9001",
            "the file cannot be read",
            files::reason(&e),
            "name a mission, or a folder of missions",
        )
    })?;
    if !meta.is_dir() {
        out.push(path.to_path_buf());
        return Ok(());
    }
    let entries = fs::read_dir(path).map_err(|e| {
        Refusal::about(&name, "S9001", "the folder cannot be read", files::reason(&e), "make it readable")
    })?;
    let mut below: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    below.sort();
    for p in below {
        // Links are not followed into folders: they could lead in a circle.
        let folder = fs::symlink_metadata(&p).is_ok_and(|m| m.is_dir());
        if folder && p.file_name().is_none_or(|n| n != "golden") {
            gather(&p, out)?;
        } else if p.extension().is_some_and(|e| e == "soi") && p.is_file() {
            out.push(p);
        }
    }
    Ok(())
}

/// The tests and the golden of one file.
fn file(path: &str, a: &Arguments, pool: Option<&rayon::ThreadPool>) -> Result<Vec<Entry>, Refusal> {
    let checked = compile::check(path, None, None)?;
    checked.findings.print();
    let mut entries = Vec::new();
    let main = checked.graph.as_ref().map(|g| g.name.to_string());
    for case in checked.tests.iter().filter(|t| is_in(t, &checked.findings.sources, path)) {
        let mission = compile::compile_with(path, None, Some(&case.mission), Some(&case.name))?.mission()?;
        let place = Place { path, at: case.at, sources: &checked.findings.sources };
        entries.push(test(&place, case, &mission, pool)?);
    }
    if let Some(graph) = checked.graph {
        let at = golden_path(path);
        if a.accept || at.exists() {
            let name = format!("golden of {}", main.unwrap_or_default());
            let now = gather_golden(&execute::load(graph, checked.images)?)?;
            let failure = if a.accept { accept(&at, &now)? } else { compare(&at, &now)? };
            let whole = [Source { path: path.into(), text: String::new() }];
            let place = Place { path, at: Span::default(), sources: &whole };
            entries.push(entry(&place, name, failure.into_iter().collect(), "S9019"));
        }
    }
    Ok(entries)
}

/// Whether a test was written in the file itself, not in one that it imports.
fn is_in(case: &TestCase, sources: &[Source], path: &str) -> bool {
    sources.get(case.at.file as usize).is_none_or(|s| s.path == path)
}

/// Where a test stands.
struct Place<'a> {
    path: &'a str,
    at: Span,
    sources: &'a [Source],
}

fn entry(place: &Place<'_>, name: String, failures: Vec<String>, code: &'static str) -> Entry {
    let passed = failures.is_empty();
    if !passed {
        let title = format!("{name} failed: {}", failures.join("; "));
        let hint = if code == "S9019" {
            "if this is meant, accept it with `soifra test --accept`"
        } else {
            "`soifra run` with that seed records what happened"
        };
        let d = Diagnostic::error(code, title).at(place.at, "").hint(hint);
        Findings { diagnostics: vec![d], sources: place.sources.to_vec() }.print();
    }
    Entry {
        path: place.path.into(),
        name,
        passed,
        failures,
        exit: if passed { Exit::Success } else { Exit::Failed },
    }
}

/// Runs every seed of a test.
fn test(
    place: &Place<'_>,
    case: &TestCase,
    mission: &Mission,
    pool: Option<&rayon::ThreadPool>,
) -> Result<Entry, Refusal> {
    let sets: Vec<(String, String)> = case.sets.iter().map(|(n, v)| (n.to_string(), v.clone())).collect();
    let values = compile::settings(mission.graph(), &sets)?;
    let seeds: Vec<u64> = (case.seeds.0..=case.seeds.1).collect();
    let work = || {
        seeds.par_iter().map(|seed| one(case, mission, *seed, &values)).collect::<Result<Vec<_>, Refusal>>()
    };
    let results = match pool {
        Some(pool) => pool.install(work)?,
        None => work()?,
    };
    Ok(entry(place, format!("test {}", case.name), results.into_iter().flatten().collect(), "S9022"))
}

fn one(
    case: &TestCase,
    mission: &Mission,
    seed: u64,
    values: &[(usize, Value)],
) -> Result<Vec<String>, Refusal> {
    let settings = execute::settings(mission.graph(), seed, values, 1);
    let report = execute::Prepared::new(mission, settings)?.run(&interrupt::flag())?;
    Ok(failures(case, seed, &report))
}

fn failures(case: &TestCase, seed: u64, r: &RunReport) -> Vec<String> {
    let mut out = Vec::new();
    if r.outcome.name() != &*case.outcome {
        out.push(format!(
            "seed {seed}: the outcome is {} ({}), expected {}",
            r.outcome.name(),
            r.reason,
            case.outcome
        ));
        let violated = r.expectations.iter().filter(|e| e.held == Some(false));
        out.extend(violated.map(|e| {
            let at = e.first_violation_s.map_or(String::new(), |t| format!(" first at {t} s"));
            format!("seed {seed}: `{}` is violated{at}", e.text)
        }));
    }
    for (metric, op, bound) in &case.expects {
        let value = r.metrics.get(&**metric).copied().flatten();
        if !value.is_some_and(|v| holds(v, *op, *bound)) {
            let value = value.map_or("absent".into(), |v| v.to_string());
            out.push(format!("seed {seed}: {metric} is {value}, expected {} {bound}", symbol(*op)));
        }
    }
    out
}

fn holds(a: f64, op: Binary, b: f64) -> bool {
    match op {
        Binary::Lt => a < b,
        Binary::Le => a <= b,
        Binary::Gt => a > b,
        Binary::Ge => a >= b,
        Binary::Eq => a == b,
        Binary::Ne => a != b,
        _ => false,
    }
}

fn symbol(op: Binary) -> &'static str {
    match op {
        Binary::Lt => "<",
        Binary::Le => "<=",
        Binary::Gt => ">",
        Binary::Ge => ">=",
        Binary::Eq => "==",
        Binary::Ne => "!=",
        _ => "?",
    }
}

/// Where the golden of a mission lies: `golden/NAME.json` beside it.
fn golden_path(path: &str) -> PathBuf {
    let p = Path::new(path);
    let stem = p.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    p.parent().unwrap_or(Path::new("")).join("golden").join(stem + ".json")
}

fn gather_golden(mission: &Mission) -> Result<Golden, Refusal> {
    let prepared = execute::Prepared::new(mission, execute::settings(mission.graph(), 1, &[], 1))?;
    let mut gatherer = Gatherer::new(prepared.scene().robots.iter().map(|r| r.name.clone()).collect());
    let report = prepared.run_into(&mut gatherer, &interrupt::flag())?;
    Ok(gatherer.finish(&report))
}

fn accept(at: &Path, now: &Golden) -> Result<Option<String>, Refusal> {
    let text = serde_json::to_string_pretty(now).unwrap_or_default() + "\n";
    files::write(&at.to_string_lossy(), text.as_bytes())?;
    let end = format!("{}, {} events", now.outcome, now.events.len());
    let digest = &graph_file::sha256(text.as_bytes())[..12];
    output::note(&format!("accepted: {} ({end}; {digest})", at.display()));
    Ok(None)
}

fn compare(at: &Path, now: &Golden) -> Result<Option<String>, Refusal> {
    let path = at.to_string_lossy();
    let text = files::read_text(&path)?;
    let golden: Golden = serde_json::from_str(&text).map_err(|e| {
        Refusal::about(
            &path,
            "S9019",
            "the golden is damaged",
            e.to_string(),
            "make it again with `soifra test --accept`",
        )
    })?;
    Ok(golden.difference(now))
}

fn human(d: &Document) -> String {
    let mut s: String = d
        .tests
        .iter()
        .map(|t| format!("{} {}: {}\n", if t.passed { "ok    " } else { "FAILED" }, t.path, t.name))
        .collect();
    s += &format!("{} passed, {} failed\n", d.passed, d.failed);
    s
}
