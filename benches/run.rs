//! The time of a whole process: `soifra run` with its trace to `soifra check` of the same mission.

mod support;

use std::{
    path::PathBuf,
    process::{Command, Stdio},
};

/// A short mission: what counts here is what a process costs beside the simulation.
fn short() -> String {
    let makefile = std::fs::read_to_string(support::project("Makefile")).expect("the Makefile");
    let line =
        makefile.lines().find_map(|l| l.strip_prefix("SHORT := ")).expect("a short mission in the Makefile");
    support::project(line.trim())
}

/// Seconds that the program takes with these arguments.
fn process(arguments: &[&str]) -> f64 {
    support::seconds(|| {
        let status = Command::new(env!("CARGO_BIN_EXE_soifra"))
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        assert!(status.is_ok_and(|s| s.success()), "soifra {arguments:?}");
    })
}

fn main() {
    let mut criterion = support::criterion().sample_size(50);
    let mission = short();
    let trace = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("short.mcap");
    let trace = trace.to_string_lossy();
    let run = || process(&["run", &mission, "--trace", &trace]);
    let check = || process(&["check", &mission]);
    let mut group = criterion.benchmark_group("process");
    support::add(&mut group, "soifra run", run);
    support::add(&mut group, "soifra check", check);
    group.finish();
    if !support::trying() {
        let what = "`soifra run` of a short mission, with trace, to `soifra check`";
        support::verdict("run_check", what, support::ratio(101, run, check), Some(3.3));
    }
    criterion.final_summary();
}
