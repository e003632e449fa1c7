//! `graph`.

use super::mission;
use crate::support::{code, folder, json, soifra, stderr, stdout};

#[test]
fn every_form_shows_every_part() {
    let dir = folder("graph_forms");
    let path = mission(&dir);
    for (form, begins) in [("mermaid", "---\n"), ("dot", "digraph"), ("svg", "<svg")] {
        let o = soifra(&["graph", &path, "--format", form]);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        let text = stdout(&o);
        assert!(text.starts_with(begins), "{form}: {text}");
        for part in ["driver", "pose", "base", "deliver", "porter", "drive every 100 ms"] {
            assert!(text.contains(part), "{form} lacks {part}: {text}");
        }
        // The ending of the file says it too.
        let named = dir.join(if form == "mermaid" { "g.md".into() } else { format!("g.{form}") });
        let o = soifra(&["graph", &path, "-o", &named.to_string_lossy()]);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        assert_eq!(std::fs::read_to_string(&named).expect("a graph"), text);
    }
}

#[test]
fn a_graph_file_is_the_graph() {
    let dir = folder("graph_file");
    let path = mission(&dir);
    let o = soifra(&["graph", &path, "--format", "json"]);
    let d = json(&o);
    assert_eq!((d["schema"].clone(), d["name"].clone()), (1.into(), "errand".into()));
    for form in ["yaml", "json"] {
        let graph = dir.join(format!("g.{form}")).to_string_lossy().into_owned();
        assert_eq!(code(&soifra(&["graph", &path, "--format", form, "-o", &graph])), 0);
        let again = soifra(&["graph", &graph, "--format", "json"]);
        assert_eq!(o.stdout, again.stdout, "{form} does not keep the graph");
    }
}

#[test]
fn a_graph_that_was_tampered_with_is_refused() {
    let dir = folder("graph_tampered");
    let text = stdout(&soifra(&["graph", &mission(&dir), "--format", "json"]));
    let cases = [
        text.replace("\"command\": [\n", "\"command\": [\n9"),
        text.replace("\"reading\": 0", "\"reading\": 7"),
        text.replace("\"agent\": 0", "\"agent\": 3"),
        text.replace("\"platform\": 0", "\"platform\": 3"),
        text.replace("\"Velocity\"", "\"Length\""),
        text[..text.len() / 2].to_string(),
    ];
    for (i, case) in cases.iter().enumerate() {
        assert_ne!(*case, text, "case {i} changes nothing");
        let path = crate::support::file(&dir, &format!("{i}.json"), case);
        let o = soifra(&["run", &path, "--trace", "none"]);
        assert_eq!(code(&o), 2, "case {i}: {}{}", stdout(&o), stderr(&o));
        assert!(!stderr(&o).contains("S9999"), "case {i}: {}", stderr(&o));
    }
}
