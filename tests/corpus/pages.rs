//! The pages of `lang/diagnostics/`: every code has one, its example gives this code and no other, the
//! corrected one gives none, and `docs/diagnostics.md` is made of them.

use super::blessing;
use crate::support::root;
use soifra_graph::{Severity, span::Source};
use soifra_lang::{CheckOptions, Loader, check, explanations};
use std::fs;

/// Examples import themselves or the standard library; everything else they need is shipped.
struct Shipped {
    path: String,
    text: String,
}

impl Loader for Shipped {
    fn load(&mut self, path: &str) -> Result<String, String> {
        if path == self.path { Ok(self.text.clone()) } else { Err("there is no such file".into()) }
    }

    fn library(&self) -> Vec<(String, String)> {
        soifra_platforms::library().map(|(p, t)| (p.to_string(), t.to_string())).collect()
    }
}

/// The findings of an example: code, weight, title with line.
fn findings(code: &str, text: &str) -> Vec<(&'static str, Severity, String)> {
    let path = format!("{code}.soi");
    let mut loader = Shipped { path: path.clone(), text: text.to_string() };
    let checked = check(&path, text, &mut loader, &CheckOptions::default());
    let line = |s: &[Source], at: soifra_graph::Span| {
        s.get(at.file as usize).map_or(0, |s| s.text[..at.start as usize].matches('\n').count() + 1)
    };
    let one = |d: &soifra_graph::Diagnostic| {
        (d.code, d.severity, format!("{} line {}: {}", d.code, line(&checked.sources, d.position()), d.title))
    };
    checked.diagnostics.iter().map(one).collect()
}

/// The fenced blocks of a page: what stands after the fence, and the text.
fn blocks(page: &str) -> Vec<(String, String)> {
    let (mut out, mut open): (Vec<(String, String)>, bool) = (Vec::new(), false);
    for line in page.lines() {
        match (line.strip_prefix("```"), open) {
            (Some(info), false) => {
                out.push((info.to_string(), String::new()));
                open = true;
            }
            (Some(_), true) => open = false,
            (None, true) => {
                if let Some((_, text)) = out.last_mut() {
                    text.push_str(line);
                    text.push('\n');
                }
            }
            (None, false) => {}
        }
    }
    out
}

#[test]
fn every_code_has_a_page_whose_examples_are_true() {
    let mut wrong = Vec::new();
    // Given by the command line for files without a mission; only graph files can be damaged.
    let without_example = ["S0701", "S0801"];
    for e in explanations() {
        let blocks = blocks(e.text);
        if e.text.trim().is_empty() || !e.text.contains("## What to do") {
            wrong.push(format!("{}: its page is missing or does not say what to do", e.code));
        }
        let announced = format!("soi error {}", e.code);
        let counts = (
            blocks.iter().filter(|(info, _)| *info == announced).count(),
            blocks.iter().filter(|(info, _)| info == "soi").count(),
        );
        let wanted = if without_example.contains(&e.code) { (0, 0) } else { (1, 1) };
        if counts != wanted || blocks.len() != counts.0 + counts.1 {
            wrong.push(format!("{}: one `{announced}` and one `soi` block are wanted", e.code));
        }
        for (info, text) in &blocks {
            let found = findings(e.code, text);
            let titles: Vec<&str> = found.iter().map(|(_, _, t)| t.as_str()).collect();
            let fits = if *info == announced {
                !found.is_empty() && found.iter().all(|(code, _, _)| *code == e.code)
            } else {
                found.is_empty()
            };
            if !fits {
                wrong.push(format!("{}: `{info}` gives {titles:?}", e.code));
            }
        }
    }
    assert!(wrong.is_empty(), "{} complaints\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn pages_belong_to_codes() {
    for e in fs::read_dir(root().join("lang/diagnostics")).expect("the pages") {
        let path = e.expect("a page").path();
        let code = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_string();
        assert!(explanations().any(|e| e.code == code), "{} is the page of no code", path.display());
    }
}

#[test]
fn the_manual_of_diagnostics_is_made_of_the_pages() {
    let mut out = String::from(
        "# Diagnostics\n\nEvery report of the checker carries a code. `soifra explain CODE` shows the page of a code. \
         Errors refuse a\nmission; warnings do not. The pages of the command line itself (`S90..`) are shown by `soifra explain` only.\n\n\
         Made from `lang/diagnostics/`; a test keeps both the same.\n\n| code | title |\n|---|---|\n",
    );
    for e in explanations() {
        out.push_str(&format!("| [{}](#{}) | {} |\n", e.code, e.code.to_lowercase(), e.title));
    }
    for e in explanations() {
        let text = e.text.trim_end().replace("\n## ", "\n### ");
        out.push_str(&format!("\n## {}\n\n**{}.** {text}\n", e.code, e.title));
    }
    let path = root().join("docs/diagnostics.md");
    if blessing() {
        fs::write(&path, &out).expect("a manual that can be written");
    }
    let have = fs::read_to_string(&path).unwrap_or_default();
    assert!(have == out, "docs/diagnostics.md is stale; run again with SOIFRA_BLESS=1");
}
