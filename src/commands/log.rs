//! `soifra log`: what is in a trace, a line for each record.

use super::replay::{instant, unreadable};
use crate::{
    exit::Exit,
    output::{self, Format},
    report::Refusal,
    trace_file::Reader,
};
use clap::{Args, ValueHint, builder::PossibleValuesParser};
use soifra_runtime::{Record, Time};
use std::fmt::Write as _;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The trace
    #[arg(value_hint = ValueHint::FilePath)]
    trace: String,
    /// Only records of these kinds, as `note,command,param`; without it all but readings and poses
    #[arg(long, value_name = "KIND,...", value_delimiter = ',', value_parser = PossibleValuesParser::new(KINDS), hide_possible_values = true)]
    only: Vec<String>,
    /// From this instant on, in seconds of virtual time
    #[arg(long, value_name = "SECONDS", value_parser = instant)]
    from: Option<Time>,
    /// Until this instant
    #[arg(long, value_name = "SECONDS", value_parser = instant)]
    to: Option<Time>,
    /// What to print on standard output; json is one record a line
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// What there is many of and says little.
const MANY: [&str; 4] = ["reading", "image", "pose", "mover"];

/// All kinds of records.
const KINDS: [&str; 32] = [
    "acl",
    "activation",
    "arbitration",
    "command",
    "completion",
    "contact",
    "conversation",
    "deferral",
    "delivery",
    "device",
    "end",
    "expectation",
    "fault",
    "goal",
    "image",
    "input",
    "life",
    "message",
    "miss",
    "mover",
    "node",
    "note",
    "param",
    "pose",
    "reading",
    "rule",
    "safe_action",
    "service",
    "state",
    "switch",
    "transition",
    "trouble",
];

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let reader = Reader::open(&a.trace).map_err(|e| unreadable(&a.trace, &e))?;
    let robots: Vec<String> = reader.header().robots().map(|r| r.name.to_string()).collect();
    for record in reader {
        let record = record.map_err(|e| unreadable(&a.trace, &e))?;
        if a.from.is_some_and(|from| record.t < from) || a.to.is_some_and(|to| record.t > to) {
            continue;
        }
        let Ok(serde_json::Value::Object(mut event)) = serde_json::to_value(&record.event) else { continue };
        let kind = event.remove("kind").and_then(|k| k.as_str().map(str::to_string)).unwrap_or_default();
        let wanted = match a.only.is_empty() {
            true => !MANY.contains(&kind.as_str()),
            false => a.only.contains(&kind),
        };
        if !wanted {
            continue;
        }
        match a.format {
            Format::Json => output::print(&line_of_json(&record))?,
            Format::Human => output::print(&line(&record, &kind, event, &robots))?,
        }
    }
    Ok(Exit::Success)
}

fn line_of_json(record: &Record) -> String {
    format!("{}\n", serde_json::to_string(record).unwrap_or_default())
}

/// Time, who, what, and the rest as it is.
fn line(
    record: &Record,
    kind: &str,
    mut event: serde_json::Map<String, serde_json::Value>,
    robots: &[String],
) -> String {
    let robot = event.remove("robot").and_then(|r| r.as_u64()).and_then(|r| robots.get(r as usize));
    let agent = event.remove("agent").and_then(|a| a.as_str().map(str::to_string));
    let who = match (&agent, robot) {
        (Some(agent), Some(robot)) if !agent.contains('@') => format!("{agent}@{robot}"),
        (Some(agent), _) => agent.clone(),
        (None, robot) => robot.cloned().unwrap_or_default(),
    };
    let mut out = format!("{:>12.6}  {who:<24} {kind:<12}", record.t.seconds());
    for (name, value) in event {
        let _ = match value {
            serde_json::Value::String(text) => write!(out, " {name}: {text}"),
            other => write!(out, " {name}: {other}"),
        };
    }
    out.push('\n');
    out
}
