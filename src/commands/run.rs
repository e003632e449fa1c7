//! `soifra run`: runs a mission in the simulator.

use crate::{
    cli::Mission,
    compile, execute,
    exit::Exit,
    files, graph_file, interrupt,
    output::{self, Format},
    report::{
        JsonDiagnostic, Refusal,
        table::{figure, table},
    },
    wall_clock::Stopwatch,
};
use clap::{Args, ValueHint};
use serde::Serialize;
use soifra_runtime::RunReport;
use std::collections::BTreeMap;

/// Arguments.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  soifra run patrol.soi --seed 7\n  soifra run patrol.soi --set critical_distance=3m --set rules=careful --trace none"
)]
pub struct Arguments {
    #[command(flatten)]
    mission: Mission,
    /// Seed of all randomness
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Set a parameter of the mission, with its unit
    #[arg(long = "set", value_name = "NAME=VALUE")]
    sets: Vec<String>,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Where the trace goes, or `none` [default: out/MISSION-SEED.mcap]
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    trace: Option<String>,
    /// What to print on standard output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// The JSON document.
#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    graph_digest: String,
    params: BTreeMap<String, String>,
    #[serde(flatten)]
    report: &'a RunReport,
    trace: Option<Trace>,
    host: Host,
    diagnostics: Vec<JsonDiagnostic>,
}

#[derive(Serialize)]
struct Trace {
    path: String,
    digest: String,
    bytes: u64,
}

/// What depends on the machine and differs from run to run.
#[derive(Serialize)]
struct Host {
    wall_time_s: f64,
    real_time_factor: Option<f64>,
    threads: usize,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let stop = interrupt::flag();
    let compiled = a.mission.compile()?;
    compiled.findings.print();
    let mut sets = Vec::new();
    for s in &a.sets {
        let (name, value) = compile::split_setting(s)?;
        // Of several values for one parameter the last counts.
        sets.retain(|(n, _)| *n != name);
        sets.push((name, value));
    }
    let values = compile::settings(&compiled.graph, &sets)?;
    compile::verify_with(&compiled.graph, &values)?;
    let graph_digest = graph_file::digest(&compiled.graph);
    let threads = execute::threads(a.threads);
    let settings = execute::settings(&compiled.graph, a.seed, &values, threads);
    let mission = execute::load(compiled.graph)?;
    let prepared = execute::Prepared::new(&mission, settings)?;

    let path = match a.trace.as_deref() {
        Some("none") => None,
        Some(path) => Some(path.to_string()),
        None => Some(format!("out/{}-{}.mcap", mission.graph().name, a.seed)),
    };
    let watch = Stopwatch::start();
    let (report, trace) = match path {
        Some(path) => {
            files::keep_apart(&a.mission.file, &path)?;
            let (report, finished) = prepared.run_traced(&path, &stop)?;
            (report, Some(Trace { path, digest: finished.digest, bytes: finished.bytes }))
        }
        None => (prepared.run(&stop)?, None),
    };
    let wall_time_s = watch.seconds();
    let exit = execute::exit_of(&report);
    for fault in &report.faults {
        output::note(&format!("fault: {fault}"));
    }
    match a.format {
        Format::Human => output::print(&human(&report, &sets, trace.as_ref()))?,
        Format::Json => output::print_json(&Document {
            schema: output::SCHEMA,
            graph_digest,
            params: sets.into_iter().collect(),
            report: &report,
            trace,
            host: Host {
                wall_time_s,
                real_time_factor: (wall_time_s > 0.0).then(|| report.sim_time_s / wall_time_s),
                threads,
            },
            diagnostics: compiled.findings.to_json(),
        })?,
    }
    Ok(exit)
}

/// Robots shown in the table; of more only a summary.
const ROBOTS: usize = 40;

/// More contacts than this are only counted.
const CONTACTS: usize = 10;

fn human(r: &RunReport, sets: &[(String, String)], trace: Option<&Trace>) -> String {
    let why = if r.reason.is_empty() { String::new() } else { format!(" ({})", r.reason) };
    let set: String = sets.iter().map(|(name, value)| format!(", {name}={value}")).collect();
    let mut s = format!(
        "{}, seed {}{set}: {}{why} after {} s, {}\n\n",
        r.mission,
        r.seed,
        r.outcome.name(),
        figure(Some(r.sim_time_s)),
        count(r.collisions, "collision"),
    );
    let place = |x: f64, y: f64| format!("{x:.3}, {y:.3}");
    let rows: Vec<Vec<String>> = r
        .robots
        .iter()
        .take(ROBOTS)
        .map(|b| {
            vec![
                b.name.clone(),
                b.platform.clone(),
                place(b.start.x_m, b.start.y_m),
                b.last.as_ref().map_or("–".into(), |p| place(p.x_m, p.y_m)),
                b.steps.map_or("–".into(), |n| n.to_string()),
                figure(b.path_length_m),
                if b.reached { "yes".into() } else { "no".into() },
                figure(b.distance_to_target_m),
                b.collisions.to_string(),
            ]
        })
        .collect();
    s += &table(
        &[
            "robot",
            "platform",
            "start m",
            "final m",
            "steps",
            "path m",
            "reached",
            "to target m",
            "collisions",
        ],
        &rows,
    );
    if r.robots.len() > ROBOTS {
        s += &format!("  … and {} more robots\n", r.robots.len() - ROBOTS);
    }
    for c in r.contacts.iter().take(CONTACTS) {
        s += &format!("  contact at {} s: {} with {}\n", figure(Some(c.at_s)), c.robot, c.with);
    }
    if r.collisions as usize > CONTACTS {
        s += &format!("  … and {} more contacts\n", r.collisions as usize - CONTACTS);
    }
    for b in r.robots.iter().filter(|b| b.safe_actions > 0).take(ROBOTS) {
        s += &format!("  {} fell back to its safe action {}\n", b.name, times(b.safe_actions));
    }
    if !r.expectations.is_empty() {
        let rows: Vec<Vec<String>> = r
            .expectations
            .iter()
            .map(|e| {
                let held = match e.held {
                    Some(true) => "held",
                    Some(false) => "violated",
                    None => "not known",
                };
                vec![
                    e.text.clone(),
                    held.into(),
                    e.first_violation_s.map_or("–".into(), |t| figure(Some(t))),
                    figure(e.margin),
                ]
            })
            .collect();
        s += &format!("\n{}", table(&["expectation", "", "first violation s", "margin"], &rows));
    }
    if !r.goals.is_empty() {
        let rows: Vec<Vec<String>> =
            r.goals.iter().map(|g| vec![g.name.clone(), g.status.to_string()]).collect();
        s += &format!("\n{}", table(&["goal", "status"], &rows));
    }
    if !r.metrics.is_empty() {
        let rows: Vec<Vec<String>> = r.metrics.iter().map(|(n, v)| vec![n.clone(), figure(*v)]).collect();
        s += &format!("\n{}", table(&["metric (SI units)", "value"], &rows));
    }
    if let Some(t) = trace {
        s += &format!("\n  trace {} ({} kB)\n", t.path, t.bytes.div_ceil(1024));
    }
    s
}

fn times(n: u32) -> String {
    if n == 1 { "once".into() } else { format!("{n} times") }
}

fn count(n: u32, word: &str) -> String {
    match n {
        0 => format!("no {word}s"),
        1 => format!("1 {word}"),
        n => format!("{n} {word}s"),
    }
}
