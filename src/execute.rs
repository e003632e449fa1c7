//! Runs a mission in the simulator or on a recording: graph, parameters and seed in, report and trace out.

use crate::{
    exit::Exit,
    files, graph_file,
    recording::{self, Everywhere},
    report::{Findings, Refusal},
    services::Everything,
    trace_file,
};
use soifra_graph::{Diagnostic, Graph, Value, span::Source};
use soifra_platforms::sim::Simulator;
use soifra_runtime::{
    Engine, Mission, NoTrace, Outcome, Pacer, Platform, RunReport, Scene, Settings, TraceSink,
    scene::ImageFile,
};
use std::{
    collections::BTreeMap,
    sync::{Arc, atomic::AtomicBool},
};

/// Compiles the code of a graph, whose materials name these image files.
pub fn load(graph: Graph, images: Vec<ImageFile>) -> Result<Mission, Refusal> {
    let sources = graph.sources.clone();
    let mission = Mission::load(graph).map_err(|diagnostics| refuse(diagnostics, sources))?;
    let mission = mission.with_services(Arc::new(Everything)).with_cameras(Arc::new(Everywhere::default()));
    Ok(mission.with_images(images))
}

/// Settings for one run.
pub fn settings(graph: &Graph, seed: u64, sets: &[(usize, Value)], threads: usize) -> Settings {
    let named = sets.iter().filter_map(|(i, v)| Some((graph.params.get(*i)?.name.to_string(), v.clone())));
    Settings { seed, params: named.collect(), threads }
}

/// A run that is set up: everything that can be wrong with it before it starts has been told.
pub struct Prepared<'m> {
    mission: &'m Mission,
    settings: Settings,
    scene: Scene,
    /// What robots read that are not simulated.
    recording: Option<recording::Opened>,
}

/// What the robots of a scene are: simulated, with so many threads at most, or recorded.
fn platform(
    scene: &Scene,
    recording: Option<&recording::Opened>,
    threads: usize,
    not_simulated: impl Fn(String) -> Refusal,
) -> Result<Box<dyn Platform>, Refusal> {
    Ok(match recording {
        Some(recording) => Box::new(recording.platform(scene)?),
        None => Box::new(Simulator::with_threads(scene, threads).map_err(not_simulated)?),
    })
}

/// The same for a scene whose recording, if there is one, has not been opened.
pub fn platform_again(
    scene: &Scene,
    threads: usize,
    not_simulated: impl Fn(String) -> Refusal,
) -> Result<Box<dyn Platform>, Refusal> {
    platform(scene, recording::open(scene)?.as_ref(), threads, not_simulated)
}

impl<'m> Prepared<'m> {
    /// Evaluates the scene for the settings, and opens the recording if there is one.
    pub fn new(mission: &'m Mission, settings: Settings) -> Result<Self, Refusal> {
        let scene = mission.scene(&settings).map_err(|d| refuse(vec![d], mission.graph().sources.clone()))?;
        let recording = recording::open(&scene)?;
        Ok(Prepared { mission, settings, scene, recording })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Runs without a trace.
    pub fn run(&self, stop: &AtomicBool) -> Result<RunReport, Refusal> {
        self.run_into(&mut NoTrace, stop)
    }

    /// Runs with the records going to `sink`.
    pub fn run_into(&self, sink: &mut dyn TraceSink, stop: &AtomicBool) -> Result<RunReport, Refusal> {
        self.run_paced(sink, stop, None)
    }

    /// As [`Prepared::run_into`], at a pace if there is one.
    pub fn run_paced(
        &self,
        sink: &mut dyn TraceSink,
        stop: &AtomicBool,
        pacer: Option<&mut dyn Pacer>,
    ) -> Result<RunReport, Refusal> {
        let sources = || self.mission.graph().sources.clone();
        let mut platform = self.platform(self.settings.threads)?;
        let engine = Engine::new(self.mission, &self.settings, &self.scene, &mut *platform, sink, stop);
        let mut engine = engine.map_err(|d| refuse(vec![d], sources()))?;
        if let Some(pacer) = pacer {
            engine.paced(pacer);
        }
        Ok(engine.run())
    }

    /// Refuses a run that cannot start.
    pub fn starts(&self) -> Result<(), Refusal> {
        let mut platform = self.platform(1)?;
        let (mut sink, stop) = (NoTrace, AtomicBool::new(false));
        match Engine::new(self.mission, &self.settings, &self.scene, &mut *platform, &mut sink, &stop) {
            Ok(_) => Ok(()),
            Err(d) => Err(refuse(vec![d], self.mission.graph().sources.clone())),
        }
    }

    fn platform(&self, threads: usize) -> Result<Box<dyn Platform>, Refusal> {
        platform(&self.scene, self.recording.as_ref(), threads, |why| self.not_simulated(why))
    }

    /// The scene has a part that the simulator does not take.
    fn not_simulated(&self, why: String) -> Refusal {
        let path = self.mission.graph().sources.first().map_or(String::new(), |s| s.path.clone());
        let hint = "look at the start poses, sizes and profiles, and at what `--set` gives them";
        Refusal::about(&path, "S9020", "the mission cannot be set up", why, hint)
    }

    /// Runs with a trace file, at a pace if there is one. Whether the file can be written is known before
    /// anything starts.
    pub fn run_traced(
        &self,
        path: &str,
        stop: &AtomicBool,
        pacer: Option<&mut dyn Pacer>,
    ) -> Result<(RunReport, trace_file::Finished), Refusal> {
        for recording in self.recording.iter().flat_map(|r| r.paths()) {
            files::keep_apart(recording, path)?;
        }
        // A run that cannot start leaves no file, and none that was there is emptied.
        self.starts()?;
        let header = header(self.mission, &self.settings, &self.scene)?;
        let unwritable = |e: std::io::Error| files::unwritable(path, &e);
        files::make_folder(path).map_err(unwritable)?;
        let mut writer = trace_file::Writer::create(path, &header).map_err(unwritable)?;
        let mut report = self.run_paced(&mut writer, stop, pacer)?;
        let finished = writer.finish().or_else(|e| {
            // The last chunk did not go out: what is on disk still counts.
            report.outcome = Outcome::Aborted;
            report.reason = format!("the trace stopped being writable: {}", files::reason(&e));
            let digest = trace_file::digest(path).unwrap_or_default();
            let bytes = std::fs::metadata(path).map_or(0, |m| m.len());
            Ok::<_, Refusal>(trace_file::Finished { digest, bytes })
        })?;
        Ok((report, finished))
    }
}

/// The header of a run's trace.
fn header(mission: &Mission, settings: &Settings, scene: &Scene) -> Result<trace_file::Header, Refusal> {
    let graph = mission.graph();
    let mut params: BTreeMap<String, Value> =
        graph.params.iter().map(|p| (p.name.to_string(), p.default.clone())).collect();
    params.extend(settings.params.clone());
    let graph_json = graph_file::canonical(graph).map_err(|e| {
        let source = Source { path: graph.name.to_string(), text: String::new() };
        Refusal::with(Diagnostic::error("S9999", format!("the graph cannot be written: {e}")), source)
            .exit(Exit::Internal)
    })?;
    Ok(trace_file::Header {
        mission: graph.name.to_string(),
        title: graph.title.clone(),
        versions: BTreeMap::from([("soifra".to_string(), env!("CARGO_PKG_VERSION").to_string())]),
        params,
        scene: scene.clone(),
        graph_json,
    })
}

/// What a finished run ends the process with.
pub fn exit_of(report: &RunReport) -> Exit {
    if report.interrupted() { Exit::Interrupted } else { Exit::of_outcome(report.outcome.name()) }
}

fn refuse(diagnostics: Vec<Diagnostic>, sources: Vec<Source>) -> Refusal {
    Refusal { findings: Findings { diagnostics, sources }, exit: Exit::WrongInput }
}

/// More threads than this help on no machine, and a system may refuse to start them.
const MOST_THREADS: usize = 256;

/// How many threads to use: as asked, else `RAYON_NUM_THREADS`, else one a core.
pub fn threads(asked: Option<usize>) -> usize {
    let from_environment = || std::env::var("RAYON_NUM_THREADS").ok()?.trim().parse().ok().filter(|n| *n > 0);
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    asked.filter(|n| *n > 0).or_else(from_environment).unwrap_or_else(cores).min(MOST_THREADS)
}
