//! `run --realtime`: the same trace in its own time, and an operator at standard input.

use crate::support::{code, command, file, folder, json, soifra, stderr};
use soifra::{
    execute::Prepared,
    trace_file::{Trace, read},
    wall_clock::Stopwatch,
};
use soifra_runtime::{Event, Input, Mission, Operation, Pacer, Record, Settings, Time};
use std::{
    io::Write,
    path::Path,
    process::{Child, Output, Stdio},
    sync::atomic::AtomicBool,
    time::Duration,
};

/// Half a second of two carts.
pub const HOP: &str = r#"edition 1

platform cart {
  body = cylinder(radius: 10 cm, height: 20 cm)
  drive = holonomic(max_speed: 1 m/s, max_turn: 1 rad/s, error: normal(sd: 1 %))
  sensor pose = ideal_pose(period: 50 ms)
  actuator base = twist()
  safe = stop()
}

record Beat { x: Length }
topic beat: Beat = channel(delay: 5 ms)

mission hop "two carts, a short way" {
  param speed: Velocity = 0.5 m/s
  param strategy: enum { bold, meek } = bold
  robot porter[2]: cart at (0 m, 1 m * index) to (20 cm, 0 m) runs driver
  goal deliver { subgoal reach by driver achieved when arrived }
  done when achieved(deliver)
  within 600 s
}

agent driver {
  sensor pose: Pose<map>
  actuator base: Twist
  state arrived: Bool = false
  service drive every 50 ms {
    set arrived = pose.position.x >= 20 cm
    publish beat Beat(x: pose.position.x)
    when strategy == bold => command base twist(speed)
  }
  service hear on beat(b) { note "heard", b.x }
}
"#;

/// A run in real time with these pieces at its standard input, each so many milliseconds after the one before.
fn operated(arguments: &[&str], pieces: &[(u64, &[u8])]) -> Output {
    let mut child = begun(arguments);
    let mut input = child.stdin.take().expect("a pipe");
    for (pause, piece) in pieces {
        std::thread::sleep(Duration::from_millis(*pause));
        // The run may be over.
        let _ = input.write_all(piece);
    }
    drop(input);
    child.wait_with_output().expect("it ends")
}

fn begun(arguments: &[&str]) -> Child {
    let mut all = vec!["run", "--realtime"];
    all.extend(arguments);
    let mut c = command(&all);
    c.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    c.spawn().expect("the program starts")
}

fn in_folder(dir: &Path, name: &str) -> String {
    dir.join(name).to_string_lossy().into_owned()
}

#[test]
fn the_wall_clock_changes_no_byte() {
    let dir = folder("realtime_same");
    let hop = file(&dir, "hop.soi", HOP);
    let (free, paced) = (in_folder(&dir, "free.mcap"), in_folder(&dir, "paced.mcap"));
    let csv = in_folder(&dir, "new/lateness.csv");
    let one = json(&soifra(&["run", &hop, "--trace", &free, "--format", "json"]));
    assert!(one["host"]["lateness"].is_null());
    let o = soifra(&["run", &hop, "--trace", &paced, "--realtime", "--lateness", &csv, "--format", "json"]);
    let two = json(&o);
    assert_eq!((code(&o), stderr(&o).as_str()), (0, ""), "the end of the input is no input");
    assert_eq!(one["trace"]["digest"], two["trace"]["digest"]);
    assert!(std::fs::read(&free).expect("a trace") == std::fs::read(&paced).expect("a trace"));
    let time = two["sim_time_s"].as_f64().expect("a time");
    assert!(time > 0.3 && two["host"]["wall_time_s"].as_f64() >= Some(time));

    let lateness = &two["host"]["lateness"];
    let figure = |name: &str| lateness[name].as_f64().unwrap_or_else(|| panic!("{name}: {lateness}"));
    assert!(figure("late") <= figure("instants") && figure("mean_s") > 0.0);
    assert!(figure("mean_s") <= figure("max_s") && figure("p99_s") <= figure("max_s"));
    let text = std::fs::read_to_string(&csv).expect("a table");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("sim_time_s,lateness_s"));
    let rows: Vec<(f64, f64)> = lines
        .filter_map(|l| l.split_once(','))
        .map(|(t, l)| (t.parse().expect("a number"), l.parse().expect("a number")))
        .collect();
    assert_eq!(rows.len() as f64, figure("instants"));
    assert!(rows.windows(2).all(|w| w[0].0 < w[1].0) && rows.iter().all(|r| r.1 >= 0.0));
    assert_eq!(rows.last().map(|r| r.0), Some(time));
    assert_eq!(rows.iter().map(|r| r.1).fold(0.0, f64::max), figure("max_s"));
}

/// Does again what a trace says was done.
struct Again(Vec<(Time, Input)>);

impl Pacer for Again {
    fn pace(&mut self, _: Time, next: Time, inputs: &mut Vec<Input>) -> Time {
        let at = self.0.first().map_or(next, |i| i.0.min(next));
        let together = self.0.iter().take_while(|i| i.0 == at).count();
        inputs.extend(self.0.drain(..together).map(|i| i.1));
        at
    }
}

/// The digest of the trace of a run with the inputs that a trace has.
fn digest_of_same(trace: &Trace, to: &str) -> String {
    let graph = serde_json::from_str(&trace.header.graph_json).expect("a graph");
    let settings = Settings { seed: trace.header.seed(), params: trace.header.params.clone(), threads: 1 };
    let mission = Mission::load(graph).expect("a sound graph");
    let prepared = Prepared::new(&mission, settings).unwrap_or_else(|r| panic!("{r:?}"));
    let inputs = trace.records.iter().filter_map(|r| Input::of(&r.event).map(|i| (r.t, i)));
    let mut again = Again(inputs.collect());
    let stop = AtomicBool::new(false);
    let ran = prepared.run_traced(to, &stop, Some(&mut again));
    ran.unwrap_or_else(|r| panic!("{r:?}")).1.digest
}

#[test]
fn what_an_operator_does_is_recorded_and_done_again() {
    let dir = folder("realtime_operator");
    let (hop, path) = (file(&dir, "hop.soi", HOP), in_folder(&dir, "run.mcap"));
    let pieces: [(u64, &[u8]); 4] = [
        (0, b"set speed=1cm/s\n\n"),
        (250, b"  set strategy = meek \r\nkill driver@por"),
        (50, b"ter[1]\n"),
        // The last line needs no end.
        (150, b"stop"),
    ];
    let o = operated(&[&hop, "--trace", &path, "--format", "json"], &pieces);
    assert_eq!((code(&o), stderr(&o).as_str()), (130, ""));
    let d = json(&o);
    assert_eq!((d["outcome"].clone(), d["reason"].clone()), ("aborted".into(), "interrupted".into()));

    let trace = read(&path).expect("a trace");
    let given: Vec<(&Record, Input)> =
        trace.records.iter().filter_map(|r| Input::of(&r.event).map(|i| (r, i))).collect();
    let set = |param: &str, x: f64| Operation::Set { param: param.into(), registers: vec![x] };
    let wanted = [
        ("set speed=1cm/s", set("speed", 0.01)),
        ("set strategy = meek", set("strategy", 1.0)),
        ("kill driver@porter[1]", Operation::Kill { agent: "driver@porter[1]".into() }),
        ("stop", Operation::Stop),
    ]
    .map(|(text, operation)| Input { text: text.into(), operation });
    assert_eq!(given.iter().map(|g| &g.1).collect::<Vec<_>>(), wanted.iter().collect::<Vec<_>>());
    assert!(given.windows(2).all(|w| w[0].0.t <= w[1].0.t));
    let effects = |n: u64| trace.records.iter().filter(move |r| r.causes.contains(&n));
    let has = |i: usize, kind: fn(&Event) -> bool| effects(given[i].0.n).any(|r| kind(&r.event));
    assert!(has(0, |e| matches!(e, Event::Param { .. })) && has(1, |e| matches!(e, Event::Param { .. })));
    assert!(has(2, |e| matches!(e, Event::Life { .. })));
    assert!(has(3, |e| matches!(e, Event::SafeAction { .. })) && has(3, |e| matches!(e, Event::End { .. })));

    for how in [vec![], vec!["--recorded"]] {
        let mut all = vec!["replay", path.as_str()];
        all.extend(how);
        let o = soifra(&all);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
    }
    assert_eq!(d["trace"]["digest"], digest_of_same(&trace, &in_folder(&dir, "again.mcap")).as_str());
}

#[test]
fn lines_that_are_not_understood_are_told_and_change_nothing() {
    let dir = folder("realtime_bad_input");
    let hop = file(&dir, "hop.soi", HOP);
    let long = "x".repeat(1_000_000);
    let cases: [(&[u8], &[&str]); 16] = [
        (b"dance", &["`dance`", "possible are `kill AGENT@ROBOT`, `set NAME=VALUE` and `stop`"]),
        (b"kil driver@porter[0]", &["did you mean `kill`?"]),
        (b"stop now", &["`stop now`"]),
        (b"kill", &["as `kill driver@porter[0]`"]),
        (b"kill drivr@porter[1]", &["no agent `drivr@porter[1]`; did you mean `driver@porter[1]`?"]),
        (b"kill driver", &["did you mean `driver@porter[0]`?"]),
        (b"kill nobody@nowhere", &["no agent `nobody@nowhere`; one is `driver@porter[0]`"]),
        (b"set", &["`set NAME=VALUE`"]),
        (b"set speed=", &["`set NAME=VALUE`"]),
        (b"set sped=1m/s", &["no parameter `sped`; did you mean `speed`?"]),
        (b"set speed=1s", &["Velocity is wanted", "`set speed=…` takes a number with a unit"]),
        (b"set strategy=bolt", &["did you mean `bold`?"]),
        (b"set speed=1e999 m/s", &["no finite number"]),
        (long.as_bytes(), &["more than 4096 bytes"]),
        (b"\xff\x00\xfe set speed=1m/s", &["not UTF-8"]),
        (b"\x1b[31mred\x00", &["possible are"]),
    ];
    let mut input = Vec::new();
    for (line, _) in &cases {
        input.extend_from_slice(line);
        input.push(b'\n');
    }
    let paced = in_folder(&dir, "paced.mcap");
    let o = operated(&[&hop, "--trace", &paced], &[(0, &input)]);
    let text = stderr(&o);
    assert_eq!(code(&o), 0, "{text}");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), cases.len(), "each is told in a line\n{text}");
    for (line, (_, says)) in lines.iter().zip(&cases) {
        assert!(line.starts_with("warning[S9028]: operator input `"), "{line}");
        assert!(says.iter().all(|s| line.contains(s)), "{line}: {says:?}");
        assert!(!line.chars().any(char::is_control) && line.chars().count() < 500, "{line:?}");
    }
    let free = in_folder(&dir, "free.mcap");
    assert_eq!(code(&soifra(&["run", &hop, "--trace", &free])), 0);
    assert!(std::fs::read(&free).expect("a trace") == std::fs::read(&paced).expect("a trace"));
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_run_that_waits() {
    let dir = folder("realtime_interrupt");
    let slow = HOP.replace("every 50 ms", "every 500 s").replace("period: 50 ms", "period: 400 s");
    let (slow, path) = (file(&dir, "slow.soi", slow), in_folder(&dir, "run.mcap"));
    let mut child = begun(&[&slow, "--trace", &path]);
    // Once its file is there it is about to begin, and then there is nothing to do for minutes.
    for _ in 0..400 {
        if std::fs::metadata(&path).is_ok_and(|m| m.len() > 0) {
            break;
        }
        std::thread::sleep(Duration::from_millis(25));
    }
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().expect("a child").is_none());
    let watch = Stopwatch::start();
    let pid = child.id().to_string();
    let kill = std::process::Command::new("sh").args(["-c", "kill -INT \"$0\"", &pid]).status();
    assert!(kill.expect("a shell").success());
    let o = child.wait_with_output().expect("it ends");
    assert_eq!(code(&o), 130, "{}", stderr(&o));
    assert!(watch.seconds() < 5.0, "it took {} s", watch.seconds());
    let o = soifra(&["replay", &path, "--format", "json"]);
    assert_eq!((code(&o), json(&o)["complete"].clone()), (0, true.into()), "{}", stderr(&o));
}

#[test]
fn a_file_for_the_lateness_that_cannot_be() {
    let dir = folder("realtime_files");
    let hop = file(&dir, "hop.soi", HOP);
    let kept = file(&dir, "kept.mcap", "kept");
    let blocked = format!("{kept}/l.csv");
    for (lateness, trace) in
        [(&hop, "none"), (&kept, kept.as_str()), (&blocked, "none"), (&"/dev/full".to_string(), "none")]
    {
        let o = soifra(&["run", &hop, "--realtime", "--lateness", lateness, "--trace", trace]);
        assert_eq!(code(&o), 2, "{lateness}: {}", stderr(&o));
        assert!(stderr(&o).contains("[S9012]"), "{lateness}: {}", stderr(&o));
    }
    assert_eq!(std::fs::read(&kept).expect("a file"), b"kept");
    assert_eq!(std::fs::read_to_string(&hop).expect("a file"), HOP);
    let o = soifra(&["run", &hop, "--lateness", &in_folder(&dir, "l.csv")]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("--realtime"), "{}", stderr(&o));
}
