//! What the checker says about mistakes: a corpus of missions with one mistake each, whose offending line ends
//! with `//~ CODE`, pages that explain every code, and input that nobody would write on purpose.
//!
//! A new case is a dropped file under `tests/golden/check_error/AREA/`. `SOIFRA_BLESS=1` writes its report anew.

mod bad_input;
mod pages;

use crate::support::root;
use soifra::{compile, exit::Exit, report::Findings};
use soifra_graph::{Diagnostic, Severity, span::Source};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Whether generated files are to be written anew.
fn blessing() -> bool {
    std::env::var_os("SOIFRA_BLESS").is_some()
}

/// The files of a folder and its folders that end in `.ext`, by path from the repository's root.
fn files(folder: &str, ext: &str) -> Vec<String> {
    fn collect(at: &Path, ext: &str, out: &mut Vec<PathBuf>) {
        for e in fs::read_dir(at).unwrap_or_else(|e| panic!("{}: {e}", at.display())) {
            let path = e.expect("a readable folder").path();
            if path.is_dir() {
                collect(&path, ext, out);
            } else if path.extension().is_some_and(|e| e == ext) {
                out.push(path);
            }
        }
    }
    let mut out = Vec::new();
    collect(&root().join(folder), ext, &mut out);
    let mut out: Vec<String> =
        out.iter().filter_map(|p| Some(p.strip_prefix(root()).ok()?.to_str()?.to_string())).collect();
    out.sort();
    out
}

/// Line of a byte of a source, from 1.
fn line_of(source: &Source, at: u32) -> usize {
    source.text[..at as usize].matches('\n').count() + 1
}

/// Findings as `path:line CODE`, sorted; without the path for the file itself.
fn places(findings: &Findings, weight: Severity) -> Vec<String> {
    let place = |d: &Diagnostic| {
        let at = d.position();
        let source = &findings.sources[at.file as usize];
        let path = if at.file == 0 { "" } else { &source.path };
        format!("{path}:{} {}", line_of(source, at.start), d.code)
    };
    let mut out: Vec<String> =
        findings.diagnostics.iter().filter(|d| d.severity == weight).map(place).collect();
    out.sort();
    out
}

/// What the markers of a file announce, in the same form.
fn marked(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let markers = line.split("//~ ").skip(1).filter_map(|m| m.split_whitespace().next());
        out.extend(markers.map(|code| format!(":{} {code}", i + 1)));
    }
    out.sort();
    out
}

/// What is wrong with the form of findings: a title is one line, hints say what to do, labels are in place.
fn bad_form(findings: &Findings) -> Vec<String> {
    let mut out = Vec::new();
    for d in &findings.diagnostics {
        let mut wrong = |why: &str| out.push(format!("{} `{}`: {why}", d.code, d.title));
        if d.title.contains('\n') || d.title.ends_with('.') || d.title.chars().count() > 100 {
            wrong("a title is one short line without full stop");
        }
        if d.hint.as_ref().is_none_or(|h| h.trim().is_empty()) {
            wrong("no hint");
        }
        if d.labels.is_empty() {
            wrong("no label");
        }
        for l in &d.labels {
            let text = findings.sources.get(l.span.file as usize).map_or("", |s| s.text.as_str());
            match text.get(l.span.start as usize..l.span.end as usize) {
                None => wrong("a label that is in no source"),
                Some(s) if s.contains("//~") => wrong("a label that covers a comment"),
                Some(_) => {}
            }
            if l.text.trim().is_empty() || l.text.ends_with('.') {
                wrong("a label is a few words without full stop");
            }
        }
    }
    out
}

#[test]
fn every_mistake_is_refused_where_it_is() {
    let (mut wrong, mut codes, mut areas) = (Vec::new(), BTreeSet::new(), BTreeMap::new());
    let cases = files("tests/golden/check_error", "soi");
    for path in &cases {
        let text = fs::read_to_string(root().join(path)).expect("a readable case");
        *areas.entry(path.split('/').nth(3).unwrap_or_default()).or_insert(0) += 1;
        let announced = marked(&text);
        codes.extend(announced.iter().filter_map(|m| m.split(' ').nth(1)).map(str::to_string));
        let Err(refusal) = compile::check(path, None, None) else {
            wrong.push(format!("{path}: accepted, but {announced:?} is announced"));
            continue;
        };
        if refusal.exit != Exit::WrongInput {
            wrong.push(format!("{path}: another exit code"));
        }
        let found = places(&refusal.findings, Severity::Error);
        if found != announced {
            wrong.push(format!("{path}: {found:?}, but {announced:?} is announced"));
        }
        wrong.extend(bad_form(&refusal.findings).iter().map(|w| format!("{path}: {w}")));
        let report = refusal.findings.render(false);
        let golden = root().join(path).with_extension("report");
        if blessing() {
            fs::write(&golden, &report).expect("a report that can be written");
        } else if fs::read_to_string(&golden).unwrap_or_default() != report {
            wrong.push(format!(
                "{path}: its report differs; look at it and run again with SOIFRA_BLESS=1\n{report}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{} complaints\n{}", wrong.len(), wrong.join("\n"));
    assert!(cases.len() >= 60, "{} cases", cases.len());
    for (area, n) in &areas {
        assert!(*n >= 3, "area {area} has {n} cases");
    }
    // What cannot be caused by a source file with a mission, and what only warns.
    let elsewhere = ["S0507", "S0512", "S0513", "S0701", "S0801"];
    let without: Vec<&str> = soifra_lang::explanations()
        .map(|e| e.code)
        .filter(|c| !codes.contains(*c) && !elsewhere.contains(c))
        .collect();
    assert!(without.is_empty(), "no case for {without:?}");
}

#[test]
fn reports_belong_to_cases() {
    for report in files("tests/golden/check_error", "report") {
        let case = root().join(&report).with_extension("soi");
        assert!(case.exists(), "{report} belongs to no case: remove it");
    }
}

#[test]
fn sound_missions_pass_with_the_warnings_they_announce() {
    let mut wrong = Vec::new();
    for path in files("tests/golden/check", "soi") {
        let text = fs::read_to_string(root().join(&path)).expect("a readable case");
        match compile::check(&path, None, None) {
            Err(refusal) => wrong.push(format!("{path} is refused\n{}", refusal.findings.render(false))),
            Ok(checked) => {
                let found = places(&checked.findings, Severity::Warning);
                if found != marked(&text) {
                    wrong.push(format!("{path}: {found:?}, but {:?} is announced", marked(&text)));
                }
                wrong.extend(bad_form(&checked.findings).iter().map(|w| format!("{path}: {w}")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
