//! `run` and `replay`.

use super::{MISSION, mission};
use crate::support::{code, command, file, folder, json, soifra, stderr, stdout};
use serde_json::Value;
use std::path::Path;

fn run_json(arguments: &[&str]) -> (i32, Value) {
    let mut all = vec!["run"];
    all.extend(arguments);
    all.extend(["--format", "json"]);
    let o = soifra(&all);
    (code(&o), json(&o))
}

#[test]
fn the_document_has_what_is_promised() {
    let dir = folder("run_document");
    let trace = dir.join("a.mcap").to_string_lossy().into_owned();
    let (exit, d) = run_json(&[&mission(&dir), "--seed", "3", "--trace", &trace]);
    assert_eq!(exit, 0, "{d:#}");
    assert_eq!((d["schema"].clone(), d["mission"].clone()), (1.into(), "errand".into()));
    assert_eq!((d["seed"].clone(), d["outcome"].clone()), (3.into(), "success".into()));
    assert_eq!(d["graph_digest"].as_str().map(str::len), Some(64));
    assert!(d["sim_time_s"].as_f64().is_some_and(|t| t > 1.0));
    assert_eq!(d["collisions"], 0);
    let e = &d["expectations"][0];
    assert!(
        e["text"].is_string()
            && e["held"] == true
            && e["first_violation_s"].is_null()
            && e.get("margin").is_some()
    );
    assert_eq!(d["goals"][0]["name"], "deliver");
    assert_eq!(d["goals"][0]["status"], "achieved");
    let r = &d["robots"][0];
    assert_eq!((r["name"].clone(), r["platform"].clone()), ("porter".into(), "cart".into()));
    for pose in ["start", "final"] {
        for axis in ["x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad"] {
            assert!(r[pose][axis].is_number(), "{pose}.{axis}");
        }
    }
    assert!(r["steps"].is_null(), "there is no step clock");
    assert_eq!((r["reached"].clone(), r["collisions"].clone()), (true.into(), 0.into()));
    assert!(r["path_length_m"].as_f64().is_some_and(|x| x > 2.5));
    assert!(r["distance_to_target_m"].as_f64().is_some_and(|x| x < 0.1));
    assert!(d["metrics"]["way"].is_number());
    assert!(d["host"]["wall_time_s"].is_number() && d["host"]["threads"].is_number());
    assert_eq!(d["trace"]["path"], trace.as_str());
    let bytes = std::fs::read(&trace).unwrap();
    assert_eq!(d["trace"]["digest"], soifra::graph_file::sha256(&bytes).as_str());
}

#[test]
fn same_inputs_same_bytes() {
    let dir = folder("run_same");
    let path = mission(&dir);
    let mut digests = Vec::new();
    for (name, threads) in [("a", "1"), ("b", "1"), ("c", "4")] {
        let trace = dir.join(format!("{name}.mcap")).to_string_lossy().into_owned();
        let (exit, d) = run_json(&[&path, "--trace", &trace, "--threads", threads]);
        assert_eq!(exit, 0);
        digests.push(d["trace"]["digest"].clone());
    }
    assert_eq!(digests[0], digests[1]);
    assert_eq!(digests[0], digests[2]);
    let (_, other) = run_json(&[&path, "--trace", &dir.join("d.mcap").to_string_lossy(), "--seed", "2"]);
    assert_ne!(digests[0], other["trace"]["digest"]);
}

#[test]
fn a_graph_runs_in_place_of_the_source() {
    let dir = folder("run_graph");
    let path = mission(&dir);
    let (_, source) = run_json(&[&path, "--trace", "none"]);
    assert!(source["trace"].is_null());
    for form in ["yaml", "json"] {
        let graph = dir.join(format!("g.{form}")).to_string_lossy().into_owned();
        let o = soifra(&["graph", &path, "--format", form, "-o", &graph]);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        let (exit, mut d) = run_json(&[&graph, "--trace", "none"]);
        let mut wanted = source.clone();
        d["host"] = Value::Null;
        wanted["host"] = Value::Null;
        assert_eq!((exit, d), (0, wanted));
    }
}

#[test]
fn outcomes_and_exit_codes() {
    let dir = folder("run_outcomes");
    let slow = file(&dir, "slow.soi", MISSION.replace("within 30 s", "within 2 s"));
    let (exit, d) = run_json(&[&slow, "--trace", "none"]);
    assert_eq!((exit, d["outcome"].clone()), (1, "timeout".into()));
    let hit = file(&dir, "hit.soi", MISSION.replace("(1.5 m, 60 cm)", "(1.5 m, 0 cm)"));
    let (exit, d) = run_json(&[&hit, "--trace", "none"]);
    assert_eq!(exit, 1, "{d:#}");
    assert!(d["collisions"].as_u64().is_some_and(|n| n > 0));
    assert_eq!(d["expectations"][0]["held"], false);
    assert!(d["expectations"][0]["first_violation_s"].is_number());
    let (exit, fast) = run_json(&[&mission(&dir), "--trace", "none", "--set", "speed=1m/s"]);
    let (_, normal) = run_json(&[&mission(&dir), "--trace", "none"]);
    assert_eq!(exit, 0);
    assert!(fast["sim_time_s"].as_f64() < normal["sim_time_s"].as_f64());
    let o = soifra(&["run", &mission(&dir), "--trace", "none"]);
    let text = stdout(&o);
    assert!(text.contains("success") && text.contains("porter") && text.contains("deliver"), "{text}");
}

#[test]
fn replay_finds_nothing_or_the_first_difference() {
    let dir = folder("run_replay");
    let trace = dir.join("a.mcap");
    let path = trace.to_string_lossy().into_owned();
    assert_eq!(code(&soifra(&["run", &mission(&dir), "--trace", &path])), 0);
    for arguments in [vec!["replay", path.as_str()], vec!["replay", path.as_str(), "--recorded"]] {
        let o = soifra(&arguments);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        assert!(stdout(&o).contains("nothing differs"));
    }
    let (changed, record) = altered(&trace, &dir);
    let o = soifra(&["replay", &changed, "--format", "json"]);
    assert_eq!(code(&o), 1, "{}", stderr(&o));
    assert!(stderr(&o).contains("S9023"));
    let d = json(&o);
    assert_eq!((d["outcome"].clone(), d["difference"]["record"].clone()), ("differs".into(), record.into()));
}

/// The trace with one reading altered, and the number of that record.
fn altered(trace: &Path, dir: &Path) -> (String, u64) {
    use soifra::trace_file::{Writer, read};
    use soifra_runtime::Event;
    let mut t = read(trace).unwrap();
    let at = t.records.len() / 2;
    let found = t.records.iter_mut().skip(at).find(|r| matches!(r.event, Event::Reading { .. })).unwrap();
    if let Event::Reading { registers, .. } = &mut found.event {
        registers[0] += 0.01;
    }
    let n = found.n;
    let path = dir.join("altered.mcap");
    let mut w = Writer::create(&path, &t.header).unwrap();
    t.records.iter().for_each(|r| w.write(r).unwrap());
    w.finish().unwrap();
    (path.to_string_lossy().into_owned(), n)
}

#[test]
fn a_cut_off_trace_is_verified_as_far_as_it_goes() {
    let dir = folder("run_cut");
    let trace = dir.join("a.mcap");
    let path = trace.to_string_lossy().into_owned();
    assert_eq!(code(&soifra(&["run", &mission(&dir), "--trace", &path])), 0);
    let bytes = std::fs::read(&trace).unwrap();
    let cut = file(&dir, "cut.mcap", &bytes[..bytes.len() * 2 / 3]);
    let o = soifra(&["replay", &cut, "--format", "json"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert_eq!(json(&o)["complete"], false);
    assert_eq!(code(&soifra(&["plot", &cut])), 0);
}

#[test]
fn a_run_that_cannot_start_leaves_the_trace_that_was_there() {
    let dir = folder("run_refused");
    let text = MISSION.replace("edition 1", "edition 1\nparam z: Int = 0");
    let wrong = text.replacen("  service", "  state share: Number = 1 / z\n  service", 1);
    assert_ne!(text, wrong);
    let (path, trace) = (file(&dir, "refused.soi", wrong), file(&dir, "old.mcap", "old"));
    let o = soifra(&["run", &path, "--trace", &trace]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert_eq!(std::fs::read(&trace).unwrap(), b"old");
}

#[test]
fn a_graph_is_not_written_under_a_name_that_promises_a_picture() {
    let dir = folder("run_graph_png");
    let png = dir.join("graph.png");
    let o = soifra(&["graph", &mission(&dir), "-o", &png.to_string_lossy()]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert!(stderr(&o).contains("S9012") && !png.exists());
}

#[test]
fn a_value_given_twice_is_swept_once() {
    let dir = folder("run_sweep_twice");
    let set = "speed=0.5m/s,1m/s,0.5m/s";
    let o = soifra(&["sweep", &mission(&dir), "--seeds", "2", "--set", set, "--format", "json"]);
    assert_eq!(json(&o)["runs"].as_array().map(Vec::len), Some(4), "{}", stderr(&o));
}

#[test]
fn the_bytes_do_not_depend_on_the_folder() {
    let dir = folder("run_folders");
    let inner = dir.join("inner");
    std::fs::create_dir_all(&inner).expect("a folder");
    let path = mission(&inner);
    let mut digests = Vec::new();
    for (from, name) in [(&dir, "inner/errand.soi"), (&inner, "errand.soi"), (&inner, path.as_str())] {
        let o = command(&["run", name, "--trace", "t.mcap", "--format", "json"])
            .current_dir(from)
            .output()
            .expect("the program starts");
        let d = json(&o);
        digests.push((d["graph_digest"].clone(), d["trace"]["digest"].clone()));
    }
    assert!(digests.iter().all(|d| *d == digests[0] && d.1.is_string()), "{digests:?}");
}

#[test]
fn a_trace_does_not_take_the_place_of_its_mission() {
    let path = mission(&folder("run_over_itself"));
    let before = std::fs::read(&path).expect("a mission");
    let o = soifra(&["run", &path, "--trace", &path]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert_eq!(std::fs::read(&path).expect("a mission"), before);
    let o = soifra(&["graph", &path, "--format", "json", "-o", &path]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert_eq!(std::fs::read(&path).expect("a mission"), before);
}

#[test]
fn a_mission_of_several_is_named() {
    let dir = folder("run_several");
    let two =
        super::MISSION.replace("mission errand", "mission trip").split("agent driver").next().map(|t| {
            let mission = t.split("mission trip").nth(1).unwrap_or_default();
            format!("{}\nmission trip{mission}", super::MISSION)
        });
    let path = file(&dir, "two.soi", two.expect("a mission"));
    for (name, exit) in [("errand", 0), ("trip", 0), ("tirp", 2)] {
        let o = soifra(&["run", &path, "--mission", name, "--trace", "none", "--format", "json"]);
        assert_eq!(code(&o), exit, "{}", stderr(&o));
        if exit == 0 {
            assert_eq!(json(&o)["mission"], name);
        } else {
            assert!(stderr(&o).contains("did you mean `trip`?"), "{}", stderr(&o));
        }
    }
}
