//! The cost of a ticked node: trees of 1,000 leaves, ticked by the engine from a mission, and by bonsai-bt.
//!
//! Every leaf compares a number with a constant; a tick asks all of them, for the last one goes on running.
//! Flat: all leaves under one reactive sequence. Deep: three levels of ten.

mod support;

use bonsai_bt::{ActionArgs, BT, Behavior, Event, Status, UpdateArgs};
use support::{Compiled, seconds};

const LEAVES: usize = 1_000;

/// Ticks of a run: its 5 s, with the instant at which it ends.
const TICKS: usize = 5_001;

/// Ticked nodes below an inner node in each tree.
const WIDTHS: [(&str, usize); 2] = [("flat", LEAVES), ("deep", 10)];

/// What the leaves read; a leaf reads one after the other.
const NAMES: [&str; 4] = ["a", "b", "c", "d"];

/// Nodes of the tree with `width` children a node.
fn nodes(width: usize) -> usize {
    let (mut level, mut all) = (LEAVES, LEAVES);
    while level > 1 {
        level /= width;
        all += level;
    }
    all
}

/// Leaves `from ..`, `count` of them, as plan nodes.
fn soi(from: usize, count: usize, width: usize) -> String {
    match count {
        1 if from + 1 == LEAVES => "wait until a < 0.5\n".into(),
        1 => format!("check {} > 0.5\n", NAMES[from % NAMES.len()]),
        _ => {
            let part = count / width;
            let children: String = (0..width).map(|i| soi(from + i * part, part, width)).collect();
            format!("reactive sequence {{\n{children}}}\n")
        }
    }
}

/// The same for bonsai.
fn behavior(from: usize, count: usize, width: usize) -> Behavior<usize> {
    if count == 1 {
        return Behavior::Action(from);
    }
    let part = count / width;
    Behavior::MemorylessSequence((0..width).map(|i| behavior(from + i * part, part, width)).collect())
}

/// One tick of bonsai: reads the same numbers.
fn tick(tree: &mut BT<usize, [f64; 4]>) -> Option<(Status, f64)> {
    let event: Event = UpdateArgs { dt: 0.001 }.into();
    tree.tick(&event, &mut |args: ActionArgs<Event, usize>, levels: &mut [f64; 4]| {
        let leaf = *args.action;
        if leaf + 1 == LEAVES {
            let ended = levels[0] < 0.5;
            (if ended { Status::Success } else { Status::Running }, 0.0)
        } else if levels[leaf % NAMES.len()] > 0.5 {
            (Status::Success, args.dt)
        } else {
            (Status::Failure, args.dt)
        }
    })
}

fn main() {
    let mut criterion = support::criterion();
    for (name, width) in WIDTHS {
        let template = support::read("benches/tree.soi.in");
        let text = template.replace("// the tree\n", &soi(0, LEAVES, width));
        let compiled = Compiled::new(&support::scratch(&format!("tree_{name}.soi"), &text), &[]);
        let prepared = compiled.prepared();
        let ticked = (TICKS * nodes(width)) as f64;
        let ours = || {
            let (report, seconds) = support::run(&prepared);
            assert_eq!(report.sim_time_s, 5.0, "{}", report.reason);
            seconds / ticked
        };
        let traced = || support::run_traced(&prepared, "tree.mcap").1 / ticked;
        let mut tree = BT::new(behavior(0, LEAVES, width), [1.0, 2.0, 3.0, 4.0]);
        let mut bonsai = || {
            let run =
                |tree: &mut BT<_, _>| (0..TICKS).all(|_| tick(tree).map(|r| r.0) == Some(Status::Running));
            seconds(|| assert!(run(&mut tree))) / ticked
        };

        let mut group = criterion.benchmark_group(format!("engine, {name} tree, a ticked node"));
        support::add(&mut group, "soifra", ours);
        support::add(&mut group, "soifra with trace", traced);
        support::add(&mut group, "bonsai-bt", &mut bonsai);
        group.finish();
        if !support::trying() {
            let what = "cost of a ticked node to that of bonsai-bt";
            let ratio = support::ratio(15, ours, &mut bonsai);
            support::verdict(&format!("engine_{name}"), what, ratio, Some(1.5));
            let ratio = support::ratio(7, traced, &mut bonsai);
            support::verdict(&format!("engine_{name}_traced"), &format!("{what}, trace on"), ratio, None);
        }
    }
    criterion.final_summary();
}
