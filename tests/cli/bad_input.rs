//! Whatever is given: a diagnostic with a code, the right exit code, in time, and never a panic.

use super::{MISSION, mission};
use crate::support::{code, command, file, folder, json, soifra, stderr};
use std::{process::Stdio, time::Duration};

/// Refused with exit 2 and this code by check and run, also with JSON.
fn refused(path: &str, wanted: &str) {
    for arguments in [vec!["check", path], vec!["run", path, "--trace", "none"]] {
        let o = soifra(&arguments);
        let text = stderr(&o);
        assert_eq!(code(&o), 2, "{arguments:?}: {text}");
        assert!(text.contains(&format!("[{wanted}]")), "{arguments:?}: {text}");
        assert!(!text.contains("panicked") && !text.contains("S9999"), "{text}");
        let mut with_json = arguments.clone();
        with_json.extend(["--format", "json"]);
        let o = soifra(&with_json);
        assert_eq!((code(&o), json(&o)["diagnostics"][0]["code"].clone()), (2, wanted.into()));
    }
}

#[test]
fn files_that_are_no_sources() {
    let dir = folder("bad_files");
    refused(&dir.join("absent.soi").to_string_lossy(), "S9001");
    refused(&dir.to_string_lossy(), "S9002");
    refused(&file(&dir, "latin.soi", b"mission caf\xe9 {}"), "S9003");
    refused(&file(&dir, "empty.soi", ""), "S0701");
    refused(&file(&dir, "blank.soi", "\n  \n"), "S0701");
    refused(&file(&dir, "graph.json", "{\"schema\": 1, "), "S9005");
    refused(&file(&dir, "graph.yaml", "- a\n"), "S9006");
    refused(&file(&dir, "old.yaml", "schema: 0\n"), "S9007");
    let text = stderr(&soifra(&["check", &dir.join("empyt.soi").to_string_lossy()]));
    assert!(text.contains("did you mean") && text.contains("empty.soi"), "{text}");
}

#[test]
fn garbage_nesting_and_long_names() {
    let dir = folder("bad_text");
    let mut state = 7u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        b' ' + (state >> 24) as u8 % 95
    };
    let garbage: Vec<u8> = (0..10_000_000).map(|i| if i % 80 == 79 { b'\n' } else { byte() }).collect();
    let one_line: Vec<u8> = garbage.iter().map(|b| if *b == b'\n' { b'x' } else { *b }).collect();
    let deep =
        format!("edition 1\nfn f(x: Number) -> Number = {}x{}\n", "(".repeat(100_000), ")".repeat(100_000));
    let name = format!("edition 1\nmission {} {{ }}\n", "n".repeat(300));
    let overflow = MISSION.replace("0.5 m/s", "1e999 m/s");
    let cases = [
        ("garbage.soi", garbage),
        ("one_line.soi", one_line),
        ("deep.soi", deep.into_bytes()),
        ("long_name.soi", name.into_bytes()),
        ("overflow.soi", overflow.into_bytes()),
        ("zeros.soi", vec![0; 100_000]),
    ];
    for (name, bytes) in cases {
        let path = file(&dir, name, bytes);
        let o = soifra(&["check", &path]);
        let text = stderr(&o);
        assert_eq!(code(&o), 2, "{name}: {}", &text[..text.len().min(2000)]);
        assert!(text.contains("[S0") && text.contains(&format!("{path}:")), "{name}");
        assert!(!text.contains("panicked") && !text.contains("S9999"), "{name}");
        assert!(text.lines().all(|l| l.chars().count() < 700), "{name}: a line was not cut");
        assert!(!text.contains('\0'), "{name}: control characters reach the terminal");
    }
}

#[test]
fn settings_that_do_not_fit() {
    let dir = folder("bad_settings");
    let path = mission(&dir);
    for (arguments, wanted, says) in [
        (vec!["--set", "sped=1m/s"], "S9010", "did you mean `speed`"),
        (vec!["--set", "speed=1s"], "S9011", "speed"),
        (vec!["--set", "speed"], "S9011", "name=value"),
        (vec!["--platform", "no_such_platform"], "S0401", "no_such_platform"),
    ] {
        let mut all = vec!["run", path.as_str(), "--trace", "none"];
        all.extend(arguments);
        let o = soifra(&all);
        assert_eq!(code(&o), 2, "{all:?}: {}", stderr(&o));
        assert!(stderr(&o).contains(wanted) && stderr(&o).contains(says), "{}", stderr(&o));
    }
}

#[test]
fn a_trace_that_cannot_be_written() {
    let dir = folder("bad_trace");
    let path = mission(&dir);
    let blocked = file(&dir, "file", "");
    for trace in [format!("{blocked}/t.mcap"), dir.to_string_lossy().into_owned(), "/dev/full".into()] {
        let o = soifra(&["run", &path, "--trace", &trace, "--format", "json"]);
        assert_eq!(code(&o), 2, "{trace}: {}", stderr(&o));
        assert_eq!(json(&o)["diagnostics"][0]["code"], "S9012");
    }
    for bytes in [&b""[..], b"no trace", b"\x89MCAP0\r\n"] {
        let trace = file(&dir, "bad.mcap", bytes);
        for command in ["replay", "plot"] {
            let o = soifra(&[command, &trace]);
            assert_eq!(code(&o), 2);
            assert!(stderr(&o).contains("S9018"), "{}", stderr(&o));
        }
    }
}

#[test]
fn a_reader_that_goes_away() {
    let mut child =
        command(&["explain", "--all"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let o = child.wait_with_output().unwrap();
    assert_eq!((code(&o), stderr(&o).as_str()), (0, ""));
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_trace() {
    let dir = folder("interrupt");
    let endless =
        MISSION.replace("within 30 s", "within 3000000 s").replace("set arrived = true", "note \"there\"");
    let path = file(&dir, "endless.soi", endless);
    let trace = dir.join("t.mcap").to_string_lossy().into_owned();
    let child = command(&["run", &path, "--trace", &trace])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Until it has recorded something.
    for _ in 0..400 {
        if std::fs::metadata(&trace).is_ok_and(|m| m.len() > 20_000) {
            break;
        }
        std::thread::sleep(Duration::from_millis(25));
    }
    let pid = child.id().to_string();
    assert!(
        std::process::Command::new("sh").args(["-c", "kill -INT \"$0\"", &pid]).status().unwrap().success()
    );
    let o = child.wait_with_output().unwrap();
    assert_eq!(code(&o), 130, "{}", stderr(&o));
    let o = soifra(&["replay", &trace, "--format", "json"]);
    assert_eq!((code(&o), json(&o)["complete"].clone()), (0, true.into()), "{}", stderr(&o));
}
