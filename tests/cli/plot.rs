//! `plot`.

use super::mission;
use crate::support::{code, file, folder, root, soifra, stderr, stdout};
use std::{collections::BTreeSet, path::Path};

/// Two agents that talk, on a core.
const TALK: &str = r#"edition 1

record Parcel {
  weight: Number
}

param pace: Number = 1

agent courier {
  state price: Number = 0
  state asked: Int = 0

  service ask every 100 ms worst 5 ms core 0 {
    tell desk request Parcel(weight: 2)
    set asked = asked + 1
  }

  service hear on propose Parcel(p) from desk at most every 100 ms worst 1 ms core 0 {
    set price = p.weight
  }
}

agent desk {
  service answer on request Parcel(p) from courier {
    tell courier propose Parcel(weight: p.weight + 1)
    set pace = pace + 1
  }
}

mission talk "parcels" {
  host board runs courier, desk
  goal work { subgoal often by courier achieved when asked >= 8 }
  within 10 s
}
"#;

/// The trace of a mission that succeeds.
fn trace(dir: &Path, mission: &str) -> String {
    let trace = dir.join("a.mcap").to_string_lossy().into_owned();
    let o = soifra(&["run", mission, "--trace", &trace]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    trace
}

#[test]
fn plots_are_pictures() {
    let dir = folder("run_plot");
    let path = dir.join("a.mcap").to_string_lossy().into_owned();
    assert_eq!(code(&soifra(&["run", &mission(&dir), "--trace", &path])), 0);
    let o = soifra(&["plot", &path]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert!(std::fs::read_to_string(dir.join("a.svg")).unwrap().starts_with("<svg"));
    assert!(std::fs::read(dir.join("a.png")).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(code(&soifra(&["plot", &path, "-o", "a.jpeg"])), 2);
}

#[test]
fn messages_and_schedules_are_pictures() {
    let dir = folder("plot_kinds");
    let trace = trace(&dir, &file(&dir, "talk.soi", TALK));
    let read = |name: &str| std::fs::read(dir.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    for (kind, names) in
        [("sequence", ["a-sequence.svg", "a-sequence.mmd"]), ("gantt", ["a-gantt.svg", "a-gantt.png"])]
    {
        let o = soifra(&["plot", "--kind", kind, &trace]);
        assert_eq!((code(&o), stderr(&o).as_str()), (0, ""));
        assert_eq!(stdout(&o).lines().count(), 2);
        assert!(names.iter().all(|n| !read(n).is_empty()), "{kind}");
    }
    let chart = String::from_utf8(read("a-sequence.mmd")).unwrap();
    for line in ["courier@board", "request Parcel (5 ms)", "propose Parcel (5.001 ms)", "pace = 2 (5.001 ms)"]
    {
        assert!(chart.contains(line), "{line}: {chart}");
    }
    let gantt = String::from_utf8(read("a-gantt.svg")).unwrap();
    assert!(gantt.contains("board, core 0") && gantt.contains("courier.hear"), "{gantt}");

    // A part of it; the ending of a file says what it is.
    let png = dir.join("part.PNG").to_string_lossy().into_owned();
    let text = dir.join("part.mermaid").to_string_lossy().into_owned();
    let part = ["--agent", "desk", "--from", "100 ms", "--to", "0.3", "--limit", "2"];
    let o = soifra(&[&["plot", "--kind", "sequence", &trace, "-o", &png, "-o", &text][..], &part].concat());
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert!(stderr(&o).contains("4 more rows are not drawn"), "{}", stderr(&o));
    assert!(read("part.PNG").starts_with(b"\x89PNG"));
    let part = String::from_utf8(read("part.mermaid")).unwrap();
    assert_eq!(part.matches("->>").count(), 2, "{part}");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let dir = folder("plot_refused");
    let trace = trace(&dir, &file(&dir, "talk.soi", TALK));
    for (arguments, wanted, says) in [
        (vec!["--kind", "sequence", "--agent", "curier"], "S9027", "did you mean `courier`?"),
        (vec!["--kind", "gantt", "--agent", "desk@bord"], "S9027", "did you mean `desk@board`?"),
        (vec!["--kind", "sequence", "--conversation", "c1"], "S9027", "there is no conversation"),
        (vec!["--agent", "courier"], "S9024", "--kind sequence"),
        (vec!["--from", "1 s"], "S9024", "--from"),
        (vec!["--kind", "gantt", "--conversation", "c1"], "S9024", "no messages"),
        (vec!["--kind", "gantt", "--from", "2 s", "--to", "1 s"], "S9024", "later than"),
        (vec!["--kind", "gantt", "-o", "a.mmd"], "S9012", ".svg or .png"),
        (vec!["--kind", "sequence", "-o", "a.jpeg"], "S9012", ".mmd"),
        (vec!["-o", "svg"], "S9012", ".svg or .png"),
        (vec!["--kind", "gantt", "--from", "1 m"], "--from", "1 m"),
        (vec!["--kind", "gantt", "--from=-1"], "--from", "from 0 s on"),
        (vec!["--kind", "sequence", "--limit", "0"], "--limit", "0"),
        (vec!["--kind", "side"], "--kind", "gantt"),
    ] {
        let o = soifra(&[&["plot", &trace][..], &arguments].concat());
        let text = stderr(&o);
        assert_eq!(code(&o), 2, "{arguments:?}: {text}");
        assert!(text.contains(wanted) && text.contains(says), "{arguments:?}: {text}");
    }
    // Nothing was written.
    assert_eq!(std::fs::read_dir(&dir).unwrap().count(), 2);
}

#[test]
fn every_option_is_told() {
    let page = std::fs::read_to_string(root().join("docs/commands.md")).unwrap();
    let (_, rest) = page.split_once("<!-- options: plot -->").unwrap();
    let rows = rest.split("<!-- end -->").next().unwrap().lines();
    let told: BTreeSet<&str> = rows.filter_map(|l| l.strip_prefix("| `--")?.split('`').next()).collect();
    let help = stdout(&soifra(&["plot", "--help"]));
    let options = help.lines().filter_map(|l| {
        let l = l.trim_start();
        let long = l.strip_prefix("-o, ").unwrap_or(l).strip_prefix("--")?;
        long.split(|c: char| !c.is_ascii_lowercase()).next()
    });
    assert_eq!(told, options.collect());
}
