//! `docs/commands.md` tells every field of the JSON documents, and no other.

use crate::support::{code, file, folder, json, root, soifra};
use serde_json::Value;
use soifra::trace_file::{Writer, read};
use std::collections::BTreeSet;

/// Fields of a table of the page.
fn told(table: &str) -> BTreeSet<String> {
    let page = std::fs::read_to_string(root().join("docs/commands.md")).expect("the page");
    let (_, rest) = page.split_once(&format!("<!-- fields: {table} -->")).expect("the table");
    let rows = rest.split("<!-- end -->").next().unwrap_or_default().lines();
    rows.filter_map(|l| Some(l.strip_prefix("| `")?.split('`').next()?.to_string())).collect()
}

/// Paths of all fields; below `opaque` names are the mission's.
fn fields(v: &Value, path: &str, opaque: &[&str], out: &mut BTreeSet<String>) {
    match v {
        Value::Object(members) => {
            for (name, member) in members {
                let inside = opaque.contains(&path);
                let at = match path {
                    "" => name.clone(),
                    _ if inside => format!("{path}.*"),
                    _ => format!("{path}.{name}"),
                };
                if !inside || member.is_object() {
                    out.extend((!inside).then(|| at.clone()));
                    fields(member, &at, opaque, out);
                }
            }
        }
        Value::Array(items) => items.iter().for_each(|i| fields(i, &format!("{path}[]"), opaque, out)),
        _ => {}
    }
}

fn found(v: &Value, opaque: &[&str], leave: &[&str]) -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    fields(v, "", opaque, &mut out);
    out.retain(|f| !leave.iter().any(|l| f.starts_with(l)));
    out
}

const BROKEN: &str = "
edition 1
mission broken {
  host here runs counter
  goal all { subgoal done by counter achieved when quarter < 0 }
  within 5 s
}
agent counter {
  state left: Int = 3
  state quarter: Number = 1
  service count every 1 s {
    set left = left - 1
    set quarter = 1 / left
  }
}
";

#[test]
fn every_field_of_a_run_is_told() {
    let dir = folder("documents");
    let trace = dir.join("run.mcap").to_string_lossy().into_owned();
    let mission = root().join("missions/khepera/sim1.soi").to_string_lossy().into_owned();
    // Without avoidance there are contacts to tell of.
    let mut seen = BTreeSet::new();
    for seed in ["1", "2", "3", "4"] {
        let o = soifra(&[
            "run",
            &mission,
            "--seed",
            seed,
            "--set",
            "avoidance=off",
            "--trace",
            &trace,
            "--format",
            "json",
        ]);
        seen.extend(found(&json(&o), &["metrics", "params"], &["robots[].final.", "diagnostics["]));
    }
    let hop = file(&dir, "hop.soi", super::realtime::HOP);
    let o = soifra(&["run", &hop, "--realtime", "--trace", "none", "--format", "json"]);
    seen.extend(found(&json(&o), &["metrics", "params"], &["robots[].final.", "diagnostics["]));
    // And something that goes wrong.
    let broken = file(&dir, "broken.soi", BROKEN);
    let o = soifra(&["run", &broken, "--trace", "none", "--format", "json"]);
    seen.extend(found(&json(&o), &["metrics", "params"], &["robots[].final.", "diagnostics["]));
    assert_eq!(seen, told("run"));
}

#[test]
fn every_field_of_a_sweep_is_told() {
    let mission = root().join("missions/khepera/sim1.soi").to_string_lossy().into_owned();
    let o = soifra(&["sweep", &mission, "--seeds", "2", "--set", "rules=safe", "--format", "json"]);
    let opaque = ["summary", "graph_digests", "runs[].metrics"];
    assert_eq!(found(&json(&o), &opaque, &["groups[].summary.", "plan.sets[", "runs[].set["]), told("sweep"));
}

#[test]
fn every_field_of_a_replay_is_told() {
    let trace = folder("documents-replay").join("run.mcap");
    let path = trace.to_string_lossy().into_owned();
    let mission = root().join("missions/khepera/sim1.soi").to_string_lossy().into_owned();
    assert_eq!(code(&soifra(&["run", &mission, "--trace", &path])), 0);
    // Another seed in the header makes the run another one.
    let mut recorded = read(&trace).expect("a trace");
    recorded.header.scene.seed += 1;
    let mut writer = Writer::create(&trace, &recorded.header).expect("a file");
    recorded.records.iter().for_each(|r| writer.write(r).expect("written"));
    writer.finish().expect("written");
    let o = soifra(&["replay", &path, "--format", "json"]);
    let leave = ["difference.recorded.", "difference.replayed."];
    assert_eq!(found(&json(&o), &[], &leave), told("replay"));
}

#[test]
fn every_field_of_a_check_is_told() {
    let wrong = file(&folder("documents-check"), "wrong.soi", "edition 1\nlet far = 3 m + 2 s\n");
    let o = soifra(&["check", &wrong, "--format", "json"]);
    let mut seen = found(&json(&o), &[], &["diagnostics[].labels["]);
    let mission = root().join("missions/agents/overload.soi").to_string_lossy().into_owned();
    let o = soifra(&["check", "--timing", &mission, "--format", "json"]);
    seen.extend(found(&json(&o), &[], &[]));
    let mission = root().join("missions/agents/allocation.soi").to_string_lossy().into_owned();
    let o = soifra(&["check", "--matrix", &mission, "--format", "json"]);
    seen.extend(found(&json(&o), &[], &[]));
    assert_eq!(seen, told("check"));
}
