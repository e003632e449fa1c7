//! `soifra fmt`: brings sources into the standard form, in place.

use crate::{
    exit::Exit,
    files, output,
    report::{Findings, Refusal},
};
use clap::{Args, ValueHint};
use soifra_graph::span::Source;
use std::io::Read;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Sources to rewrite; `-` reads standard input and writes standard output
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    files: Vec<String>,
    /// Only report what would change, with exit code 1
    #[arg(long)]
    check: bool,
}

/// Runs the command. A file that cannot be parsed is left as it is; the others are still done.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let mut worst = Exit::Success;
    for path in &a.files {
        match one(path, a.check) {
            Ok(e) => worst = worst.max(e),
            Err(r) => {
                r.findings.print();
                worst = worst.max(r.exit);
            }
        }
    }
    Ok(worst)
}

fn one(path: &str, check: bool) -> Result<Exit, Refusal> {
    let text = if path == "-" { standard_input()? } else { files::read_text(path)? };
    let formatted = soifra_lang::format(&text).map_err(|diagnostics| Refusal {
        findings: Findings { diagnostics, sources: vec![Source { path: path.into(), text: text.clone() }] },
        exit: Exit::WrongInput,
    })?;
    if path == "-" && !check {
        output::print(&formatted)?;
    } else if formatted != text {
        if check {
            let line = first_difference(&text, &formatted);
            output::print(&format!("{path}:{line}: not in the standard form\n"))?;
            return Ok(Exit::Failed);
        }
        files::write(path, formatted.as_bytes())?;
    }
    Ok(Exit::Success)
}

fn standard_input() -> Result<String, Refusal> {
    let mut bytes = Vec::new();
    let read = std::io::stdin().lock().take(files::LIMIT).read_to_end(&mut bytes);
    let hint = "pipe a UTF-8 source into it";
    match read.map(|_| String::from_utf8(bytes)) {
        Ok(Ok(text)) => Ok(text),
        Ok(Err(_)) => Err(Refusal::about("-", "S9003", "standard input is not UTF-8 text", "", hint)),
        Err(e) => Err(Refusal::about("-", "S9001", "standard input cannot be read", files::reason(&e), hint)),
    }
}

/// Number of the first line that differs, from 1.
fn first_difference(a: &str, b: &str) -> usize {
    1 + a.lines().zip(b.lines()).take_while(|(x, y)| x == y).count()
}
