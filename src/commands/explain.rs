//! `soifra explain`: the page of a diagnostic code.

use crate::{codes, exit::Exit, output, report::Refusal};
use clap::Args;
use soifra_graph::did_you_mean;
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
    let all = codes::all();
    let near = did_you_mean(code, all.iter().map(|p| p.code));
    let hint = near.map_or("`soifra explain` lists all codes".to_string(), |n| format!("did you mean {n}?"));
    Refusal::about(code, "S9025", "no diagnostic has this code", "codes are an S and four digits", &hint)
}
