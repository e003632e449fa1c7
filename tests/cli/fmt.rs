//! `fmt`.

use super::MISSION;
use crate::support::{code, command, file, folder, soifra, stderr, stdout};
use std::{io::Write, process::Stdio};

#[test]
fn sources_come_into_form_and_stay_there() {
    let dir = folder("fmt");
    let ragged: String = MISSION.lines().map(|l| format!("   {}\n", l.trim())).collect();
    let path = file(&dir, "a.soi", &ragged);
    assert_eq!(code(&soifra(&["fmt", "--check", &path])), 1);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), ragged, "--check only reports");
    let o = soifra(&["fmt", &path]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let formed = std::fs::read_to_string(&path).unwrap();
    assert_ne!(formed, ragged);
    assert_eq!(code(&soifra(&["fmt", "--check", &path])), 0);

    let mut child = command(&["fmt", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(ragged.as_bytes()).unwrap();
    assert_eq!(stdout(&child.wait_with_output().unwrap()), formed);
}

#[test]
fn what_cannot_be_parsed_is_left_alone() {
    let dir = folder("fmt_broken");
    let text = "mission { robot }\n";
    let path = file(&dir, "a.soi", text);
    let o = soifra(&["fmt", &path]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains(&format!("{path}:1:")), "{}", stderr(&o));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}
