//! Snapshots in trace files: where they stand, that a replay goes on from them, and what damage does.

use crate::support::{code, folder, json, soifra, stderr, stdout};
use soifra::trace_file::{Reader, SNAPSHOT_TIME, Trace, Writer, read};
use soifra_runtime::{Event, Mission, Settings, Snapshot, Time, TraceSink, replay};
use std::path::{Path, PathBuf};

/// A run of a shipped mission that lasts a minute.
fn traced(name: &str) -> PathBuf {
    let path = folder(name).join("run.mcap");
    let o =
        soifra(&["run", "missions/khepera/bench1.soi", "--seed", "3", "--trace", &path.to_string_lossy()]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    path
}

fn snapshot(path: &Path, until: f64) -> Option<Snapshot> {
    let until = Time::from_seconds(until).expect("an instant");
    Reader::open(path).and_then(|r| r.snapshot(until)).expect("a readable trace")
}

/// The mission and settings that a trace carries.
fn mission(trace: &Trace) -> (Mission, Settings) {
    let graph = serde_json::from_str(&trace.header.graph_json).expect("a graph");
    let settings = Settings { seed: trace.header.seed(), params: trace.header.params.clone(), threads: 1 };
    (Mission::load(graph).expect("a sound graph"), settings)
}

#[test]
fn a_replay_begins_where_it_is_told() {
    let path = traced("snapshots_from");
    assert!(snapshot(&path, SNAPSHOT_TIME.seconds() - 0.1).is_none(), "the first comes after some time");
    let taken = snapshot(&path, 1e6).expect("a snapshot");
    assert!(taken.t >= SNAPSHOT_TIME && taken.next > 0);
    let from = format!("{}", taken.t.seconds() + 0.5);
    let path = path.to_string_lossy();
    let o = soifra(&["replay", &path, "--from", &from, "--format", "json"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let (part, whole) = (json(&o), json(&soifra(&["replay", &path, "--recorded", "--format", "json"])));
    assert_eq!(part["from_s"], taken.t.seconds());
    assert_eq!(whole["from_s"], 0.0);
    assert_eq!(part["records"].as_u64().map(|n| n + taken.next), whole["records"].as_u64());
    let o = soifra(&["replay", &path, "--from", "1 s"]);
    assert!(stdout(&o).contains("from 0 s on, nothing differs"), "{}", stdout(&o));
    let o = soifra(&["replay", &path, "--from", "-1"]);
    assert_eq!(code(&o), 2, "{}", stdout(&o));
}

/// The trace again with one snapshot; readings from `shift` records behind it on are altered.
fn rewritten(trace: &Trace, to: &Path, taken: &Snapshot, shift: usize) {
    let mut w = Writer::create(to, &trace.header).expect("a file");
    for r in &trace.records {
        if r.n == taken.next {
            w.snapshot(taken).expect("written");
        }
        let mut r = r.clone();
        if r.n as usize >= taken.next as usize + shift
            && let Event::Reading { registers, .. } = &mut r.event
        {
            registers[0] += 0.05;
        }
        w.write(&r).expect("written");
    }
    w.finish().expect("written");
}

#[test]
fn what_differs_behind_a_snapshot_is_found_from_it() {
    let path = traced("snapshots_differ");
    let (trace, taken) = (read(&path).expect("a trace"), snapshot(&path, 1e6).expect("a snapshot"));
    let copy = path.with_file_name("copy.mcap");
    let replayed = |shift| {
        rewritten(&trace, &copy, &taken, shift);
        code(&soifra(&["replay", &copy.to_string_lossy(), "--from", "1000"]))
    };
    assert_eq!(replayed(usize::MAX / 2), 0, "nothing was altered");
    assert_eq!(replayed(20), 1, "readings were altered");
}

#[test]
fn a_damaged_snapshot_is_refused_or_differs() {
    let path = traced("snapshots_damaged");
    let trace = read(&path).expect("a trace");
    let (mission, settings) = mission(&trace);
    let text = serde_json::to_string(&snapshot(&path, 1e6).expect("a snapshot")).expect("text");
    let digits: Vec<usize> = text.char_indices().filter(|c| c.1.is_ascii_digit()).map(|c| c.0).collect();
    let (mut refused, mut differ) = (0, 0);
    for (i, with) in
        (0..digits.len()).step_by(digits.len() / 60).zip(["9", "", "77", "-1", "[1]", "1e300"].iter().cycle())
    {
        let at = digits[i];
        let damaged = format!("{}{with}{}", &text[..at], &text[at + 1..]);
        let Ok(snapshot) = serde_json::from_str::<Snapshot>(&damaged) else {
            refused += 1;
            continue;
        };
        match replay::verify_from(&mission, &settings, snapshot, trace.records.iter().cloned()) {
            Ok(_) => {}
            Err(replay::ReplayError::Difference(_)) => differ += 1,
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 0 && differ > 0, "{refused} refused, {differ} differ");
}

#[test]
fn a_snapshot_of_another_mission_is_refused() {
    let path = traced("snapshots_other");
    let trace = read(&path).expect("a trace");
    let taken = snapshot(&path, 1e6).expect("a snapshot");
    let other = folder("snapshots_other_mission").join("sim1.mcap");
    let o = soifra(&["run", "missions/khepera/sim1.soi", "--trace", &other.to_string_lossy()]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let (mission, settings) = mission(&read(&other).expect("a trace"));
    let result = replay::verify_from(&mission, &settings, taken, trace.records.iter().cloned());
    assert!(matches!(result, Err(replay::ReplayError::Snapshot)), "{result:?}");
}
