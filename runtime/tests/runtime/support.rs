//! A scripted platform, and short ways to compile and run missions on it.

use soifra_graph::{Graph, Value};
use soifra_lang::{CheckOptions, Loader, check};
use soifra_runtime::{
    Engine, Event, Mission, Pacer, Platform, Readings, Record, Report, RunReport, Scene, Settings, Snapshot,
    Time, TraceSink, WorldTruth, replay, scene::RobotScene,
};
use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// Profiles that test missions use.
pub const PROFILES: &str = r"
edition 1
platform cart {
  body = cylinder(radius: 10 cm, height: 20 cm)
  drive = holonomic(max_speed: 1 m/s, max_turn: 1 rad/s)
  sensor pose = ideal_pose(period: 100 ms)
  sensor slow = ideal_pose(period: 1 s, latency: 200 ms)
  actuator base = twist()
  actuator arm = twist(lifetime: 150 ms)
  safe = stop()
}
platform pawn {
  body = cylinder(radius: 10 cm, height: 20 cm)
  drive = holonomic(max_speed: 10 m/s, max_turn: 1 rad/s)
  sensor pose = ideal_pose()
  actuator legs = strides(duration: 900 ms)
  safe = stop()
}
";

struct Library;

impl Loader for Library {
    fn load(&mut self, path: &str) -> Result<String, String> {
        Err(format!("no file {path}"))
    }
    fn library(&self) -> Vec<(String, String)> {
        vec![("profiles.soi".into(), PROFILES.into())]
    }
}

/// Compiles a mission; warnings do not matter.
pub fn graph(text: &str) -> Graph {
    let checked = check("mission.soi", text, &mut Library, &CheckOptions::default());
    let errors: Vec<String> = checked
        .diagnostics
        .iter()
        .filter(|d| d.severity == soifra_graph::Severity::Error)
        .map(|d| format!("{} {} {:?} at {:?}", d.code, d.title, d.hint, d.labels))
        .collect();
    checked.graph.unwrap_or_else(|| panic!("{errors:#?}\n{text}"))
}

pub fn mission(text: &str) -> Mission {
    Mission::load(graph(text)).unwrap_or_else(|e| panic!("{e:#?}"))
}

pub fn settings() -> Settings {
    Settings { seed: 1, params: BTreeMap::new(), threads: 1 }
}

pub fn with(params: &[(&str, Value)]) -> Settings {
    Settings { params: params.iter().map(|(n, v)| ((*n).to_string(), v.clone())).collect(), ..settings() }
}

/// A world in which carts keep their velocity and pawns have walked their strides by the next poll. Readings of poses
/// come at multiples of the period of their sensor, unless they are switched off.
pub struct World {
    now: Time,
    robots: Vec<Body>,
    sensors: Vec<Eye>,
    /// Reports to hand over, in order of time.
    pub script: Vec<Report>,
    /// Readings to be left out: robot, sensor, from, to.
    pub blind: Vec<(u32, u32, Time, Time)>,
    /// Added to a reading: robot, sensor, captured, x.
    pub altered: Vec<(u32, u32, Time, f64)>,
    pub truth: bool,
    /// The operator stops the run while nothing happens.
    pub stops_when_idle: bool,
    pub stop: Arc<AtomicBool>,
    pub sent: Vec<(Time, u32, u32, Vec<f64>, Time)>,
    pub safe: Vec<(Time, u32)>,
}

struct Body {
    pose: [f64; 7],
    velocity: [f64; 2],
    /// A stride that is to be walked: along x, along y, length.
    stride: [f64; 3],
    path: f64,
}

#[derive(Clone)]
struct Eye {
    robot: u32,
    sensor: u32,
    period: i64,
    latency: i64,
    /// Number of the next capture.
    next: i64,
}

impl World {
    pub fn new(scene: &Scene) -> Self {
        let body = |r: &RobotScene| Body { pose: r.start, velocity: [0.0; 2], stride: [0.0; 3], path: 0.0 };
        let bodies = scene.bodies().iter().map(body);
        let mut sensors = Vec::new();
        for (r, robot) in scene.bodies().iter().enumerate() {
            for (s, part) in scene.platforms[robot.platform as usize].of_role("sensor").enumerate() {
                if robot.consumed[s] {
                    let period = part
                        .optional("period")
                        .map_or(scene.step.unwrap_or(Time(1)), |p| Time::from_seconds(p).unwrap());
                    let latency = Time::from_seconds(part.number("latency")).unwrap();
                    let (robot, sensor) = (r as u32, s as u32);
                    sensors.push(Eye { robot, sensor, period: period.0, latency: latency.0, next: 0 });
                }
            }
        }
        World {
            now: Time::ZERO,
            robots: bodies.collect(),
            sensors,
            script: Vec::new(),
            blind: Vec::new(),
            altered: Vec::new(),
            truth: true,
            stops_when_idle: false,
            stop: Arc::default(),
            sent: Vec::new(),
            safe: Vec::new(),
        }
    }
}

impl Platform for World {
    fn next_due(&self) -> Option<Time> {
        self.sensors.iter().map(|s| Time(s.next * s.period + s.latency)).min()
    }

    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>) {
        let dt = (now - self.now).seconds();
        for b in &mut self.robots {
            let [x, y, length] = std::mem::take(&mut b.stride);
            b.pose[0] += x;
            b.pose[1] += y;
            b.path += length;
            let v = b.velocity;
            b.pose[0] += v[0] * dt;
            b.pose[1] += v[1] * dt;
            b.path += (v[0] * v[0] + v[1] * v[1]).sqrt() * dt;
        }
        self.now = now;
        while let Some(first) = self.script.first() {
            let (Report::ContactBegin { at, .. }
            | Report::ContactEnd { at, .. }
            | Report::Lost { at, .. }
            | Report::Over { at }) = first;
            if *at > now {
                break;
            }
            reports.push(self.script.remove(0));
        }
        for i in 0..self.sensors.len() {
            while let Eye { robot, sensor, period, latency, next } = self.sensors[i].clone()
                && next * period + latency <= now.0
            {
                self.sensors[i].next += 1;
                let captured = Time(next * period);
                let hidden = |b: &(u32, u32, Time, Time)| {
                    b.0 == robot && b.1 == sensor && b.2 <= captured && captured < b.3
                };
                if self.blind.iter().any(hidden) {
                    continue;
                }
                let mut pose = self.robots[robot as usize].pose;
                for a in self.altered.iter().filter(|a| (a.0, a.1, a.2) == (robot, sensor, captured)) {
                    pose[0] += a.3;
                }
                readings.push(robot, sensor, captured, Time(next * period + latency), &pose);
            }
        }
    }

    fn advance(&mut self, _: Time) {
        self.stop.store(self.stops_when_idle, Ordering::Relaxed);
    }

    fn send(&mut self, now: Time, robot: u32, actuator: u32, command: &[f64], expires: Time) {
        let body = &mut self.robots[robot as usize];
        if command.len() == 2 {
            let (heading, length) = (command[0], command[1]);
            let (sin, cos) = quarter_turns(heading);
            body.stride = [length * cos, length * sin, length];
        } else if actuator == 0 {
            body.velocity = [command[0], command[1]];
        }
        self.sent.push((now, robot, actuator, command.to_vec(), expires));
    }

    fn safe_action(&mut self, now: Time, robot: u32) -> &'static str {
        self.robots[robot as usize].velocity = [0.0; 2];
        self.safe.push((now, robot));
        "stop"
    }

    fn truth(&self) -> Option<&dyn WorldTruth> {
        if self.truth { Some(self) } else { None }
    }
}

/// Sine and cosine by multiples of a right angle, which is all that pawns turn to here.
fn quarter_turns(x: f64) -> (f64, f64) {
    match (x / std::f64::consts::FRAC_PI_2).round() as i64 % 4 {
        0 => (0.0, 1.0),
        1 | -3 => (1.0, 0.0),
        2 | -2 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

impl WorldTruth for World {
    fn pose(&self, robot: u32) -> [f64; 7] {
        self.robots[robot as usize].pose
    }
    fn path_length(&self, robot: u32) -> f64 {
        self.robots[robot as usize].path
    }
    fn collisions(&self, _: u32) -> u32 {
        0
    }
    fn in_collision(&self, _: u32) -> bool {
        false
    }
    fn total_collisions(&self) -> u32 {
        0
    }
    fn movers(&self) -> Vec<(String, [f64; 7])> {
        Vec::new()
    }
}

/// A run with everything that came out of it.
pub struct Ran {
    pub report: RunReport,
    pub records: Vec<Record>,
    pub world: World,
}

pub fn run(text: &str) -> Ran {
    run_with(&mission(text), &settings(), |_| {})
}

pub fn run_with(mission: &Mission, settings: &Settings, prepare: impl FnOnce(&mut World)) -> Ran {
    run_paced(mission, settings, prepare, None)
}

/// A run that is held to a pace.
pub fn run_paced(
    mission: &Mission,
    settings: &Settings,
    prepare: impl FnOnce(&mut World),
    pacer: Option<&mut dyn Pacer>,
) -> Ran {
    let scene = mission.scene(settings).unwrap_or_else(|e| panic!("{e:?}"));
    let mut world = World::new(&scene);
    prepare(&mut world);
    let mut sink = Watcher::default();
    let stop = world.stop.clone();
    let engine = Engine::new(mission, settings, &scene, &mut world, &mut sink, &stop);
    let mut engine = engine.unwrap_or_else(|e| panic!("{e:?}"));
    if let Some(pacer) = pacer {
        engine.paced(pacer);
    }
    let report = engine.run();
    let Watcher { records, snapshots, .. } = sink;
    for text in snapshots {
        goes_on(mission, settings, &text, &records, &report);
    }
    Ran { report, records, world }
}

/// A replay from a snapshot gives the same records and the same report.
fn goes_on(mission: &Mission, settings: &Settings, text: &str, records: &[Record], report: &RunReport) {
    let snapshot: Snapshot = serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    let t = snapshot.t;
    match replay::verify_from(mission, settings, snapshot, records.iter().cloned()) {
        Ok(again) => assert_eq!(&again, report, "from {t:?}"),
        Err(e) => panic!("from {t:?}: {e:?}\n{text}"),
    }
}

/// Keeps records, and a snapshot of the 1st, 2nd, 4th, 8th … instant at whose end time goes on.
#[derive(Default)]
struct Watcher {
    records: Vec<Record>,
    snapshots: Vec<String>,
    instants: u32,
}

impl TraceSink for Watcher {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        self.records.record(record)
    }

    fn wants_snapshot(&mut self, _: Time) -> bool {
        self.instants += 1;
        self.instants.is_power_of_two()
    }

    fn snapshot(&mut self, snapshot: &Snapshot) -> Result<(), String> {
        self.snapshots.push(serde_json::to_string(snapshot).map_err(|e| e.to_string())?);
        Ok(())
    }
}

impl Ran {
    /// Remarks, as (ms, text).
    pub fn notes(&self) -> Vec<(i64, String)> {
        self.records
            .iter()
            .filter_map(|r| match &r.event {
                Event::Note { text, .. } => Some((r.t.0 / 1_000_000, text.clone())),
                _ => None,
            })
            .collect()
    }

    /// What `pick` makes of the records.
    pub fn all<T>(&self, pick: impl Fn(&Record) -> Option<T>) -> Vec<T> {
        self.records.iter().filter_map(pick).collect()
    }

    /// Records are numbered without gaps, in order of time, and caused by earlier ones.
    pub fn check_records(&self) {
        let mut last = Time::ZERO;
        for (i, r) in self.records.iter().enumerate() {
            assert_eq!(r.n, i as u64);
            assert!(r.t >= last, "{r:?} after {last:?}");
            assert!(r.causes.iter().all(|c| *c < r.n), "{r:?}");
            last = r.t;
        }
    }
}
