//! Dependency direction: lang → graph ← runtime ← platforms, and the root package over all.

use crate::support::root;
use std::collections::BTreeSet;

/// The soifra crates that the manifest of a folder is built with. Tests may use more: the runtime's are
/// written in the language.
fn depends_on(folder: &str) -> BTreeSet<String> {
    let path = root().join(folder).join("Cargo.toml");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let (mut in_table, mut out) = (false, BTreeSet::new());
    for line in text.lines().map(str::trim) {
        if line.starts_with('[') {
            in_table = matches!(line, "[dependencies]" | "[build-dependencies]");
        } else if in_table && line.starts_with("soifra") {
            let name = line
                .split(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_'))
                .next()
                .unwrap_or_default();
            out.insert(name.trim_start_matches("soifra-").to_string());
        }
    }
    out
}

fn set(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|n| (*n).to_string()).collect()
}

#[test]
fn crates_depend_in_one_direction() {
    assert_eq!(depends_on("lang/graph"), set(&[]));
    assert_eq!(depends_on("lang"), set(&["graph"]));
    assert_eq!(depends_on("runtime"), set(&["graph"]));
    assert_eq!(depends_on("platforms/camera"), set(&[]));
    assert_eq!(depends_on("platforms"), set(&["graph", "runtime", "camera"]));
    assert_eq!(depends_on("runtime/vision"), set(&[]));
    assert_eq!(depends_on("runtime/mapping"), set(&[]));
    assert_eq!(depends_on("."), set(&["graph", "lang", "runtime", "platforms", "vision", "mapping"]));
}

#[test]
fn pure_crates_touch_no_file_clock_or_terminal() {
    let forbidden = [
        "std::fs",
        "std::net",
        "std::process",
        "std::io",
        "std::env",
        "Instant::now",
        "SystemTime",
        "println!",
        "eprintln!",
    ];
    for folder in ["lang/src", "lang/graph/src", "runtime/src", "runtime/mapping/src"] {
        for path in crate::support::files(folder, ".rs") {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            for (number, line) in text.lines().enumerate() {
                let code = line.split("//").next().unwrap_or_default();
                for word in forbidden {
                    assert!(
                        !code.contains(word),
                        "{}:{}: {word} in a crate that is pure",
                        path.display(),
                        number + 1
                    );
                }
            }
        }
    }
}
