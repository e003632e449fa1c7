//! Every shipped mission: it passes the check, is in the standard form, and its run, a second run and the
//! replay of the first are the same.

mod blind;
mod detection;
mod objects;
mod soifra;

use crate::support::{code, files, folder, json, root, soifra, stderr};
use std::path::PathBuf;

/// Files under `missions/`; with a line that begins `mission`, they can be run. What runs on a recording of the user's
/// is run by the tests of recordings.
fn missions() -> Vec<(String, bool)> {
    let relative = |p: PathBuf| p.strip_prefix(root()).unwrap_or(&p).to_string_lossy().into_owned();
    let runnable = |p: &PathBuf| {
        let text = std::fs::read_to_string(p).unwrap_or_default();
        text.lines().any(|l| l.starts_with("mission ")) && !text.contains("extends recorded_camera")
    };
    files("missions", ".soi").into_iter().map(|p| (runnable(&p), p)).map(|(r, p)| (relative(p), r)).collect()
}

#[test]
fn all_pass_the_check_without_a_warning() {
    for (path, _) in missions() {
        let o = soifra(&["check", "--deny", "warnings", &path]);
        assert_eq!(code(&o), 0, "{path}: {}", stderr(&o));
    }
}

#[test]
fn all_are_in_the_standard_form() {
    let mut all: Vec<String> = missions().into_iter().map(|(p, _)| p).collect();
    for folder in ["platforms", "lang/std"] {
        all.extend(files(folder, ".soi").iter().map(|p| p.to_string_lossy().into_owned()));
    }
    let mut arguments = vec!["fmt", "--check"];
    arguments.extend(all.iter().filter(|p| !p.contains("/golden/")).map(String::as_str));
    let o = soifra(&arguments);
    assert_eq!(code(&o), 0, "{}{}", String::from_utf8_lossy(&o.stdout), stderr(&o));
}

/// Folders by themselves, so that they are tested beside each other.
const IMAGES: &str = "missions/soifra/";

#[test]
fn run_and_second_run_and_replay_are_the_same() {
    same("missions_same", |path| !path.starts_with(IMAGES));
}

#[test]
fn run_and_second_run_and_replay_are_the_same_with_images() {
    same("images_same", |path| path.starts_with(IMAGES));
}

fn same(name: &str, which: impl Fn(&str) -> bool) {
    let dir = folder(name);
    let chosen = missions().into_iter().filter(|(path, runnable)| *runnable && which(path));
    for (i, (path, _)) in chosen.enumerate() {
        let mut digests = Vec::new();
        for (name, threads) in [("a", "1"), ("b", "2")] {
            let trace = dir.join(format!("{i}{name}.mcap")).to_string_lossy().into_owned();
            let o = soifra(&[
                "run",
                &path,
                "--seed",
                "5",
                "--trace",
                &trace,
                "--threads",
                threads,
                "--format",
                "json",
            ]);
            assert!([0, 1].contains(&code(&o)), "{path}: {}", stderr(&o));
            digests.push(json(&o)["trace"]["digest"].clone());
        }
        assert_eq!(digests[0], digests[1], "{path}: two runs differ");
        let trace = dir.join(format!("{i}a.mcap")).to_string_lossy().into_owned();
        for arguments in [vec!["replay", trace.as_str()], vec!["replay", trace.as_str(), "--recorded"]] {
            let o = soifra(&arguments);
            assert_eq!(code(&o), 0, "{path}: {}", stderr(&o));
        }
    }
}

#[test]
fn their_own_tests_pass() {
    let o = soifra(&["test", "missions"]);
    assert_eq!(code(&o), 0, "{}{}", String::from_utf8_lossy(&o.stdout), stderr(&o));
}
