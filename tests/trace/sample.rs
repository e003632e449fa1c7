//! A made-up run: three robots that go to their targets among two movers.

use soifra::trace_file::{Header, Trace};
use soifra_graph::{Name, Value};
use soifra_runtime::scene::{Part, PlatformScene, RobotScene, Scene};
use soifra_runtime::{Event, Record, Thread, Time};
use std::collections::BTreeMap;

fn part(role: &str, name: &str, model: &str, args: &[(&str, Value)]) -> Part {
    let args = args.iter().map(|(n, v)| (Name::from(*n), v.clone())).collect();
    Part { role: role.into(), name: name.into(), model: model.into(), args, ty: None }
}

fn at(x: f64, y: f64) -> Value {
    Value::Vector([x, y, 0.0])
}

fn cm(x: f64) -> Value {
    Value::Number(x / 100.0)
}

pub fn pose(x: f64, y: f64, yaw: f64) -> [f64; 7] {
    [x, y, 0.0, 0.0, 0.0, libm::sin(yaw / 2.0), libm::cos(yaw / 2.0)]
}

pub fn scene() -> Scene {
    let world = vec![
        part("bounds", "", "rectangle", &[("low", at(0.0, 0.0)), ("high", at(0.25, 0.25))]),
        part(
            "wall",
            "divider",
            "segment",
            &[
                ("from", at(0.16, 0.02)),
                ("to", at(0.21, 0.05)),
                ("thickness", cm(0.4)),
                ("height", cm(50.0)),
                ("material", Value::Text("plaster".into())),
            ],
        ),
        part(
            "obstacle",
            "pillar",
            "cylinder",
            &[("at", at(0.12, 0.17)), ("radius", cm(0.8)), ("height", cm(50.0))],
        ),
        part(
            "obstacle",
            "crate",
            "box",
            &[
                ("at", at(0.22, 0.22)),
                ("size", Value::Vector([0.02, 0.012, 0.05])),
                ("heading", Value::Number(0.5)),
            ],
        ),
        part("region", "dock", "circle", &[("at", at(0.08, 0.1)), ("radius", cm(1.6))]),
        part("region", "yard", "rectangle", &[("low", at(0.01, 0.19)), ("high", at(0.06, 0.24))]),
        part("mover", "block[0]", "disc", &[("radius", cm(0.8)), ("height", cm(50.0))]),
        part("mover", "block[1]", "disc", &[("radius", cm(0.8)), ("height", cm(50.0))]),
        part("material", "plaster", "plain", &[("color", Value::Text("#cccccc".into()))]),
    ];
    let body = part(
        "body",
        "",
        "cylinder",
        &[("radius", cm(0.4)), ("height", cm(1.0)), ("mass", Value::Number(0.1))],
    );
    let robot = |name: &str, start: (f64, f64), target: (f64, f64)| RobotScene {
        name: name.into(),
        group: 0,
        platform: 0,
        declared_start: pose(start.0, start.1, 0.0),
        start: pose(start.0, start.1, 0.0),
        target: Some([target.0, target.1, 0.0]),
        consumed: vec![true],
        host: false,
    };
    Scene {
        seed: 7,
        step: Some(Time(1_000_000_000)),
        world,
        platforms: vec![PlatformScene { name: "disc".into(), parts: vec![body] }],
        robots: vec![
            robot("r1", (0.2, 0.12), (0.08, 0.1)),
            robot("r2", (0.18, 0.2), (0.09, 0.125)),
            robot("r3", (0.01, 0.05), (0.1, 0.235)),
        ],
        faults: Vec::new(),
        images: Vec::new(),
    }
}

pub fn header() -> Header {
    Header {
        mission: "sim".into(),
        title: "three discs among two movers".into(),
        versions: BTreeMap::from([("soifra".into(), "0.1.0".into())]),
        params: BTreeMap::from([
            ("avoidance".into(), Value::Bool(true)),
            ("speed".into(), Value::Number(0.1 + 0.2)),
        ]),
        scene: scene(),
        graph_json: r#"{"schema":1,"name":"sim","title":"three discs among two movers"}"#.into(),
    }
}

/// Collects records, numbering them.
pub struct Log {
    pub records: Vec<Record>,
    pub now: Time,
}

impl Log {
    pub fn push(&mut self, causes: &[u64], event: Event) -> u64 {
        let n = self.records.len() as u64;
        self.records.push(Record { n, t: self.now, causes: causes.to_vec(), event });
        n
    }
}

/// One event of every kind, with everything that is hard to write.
pub fn every_kind() -> Vec<Event> {
    let agent = || "navigator@r1".to_string();
    let text = || "a \"quoted\" text,\nµ and \u{1F916}".to_string();
    let numbers = || vec![0.1 + 0.2, -0.0, 1e-300, 5e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 3.0];
    vec![
        Event::Reading { robot: 0, sensor: 1, captured: Time(17), registers: numbers() },
        Event::Activation {
            robot: 0,
            agent: agent(),
            unit: "step".into(),
            release: Time(1),
            start: Time(2),
            finish: Some(Time(3)),
            skipped: Some(text()),
        },
        Event::Rule { robot: 0, agent: agent(), unit: "step".into(), rule: 2, guard: text() },
        Event::Transition {
            robot: 0,
            agent: agent(),
            unit: "m".into(),
            from: "idle".into(),
            to: "turning".into(),
        },
        Event::Node {
            robot: 0,
            agent: agent(),
            unit: "p".into(),
            node: 4,
            label: text(),
            result: "success".into(),
        },
        Event::State { robot: 0, agent: agent(), state: "arrived".into(), registers: numbers() },
        Event::Message { robot: 0, agent: agent(), topic: "plan".into(), registers: numbers() },
        Event::Delivery {
            robot: 1,
            agent: agent(),
            topic: "plan".into(),
            message: 6,
            dropped: Some("range".into()),
        },
        Event::Arbitration {
            robot: 0,
            actuator: "base".into(),
            winner: None,
            losers: vec![("a.b".into(), text()), ("c.d".into(), "inhibited".into())],
        },
        Event::Command { robot: 0, actuator: 0, registers: numbers(), expires: Time::MAX },
        Event::SafeAction { robot: 2, action: "stop".into(), reason: text() },
        Event::Param { agent: agent(), param: "speed".into(), registers: numbers() },
        Event::Note { robot: 0, agent: agent(), text: text() },
        Event::Pose { robot: 0, pose: pose(0.1, 0.2, 0.3), path_m: 0.3 },
        Event::Pose { robot: 0, pose: [f64::NAN; 7], path_m: f64::INFINITY },
        Event::Pose { robot: 99, pose: pose(0.1, 0.2, 0.3), path_m: 0.3 },
        Event::Mover { name: "block[0]".into(), pose: pose(1.0, 1e-17, 2.0) },
        Event::Mover { name: text(), pose: [f64::NEG_INFINITY; 7] },
        Event::Contact { robot: 0, other: Some(2), with: "r3".into(), begin: true },
        Event::Goal { goal: "arrive".into(), robot: None, status: "active".into(), reason: None },
        Event::Expectation { index: 0, robot: Some(1), held: false, margin: Some(-0.1) },
        Event::Expectation { index: 1, robot: None, held: true, margin: Some(f64::INFINITY) },
        Event::Fault { robot: None, agent: agent(), text: text() },
        Event::End { outcome: "failed".into(), reason: text() },
        Event::Deferral { robot: 0, agent: agent(), unit: "brake".into(), until: Time(9) },
        Event::Switch { robot: 0, core: 1, agent: Some(agent()), unit: Some("brake".into()) },
        Event::Switch { robot: 0, core: 1, agent: None, unit: None },
        Event::Completion {
            robot: 0,
            agent: agent(),
            unit: "brake".into(),
            release: Time(1),
            start: Time(2),
            rounds: Some(3),
        },
        Event::Miss { robot: 0, agent: agent(), unit: "brake".into(), release: Time(1), deadline: Time(5) },
        Event::Acl {
            robot: 0,
            performative: "request".into(),
            sender: agent(),
            receiver: "df@host".into(),
            content: Some("Offer".into()),
            registers: numbers(),
            reason: Some(text()),
            thread: Box::new(Thread {
                conversation_id: Some("c1".into()),
                protocol: Some("request".into()),
                ontology: Some("parcels".into()),
                reply_with: Some("m1".into()),
                in_reply_to: Some("m0".into()),
                reply_by: Some(Time(7)),
            }),
        },
        Event::Conversation {
            robot: 0,
            agent: agent(),
            conversation_id: "c1".into(),
            state: "asked".into(),
            over: false,
        },
        Event::Service {
            robot: 0,
            agent: agent(),
            service: "drive".into(),
            running: true,
            subgoal: Some("navigate".into()),
        },
        Event::Life { robot: 0, agent: agent(), status: "dead".into(), reason: text() },
        Event::Device { robot: 0, agent: agent(), device: "camera".into(), unit: None, waiting: 2 },
        Event::Input {
            text: text(),
            operation: "set".into(),
            agent: None,
            param: Some("speed".into()),
            registers: numbers(),
        },
    ]
}

/// The run. `steps` a second, for `seconds`.
pub fn run(steps: u32, seconds: u32) -> Vec<Record> {
    let scene = scene();
    let mut log = Log { records: Vec::new(), now: Time::ZERO };
    log.push(&[], Event::Goal { goal: "arrive".into(), robot: None, status: "active".into(), reason: None });
    let total = steps * seconds;
    for i in 0..=total {
        log.now = Time(i64::from(i) * 1_000_000_000 / i64::from(steps));
        let (s, t) = (f64::from(i) / f64::from(total), log.now.seconds());
        for (k, x) in [(0, 0.04), (1, 0.14)] {
            let y = 0.125 + 0.11 * libm::sin(0.45 * t + f64::from(k));
            let yaw = if libm::cos(0.45 * t + f64::from(k)) < 0.0 { -1.57 } else { 1.57 };
            log.push(&[], Event::Mover { name: format!("block[{k}]"), pose: pose(x, y, yaw) });
        }
        for (k, r) in scene.robots.iter().enumerate() {
            let (a, b) = (r.start, r.target.unwrap_or_default());
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            // A line with a bulge: the robots do not go straight.
            let bulge = 0.25 * libm::sin(std::f64::consts::PI * s) * [0.3, -0.5, 0.6][k];
            let (x, y) = (a[0] + s * dx - bulge * dy, a[1] + s * dy + bulge * dx);
            let slope =
                0.25 * std::f64::consts::PI * libm::cos(std::f64::consts::PI * s) * [0.3, -0.5, 0.6][k];
            let yaw = libm::atan2(dy + slope * dx, dx - slope * dy);
            let reading = Event::Reading {
                robot: k as u32,
                sensor: 0,
                captured: log.now,
                registers: pose(x, y, yaw).to_vec(),
            };
            let cause = log.push(&[], reading);
            let agent = format!("navigator@{}", r.name);
            let rule =
                Event::Rule { robot: k as u32, agent, unit: "go".into(), rule: 1, guard: "otherwise".into() };
            let cause = log.push(&[cause], rule);
            let command = Event::Command {
                robot: k as u32,
                actuator: 0,
                registers: vec![yaw, 0.01],
                expires: log.now + Time(2_000_000_000),
            };
            log.push(&[cause], command);
            let path_m = s * libm::hypot(dx, dy);
            log.push(&[], Event::Pose { robot: k as u32, pose: pose(x, y, yaw), path_m });
        }
        if i == total / 2 {
            let contact = |begin| Event::Contact { robot: 1, other: None, with: "pillar".into(), begin };
            log.push(&[], contact(true));
            log.push(&[], contact(false));
        }
    }
    log.push(&[], Event::End { outcome: "success".into(), reason: "every robot arrived".into() });
    log.records
}

pub fn trace() -> Trace {
    Trace { header: header(), records: run(10, 20), complete: true }
}
