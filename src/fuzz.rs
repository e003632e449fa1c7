//! Fuzz bodies: plain functions that take any bytes and must neither panic nor hang. The test suite
//! runs them over a corpus; `fuzz/` wraps them for cargo-fuzz.

use crate::{graph_file, plot, recording, trace_file};
use soifra_graph::{Diagnostic, Graph, Severity};
use soifra_lang::CheckOptions;
use soifra_runtime::{Mission, Settings};
use std::{collections::BTreeMap, io::Cursor};

/// Knows the embedded library and no files.
struct NoFiles;

impl soifra_lang::Loader for NoFiles {
    fn load(&mut self, _: &str) -> Result<String, String> {
        Err("there are no files here".into())
    }

    fn library(&self) -> Vec<(String, String)> {
        soifra_platforms::library().map(|(p, t)| (p.to_string(), t.to_string())).collect()
    }
}

/// Parses and formats; what was formatted must stay as it is when formatted again.
pub fn fuzz_parse(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(once) = soifra_lang::format(text) {
        let twice = soifra_lang::format(&once);
        assert_eq!(twice.ok().as_ref(), Some(&once), "formatting is not idempotent");
    }
}

/// Checks a source; a graph that comes out must pass the verifier and survive being written and read.
pub fn fuzz_check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let checked = soifra_lang::check("fuzz.soi", text, &mut NoFiles, &CheckOptions::default());
    let findings = crate::report::Findings { diagnostics: checked.diagnostics, sources: checked.sources };
    findings.render(false);
    if let Some(graph) = checked.graph {
        let found = faults(&graph);
        assert!(found.is_empty(), "a checked graph does not pass the verifier: {found:#?}\n{text}");
        let json = graph_file::canonical(&graph).unwrap_or_default();
        let back = graph_file::parse("fuzz.json", &json).ok();
        assert!(back.as_ref() == Some(&graph), "a graph changes when it is written and read");
    }
}

/// Loads a graph file in both forms, verifies it, and sets a run up.
pub fn fuzz_graph(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    for path in ["fuzz.json", "fuzz.yaml"] {
        let Ok(graph) = graph_file::parse(path, text) else { continue };
        if !faults(&graph).is_empty() {
            continue;
        }
        for show in [crate::graph_view::Show::Behaviour, crate::graph_view::Show::Agents] {
            crate::graph_view::svg(&graph, show);
        }
        let Ok(mission) = Mission::load(graph) else { continue };
        let _ = mission.scene(&Settings { seed: 1, params: BTreeMap::new(), threads: 1 });
    }
}

/// Reads a trace, whole or damaged, and draws what can be read.
pub fn fuzz_trace(data: &[u8]) {
    if let Ok(trace) = trace_file::Reader::new(Cursor::new(data)).and_then(trace_file::Reader::into_trace) {
        let all = plot::Selection::default();
        let chart = plot::Sequence::of(&trace, &all, 100);
        chart.mermaid();
        for picture in [plot::top_view(&trace), chart.drawing(), plot::Gantt::of(&trace, &all, 100).drawing()]
        {
            assert!(!picture.to_svg().contains("NaN"), "a picture has places that are no numbers");
            let _ = picture.to_png(60);
        }
    }
}

/// Reads a video and an image, whole or damaged.
pub fn fuzz_images(data: &[u8]) {
    let mut input = Cursor::new(data);
    if let Ok(video) = recording::Y4m::index(&mut input) {
        for n in 0..video.count().min(8) {
            let pixels = video.image(&mut input, n).map(|i| i.len());
            assert_eq!(pixels, Ok(3 * video.width * video.height), "a frame that was found is not there");
        }
    }
    if let Ok(image) = recording::decode(data) {
        assert_eq!(image.data.len(), 3 * image.width * image.height, "an image without all of its pixels");
    }
}

/// What the verifier refuses; warnings do not keep a graph from running.
fn faults(graph: &Graph) -> Vec<Diagnostic> {
    let mut found = soifra_lang::verify(graph);
    found.retain(|d| d.severity == Severity::Error);
    found
}
