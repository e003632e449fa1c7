//! Every kind of plan node, for every status of its children.

use soifra_runtime::{
    Time,
    nodes::{self, Act, Code, Ended, Host, Kind, Memory, Part, Status, Tree},
};

/// Leaves follow a script: each tick of leaf `n` takes the next letter: `s`uccess, `f`ailure, `r`unning.
/// Code 2n asks whether it succeeds, 2n + 1 whether it fails.
struct Script {
    leaves: Vec<Vec<char>>,
    now: i64,
    log: Vec<String>,
}

impl Host for Script {
    type Fault = ();
    fn now(&self) -> Time {
        Time(self.now)
    }
    fn holds(&mut self, code: Code) -> Result<bool, ()> {
        if code >= 100 {
            return Ok(self.now < i64::from(code));
        }
        let leaf = &mut self.leaves[code as usize / 2];
        match (leaf.first().copied().expect("the script is long enough"), code % 2) {
            ('s', 0) | ('f', 1) => {
                leaf.remove(0);
                Ok(true)
            }
            ('r', 1) => {
                leaf.remove(0);
                Ok(false)
            }
            _ => Ok(false),
        }
    }
    fn duration(&mut self, code: Code) -> Result<Time, ()> {
        Ok(Time(i64::from(code)))
    }
    fn run(&mut self, code: Code) -> Result<(), ()> {
        self.log.push(format!("run {code}"));
        Ok(())
    }
    fn ended(&mut self, node: u32, how: Ended) {
        self.log.push(match how {
            Ended::Halted => format!("{node} halted"),
            Ended::With(s) => format!("{node} {s:?}"),
        });
    }
}

fn leaf(n: u32) -> Part {
    Part::Act(Act { until: Some(2 * n), fails: Some(2 * n + 1), halt: Some(50 + n), ..Act::default() })
}

/// Ticks a tree of `kind` over scripted leaves, at instants 0, 10, 20 …; returns a letter a tick.
fn ticks(kind: Kind, leaves: &[&str], count: usize) -> (String, Vec<String>) {
    let children: Vec<u32> = (1..=leaves.len() as u32).collect();
    let mut parts: Vec<(Part, &[u32])> = vec![(Part::Kind(kind), &children)];
    parts.extend((0..leaves.len() as u32).map(|n| (leaf(n), &[][..])));
    let tree = Tree::new(&parts).unwrap();
    let mut script =
        Script { leaves: leaves.iter().map(|l| l.chars().collect()).collect(), now: 0, log: Vec::new() };
    let (mut status, mut slot) = (vec![0; tree.len()], vec![0; tree.len()]);
    let mut out = String::new();
    for _ in 0..count {
        let memory = Memory { status: &mut status, slot: &mut slot };
        out.push(match nodes::tick(&tree, memory, &mut script).unwrap() {
            Status::Success => 's',
            Status::Failure => 'f',
            Status::Running => 'r',
            Status::Idle => 'i',
        });
        script.now += 10;
    }
    let halts = script.log.into_iter().filter(|l| l.starts_with("run")).collect();
    (out, halts)
}

fn results(kind: Kind, leaves: &[&str], count: usize) -> String {
    ticks(kind, leaves, count).0
}

#[test]
fn sequence_for_every_child_status() {
    for memory in [false, true] {
        let k = Kind::Sequence { memory };
        assert_eq!(results(k, &["s", "s"], 1), "s");
        assert_eq!(results(k, &["s", "f"], 1), "f");
        assert_eq!(results(k, &["s", "r"], 1), "r");
        assert_eq!(results(k, &["f", ""], 1), "f");
        assert_eq!(results(k, &["r", ""], 1), "r");
    }
    // With memory the first child is not asked again; reactive it is, and halts the second.
    assert_eq!(ticks(Kind::Sequence { memory: true }, &["s", "rs"], 2), ("rs".into(), vec![]));
    assert_eq!(ticks(Kind::Sequence { memory: false }, &["ss", "rs"], 2), ("rs".into(), vec![]));
    let (out, halts) = ticks(Kind::Sequence { memory: false }, &["sf", "r"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rf", &["run 51".to_string()][..]));
    let (out, halts) = ticks(Kind::Sequence { memory: false }, &["sr", "r"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rr", &["run 51".to_string()][..]));
    // Ended, it starts again at the first child.
    assert_eq!(results(Kind::Sequence { memory: true }, &["sss", "rfs"], 3), "rfs");
}

#[test]
fn fallback_for_every_child_status() {
    for memory in [false, true] {
        let k = Kind::Fallback { memory };
        assert_eq!(results(k, &["s", ""], 1), "s");
        assert_eq!(results(k, &["f", "s"], 1), "s");
        assert_eq!(results(k, &["f", "f"], 1), "f");
        assert_eq!(results(k, &["f", "r"], 1), "r");
        assert_eq!(results(k, &["r", ""], 1), "r");
    }
    assert_eq!(ticks(Kind::Fallback { memory: true }, &["f", "rf"], 2), ("rf".into(), vec![]));
    let (out, halts) = ticks(Kind::Fallback { memory: false }, &["fs", "r"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rs", &["run 51".to_string()][..]));
    let (out, halts) = ticks(Kind::Fallback { memory: false }, &["fr", "r"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rr", &["run 51".to_string()][..]));
}

#[test]
fn parallel_for_every_child_status() {
    let k = |successes| Kind::Parallel { successes };
    assert_eq!(results(k(2), &["s", "s"], 1), "s");
    assert_eq!(results(k(2), &["s", "f"], 1), "f");
    assert_eq!(results(k(1), &["f", "f"], 1), "f");
    assert_eq!(results(k(1), &["f", "s"], 1), "s");
    // A child that has ended is not ticked again before the parallel has.
    assert_eq!(results(k(2), &["s", "rrs"], 3), "rrs");
    assert_eq!(results(k(2), &["ss", "rsrs"], 4), "rsrs");
    // Enough is enough: the rest is halted.
    let (out, halts) = ticks(k(1), &["rs", "rr"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rs", &["run 51".to_string()][..]));
    let (out, halts) = ticks(k(2), &["rf", "rr"], 2);
    assert_eq!((out.as_str(), halts.as_slice()), ("rf", &["run 51".to_string()][..]));
}

#[test]
fn decorators_for_every_child_status() {
    assert_eq!(results(Kind::Invert, &["srf"], 3), "frs");
    assert_eq!(results(Kind::Succeed, &["srf"], 3), "srs");
    // Two more attempts, each at a tick of its own.
    assert_eq!(results(Kind::Retry(2), &["ffff"], 4), "rrfr");
    assert_eq!(results(Kind::Retry(2), &["frfs"], 4), "rrrs");
    assert_eq!(results(Kind::Retry(0), &["f"], 1), "f");
    let repeat = |times, condition| Kind::Repeat { times, condition };
    assert_eq!(results(repeat(Some(2), None), &["rsrs"], 4), "rrrs");
    assert_eq!(results(repeat(Some(2), None), &["sf"], 2), "rf");
    assert_eq!(results(repeat(Some(0), None), &[""], 1), "s");
    // The condition holds before instant 25 here: it is not tested within a round.
    assert_eq!(results(repeat(None, Some(25 + 75)), &["ssssssssss"], 11), "rrrrrrrrrrs");
    assert_eq!(results(repeat(None, None), &["sss"], 3), "rrr");
    // Starts at 0 and may run until 25.
    assert_eq!(results(Kind::Timeout(25), &["rrrr"], 4), "rrrf");
    assert_eq!(ticks(Kind::Timeout(25), &["rrr"], 4).1, ["run 50"]);
    assert_eq!(results(Kind::Timeout(20), &["rrs"], 3), "rrs");
    assert_eq!(results(Kind::Timeout(20), &["fs"], 2), "fs");
}

/// A single leaf at instants 0, 10, 20 ….
fn alone(part: Part, count: usize) -> String {
    let tree = Tree::new(&[(part, &[])]).unwrap();
    let mut script = Script { leaves: vec![], now: 0, log: Vec::new() };
    let (mut status, mut slot) = ([0], [0]);
    (0..count)
        .map(|_| {
            let memory = Memory { status: &mut status, slot: &mut slot };
            let result = nodes::tick(&tree, memory, &mut script).unwrap();
            script.now += 10;
            match result {
                Status::Success => 's',
                Status::Failure => 'f',
                _ => 'r',
            }
        })
        .collect()
}

#[test]
fn leaves() {
    // Codes above 100 hold before that instant.
    let script = |k| alone(Part::Kind(k), 12);
    assert_eq!(script(Kind::Check(105)), "sssssssssssf");
    assert_eq!(script(Kind::WaitUntil(105)), "sssssssssssr");
    assert_eq!(alone(Part::Kind(Kind::Wait(25)), 5), "rrrsr");
    assert_eq!(alone(Part::Kind(Kind::Wait(0)), 2), "ss");
    assert_eq!(alone(Part::Act(Act { body: Some(1), ..Act::default() }), 2), "ss");
}

#[test]
fn what_is_no_tree_is_refused() {
    let seq = Part::Kind(Kind::Sequence { memory: true });
    let wait = Part::Kind(Kind::Wait(0));
    assert!(Tree::new(&[]).is_err());
    assert!(Tree::new(&[(seq, &[])]).is_err());
    assert!(Tree::new(&[(seq, &[1]), (wait, &[0])]).is_err());
    assert!(Tree::new(&[(seq, &[1, 1]), (wait, &[])]).is_err());
    assert!(Tree::new(&[(seq, &[7]), (wait, &[])]).is_err());
    assert!(Tree::new(&[(wait, &[]), (wait, &[])]).is_err());
    assert!(Tree::new(&[(Part::Kind(Kind::Act(3)), &[])]).is_err());
    let deep: Vec<[u32; 1]> = (1..2000).map(|i| [i]).collect();
    let mut parts: Vec<(Part, &[u32])> = deep.iter().map(|c| (Part::Kind(Kind::Invert), &c[..])).collect();
    parts.push((wait, &[]));
    assert!(Tree::new(&parts).is_err());
}
