//! Replay: runs a mission again and compares every record with those of an earlier run.
//!
//! [`verify`] feeds the recorded inputs (readings, contacts, poses, losses) to the graph, so that it needs
//! no simulator and no robot; [`resimulate`] runs on a platform again and compares the inputs as well. What an
//! operator did to the run is done again by both.
//! Both hold only as much of the recording in memory as lies between two inputs.

mod recorded;
mod tape;

use crate::{
    Engine, Mission, Platform, Readings, Record, Report, RunReport, Scene, Settings, Snapshot, Time,
    TraceSink, WorldTruth,
};
use recorded::Recorded;
use soifra_graph::Diagnostic;
use std::{
    fmt,
    sync::atomic::{AtomicBool, Ordering},
};
use tape::{Again, Tape};

/// Why a replay is not the run that was recorded.
#[derive(Debug, Clone, PartialEq)]
pub enum ReplayError {
    /// The run cannot be prepared.
    Start(Diagnostic),
    /// The snapshot is not one of this mission with these settings.
    Snapshot,
    /// A record differs.
    Difference(Box<Difference>),
}

/// The first record that differs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Its number.
    pub record: u64,
    /// As recorded; `None` when the recording had ended.
    pub expected: Option<Record>,
    /// As replayed; `None` when the replay has ended.
    pub got: Option<Record>,
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReplayError::Start(d) => f.write_str(&d.title),
            ReplayError::Snapshot => f.write_str("the snapshot is one of another run"),
            ReplayError::Difference(d) => write!(f, "record {} differs", d.record),
        }
    }
}

impl std::error::Error for ReplayError {}

/// Executes the graph again on the recorded inputs. A recording that was cut off is verified as far as
/// it goes. Returns the report of the replayed run.
///
/// # Errors
/// The first record that differs.
pub fn verify(
    mission: &Mission,
    settings: &Settings,
    records: impl IntoIterator<Item = Record>,
) -> Result<RunReport, ReplayError> {
    let scene = mission.scene(settings).map_err(ReplayError::Start)?;
    let stop = AtomicBool::new(false);
    let tape = Tape::new(records.into_iter());
    let mut platform = Recorded::new(&tape, scene.bodies().len(), &stop, mission.cameras(&scene));
    compare(mission, settings, &scene, &mut platform, &tape, &stop, None)
}

/// As [`verify`], from a snapshot on; records before it are passed over.
///
/// # Errors
/// The first record that differs; [`ReplayError::Snapshot`] for a snapshot of another mission.
pub fn verify_from(
    mission: &Mission,
    settings: &Settings,
    snapshot: Snapshot,
    records: impl IntoIterator<Item = Record>,
) -> Result<RunReport, ReplayError> {
    let scene = mission.scene(settings).map_err(ReplayError::Start)?;
    let stop = AtomicBool::new(false);
    let next = snapshot.next;
    let tape = Tape::new(records.into_iter().skip_while(move |r| r.n < next));
    let mut platform = Recorded::resumed(&tape, &snapshot, &stop, mission.cameras(&scene));
    compare(mission, settings, &scene, &mut platform, &tape, &stop, Some(snapshot))
}

/// Runs on a platform again, which was made from the same scene, and compares everything.
///
/// # Errors
/// The first record that differs.
pub fn resimulate(
    mission: &Mission,
    settings: &Settings,
    scene: &Scene,
    platform: &mut dyn Platform,
    records: impl IntoIterator<Item = Record>,
) -> Result<RunReport, ReplayError> {
    let stop = AtomicBool::new(false);
    let tape = Tape::new(records.into_iter());
    let mut platform = Watched { platform, tape: &tape, stop: &stop };
    compare(mission, settings, scene, &mut platform, &tape, &stop, None)
}

fn compare(
    mission: &Mission,
    settings: &Settings,
    scene: &Scene,
    platform: &mut dyn Platform,
    tape: &Tape<'_>,
    stop: &AtomicBool,
    snapshot: Option<Snapshot>,
) -> Result<RunReport, ReplayError> {
    let mut sink = Compare { tape, difference: None };
    let mut again = Again(tape);
    let mut engine =
        Engine::new(mission, settings, scene, platform, &mut sink, stop).map_err(ReplayError::Start)?;
    if snapshot.is_some_and(|s| !engine.resume(s)) {
        return Err(ReplayError::Snapshot);
    }
    engine.paced(&mut again);
    let report = engine.run();
    if let Some(d) = sink.difference {
        return Err(ReplayError::Difference(d));
    }
    match tape.next() {
        Some(r) => {
            let d = Difference { record: r.n, expected: Some(r), got: None };
            Err(ReplayError::Difference(Box::new(d)))
        }
        None => Ok(report),
    }
}

/// Compares what it is given with the tape.
struct Compare<'t, 'r> {
    tape: &'t Tape<'r>,
    difference: Option<Box<Difference>>,
}

impl TraceSink for Compare<'_, '_> {
    fn record(&mut self, got: &Record) -> Result<(), String> {
        let expected = self.tape.next();
        match expected {
            Some(e) if same(&e, got) => Ok(()),
            None if self.tape.cut_off() => Err("the recording was cut off here".into()),
            expected => {
                let record = expected.as_ref().map_or(got.n, |e| e.n);
                self.difference = Some(Box::new(Difference { record, expected, got: Some(got.clone()) }));
                Err("the replay differs".into())
            }
        }
    }
}

/// Whether two records are equal; no number equals itself.
fn same(a: &Record, b: &Record) -> bool {
    a == b || (a.n == b.n && a.t == b.t && format!("{a:?}") == format!("{b:?}"))
}

/// A platform that stops the run where the operator stopped the recorded one.
struct Watched<'a, 'r> {
    platform: &'a mut dyn Platform,
    tape: &'a Tape<'r>,
    stop: &'a AtomicBool,
}

impl Platform for Watched<'_, '_> {
    fn next_due(&self) -> Option<Time> {
        self.platform.next_due()
    }

    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>) {
        self.tape.pull(now);
        if self.tape.interrupted(now) {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.platform.poll(now, readings, reports);
    }

    fn advance(&mut self, now: Time) {
        self.platform.advance(now);
    }

    fn send(&mut self, now: Time, robot: u32, actuator: u32, command: &[f64], expires: Time) {
        self.platform.send(now, robot, actuator, command, expires);
    }

    fn safe_action(&mut self, now: Time, robot: u32) -> &'static str {
        self.platform.safe_action(now, robot)
    }

    fn finish(&mut self, now: Time, robot: u32) -> &'static str {
        self.platform.finish(now, robot)
    }

    fn truth(&self) -> Option<&dyn WorldTruth> {
        self.platform.truth()
    }
}
