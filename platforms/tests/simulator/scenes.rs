//! Scenes made by hand, and a driver for them.

use soifra_graph::{Distribution, Value, component};
use soifra_platforms::sim::Simulator;
use soifra_runtime::{
    Platform, Readings, Report, Scene, Time, WorldTruth,
    scene::{Part, PlatformScene, RobotScene},
};
use std::{collections::BTreeMap, f64::consts::FRAC_PI_2};

/// A component with the defaults of its model.
pub fn part(role: &str, name: &str, model: &str, args: &[(&str, Value)]) -> Part {
    let known = component::model(role, model).unwrap();
    let mut all: BTreeMap<_, _> = BTreeMap::new();
    for p in &known.signature.parameters {
        if let Some(d) = &p.default {
            all.insert(p.name.clone(), d.clone());
        }
    }
    for (n, v) in args {
        assert!(known.signature.parameters.iter().any(|p| &*p.name == *n), "{model} has no {n}");
        all.insert((*n).into(), v.clone());
    }
    Part { role: role.into(), name: name.into(), model: model.into(), args: all, ty: None }
}

pub fn num(x: f64) -> Value {
    Value::Number(x)
}
pub fn at(x: f64, y: f64) -> Value {
    Value::Vector([x, y, 0.0])
}
pub fn list(items: &[f64]) -> Value {
    Value::List(items.iter().map(|x| num(*x)).collect())
}
pub fn path(points: &[[f64; 2]]) -> Value {
    Value::List(points.iter().map(|p| at(p[0], p[1])).collect())
}
pub fn normal(sd: f64) -> Value {
    Value::Distribution(Distribution::Normal(0.0, sd))
}
pub fn some(x: f64) -> Value {
    Value::Some(Box::new(num(x)))
}

pub fn body(radius: f64) -> Part {
    part("body", "", "cylinder", &[("radius", num(radius)), ("height", num(0.3))])
}

pub fn wheels(extra: &[(&str, Value)]) -> Part {
    let mut args = vec![
        ("wheel_radius", num(0.02)),
        ("wheel_base", num(0.1)),
        ("max_speed", num(1.0)),
        ("wheel_acceleration", num(1e6)),
    ];
    args.extend(extra.iter().cloned());
    part("drive", "", "differential", &args)
}

pub fn holonomic(extra: &[(&str, Value)]) -> Part {
    let mut args = vec![("max_speed", num(10.0)), ("max_turn", num(10.0))];
    args.extend(extra.iter().cloned());
    part("drive", "", "holonomic", &args)
}

pub fn sensor(model: &str, args: &[(&str, Value)]) -> Part {
    part("sensor", model, model, args)
}

pub fn twist() -> Part {
    part("actuator", "base", "twist", &[])
}
pub fn strides(duration: f64) -> Part {
    part("actuator", "legs", "strides", &[("duration", num(duration))])
}

pub fn platform(parts: Vec<Part>) -> PlatformScene {
    PlatformScene { name: "tested".into(), parts }
}

pub fn pose(x: f64, y: f64, heading: f64) -> [f64; 7] {
    [x, y, 0.0, 0.0, 0.0, libm::sin(0.5 * heading), libm::cos(0.5 * heading)]
}

/// One platform, robots at these places with these headings, every sensor read.
pub fn scene(parts: Vec<Part>, world: Vec<Part>, starts: &[[f64; 3]]) -> Scene {
    let sensors = parts.iter().filter(|p| &*p.role == "sensor").count();
    let robots = starts
        .iter()
        .enumerate()
        .map(|(i, s)| RobotScene {
            host: false,
            name: format!("r[{i}]"),
            group: 0,
            platform: 0,
            declared_start: pose(s[0], s[1], s[2]),
            start: pose(s[0], s[1], s[2]),
            target: None,
            consumed: vec![true; sensors],
        })
        .collect();
    Scene {
        seed: 7,
        step: Some(Time(1_000_000_000)),
        world,
        platforms: vec![platform(parts)],
        robots,
        faults: Vec::new(),
        images: Vec::new(),
    }
}

pub fn secs(s: f64) -> Time {
    Time::from_seconds(s).unwrap()
}

/// Drives a simulator and keeps what it says.
pub struct Rig {
    pub sim: Simulator,
    pub readings: Readings,
    pub reports: Vec<Report>,
}

impl Rig {
    pub fn new(scene: &Scene) -> Rig {
        Rig { sim: Simulator::new(scene).unwrap(), readings: Readings::default(), reports: Vec::new() }
    }
    pub fn poll(&mut self, t: f64) {
        self.sim.poll(secs(t), &mut self.readings, &mut self.reports);
    }
    pub fn send(&mut self, t: f64, robot: u32, command: &[f64], expires: f64) {
        self.sim.send(secs(t), robot, 0, command, secs(expires));
    }
    /// Sends a twist that does not expire.
    pub fn drive(&mut self, t: f64, robot: u32, forward: f64, left: f64, turn: f64) {
        self.send(t, robot, &[forward, left, 0.0, 0.0, 0.0, turn], 1e6);
    }
    /// x, y, heading at the last poll.
    pub fn place(&self, robot: u32) -> [f64; 3] {
        let p = self.sim.truth().unwrap().pose(robot);
        [p[0], p[1], 2.0 * libm::atan2(p[5], p[6])]
    }
    /// Registers of the latest reading of a sensor.
    pub fn latest(&self, robot: u32, sensor: u32) -> &[f64] {
        let r = self.readings.items.iter().rfind(|r| r.robot == robot && r.sensor == sensor).unwrap();
        &self.readings.registers[r.from as usize..r.to as usize]
    }
    /// Beams of the latest reading: bearing and range.
    pub fn beams(&self, robot: u32, sensor: u32) -> Vec<(f64, Option<f64>)> {
        let r = self.latest(robot, sensor);
        assert_eq!(r.len(), 1 + 3 * r[0] as usize);
        r[1..].chunks(3).map(|b| (b[0], (b[1] == 0.0).then_some(b[2]))).collect()
    }
    pub fn truth(&self) -> &dyn WorldTruth {
        self.sim.truth().unwrap()
    }
}

pub fn close(a: f64, b: f64, within: f64) {
    assert!((a - b).abs() <= within, "{a} is not {b} ± {within}");
}

/// Begins and ends of contacts: time in ns, robot, other robot, name.
pub fn contacts(reports: &[Report]) -> Vec<(i64, bool, u32, Option<u32>, String)> {
    reports
        .iter()
        .filter_map(|r| match r {
            Report::ContactBegin { at, robot, other, with } => {
                Some((at.0, true, *robot, *other, with.clone()))
            }
            Report::ContactEnd { at, robot, other, with } => {
                Some((at.0, false, *robot, *other, with.clone()))
            }
            Report::Lost { .. } | Report::Over { .. } => None,
        })
        .collect()
}

pub const NORTH: f64 = FRAC_PI_2;
