//! `soifra completions`: what a shell needs to complete command lines.

use crate::{cli, exit::Exit, output, report::Refusal};
use clap::Args;
use clap_complete::Shell;

/// Arguments.
#[derive(Debug, Args)]
#[command(
    after_help = "For bash: soifra completions bash > ~/.local/share/bash-completion/completions/soifra"
)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let mut text = Vec::new();
    clap_complete::generate(a.shell, &mut cli::grammar(), "soifra", &mut text);
    output::print(&String::from_utf8_lossy(&text))?;
    Ok(Exit::Success)
}
