//! From a root file to all the files it needs: imports, the prelude, the library of profiles and worlds.

use crate::{ast, code, parse};
use soifra_graph::{Diagnostic, Span, span::Source};

/// Hands texts to the compiler; the shell decides where they come from.
pub trait Loader {
    /// The text of a source file. Paths are relative to the root file's folder as the import wrote them,
    /// joined with `/`. The error says why it cannot be read.
    fn load(&mut self, path: &str) -> Result<String, String>;

    /// Library files that need no import, as (path, text): platform profiles and worlds.
    fn library(&self) -> Vec<(String, String)>;
}

/// The standard library: dotted name and text.
pub const STANDARD: &[(&str, &str)] = &[
    ("std.prelude", include_str!("../std/prelude.soi")),
    ("std.motion", include_str!("../std/motion.soi")),
    ("std.vision", include_str!("../std/vision.soi")),
    ("std.protocols", include_str!("../std/protocols.soi")),
];

/// One file of the program.
#[derive(Debug)]
pub struct Module {
    /// Its tree.
    pub tree: ast::File,
    /// Whether it is the user's: not the standard library, not a library profile.
    pub own: bool,
}

/// All files, in order of loading; module n is source n. The first is the root.
#[derive(Debug, Default)]
pub struct Program {
    /// Files.
    pub modules: Vec<Module>,
    /// Their texts.
    pub sources: Vec<Source>,
    /// What went wrong so far.
    pub errors: Vec<Diagnostic>,
}

/// Editions of the language this compiler reads.
pub const EDITION: u32 = 1;

impl Program {
    /// Loads the root file and everything it needs.
    pub fn load(path: &str, text: &str, loader: &mut dyn Loader) -> Program {
        let mut p = Program::default();
        p.add(path, text.to_string(), true);
        p.follow(0, loader, &mut vec![(normal(path), Span::default())]);
        p.add("std/prelude.soi", STANDARD[0].1.to_string(), false);
        for (path, text) in loader.library() {
            p.add(&path, text, false);
        }
        p
    }

    fn add(&mut self, path: &str, text: String, own: bool) -> usize {
        let file = self.modules.len();
        // Some editors begin a file with a mark of its encoding.
        let text = text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text);
        let (tree, errors) = parse::parse(file as u32, &text);
        self.errors.extend(errors);
        if let Some((edition, span)) = tree.edition
            && edition != i64::from(EDITION)
        {
            self.errors.push(
                Diagnostic::error(code::EDITION, format!("edition {edition} is unknown"))
                    .at(span, "asked for here")
                    .hint(format!("this soifra reads edition {EDITION}; write `edition {EDITION}`")),
            );
        }
        self.modules.push(Module { tree, own });
        self.sources.push(Source { path: path.to_string(), text });
        file
    }

    /// Loads what module `from` imports; `open` are the files between the root and it, itself last, each with
    /// the import that led to it.
    fn follow(&mut self, from: usize, loader: &mut dyn Loader, open: &mut Vec<(String, Span)>) {
        let imports = std::mem::take(&mut self.modules[from].tree.imports);
        for import in &imports {
            if import.is_file {
                self.follow_file(from, import, loader, open);
            } else {
                self.follow_standard(import);
            }
        }
        self.modules[from].tree.imports = imports;
    }

    fn follow_standard(&mut self, import: &ast::Import) {
        let Some((name, text)) = STANDARD.iter().find(|(n, _)| *n == import.path) else {
            let d = Diagnostic::error(code::MISSING_IMPORT, format!("there is no library `{}`", import.path))
                .at(import.span, "imported here");
            let names = STANDARD.iter().map(|(n, _)| *n);
            self.errors.push(match soifra_graph::did_you_mean(&import.path, names) {
                Some(near) => d.hint(format!("did you mean `{near}`?")),
                None => d.hint("files are imported with quotes: `import \"rules.soi\"`"),
            });
            return;
        };
        let path = format!("{}.soi", name.replace('.', "/"));
        if !self.sources.iter().any(|s| s.path == path) {
            self.add(&path, (*text).to_string(), false);
        }
    }

    fn follow_file(
        &mut self,
        from: usize,
        import: &ast::Import,
        loader: &mut dyn Loader,
        open: &mut Vec<(String, Span)>,
    ) {
        let folder = self.sources[from].path.rsplit_once('/').map_or("", |(f, _)| f).to_string();
        let joined = if folder.is_empty() || import.path.starts_with('/') {
            import.path.clone()
        } else {
            format!("{folder}/{}", import.path)
        };
        let path = normal(&joined);
        if let Some(at) = open.iter().position(|(o, _)| *o == path) {
            let mut ring: Vec<&str> = open[at..].iter().map(|(o, _)| o.as_str()).collect();
            ring.push(&path);
            let ring = ring.join(" → ");
            let d = Diagnostic::error(code::IMPORT_CYCLE, "files import each other in a ring");
            // The root file's own import comes first: that is where the user is looking.
            let d = match open.get(1) {
                Some((_, first)) => d.at(*first, ring).at(import.span, "leads back"),
                None => d.at(import.span, ring),
            };
            self.errors.push(d.hint("move what both need into a third file"));
            return;
        }
        if self.sources.iter().any(|s| normal(&s.path) == path) {
            return;
        }
        if open.len() > 64 {
            self.errors.push(
                Diagnostic::error(code::IMPORT_CYCLE, "imports nest deeper than 64 files")
                    .at(import.span, "imported here")
                    .hint("import from fewer levels"),
            );
            return;
        }
        match loader.load(&path) {
            Ok(text) => {
                let file = self.add(&path, text, true);
                open.push((path, import.span));
                self.follow(file, loader, open);
                open.pop();
            }
            Err(why) => self.errors.push(
                Diagnostic::error(code::MISSING_IMPORT, format!("cannot read `{}`", import.path))
                    .at(import.span, why)
                    .hint("paths are relative to the file that imports"),
            ),
        }
    }

    /// The text of a span.
    pub fn text(&self, span: Span) -> &str {
        let text = self.sources.get(span.file as usize).map_or("", |s| s.text.as_str());
        text.get(span.start as usize..span.end as usize).unwrap_or_default()
    }
}

/// A path without `.` and inner `..`.
fn normal(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|p| *p != ".." && !p.is_empty()) => {
                parts.pop();
            }
            p => parts.push(p),
        }
    }
    parts.join("/")
}
