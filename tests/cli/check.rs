//! `check`, `explain`, `completions` and the command line itself.

use super::{MISSION, mission};
use crate::support::{code, file, folder, json, soifra, stderr, stdout};

#[test]
fn a_sound_mission() {
    let dir = folder("check_sound");
    let o = soifra(&["check", &mission(&dir)]);
    assert_eq!((code(&o), stderr(&o).as_str()), (0, ""));
    assert!(stdout(&o).contains("mission `errand` is sound"));
}

#[test]
fn findings_carry_code_place_and_excerpt() {
    let dir = folder("check_unsound");
    let path = file(&dir, "a.soi", MISSION.replace("norm(way) <= 5 cm", "norm(way) <= 5 s"));
    let o = soifra(&["check", &path]);
    assert_eq!(code(&o), 2);
    let text = stderr(&o);
    let line = MISSION.lines().position(|l| l.contains("<= 5 cm")).unwrap() + 1;
    assert!(text.contains(&format!("{path}:{line}:")), "{text}");
    assert!(text.contains("[S0") && text.contains("norm(way) <= 5 s"), "{text}");
    assert!(!text.contains('\u{1b}'), "colour without a terminal");
    assert!(stdout(&o).is_empty());

    let o = soifra(&["check", &path, "--format", "json"]);
    let d = json(&o);
    assert_eq!(code(&o), 2);
    assert_eq!(d["outcome"], "refused");
    assert_eq!(d["diagnostics"][0]["line"], line);
    assert_eq!(d["diagnostics"][0]["severity"], "error");
    assert!(d["diagnostics"][0]["hint"].is_string());
}

#[test]
fn several_files_are_all_checked() {
    let dir = folder("check_several");
    let (good, bad) = (mission(&dir), file(&dir, "bad.soi", "mission {"));
    let o = soifra(&["check", &bad, &good, "--format", "json"]);
    assert_eq!(code(&o), 2);
    let d = json(&o);
    assert_eq!((d["files"][0]["sound"].clone(), d["files"][1]["sound"].clone()), (false.into(), true.into()));
    assert_eq!(d["files"][1]["graph_digest"].as_str().map(str::len), Some(64));
}

#[test]
fn every_code_is_explained() {
    let o = soifra(&["explain"]);
    assert_eq!(code(&o), 0);
    let list = stdout(&o);
    assert!(list.lines().count() > 40);
    for line in list.lines() {
        let c = line.split(' ').next().unwrap();
        let page = soifra(&["explain", c]);
        assert_eq!(code(&page), 0, "{c}");
        assert!(stdout(&page).len() > line.len() + 20, "{c} has no text");
    }
    let o = soifra(&["explain", "S0000"]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("help:"));
}

#[test]
fn completions_and_help() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let o = soifra(&["completions", shell]);
        assert_eq!(code(&o), 0);
        assert!(stdout(&o).contains("soifra"));
    }
    for command in
        ["check", "run", "sweep", "graph", "fmt", "test", "plot", "replay", "explain", "completions"]
    {
        assert_eq!(code(&soifra(&[command, "--help"])), 0);
    }
    assert_eq!(code(&soifra(&["--version"])), 0);
    assert_eq!(code(&soifra(&["fly"])), 2);
    let o = soifra(&["run", "--format", "json"]);
    assert_eq!((code(&o), json(&o)["outcome"].clone()), (2, "refused".into()));
}
