//! Response-time analysis against the schedule that the runtime executes: no response is longer than its bound,
//! and where nothing blocks and nothing comes late, the bound is reached when all are released together.

use soifra_graph::Graph;
use soifra_lang::{CheckOptions, Loader, schedule};
use soifra_platforms::sim::Simulator;
use soifra_runtime::{Engine, Event, Mission, Record, Settings, TraceSink, seed::Stream};
use std::{collections::BTreeMap, fmt::Write, sync::atomic::AtomicBool};

/// How many sets of each kind: 1,000 in all.
const PLAIN: u64 = 400;
const BLOCKED: u64 = 400;
const SPORADIC: u64 = 200;

struct Nothing;

impl Loader for Nothing {
    fn load(&mut self, path: &str) -> Result<String, String> {
        Err(format!("there is no {path}"))
    }

    fn library(&self) -> Vec<(String, String)> {
        Vec::new()
    }
}

/// The longest response of each unit.
#[derive(Default)]
struct Longest(BTreeMap<String, i64>);

impl TraceSink for Longest {
    fn record(&mut self, r: &Record) -> Result<(), String> {
        if let Event::Completion { unit, release, .. } = &r.event {
            let response = r.t.0 - release.0;
            let longest = self.0.entry(unit.clone()).or_default();
            *longest = (*longest).max(response);
        }
        Ok(())
    }
}

/// A random set of tasks as a mission.
struct Draw(Stream);

impl Draw {
    fn below(&mut self, n: u64) -> u64 {
        self.0.bits() % n.max(1)
    }

    fn set(&mut self, kind: &str) -> String {
        let n = 2 + self.below(5);
        // Shares of the core that come to 0.5 to 1.
        let total = 500 + self.below(500);
        let weights: Vec<u64> = (0..n).map(|_| 1 + self.below(100)).collect();
        let sum: u64 = weights.iter().sum();
        let mut text = String::from("edition 1\nagent tasks {\n  state done: Bool = false\n");
        if kind == "sporadic" {
            let every = 300 + self.below(700);
            let _ = writeln!(text, "  event go\n  service stir every {every} us {{ raise go }}");
        }
        for (i, w) in weights.iter().enumerate() {
            let period = [1_000, 2_000, 5_000, 10_000, 20_000][self.below(5) as usize] + 10 * self.below(100);
            let worst = (period * total * w / sum / 1000).max(2);
            let deadline = worst + self.below(period - worst + 1);
            let priority = self.below(4);
            let trigger = match kind {
                "sporadic" if i % 2 == 1 => format!("on event go at most every {period} us"),
                _ => format!("every {period} us"),
            };
            let mut extra = String::new();
            if kind == "blocked" {
                if self.below(2) == 0 {
                    let held = 1 + self.below(worst / 2 + 1).min(worst - 1);
                    let _ =
                        write!(extra, " shares {} for {held} us", ["bus", "disk"][self.below(2) as usize]);
                }
                if self.below(3) == 0 {
                    let _ = write!(extra, " jitter {} us", 1 + self.below(period / 4));
                }
            }
            let _ = writeln!(
                text,
                "  service task{i} {trigger} worst {worst} us deadline {deadline} us soft priority {priority} core 0{extra} {{ set done = true }}"
            );
        }
        text += "}\nmission set {\n  host box runs tasks\n  goal g { subgoal s by tasks achieved when false }\n  within 200 ms\n}\n";
        text
    }
}

fn graph(text: &str) -> Graph {
    let checked = soifra_lang::check("set.soi", text, &mut Nothing, &CheckOptions::default());
    checked.graph.unwrap_or_else(|| panic!("{text}\n{:#?}", checked.diagnostics))
}

fn run(graph: Graph) -> Longest {
    let mission = Mission::load(graph).expect("it loads");
    let settings = Settings { seed: 1, params: BTreeMap::new(), threads: 1 };
    let scene = mission.scene(&settings).expect("a scene");
    let mut platform = Simulator::new(&scene).expect("a simulator");
    let (mut sink, stop) = (Longest::default(), AtomicBool::new(false));
    Engine::new(&mission, &settings, &scene, &mut platform, &mut sink, &stop).expect("it starts").run();
    sink
}

/// Compares one set; gives how many bounds were compared and how many were reached.
fn compare(text: &str) -> (usize, usize) {
    let graph = graph(text);
    let timing = schedule::timing(&graph);
    let seen = run(graph);
    let (mut compared, mut reached) = (0, 0);
    for t in timing.cores.iter().flat_map(|c| &c.tasks) {
        let (Some(bound), Some(longest)) = (t.response, seen.0.get(&*t.unit)) else { continue };
        assert!(*longest <= bound, "{} took {longest} ns, its bound is {bound} ns:\n{text}", t.unit);
        compared += 1;
        reached += usize::from(*longest == bound);
    }
    (compared, reached)
}

fn sets(kind: &str, count: u64) -> (usize, usize) {
    let (mut compared, mut reached) = (0, 0);
    for i in 0..count {
        let text = Draw(Stream::new(i, kind)).set(kind);
        let (c, r) = compare(&text);
        compared += c;
        reached += r;
    }
    (compared, reached)
}

#[test]
fn the_bound_is_reached_when_all_are_released_together() {
    let (mut compared, mut met) = (0, 0);
    for i in 0..PLAIN {
        let text = Draw(Stream::new(i, "plain")).set("plain");
        let graph = graph(&text);
        let timing = schedule::timing(&graph);
        let seen = run(graph);
        for t in timing.cores.iter().flat_map(|c| &c.tasks) {
            let Some(bound) = t.response else { continue };
            let longest = seen.0.get(&*t.unit).copied().unwrap_or(0);
            assert!(longest <= bound, "{} took {longest} ns, its bound is {bound} ns:\n{text}", t.unit);
            compared += 1;
            // A task that is not done by its next release is skipped then, so that others are delayed less.
            let core = &timing.cores[0].tasks;
            let above = core.iter().take_while(|o| o.unit != t.unit).chain([t]);
            if above.into_iter().all(|o| o.response.zip(o.period).is_some_and(|(r, p)| r <= p)) {
                assert_eq!(longest, bound, "{}: the bound is not reached:\n{text}", t.unit);
                met += 1;
            }
        }
    }
    assert!(compared > 1000 && met > 900, "{compared} compared, {met} reached");
}

#[test]
fn no_response_is_longer_than_its_bound_with_jitter_and_blocking() {
    let (compared, reached) = sets("blocked", BLOCKED);
    assert!(compared > 1000 && reached > 100, "{compared} compared, {reached} reached");
}

#[test]
fn no_response_of_sporadic_tasks_is_longer_than_its_bound() {
    let (compared, reached) = sets("sporadic", SPORADIC);
    assert!(compared > 400 && reached > 50, "{compared} compared, {reached} reached");
}

/// From a reading to a command by a message that is told, a conversation and a parameter.
#[test]
fn chains_go_from_agent_to_agent() {
    const TEXT: &str = r#"
edition 1
record Word { n: Int }
protocol say<Say> { state start { initiator inform Say -> said } state said }
conversation talk: say<Word> = channel(delay: 5 ms)
param level: Int = 0
platform cart {
  body = cylinder(radius: 10 cm, height: 10 cm)
  drive = holonomic(max_speed: 1 m/s, max_turn: 1 rad/s)
  sensor pose = ideal_pose(period: 100 ms, latency: 1 ms)
  actuator base = twist()
  safe = stop()
}
agent eye {
  sensor pose: Pose<map>
  service look on sensor pose { tell head inform Word(n: if pose.position.x > 1 m then 1 else 0) }
}
agent head {
  service think on inform Word(w) from eye { open talk inform Word(n: w.n) to offering(talk) }
}
agent hand {
  offers talk
  service hear on talk inform(w) { set level = w.n }
}
agent foot {
  actuator base: Twist
  state done = false
  service go every 20 ms worst 2 ms {
    set done = level > 0
    command base twist(if level > 0 then 0 m/s else 0.1 m/s)
  }
}
mission m {
  robot a: cart at (0 m, 0 m) runs eye, head, hand, foot
  goal g { subgoal s by foot achieved when done }
  within 60 s
}
"#;
    let timing = schedule::timing(&graph(TEXT));
    let [chain] = &timing.chains[..] else { panic!("{:?}", timing.chains) };
    let units: Vec<String> = chain.links.iter().map(|l| format!("{}.{}", l.agent, l.unit)).collect();
    assert_eq!(units, ["eye.look", "head.think", "hand.hear", "foot.go"]);
    // Latency of the sensor, 1 us told, 5 ms said, 1 us of the parameter, a period of waiting, and its execution.
    assert_eq!(chain.latency, Some(1_000_000 + 1_000 + 5_000_000 + 1_000 + 20_000_000 + 2_000_000));
}
