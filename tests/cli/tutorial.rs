//! What the tutorial says of its missions is so.

use crate::support::{code, file, folder, json, root, soifra, stderr};
use std::collections::BTreeMap;

/// Whole files of the tutorial, and the trolley put into the first.
fn missions() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("docs/tutorial.md")).expect("the tutorial");
    let block = |mark: &str, n: usize| {
        let rest = text.split(mark).nth(n).expect("a block");
        rest.split("```").next().unwrap_or_default().to_string()
    };
    let (first, last) = (block("```soi\n", 1), block("```soi\n", 2));
    let bounds = first.lines().find(|l| l.contains("bounds =")).expect("bounds").to_string();
    let trolley = block("```soi mission\n", 1);
    let second = first.replace(&bounds, &format!("{bounds}\n{trolley}"));
    vec![first, second, last]
}

/// Outcomes of 20 seeds, by the value of a parameter.
fn sweep(path: &str, set: &[&str]) -> BTreeMap<String, Vec<String>> {
    let mut arguments = vec!["sweep", path, "--seeds", "20", "--format", "json"];
    for s in set {
        arguments.extend(["--set", s]);
    }
    let o = soifra(&arguments);
    let mut out: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for r in json(&o)["runs"].as_array().unwrap_or_else(|| panic!("{}", stderr(&o))) {
        out.entry(r["set"].to_string()).or_default().push(r["outcome"].as_str().unwrap_or("").into());
    }
    out
}

#[test]
fn missions_do_what_is_said_of_them() {
    let dir = folder("tutorial");
    let paths: Vec<String> =
        missions().iter().enumerate().map(|(i, t)| file(&dir, &format!("{i}.soi"), t)).collect();
    let share = |outcomes: &[String], what: &str| outcomes.iter().filter(|o| *o == what).count();

    let alone = sweep(&paths[0], &["cruise=0.2m/s,0.4m/s,0.6m/s"]);
    assert_eq!(alone.len(), 3);
    assert!(alone.values().all(|o| share(o, "success") == 20), "{alone:?}");

    let blind = sweep(&paths[1], &[]);
    assert_eq!(blind.values().map(|o| share(o, "failed")).sum::<usize>(), 5, "{blind:?}");

    assert_eq!(code(&soifra(&["test", &paths[2]])), 1, "seed 2 fails at 60 cm");
    for (keep_off, outcome, at_least) in
        [("60cm", "failed", 1), ("80cm", "success", 20), ("100cm", "success", 20)]
    {
        let found = sweep(&paths[2], &[&format!("keep_off={keep_off}")]);
        let n: usize = found.values().map(|o| share(o, outcome)).sum();
        assert!(n >= at_least, "{keep_off}: {found:?}");
    }
    let mended = missions()[2].replace("keep_off: Length = 60 cm", "keep_off: Length = 80 cm");
    let o = soifra(&["test", &file(&dir, "mended.soi", mended)]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
}
