//! The command line: what it takes, and which command does it.

use crate::{commands, compile, exit::Exit, output, output::Format, report::Refusal};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueHint, error::ErrorKind};
use serde::Serialize;
use std::ffi::OsString;

/// soifra: the language in which robot missions are written.
#[derive(Debug, Parser)]
#[command(
    name = "soifra",
    version,
    about = "Checks, runs and explains robot missions",
    after_help = "Start with `soifra check FILE`, then `soifra run FILE`.\nExit codes: 0 done, 1 failed or different, 2 wrong input, 3 aborted, 130 interrupted."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check missions: everything that can be known before a robot moves
    Check(commands::check::Arguments),
    /// Run a mission
    Run(commands::run::Arguments),
    /// Run a mission over seeds, parameters and platforms
    Sweep(commands::sweep::Arguments),
    /// Show the behaviour graph of a mission
    Graph(commands::graph::Arguments),
    /// Bring sources into the standard form
    Fmt(commands::fmt::Arguments),
    /// Run the tests and goldens of missions
    Test(commands::test::Arguments),
    /// Run the studies of a file and write their tables
    Measure(commands::measure::Arguments),
    /// Draw a trace: the top view, the messages, or the schedule
    Plot(commands::plot::Arguments),
    /// Print what is in a trace, a line for each record
    Log(commands::log::Arguments),
    /// Execute a trace again and verify that nothing differs
    Replay(commands::replay::Arguments),
    /// Explain a diagnostic code
    Explain(commands::explain::Arguments),
    /// Print completions for a shell
    Completions(commands::completions::Arguments),
}

/// A mission and how it is set up.
#[derive(Debug, Clone, Args)]
pub struct Mission {
    /// Mission source (.soi) or behaviour graph (.yaml, .json)
    #[arg(value_hint = ValueHint::FilePath)]
    pub file: String,
    /// The mission that is meant, in a file with several [default: the first]
    #[arg(long, value_name = "NAME")]
    pub mission: Option<String>,
    /// Let the faults of this test happen; its mission unless `--mission` names one
    #[arg(long, value_name = "NAME")]
    pub test: Option<String>,
    /// Run every robot on this platform profile
    #[arg(long, value_name = "PROFILE")]
    pub platform: Option<String>,
}

impl Mission {
    /// Compiles it.
    pub fn compile(&self) -> Result<compile::Compiled, Refusal> {
        compile::compile_with(
            &self.file,
            self.platform.as_deref(),
            self.mission.as_deref(),
            self.test.as_deref(),
        )
    }
}

/// The grammar of the command line, for completions.
pub fn grammar() -> clap::Command {
    Cli::command()
}

/// Runs the command line `arguments` (the first is the program's name).
pub fn run(arguments: Vec<OsString>) -> Exit {
    let json = wants_json(&arguments);
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(e) => return usage(&e, json),
    };
    let (result, format) = match cli.command {
        Command::Check(a) => (commands::check::run(&a), a.format),
        Command::Run(a) => (commands::run::run(&a), a.format),
        Command::Sweep(a) => (commands::sweep::run(&a), a.format()),
        Command::Graph(a) => (commands::graph::run(&a), a.document()),
        Command::Fmt(a) => (commands::fmt::run(&a), Format::Human),
        Command::Test(a) => (commands::test::run(&a), a.format),
        Command::Measure(a) => (commands::measure::run(&a), Format::Human),
        Command::Plot(a) => (commands::plot::run(&a), Format::Human),
        Command::Log(a) => (commands::log::run(&a), a.format),
        Command::Replay(a) => (commands::replay::run(&a), a.format),
        Command::Explain(a) => (commands::explain::run(&a), Format::Human),
        Command::Completions(a) => (commands::completions::run(&a), Format::Human),
    };
    result.unwrap_or_else(|refusal| refuse(&refusal, format))
}

/// The JSON document of a command that was refused.
#[derive(Serialize)]
struct Refused {
    schema: u32,
    outcome: &'static str,
    diagnostics: Vec<crate::report::JsonDiagnostic>,
}

fn refuse(refusal: &Refusal, format: Format) -> Exit {
    refusal.findings.print();
    if format == Format::Json {
        let document =
            Refused { schema: output::SCHEMA, outcome: "refused", diagnostics: refusal.findings.to_json() };
        if let Err(e) = output::print_json(&document) {
            return e;
        }
    }
    refusal.exit
}

/// A command line that clap refused, or one that asked for help.
fn usage(e: &clap::Error, json: bool) -> Exit {
    if matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return output::print(&e.render().to_string()).err().unwrap_or(Exit::Success);
    }
    if !json {
        output::note(e.render().to_string().trim_end());
        return Exit::WrongInput;
    }
    let text = e.render().to_string();
    let first: Vec<&str> = text.lines().map(str::trim).take_while(|l| !l.is_empty()).collect();
    let title = first.join(" ").trim_start_matches("error: ").to_string();
    refuse(
        &Refusal::about("command line", "S9024", title, "", "`soifra --help` lists what there is"),
        Format::Json,
    )
}

/// Whether JSON was asked for, as far as can be told from a command line that may be wrong.
fn wants_json(arguments: &[OsString]) -> bool {
    arguments.iter().any(|a| a == "--format=json")
        || arguments.windows(2).any(|w| w[0] == "--format" && w[1] == "json")
}
