//! `sweep` and `sweep merge`.

use super::{MISSION, mission};
use crate::support::{code, command, file, folder, json, soifra, stderr, stdout};

fn sweep(path: &str, more: &[&str]) -> Vec<u8> {
    let mut all = vec!["sweep", path, "--seeds", "6", "--set", "speed=0.5m/s,1m/s", "--format", "json"];
    all.extend(more);
    let o = soifra(&all);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    o.stdout
}

#[test]
fn threads_and_shards_change_nothing() {
    let dir = folder("sweep_same");
    let path = mission(&dir);
    let whole = sweep(&path, &["--threads", "1"]);
    assert_eq!(whole, sweep(&path, &["--threads", "4"]));
    let o = command(&["sweep", &path, "--seeds", "6", "--set", "speed=0.5m/s,1m/s", "--format", "json"])
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    assert_eq!(whole, o.stdout);
    let shards: Vec<String> = (1..=5)
        .map(|i| file(&dir, &format!("{i}.json"), sweep(&path, &["--shard", &format!("{i}/5")])))
        .collect();
    let mut arguments = vec!["sweep", "merge", "--format", "json"];
    arguments.extend(shards.iter().rev().map(String::as_str));
    let o = soifra(&arguments);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert_eq!(whole, o.stdout);

    let o = soifra(&["sweep", "merge", &shards[0], &shards[1]]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("S9016") && stderr(&o).contains("shard 3 of 5 is missing"), "{}", stderr(&o));
    let o = soifra(&["sweep", "merge", &shards[0], &shards[0]]);
    assert!(stderr(&o).contains("both shard 1"), "{}", stderr(&o));
}

#[test]
fn the_summary_is_that_of_the_runs() {
    let dir = folder("sweep_summary");
    let o = soifra(&["sweep", &mission(&dir), "--seeds", "2..5", "--format", "json"]);
    let d = json(&o);
    let runs = d["runs"].as_array().unwrap();
    assert_eq!(runs.iter().map(|r| r["seed"].as_u64().unwrap()).collect::<Vec<_>>(), [2, 3, 4, 5]);
    let ways: Vec<f64> = runs.iter().map(|r| r["metrics"]["way"].as_f64().unwrap()).collect();
    let mean = ways.iter().sum::<f64>() / 4.0;
    assert!((d["summary"]["way"]["mean"].as_f64().unwrap() - mean).abs() < 1e-12);
    assert_eq!(d["summary"]["way"]["n"], 4);
    assert!(ways.iter().any(|w| *w != ways[0]), "seeds change nothing");
    for field in ["mean", "sd", "min", "max", "n"] {
        assert!(d["summary"]["porter.distance_to_target_m"][field].is_number());
    }
    let o = soifra(&["sweep", &mission(&dir), "--seeds", "3"]);
    assert!(stdout(&o).contains("±") && stderr(&o).is_empty(), "{}{}", stdout(&o), stderr(&o));
}

#[test]
fn the_worst_run_decides() {
    let dir = folder("sweep_worst");
    let slow = file(&dir, "slow.soi", MISSION.replace("within 30 s", "within 4 s"));
    let o = soifra(&["sweep", &slow, "--seeds", "2", "--set", "speed=0.5m/s,1m/s", "--format", "json"]);
    assert_eq!(code(&o), 1);
    assert_eq!(json(&o)["groups"][0]["summary"]["success"]["mean"], 0.0);
    for bad in [vec!["--seeds", "0"], vec!["--seeds", "5..1"], vec!["--shard", "3/2"]] {
        let mut all = vec!["sweep", slow.as_str()];
        all.extend(bad);
        let o = soifra(&all);
        assert_eq!(code(&o), 2);
        assert!(stderr(&o).contains("S9015"));
    }
}
