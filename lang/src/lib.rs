//! The mission language: text in, checked behaviour graph and diagnostics out.
//!
//! Invariant: no file, clock or terminal is touched here; a [`Loader`] hands over imported texts.

pub mod ast;
pub mod check;
pub mod code;
pub(crate) mod conversation;
mod decls;
mod derived;
mod explain;
pub mod format;
mod lower;
mod modules;
pub mod parse;
pub mod schedule;
mod test_case;
mod typed;
mod unseen;
mod value;

pub use check::{Allotted, allocation, verify};
pub use explain::{Explanation, explain, explanations};
pub use format::format;
pub use modules::Loader;
pub use test_case::TestCase;
pub use value::parse_value;

use soifra_graph::{Diagnostic, Graph, Severity, span::Source};

/// What came out of checking a file.
#[derive(Debug)]
pub struct Checked {
    /// The graph, when nothing stands in the way of running it.
    pub graph: Option<Graph>,
    /// The file's missions, in order.
    pub missions: Vec<String>,
    /// Platform profiles that a robot could be, those of the file and of the library.
    pub platforms: Vec<String>,
    /// Every finding, by file and position; errors and warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// Sources that spans refer to.
    pub sources: Vec<Source>,
    /// The file's tests.
    pub tests: Vec<TestCase>,
    /// The timing of each mission, when it was asked for; also of one that cannot be run.
    pub timings: Vec<(String, schedule::Timing)>,
}

/// How to check.
#[derive(Debug, Clone, Default)]
pub struct CheckOptions {
    /// Platform for every robot, in place of the one it names.
    pub platform: Option<String>,
    /// Which mission, when the program has several; else the root file's first.
    pub mission: Option<String>,
    /// Test whose faults are to happen too.
    pub test: Option<String>,
    /// Whether the timing is wanted.
    pub timing: bool,
}

/// Checks the file `path` with text `text` and everything it imports.
///
/// A file without a mission is checked too; it gives no graph, and no error for lacking one: a file of
/// agents or profiles is not wrong. Running it is refused by the caller. So is a mission that is asked for and
/// not there.
pub fn check(path: &str, text: &str, loader: &mut dyn Loader, options: &CheckOptions) -> Checked {
    let mut program = modules::Program::load(path, text, loader);
    let mut diagnostics = std::mem::take(&mut program.errors);
    let mut later = derived::missions(&mut program);
    let decls = decls::Decls::collect(&program, &mut diagnostics);
    // A test says which mission it is about.
    let run = decls.tests.iter().find(|t| options.test.as_deref() == Some(&*t.name.name));
    let run = run.and_then(|t| t.run.first()).map(|m| m.name.to_string());
    let options = &CheckOptions { mission: options.mission.clone().or(run), ..options.clone() };
    let missions: Vec<String> = decls.root_missions().map(|m| m.name.name.to_string()).collect();
    let platforms: Vec<String> = decls.platforms.keys().map(|p| p.to_string()).collect();
    if let Some(name) = &options.mission
        && !decls.missions.iter().any(|(_, m)| *m.name.name == **name)
    {
        let sources = std::mem::take(&mut program.sources);
        return Checked {
            graph: None,
            missions,
            platforms,
            diagnostics,
            sources,
            tests: Vec::new(),
            timings: Vec::new(),
        };
    }
    let mut timings = Vec::new();
    let mut time = |g: &Graph| {
        if options.timing {
            timings.extend(schedule::of_graph(g).map(|t| (g.name.to_string(), t)));
        }
    };
    let syntax_failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    let unseen = unseen::Unseen::of(&program, &diagnostics);
    let choice = lower::Choice {
        platform: options.platform.clone(),
        alternative: 0,
        mission: options.mission.clone(),
        test: options.test.clone(),
    };
    let mut graph = lower::lower(&program, &decls, &choice, &mut later);
    let tests = test_case::collect(&decls, graph.as_ref(), &mut later);
    if syntax_failed {
        later.retain(|d| !unseen.explains(d));
        graph = None;
    }
    diagnostics.append(&mut later);
    if let Some(g) = &graph {
        time(g);
        diagnostics.extend(verify(g));
        if options.platform.is_none() {
            let others = alternatives(&program, &decls, &choice, g, &diagnostics);
            diagnostics.extend(others);
        }
    }
    if options.mission.is_none() && !syntax_failed {
        for name in missions.iter().skip(1) {
            let choice = lower::Choice { mission: Some(name.clone()), ..choice.clone() };
            let mut here = Vec::new();
            if let Some(g) = lower::lower(&program, &decls, &choice, &mut here) {
                time(&g);
                here.extend(verify(&g));
                here.extend(alternatives(&program, &decls, &choice, &g, &here));
            }
            // What the missions share is told once.
            here.retain(|d| !diagnostics.contains(d));
            diagnostics.extend(here);
        }
    }
    if !syntax_failed {
        diagnostics.extend(of_tests(&program, &decls, &choice, &diagnostics));
    }
    diagnostics.sort_by(|a, b| (a.position(), a.code, &a.title).cmp(&(b.position(), b.code, &b.title)));
    diagnostics.dedup();
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        graph = None;
    }
    let sources = std::mem::take(&mut program.sources);
    Checked { graph, missions, platforms, diagnostics, sources, tests, timings }
}

/// What is wrong only with the faults of a test.
fn of_tests(
    program: &modules::Program,
    decls: &decls::Decls<'_>,
    first: &lower::Choice,
    known: &[Diagnostic],
) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for t in decls.tests.iter().filter(|t| !t.faults.is_empty()) {
        let (mission, test) = (t.run.first().map(|m| m.name.to_string()), Some(t.name.name.to_string()));
        let mut here = Vec::new();
        if let Some(g) =
            lower::lower(program, decls, &lower::Choice { mission, test, ..first.clone() }, &mut here)
        {
            here.extend(verify(&g));
        }
        found.extend(here.into_iter().filter(|d| !known.contains(d)));
    }
    found
}

/// What is wrong only when robots are what `any of […]` names after the first.
fn alternatives(
    program: &modules::Program,
    decls: &decls::Decls<'_>,
    first: &lower::Choice,
    graph: &Graph,
    known: &[Diagnostic],
) -> Vec<Diagnostic> {
    let most = graph.robots.iter().map(|r| r.alternatives.len()).max().unwrap_or(0);
    let mut found: Vec<Diagnostic> = Vec::new();
    for alternative in 1..=most {
        let choice = lower::Choice { alternative, ..first.clone() };
        let mut here = Vec::new();
        if let Some(g) = lower::lower(program, decls, &choice, &mut here) {
            here.extend(verify(&g));
        }
        for mut d in here {
            if known.contains(&d) || d.severity != Severity::Error {
                continue;
            }
            let named: Vec<&str> =
                graph.robots.iter().filter_map(|r| Some(&**r.alternatives.get(alternative - 1)?)).collect();
            if !named.iter().any(|n| d.title.contains(*n)) {
                d.title = format!("as `{}`: {}", named.join("`, `"), d.title);
            }
            found.push(d);
        }
    }
    found
}
