//! `soifra run`: runs a mission in the simulator, or on a recording.

use crate::{
    cli::Mission,
    compile, execute,
    exit::Exit,
    files, graph_file, interrupt,
    output::{self, Format},
    realtime::{Lateness, Operator, Summary, WallPacer},
    recording,
    report::{
        JsonDiagnostic, Refusal,
        table::{figure, table},
    },
    wall_clock::Stopwatch,
};
use clap::{Args, ValueHint};
use serde::Serialize;
use soifra_runtime::{NoTrace, Pacer, RunReport};
use std::collections::BTreeMap;

/// Arguments.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  soifra run patrol.soi --seed 7\n  soifra run patrol.soi --set critical_distance=3m --set rules=careful --trace none\n  soifra run patrol.soi --realtime --lateness out/lateness.csv\n  soifra run watch.soi --recording my_frames/ --rate 20Hz"
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
    /// What recorded robots read: a folder or numbered pattern of PNG or JPEG files, a .y4m file, or a trace
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    recording: Option<String>,
    /// How many images a second the recording has, with its unit; a .y4m file tells by itself
    #[arg(long, value_name = "RATE", allow_hyphen_values = true)]
    rate: Option<String>,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Where the trace goes, or `none` [default: out/MISSION-SEED.mcap]
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    trace: Option<String>,
    /// Hold the run to the wall clock; on standard input an operator can `kill AGENT@ROBOT`, `set NAME=VALUE` and
    /// `stop`, one a line
    #[arg(long)]
    realtime: bool,
    /// Where the lateness of each instant goes, as CSV
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath, requires = "realtime")]
    lateness: Option<String>,
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
    lateness: Option<Summary>,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let stop = interrupt::flag();
    let mut compiled = a.mission.compile()?;
    recording::name(&mut compiled.graph, a.recording.as_deref(), a.rate.as_deref())?;
    compiled.findings.print();
    let mut sets = Vec::new();
    for s in &a.sets {
        let (name, value) = compile::split_setting(s)?;
        // Of several values for one parameter the last counts.
        sets.retain(|(n, _)| *n != name);
        sets.push((name, value));
    }
    let sets = compile::with_test(&compiled.tests, a.mission.test.as_deref(), sets);
    let values = compile::settings(&compiled.graph, &sets)?;
    compile::verify_with(&compiled.graph, &values)?;
    let graph_digest = graph_file::digest(&compiled.graph);
    let threads = execute::threads(a.threads);
    let settings = execute::settings(&compiled.graph, a.seed, &values, threads);
    let mission = execute::load(compiled.graph, compiled.images)?;
    let prepared = execute::Prepared::new(&mission, settings)?;

    let path = match a.trace.as_deref() {
        Some("none") => None,
        Some(path) => Some(path.to_string()),
        None => Some(format!("out/{}-{}.mcap", mission.graph().name, a.seed)),
    };
    if let Some(path) = &path {
        files::keep_apart(&a.mission.file, path)?;
    }
    let mut pacer = match a.realtime {
        true => {
            let lateness = lateness(a, &prepared, path.as_deref())?;
            let operator = Operator::at_standard_input(&mission, prepared.scene());
            Some(WallPacer::new(&stop, operator, lateness))
        }
        false => None,
    };
    let pace = pacer.as_mut().map(|p| p as &mut dyn Pacer);
    let watch = Stopwatch::start();
    let (report, trace) = match path {
        Some(path) => {
            let (report, finished) = prepared.run_traced(&path, &stop, pace)?;
            (report, Some(Trace { path, digest: finished.digest, bytes: finished.bytes }))
        }
        None => (prepared.run_paced(&mut NoTrace, &stop, pace)?, None),
    };
    let wall_time_s = watch.seconds();
    let (lateness, unwritten) = pacer.map(WallPacer::finish).unzip();
    let mut exit = execute::exit_of(&report);
    if let Some(refusal) = unwritten.flatten() {
        // The run is what it is; what was asked for beside it is not there.
        refusal.findings.print();
        exit = exit.max(Exit::Aborted);
    }
    for fault in &report.faults {
        let often = if fault.times > 1 { format!(", {} times", fault.times) } else { String::new() };
        output::note(&format!("fault at {} s{often}: {}", figure(Some(fault.at_s)), fault.text));
    }
    match a.format {
        Format::Human => output::print(&human(&report, &sets, trace.as_ref(), lateness.as_ref()))?,
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
                lateness,
            },
            diagnostics: compiled.findings.to_json(),
        })?,
    }
    Ok(exit)
}

/// Where the lateness of a run goes. Nothing is written before it is known that the run can start.
fn lateness(
    a: &Arguments,
    prepared: &execute::Prepared<'_>,
    trace: Option<&str>,
) -> Result<Lateness, Refusal> {
    let Some(path) = &a.lateness else { return Ok(Lateness::new()) };
    files::keep_apart(&a.mission.file, path)?;
    let apart = || trace.map_or(Ok(()), |t| files::apart(t, path, "the trace goes there"));
    apart()?;
    prepared.starts()?;
    let lateness = Lateness::into_file(path)?;
    // A trace that was not there yet may be the same file all the same.
    apart().map(|()| lateness)
}

/// Robots shown in the table; of more only a summary.
const ROBOTS: usize = 40;

/// More contacts than this are only counted.
const CONTACTS: usize = 10;

fn human(
    r: &RunReport,
    sets: &[(String, String)],
    trace: Option<&Trace>,
    lateness: Option<&Summary>,
) -> String {
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
    match r.missed_deadlines {
        0 => {}
        1 => s += "  one deadline was missed\n",
        n => s += &format!("  {n} deadlines were missed\n"),
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
        let reasons = r.goals.iter().filter_map(|g| Some(format!("  {}: {}\n", g.name, g.reason.as_ref()?)));
        s += &format!("\n{}", table(&["goal", "status"], &rows));
        s.extend(reasons);
    }
    if !r.metrics.is_empty() {
        let rows: Vec<Vec<String>> = r.metrics.iter().map(|(n, v)| vec![n.clone(), figure(*v)]).collect();
        s += &format!("\n{}", table(&["metric (SI units)", "value"], &rows));
    }
    if let Some(t) = trace {
        s += &format!("\n  trace {} ({} kB)\n", t.path, t.bytes.div_ceil(1024));
    }
    if let Some(l) = lateness {
        let gap = if trace.is_some() { "" } else { "\n" };
        s += &format!("{gap}  {}\n", l.line());
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
