//! The time to check a file: of 100,000 lines to one of 10,000, and of all checks to the pest parse of the
//! same text.
//!
//! The text is a block of a hundred lines many times over, with other names each time: an agent of every kind
//! of unit, functions, a topic, and its robot and goal in the one mission.

mod support;

use soifra_lang::{CheckOptions, parse};
use std::fmt::Write;

const LINES: [usize; 2] = [10_000, 100_000];

/// A file of `lines` lines that has no mistake.
fn text(lines: usize) -> String {
    let block = support::read("benches/block.soi.in");
    let head = support::read("benches/field.soi.in");
    // A block has its lines, and two in the mission.
    let blocks = (lines - head.lines().count()) / (block.lines().count() + 2);
    let (mut units, mut robots) = (String::new(), String::new());
    let columns = (blocks as f64).sqrt().ceil() as usize;
    for i in 0..blocks {
        units += &block.replace('@', &i.to_string());
        let (x, y) = (i % columns, i / columns);
        let _ = writeln!(
            robots,
            "  robot r{i}: rover at ({x} m, {y} m) to ({x}.5 m, {y} m) runs pilot{i}(rank: {i})\n  \
             goal g{i} {{ subgoal s{i} by pilot{i} achieved when arrived }}"
        );
    }
    let mut text = head.replace("// the blocks\n", &units).replace("  // the robots\n", &robots);
    while text.lines().count() < lines {
        text += "// The rest.\n";
    }
    text
}

/// Checks a text as `soifra check` does; what it finds is wrong with the bench.
fn check(text: &str) {
    let checked = soifra_lang::check("many.soi", text, &mut soifra::files::Loader, &CheckOptions::default());
    if let Some(d) = checked.diagnostics.first() {
        panic!("{d:?}");
    }
    assert!(checked.graph.is_some());
}

fn main() {
    let mut criterion = support::criterion();
    let [few, many] = LINES.map(text);
    let checked = |text: &str| support::seconds(|| check(text));
    let parsed = |text: &str| support::seconds(|| assert!(parse::recognise(text)));
    for (text, lines) in [&few, &many].iter().zip(LINES) {
        let mut group = criterion.benchmark_group(format!("check, {lines} lines"));
        support::add(&mut group, "all checks", || checked(text));
        support::add(&mut group, "pest parse", || parsed(text));
        group.finish();
    }
    if !support::trying() {
        let ratio = support::ratio(7, || checked(&many), || checked(&few));
        support::verdict("check_lines", "time for 100,000 lines to that for 10,000", ratio, Some(12.0));
        let ratio = support::ratio(15, || checked(&few), || parsed(&few));
        let what = "time to parse and check a text to that of the pest parse";
        support::verdict("check_parse", &format!("{what}, 10,000 lines"), ratio, Some(3.0));
        let ratio = support::ratio(7, || checked(&many), || parsed(&many));
        support::verdict("check_parse_many", &format!("{what}, 100,000 lines"), ratio, Some(3.0));
    }
    criterion.final_summary();
}
