//! Reads what the user named: sources and what they import. Whatever is wrong with a file becomes a
//! diagnostic that names it.

use crate::report::Refusal;
use soifra_graph::{Diagnostic, Span, span::Source};
use std::{
    fs,
    io::{ErrorKind, Read},
    path::Path,
};

/// Largest source or graph file, in bytes.
pub const LIMIT: u64 = 256 << 20;

/// Reads a text file.
pub fn read_text(path: &str) -> Result<String, Refusal> {
    let bytes = read_bytes(path)?;
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let bad = e.as_bytes()[at];
        // Only what a report shows around the place is worth converting.
        let end = (at + 4096).min(e.as_bytes().len());
        let text = String::from_utf8_lossy(&e.as_bytes()[..end]).into_owned();
        let diagnostic = Diagnostic::error("S9003", "the file is not UTF-8 text")
            .at(
                Span::new(0, at, at + '\u{fffd}'.len_utf8()),
                format!("byte {bad:#04x} at offset {at} belongs to no character"),
            )
            .hint(if e.as_bytes().starts_with(b"\x89MCAP") {
                "this is a trace: `soifra replay` and `soifra plot` read it"
            } else {
                "save the file as UTF-8; missions and graphs are text files"
            });
        Refusal::with(diagnostic, Source { path: path.into(), text })
    })
}

/// Reads a file whole.
pub fn read_bytes(path: &str) -> Result<Vec<u8>, Refusal> {
    let wrong = |e: std::io::Error| match e.kind() {
        ErrorKind::NotFound => {
            Refusal::about(path, "S9001", "the file cannot be read", "there is no such file", &near(path))
        }
        ErrorKind::IsADirectory => directory(path),
        _ => Refusal::about(
            path,
            "S9001",
            "the file cannot be read",
            reason(&e),
            "make it readable, or name another file",
        ),
    };
    let meta = fs::metadata(path).map_err(wrong)?;
    if meta.is_dir() {
        return Err(directory(path));
    }
    let mut bytes = Vec::new();
    // Devices and pipes have no length of their own: reading stops at the limit in any case.
    let file = fs::File::open(path).map_err(wrong)?;
    file.take(LIMIT + 1).read_to_end(&mut bytes).map_err(wrong)?;
    if bytes.len() as u64 > LIMIT {
        return Err(Refusal::about(
            path,
            "S9004",
            "the file is too large",
            format!("more than {} MB", LIMIT >> 20),
            "split the mission with `import`, or check that this is the file you meant",
        ));
    }
    Ok(bytes)
}

fn directory(path: &str) -> Refusal {
    Refusal::about(path, "S9002", "a file is needed here", "this is a directory", "name a file in it")
}

/// What the system says, without the number it adds for programmers.
pub fn reason(e: &std::io::Error) -> String {
    let text = e.to_string();
    let text = text.split(" (os error").next().unwrap_or_default();
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_lowercase().collect::<String>() + chars.as_str())
}

/// A hint with the file of the nearest name in the same folder, if there is one.
fn near(path: &str) -> String {
    let p = Path::new(path);
    let name = p.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = p.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Some(names) = names_in(folder) else {
        return format!("there is no folder `{}` either", folder.display());
    };
    match soifra_graph::did_you_mean(&name, names.iter().map(String::as_str)) {
        Some(n) => format!("did you mean `{}`?", p.with_file_name(n).display()),
        None => "check the path; it is taken from the current folder".into(),
    }
}

/// Names of what is in a folder, sorted; of a very full one some of them. None where there is no such folder.
pub fn names_in(folder: &Path) -> Option<Vec<String>> {
    let entries = fs::read_dir(folder).ok()?;
    let mut names: Vec<String> =
        entries.flatten().take(10_000).map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    Some(names)
}

/// Writes a file, making its folder when there is none.
pub fn write(path: &str, bytes: &[u8]) -> Result<(), Refusal> {
    make_folder(path).and_then(|()| fs::write(path, bytes)).map_err(|e| unwritable(path, &e))
}

/// Refuses to write what was made of a file over that file.
pub fn keep_apart(input: &str, output: &str) -> Result<(), Refusal> {
    apart(input, output, "it is the file that is read")
}

/// Refuses to write `output` when it is the same file as `other`, in these words.
pub fn apart(other: &str, output: &str, words: &str) -> Result<(), Refusal> {
    let same = match (fs::canonicalize(other), fs::canonicalize(output)) {
        (Ok(a), Ok(b)) => a == b,
        _ => other == output,
    };
    if same {
        let title = "the file cannot be written";
        return Err(Refusal::about(output, "S9012", title, words, "name another file"));
    }
    Ok(())
}

/// Makes the folder of a file to be written.
pub fn make_folder(path: &str) -> std::io::Result<()> {
    match Path::new(path).parent() {
        Some(f) if !f.as_os_str().is_empty() => fs::create_dir_all(f).map_err(|e| match e.kind() {
            ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
                std::io::Error::new(e.kind(), "part of its path is a file, not a folder")
            }
            _ => e,
        }),
        _ => Ok(()),
    }
}

/// The refusal for a file that cannot be written.
pub fn unwritable(path: &str, e: &std::io::Error) -> Refusal {
    Refusal::about(
        path,
        "S9012",
        "the file cannot be written",
        reason(e),
        "name another path, or make this one writable",
    )
}

/// Loads imports from the file system, and knows the embedded library.
#[derive(Debug, Default)]
pub struct Loader;

impl soifra_lang::Loader for Loader {
    fn load(&mut self, path: &str) -> Result<String, String> {
        read_text(path).map_err(|r| {
            let d = r.findings.diagnostics.into_iter().next();
            d.and_then(|d| d.labels.into_iter().next()).map_or_else(|| "cannot be read".into(), |l| l.text)
        })
    }

    fn library(&self) -> Vec<(String, String)> {
        soifra_platforms::library().map(|(path, text)| (path.to_string(), text.to_string())).collect()
    }
}
