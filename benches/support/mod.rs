//! What the benches share: missions set up as `soifra run` sets them up, ratios, and verdicts.
//!
//! Every ratio is taken in pairs: ours and the reference run in turn, and the median of the ratios of
//! neighbours counts. So what else the machine does weighs on both.
#![expect(clippy::print_stdout, reason = "a bench tells its ratios on the terminal")]
#![allow(dead_code, reason = "every bench uses a part of it")]

use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use serde::Serialize;
use soifra::{compile, execute, wall_clock::Stopwatch};
use soifra_runtime::{Mission, RunReport, Settings};
use std::{path::PathBuf, sync::atomic::AtomicBool, time::Duration};

/// Whether the bench is only tried out (`cargo test --benches`): then nothing is judged.
pub fn trying() -> bool {
    std::env::args().any(|a| a == "--test") || !std::env::args().any(|a| a == "--bench")
}

/// The harness, with samples as small as a bench of whole runs needs.
pub fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
        .without_plots()
        .configure_from_args()
}

/// Adds a bench whose routine times itself: it returns the seconds it took.
pub fn add(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mut routine: impl FnMut() -> f64) {
    group.bench_function(name, |b| {
        b.iter_custom(|n| Duration::from_secs_f64((0..n).map(|_| routine()).sum()));
    });
}

/// Seconds that something takes.
pub fn seconds<T>(what: impl FnOnce() -> T) -> f64 {
    let watch = Stopwatch::start();
    std::hint::black_box(what());
    watch.seconds()
}

/// The median ratio of two routines that run in turn; each returns what it cost.
pub fn ratio(pairs: usize, mut ours: impl FnMut() -> f64, mut reference: impl FnMut() -> f64) -> f64 {
    // The first of each warms caches and is not counted.
    ours();
    reference();
    let ratios = (0..pairs.max(1)).map(|i| {
        // Neither is always the one that comes first.
        if i % 2 == 0 {
            let a = ours();
            a / reference()
        } else {
            let b = reference();
            ours() / b
        }
    });
    median(ratios.collect())
}

/// The middle one.
pub fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// A ratio, the bar it must not exceed, and whether it holds; `bar` is absent for a figure to know by the way.
#[derive(Serialize)]
struct Verdict<'a> {
    name: &'a str,
    what: &'a str,
    ratio: f64,
    bar: Option<f64>,
    held: Option<bool>,
}

/// Prints a ratio against its bar and leaves it in `out/bench/NAME.json`.
pub fn verdict(name: &str, what: &str, ratio: f64, bar: Option<f64>) {
    let held = bar.map(|b| ratio <= b);
    let words = match (bar, held) {
        (Some(b), Some(true)) => format!("bar {b}: held"),
        (Some(b), _) => format!("bar {b}: NOT HELD"),
        _ => "no bar".into(),
    };
    println!("{name}: {ratio:.3} ({what}; {words})");
    let folder = PathBuf::from(project("out/bench"));
    let text = serde_json::to_string_pretty(&Verdict { name, what, ratio, bar, held }).unwrap_or_default();
    let written = std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(folder.join(format!("{name}.json")), text + "\n"));
    if let Err(e) = written {
        println!("{}: {e}", folder.display());
    }
}

/// A file of the project.
pub fn project(path: &str) -> String {
    PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo tells the folder"))
        .join(path)
        .to_string_lossy()
        .into_owned()
}

/// The text of a file of the project.
pub fn read(path: &str) -> String {
    std::fs::read_to_string(project(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// Where files of the benches' own are.
pub fn scratch_path(name: &str) -> String {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name).to_string_lossy().into_owned()
}

/// A file of the bench's own, made anew.
pub fn scratch(name: &str, text: &str) -> String {
    let path = scratch_path(name);
    std::fs::write(&path, text).unwrap_or_else(|e| panic!("{path}: {e}"));
    path
}

/// A mission compiled from its source, with the settings of its runs.
pub struct Compiled {
    pub mission: Mission,
    pub settings: Settings,
}

impl Compiled {
    /// Compiles a file as `soifra run --set NAME=VALUE … --threads 1` does.
    pub fn new(path: &str, sets: &[(&str, String)]) -> Compiled {
        let compiled = compile::compile(path, None).unwrap_or_else(|r| refused(r));
        let sets: Vec<(String, String)> = sets.iter().map(|(n, v)| ((*n).into(), v.clone())).collect();
        let values = compile::settings(&compiled.graph, &sets).unwrap_or_else(|r| refused(r));
        let settings = execute::settings(&compiled.graph, 1, &values, 1);
        let mission = execute::load(compiled.graph, compiled.images).unwrap_or_else(|r| refused(r));
        Compiled { mission, settings }
    }

    /// A run that is set up.
    pub fn prepared(&self) -> execute::Prepared<'_> {
        execute::Prepared::new(&self.mission, self.settings.clone()).unwrap_or_else(|r| refused(r))
    }
}

/// Runs without a trace; returns the report and the seconds it took.
pub fn run(prepared: &execute::Prepared<'_>) -> (RunReport, f64) {
    let watch = Stopwatch::start();
    let report = prepared.run(&AtomicBool::new(false)).unwrap_or_else(|r| refused(r));
    (report, watch.seconds())
}

/// Runs with a trace in a file of the bench's own, or in one that an absolute path names.
pub fn run_traced(prepared: &execute::Prepared<'_>, name: &str) -> (RunReport, f64) {
    let path = scratch_path(name);
    let watch = Stopwatch::start();
    let (report, _) =
        prepared.run_traced(&path, &AtomicBool::new(false), None).unwrap_or_else(|r| refused(r));
    (report, watch.seconds())
}

fn refused(refusal: soifra::report::Refusal) -> ! {
    refusal.findings.print();
    panic!("the bench's mission is refused");
}
