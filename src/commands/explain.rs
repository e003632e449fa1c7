//! `soifra explain`: the page of a diagnostic code.

use crate::{codes, exit::Exit, output, report::Refusal};
use clap::Args;
use std::fmt::Write;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The code in the brackets of a report, as S0201; without one, all codes are listed
    code: Option<String>,
    /// Print the pages of all codes, as Markdown
    #[arg(long, conflicts_with = "code")]
    all: bool,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let text = match &a.code {
        Some(code) => match codes::find(code) {
            Some(page) => render(&page),
            None => return Err(unknown(code)),
        },
        None if a.all => codes::all().iter().map(|p| render(p) + "\n").collect(),
        None => codes::all().iter().fold(String::new(), |mut s, p| {
            let _ = writeln!(s, "{}  {}", p.code, p.title);
            s
        }),
    };
    output::print(&text)?;
    Ok(Exit::Success)
}

fn render(page: &codes::Page) -> String {
    format!("# {}: {}\n\n{}\n", page.code, page.title, page.text.trim())
}

fn unknown(code: &str) -> Refusal {
    let hint = "`soifra explain` lists all codes";
    Refusal::about(code, "S9025", "no diagnostic has this code", "codes are an S and four digits", hint)
}
