//! Every example of the reference and of the tutorial does what is said of it.

use super::{
    Library,
    blocks::{self, Block},
    context::wrap,
    read, repository, writing,
};
use soifra_graph::{Diagnostic, Graph, Severity, StmtKind, UnitKind, span::Source};
use soifra_lang::{CheckOptions, Checked, check, format};
use std::fs;

const PATHS: &[&str] = &["docs/language.md", "docs/tutorial.md"];

fn run(text: &str) -> Checked {
    check("missions/example.soi", text, &mut Library, &CheckOptions::default())
}

fn show(d: &Diagnostic, sources: &[Source], offset: usize) -> String {
    let mut out = format!("{} {}", d.code, d.title);
    for l in &d.labels {
        let text = &sources[l.span.file as usize].text;
        let line = text[..l.span.start as usize].matches('\n').count() + offset;
        let what = &text[l.span.start as usize..l.span.end as usize];
        out.push_str(&format!("\n    line {line}: `{what}`: {}", l.text));
    }
    out
}

/// What is wrong with a checked example; `line` is where its text begins in the reference.
fn complaints(c: &Checked, block: &Block, line: usize, whole: bool) -> Vec<String> {
    let shown = |d: &&Diagnostic| show(d, &c.sources, line);
    if let Some(code) = block.error() {
        let errors: Vec<_> = c.diagnostics.iter().filter(|d| d.severity == Severity::Error).collect();
        let other: Vec<String> =
            errors.iter().copied().filter(|d| d.code != code).map(|d| shown(&d)).collect();
        return match (errors.is_empty(), other.is_empty()) {
            (true, _) => vec![format!("{code} is expected, there is no error")],
            (false, true) => Vec::new(),
            (false, false) => other,
        };
    }
    c.diagnostics.iter().filter(|d| whole || d.severity == Severity::Error).map(|d| shown(&d)).collect()
}

#[test]
fn examples_are_as_they_say() {
    let mut wrong: Vec<String> = Vec::new();
    let mut count = 0;
    // Parts of a file stand in the reference's context.
    let reference = read(PATHS[0]);
    for path in PATHS {
        let text = read(path);
        for b in blocks::of(&text, "soi") {
            count += 1;
            let mut complain =
                |list: Vec<String>| wrong.extend(list.iter().map(|w| format!("{path}:{}: {w}", b.line)));
            match b.kind() {
                "" | "context" => complain(complaints(&run(&b.text), &b, b.line, true)),
                "expr" => lines(&reference, &b, &mut complain),
                _ => {
                    let (file, before) = wrap(&reference, &b, &b.text);
                    complain(complaints(&run(&file), &b, (b.line + 1).saturating_sub(before), false));
                }
            }
        }
    }
    assert!(count > 20, "only {count} examples found");
    assert!(wrong.is_empty(), "{} complaints\n{}", wrong.len(), wrong.join("\n"));
}

/// A block of expressions, one a line: `EXPRESSION  // TYPE`, or each wrong by itself.
fn lines(reference: &str, b: &Block, complain: &mut impl FnMut(Vec<String>)) {
    for (i, line) in b.text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()) {
        let (e, ty) = line.rsplit_once("  // ").unwrap_or((line, ""));
        let (file, before) = wrap(reference, b, &format!("let result = {e}"));
        let checked = run(&file);
        complain(complaints(&checked, b, (b.line + i + 1).saturating_sub(before), false));
        let ty = ty.trim();
        if b.error().is_none() {
            let found = checked.graph.as_ref().and_then(result_type);
            if found.as_deref() != Some(ty) {
                complain(vec![format!("`{}` is {}, not {ty}", e.trim(), found.unwrap_or_default())]);
            }
        }
    }
}

/// The type of the `let` that [`lines`] writes.
fn result_type(g: &Graph) -> Option<String> {
    let units = g.agents.iter().flat_map(|a| &a.units).filter(|u| &*u.name == "work");
    let bodies = units.filter_map(|u| match &u.kind {
        UnitKind::Service(body) => Some(body),
        _ => None,
    });
    let found = bodies.flatten().find_map(|s| match &s.kind {
        StmtKind::Let(_, e) if g.sources[0].text[..s.at.end as usize].contains("let result = ") => Some(e),
        _ => None,
    });
    found.map(|e| e.ty.to_string())
}

/// Whole files are laid out as `soifra fmt` does it.
#[test]
fn whole_files_are_in_canonical_form() {
    let _guard = writing();
    for path in PATHS {
        let text = read(path);
        let (mut new, mut stale) = (text.clone(), Vec::new());
        for b in blocks::of(&text, "soi")
            .iter()
            .filter(|b| matches!(b.kind(), "" | "context") && b.error().is_none())
        {
            match format(&b.text) {
                Ok(f) if f != b.text => {
                    stale.push(b.line);
                    new = new.replace(&format!("\n{}```", b.text), &format!("\n{f}```"));
                }
                Ok(_) => {}
                Err(e) => panic!("{path}:{}: {e:?}", b.line),
            }
        }
        if new != text && std::env::var_os("SOIFRA_BLESS").is_some() {
            fs::write(repository(path), new).unwrap();
            continue;
        }
        assert!(stale.is_empty(), "{path}: examples at lines {stale:?}; run again with SOIFRA_BLESS=1");
    }
}
