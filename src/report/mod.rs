//! The only fancy rendering: diagnostics with source excerpts, and tables.

mod excerpt;
pub mod matrix;
pub mod table;
pub mod timing;

use crate::{exit::Exit, output};
use excerpt::Excerpt;
pub(crate) use excerpt::clean;
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, Severity as Weight, SourceCode};
use serde::Serialize;
use soifra_graph::{Diagnostic, Label, Severity, Span, span::Source};
use std::{fmt, io::IsTerminal};

/// So many diagnostics are shown with an excerpt; the rest get a line each.
const WITH_EXCERPT: usize = 30;
/// So many get a line at least; the rest are only counted.
const WITH_LINE: usize = 1000;
/// Width of a report in columns.
const WIDTH: usize = 110;

/// Findings with the sources they point into.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// What was found.
    pub diagnostics: Vec<Diagnostic>,
    /// Indexed by [`Span::file`].
    pub sources: Vec<Source>,
}

/// Why a command stopped before it did what it was asked for.
#[derive(Debug, Clone)]
pub struct Refusal {
    /// What to tell.
    pub findings: Findings,
    /// What the process ends with.
    pub exit: Exit,
}

impl From<Exit> for Refusal {
    /// Nothing more to tell: it was told where it happened.
    fn from(exit: Exit) -> Self {
        Refusal { findings: Findings::default(), exit }
    }
}

impl Refusal {
    /// Refuses with one error about a file, or about an argument (then `path` is the argument).
    pub fn about(
        path: &str,
        code: &'static str,
        title: impl Into<String>,
        seen: impl Into<String>,
        hint: &str,
    ) -> Self {
        let diagnostic = Diagnostic::error(code, title).at(Span::default(), seen).hint(hint);
        Refusal::with(diagnostic, Source { path: path.into(), text: String::new() })
    }

    /// Refuses with one error in one source.
    pub fn with(diagnostic: Diagnostic, source: Source) -> Self {
        Refusal {
            findings: Findings { diagnostics: vec![diagnostic], sources: vec![source] },
            exit: Exit::WrongInput,
        }
    }

    /// The same with another exit code.
    #[must_use]
    pub fn exit(mut self, exit: Exit) -> Self {
        self.exit = exit;
        self
    }
}

impl Findings {
    /// Number of errors.
    pub fn errors(&self) -> usize {
        self.diagnostics.iter().filter(|d| d.severity == Severity::Error).count()
    }

    /// Number of warnings.
    pub fn warnings(&self) -> usize {
        self.diagnostics.len() - self.errors()
    }

    /// Prints every finding on standard error.
    pub fn print(&self) {
        let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        let text = self.render(colour);
        if !text.is_empty() {
            output::note(text.trim_end_matches('\n'));
        }
    }

    /// Every finding as text.
    pub fn render(&self, colour: bool) -> String {
        let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_links(false)
            .with_width(WIDTH)
            .with_context_lines(1);
        let mut out = String::new();
        for (i, d) in self.diagnostics.iter().enumerate() {
            if i < WITH_EXCERPT {
                let report = Report::new(d, &self.sources);
                if handler.render_report(&mut out, &report).is_err() {
                    out.push_str(&format!("{}: {}\n", report.head, report.title));
                }
                out.push('\n');
            } else if i < WITH_LINE {
                out.push_str(&format!("{}: {}\n", head(d, &self.sources), excerpt::clean(&d.title)));
            }
        }
        if self.diagnostics.len() > WITH_LINE {
            out.push_str(&format!("… and {} more\n", self.diagnostics.len() - WITH_LINE));
        }
        out
    }

    /// Every finding as data.
    pub fn to_json(&self) -> Vec<JsonDiagnostic> {
        self.diagnostics.iter().take(WITH_LINE).map(|d| JsonDiagnostic::new(d, &self.sources)).collect()
    }

    /// `2 errors, 1 warning`; empty when there is nothing.
    pub fn count(&self) -> String {
        let some = |n: usize, word: &str| match n {
            0 => None,
            1 => Some(format!("1 {word}")),
            n => Some(format!("{n} {word}s")),
        };
        [some(self.errors(), "error"), some(self.warnings(), "warning")]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// `error[S0204] path:line:column`
fn head(d: &Diagnostic, sources: &[Source]) -> String {
    let weight = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    match d.labels.first().and_then(|l| Place::of(l.span, sources)) {
        Some(p) => format!("{weight}[{}] {}:{}:{}", d.code, p.path, p.line, p.column),
        None => format!("{weight}[{}]", d.code),
    }
}

/// Where a span is, for people: lines and columns (in characters) from 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// Path of the source.
    pub path: String,
    /// Line of the first character.
    pub line: usize,
    /// Column of the first character.
    pub column: usize,
    /// Line of the end.
    pub end_line: usize,
    /// Column of the end.
    pub end_column: usize,
}

impl Place {
    /// Where `span` is, if its source is known.
    pub fn of(span: Span, sources: &[Source]) -> Option<Place> {
        let source = sources.get(span.file as usize)?;
        let (line, column) = position(&source.text, span.start as usize);
        let (end_line, end_column) = position(&source.text, (span.end as usize).max(span.start as usize));
        Some(Place { path: source.path.clone(), line, column, end_line, end_column })
    }
}

/// Line and column, from 1, of a byte offset; offsets outside count as the end.
fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..offset.min(text.len())];
    let line_start = before.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
    // A byte that continues a character starts no column.
    let column = 1 + before[line_start..].iter().filter(|b| **b & 0xC0 != 0x80).count();
    (line, column)
}

/// A diagnostic in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JsonDiagnostic {
    code: &'static str,
    severity: Severity,
    title: String,
    #[serde(flatten)]
    place: Option<Place>,
    labels: Vec<JsonLabel>,
    hint: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct JsonLabel {
    text: String,
    #[serde(flatten)]
    place: Option<Place>,
}

impl JsonDiagnostic {
    fn new(d: &Diagnostic, sources: &[Source]) -> Self {
        let place = |l: &Label| Place::of(l.span, sources);
        JsonDiagnostic {
            code: d.code,
            severity: d.severity,
            title: d.title.clone(),
            place: d.labels.first().and_then(place),
            labels: d.labels.iter().map(|l| JsonLabel { text: l.text.clone(), place: place(l) }).collect(),
            hint: d.hint.clone(),
        }
    }
}

/// A diagnostic as miette sees it. Labels in other files than the primary one become related reports.
#[derive(Debug)]
struct Report {
    head: String,
    title: String,
    weight: Weight,
    hint: Option<String>,
    excerpt: Option<Excerpt>,
    labels: Vec<LabeledSpan>,
    related: Vec<Report>,
}

impl Report {
    fn new(d: &Diagnostic, sources: &[Source]) -> Report {
        let file = d.labels.first().map(|l| l.span.file);
        let (here, elsewhere): (Vec<&Label>, Vec<&Label>) =
            d.labels.iter().partition(|l| Some(l.span.file) == file);
        let mut report = Report {
            head: head(d, sources),
            title: excerpt::clean(&d.title),
            weight: match d.severity {
                Severity::Error => Weight::Error,
                Severity::Warning => Weight::Warning,
            },
            hint: d.hint.as_deref().map(excerpt::clean),
            excerpt: None,
            labels: Vec::new(),
            related: Vec::new(),
        };
        report.show(&here, sources);
        for label in elsewhere {
            let mut other = Report {
                head: Place::of(label.span, sources)
                    .map_or(String::new(), |p| format!("{}:{}:{}", p.path, p.line, p.column)),
                title: excerpt::clean(&label.text),
                weight: Weight::Advice,
                hint: None,
                excerpt: None,
                labels: Vec::new(),
                related: Vec::new(),
            };
            other.show(&[label], sources);
            report.related.push(other);
        }
        report
    }

    fn show(&mut self, labels: &[&Label], sources: &[Source]) {
        let Some(source) = labels.first().and_then(|l| sources.get(l.span.file as usize)) else { return };
        if source.text.is_empty() {
            // Nothing to quote: the words of the labels follow the title.
            let words: Vec<String> =
                labels.iter().map(|l| excerpt::clean(&l.text)).filter(|t| !t.is_empty()).collect();
            if !words.is_empty() {
                self.title = format!("{}: {}", self.title, words.join("; "));
            }
            return;
        }
        let (excerpt, spans) = Excerpt::new(source, &labels.iter().map(|l| l.span).collect::<Vec<_>>());
        self.labels = labels
            .iter()
            .zip(spans)
            .enumerate()
            .map(|(i, (l, s))| {
                let text = Some(excerpt::clean(&l.text)).filter(|t| !t.is_empty());
                if i == 0 {
                    LabeledSpan::new_primary_with_span(text, s)
                } else {
                    LabeledSpan::new_with_span(text, s)
                }
            })
            .collect();
        self.excerpt = Some(excerpt);
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.title)
    }
}

impl std::error::Error for Report {}

impl miette::Diagnostic for Report {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.head))
    }
    fn severity(&self) -> Option<Weight> {
        Some(self.weight)
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|e| e as &dyn SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        (!self.labels.is_empty())
            .then(|| Box::new(self.labels.iter().cloned()) as Box<dyn Iterator<Item = LabeledSpan>>)
    }
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        (!self.related.is_empty()).then(|| {
            Box::new(self.related.iter().map(|r| r as &dyn miette::Diagnostic)) as Box<dyn Iterator<Item = _>>
        })
    }
}
