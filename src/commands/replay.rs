//! `soifra replay`: executes a trace again and verifies that nothing differs.

use crate::{
    execute,
    exit::Exit,
    graph_file, image_files,
    output::{self, Format},
    report::{Findings, Refusal},
    trace_file::{Reader, TraceError},
};
use clap::{Args, ValueHint};
use serde::Serialize;
use soifra_runtime::{
    Mission, Record, RunReport, Settings, Snapshot, Time,
    replay::{self, Difference, ReplayError},
};
use std::{cell::RefCell, fs::File, io::BufReader};

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The trace
    #[arg(value_hint = ValueHint::FilePath)]
    trace: String,
    /// Execute the graph on the recorded readings; without it the world is simulated again and the readings
    /// are compared too
    #[arg(long)]
    recorded: bool,
    /// Begin at the last snapshot at or before this instant, in seconds of virtual time, instead of at the start;
    /// the graph is executed on the recorded readings
    #[arg(long, value_name = "SECONDS", value_parser = instant)]
    from: Option<Time>,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// What to print on standard output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    mission: &'a str,
    seed: u64,
    /// `same` or `differs`.
    outcome: &'static str,
    /// Where it began, in seconds.
    from_s: f64,
    records: u64,
    complete: bool,
    difference: Option<JsonDifference<'a>>,
}

#[derive(Serialize)]
struct JsonDifference<'a> {
    record: u64,
    recorded: &'a Option<Record>,
    replayed: &'a Option<Record>,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let unreadable = |e: &TraceError| unreadable(&a.trace, e);
    let mut reader = Reader::open(&a.trace).map_err(|e| unreadable(&e))?;
    let snapshot = match a.from {
        Some(from) => Reader::open(&a.trace).and_then(|r| r.snapshot(from)).map_err(|e| unreadable(&e))?,
        None => None,
    };
    let (from_s, before) = snapshot.as_ref().map_or((0.0, 0), |s| (s.t.seconds(), s.next));
    let header = reader.header().clone();
    let images = image_files::again(&header.scene.images)?;
    let mission = execute::load(graph(&a.trace, &header.graph_json)?, images)?;
    let settings =
        Settings { seed: header.seed(), params: header.params.clone(), threads: execute::threads(a.threads) };

    let tape = Tape { path: &a.trace, reader: &mut reader, count: 0, failure: RefCell::default() };
    let (result, tape) = replay(a, &mission, &settings, snapshot, tape)?;
    let records = tape.count.saturating_sub(before);
    if let Some(e) = tape.failure.into_inner() {
        return Err(unreadable(&e));
    }
    let complete = reader.complete();
    let difference = match result {
        Ok(_) => None,
        Err(ReplayError::Difference(d)) => Some(d),
        Err(ReplayError::Snapshot) => {
            let why = format!("its snapshot at {from_s} s is not one of its mission");
            return Err(Refusal::about(
                &a.trace,
                "S9018",
                "the trace cannot be read",
                why,
                "leave `--from` out",
            ));
        }
        Err(ReplayError::Start(d)) => {
            let findings = Findings { diagnostics: vec![d], sources: mission.graph().sources.clone() };
            return Err(Refusal { findings, exit: Exit::WrongInput });
        }
    };
    if let Some(d) = &difference {
        tell(&a.trace, d);
    }
    if !complete {
        output::note(&format!("{}: the trace was cut off; it was verified as far as it goes", a.trace));
    }
    match a.format {
        Format::Human if difference.is_none() => output::print(&format!(
            "{}, seed {}: {records} records{}, nothing differs\n",
            header.mission,
            header.seed(),
            if a.from.is_some() { format!(" from {from_s} s on") } else { String::new() },
        ))?,
        Format::Human => {}
        Format::Json => output::print_json(&Document {
            schema: output::SCHEMA,
            mission: &header.mission,
            seed: header.seed(),
            from_s,
            outcome: if difference.is_some() { "differs" } else { "same" },
            records,
            complete,
            difference: difference.as_ref().map(|d| JsonDifference {
                record: d.record,
                recorded: &d.expected,
                replayed: &d.got,
            }),
        })?,
    }
    Ok(if difference.is_some() { Exit::Failed } else { Exit::Success })
}

/// An instant of a run, from seconds.
pub(super) fn instant(text: &str) -> Result<Time, String> {
    let seconds = text.trim().trim_end_matches('s').trim_end().parse().ok().and_then(Time::from_seconds);
    seconds.filter(|t| *t >= Time::ZERO).ok_or_else(|| "give seconds of virtual time, from 0 on".into())
}

type Replayed<'r> = (Result<RunReport, ReplayError>, Tape<'r>);

fn replay<'r>(
    a: &Arguments,
    mission: &Mission,
    settings: &Settings,
    snapshot: Option<Snapshot>,
    mut tape: Tape<'r>,
) -> Result<Replayed<'r>, Refusal> {
    let result = if let Some(snapshot) = snapshot {
        replay::verify_from(mission, settings, snapshot, &mut tape)
    } else if a.recorded || a.from.is_some() {
        replay::verify(mission, settings, &mut tape)
    } else {
        match mission.scene(settings) {
            Ok(scene) => {
                let mut platform = execute::platform_again(&scene, settings.threads, |why| {
                    Refusal::about(
                        &a.trace,
                        "S9020",
                        "the mission cannot be set up",
                        why,
                        "replay it with `--recorded`",
                    )
                })?;
                replay::resimulate(mission, settings, &scene, &mut *platform, &mut tape)
            }
            Err(d) => Err(ReplayError::Start(d)),
        }
    };
    // What is left of the file is read, so that damage in it is told.
    tape.by_ref().for_each(drop);
    Ok((result, tape))
}

/// The records of a file, until its end or its first damage.
struct Tape<'r> {
    path: &'r str,
    reader: &'r mut Reader<BufReader<File>>,
    count: u64,
    failure: RefCell<Option<TraceError>>,
}

impl Iterator for Tape<'_> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        if self.failure.borrow().is_some() {
            return None;
        }
        match self.reader.next()? {
            Ok(record) => {
                self.count += 1;
                Some(record)
            }
            Err(e) => {
                output::note(&format!("{}: damaged after {} records", self.path, self.count));
                self.failure.replace(Some(e));
                None
            }
        }
    }
}

/// The graph that a trace carries, verified like any other graph file.
fn graph(path: &str, json: &str) -> Result<soifra_graph::Graph, Refusal> {
    let graph = graph_file::parse(&format!("{path}.json"), json)?;
    let findings = Findings { diagnostics: soifra_lang::verify(&graph), sources: graph.sources.clone() };
    if findings.errors() > 0 {
        return Err(Refusal { findings, exit: Exit::WrongInput });
    }
    Ok(graph)
}

/// The refusal for a trace that cannot be read.
pub fn unreadable(path: &str, e: &TraceError) -> Refusal {
    Refusal::about(
        path,
        "S9018",
        "the trace cannot be read",
        e.to_string(),
        "name a trace that `soifra run` wrote",
    )
}

fn tell(path: &str, d: &Difference) {
    let show = |r: &Option<Record>| match r {
        Some(r) => format!("at {} s {}", r.t.seconds(), serde_json::to_string(&r.event).unwrap_or_default()),
        None => "nothing more".to_string(),
    };
    let title = format!("the replay differs at record {}", d.record);
    let seen = format!("recorded was {}\nreplayed was {}", show(&d.expected), show(&d.got));
    let hint = "the trace was altered, or it was made by another version of soifra";
    Refusal::about(path, "S9023", title, seen, hint).findings.print();
}
