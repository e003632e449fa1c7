//! A circle swap against dodgy_2d, and time and memory for many robots. The rules are those of
//! `missions/swarm/traffic.soi`; one thread, as dodgy_2d has.
#![expect(clippy::print_stdout, reason = "a bench tells its figures on the terminal")]

#[path = "support/dodgy.rs"]
mod dodgy;
#[path = "support/memory.rs"]
mod memory;
mod support;

use dodgy::Swap;
use soifra::execute::Prepared;
use soifra_runtime::RunReport;
use support::Compiled;

/// A few robots and many, at the same density: rows and columns of circles of 25.
const COLUMNS: [usize; 2] = [2, 20];
const ROBOTS: [usize; 2] = [100, 10_000];

/// The most memory 10,000 robots may take, in MB.
const MEMORY: f64 = 300.0;

/// Steps of all robots together.
fn robot_steps(report: &RunReport) -> f64 {
    let steps = report.sim_time_s / f64::from(dodgy::STEP);
    steps.round() * report.robots.len() as f64
}

/// A run must end well to count.
fn judged(what: &str, (report, seconds): (RunReport, f64)) -> (RunReport, f64) {
    let arrived = report.robots.iter().filter(|r| r.reached).count();
    assert_eq!(report.outcome.name(), "success", "{what}: {}, {arrived} arrived", report.reason);
    assert_eq!(report.collisions, 0, "{what}");
    (report, seconds)
}

fn circle(criterion: &mut criterion::Criterion) {
    let compiled = Compiled::new(&support::project("missions/swarm/circle_swap.soi"), &[]);
    let prepared = compiled.prepared();
    let (starts, targets) = places(&prepared);
    let (report, _) = judged("circle swap", support::run(&prepared));
    assert!(report.robots.iter().all(|r| r.reached), "not all have arrived");
    let (our_steps, their_steps) = (robot_steps(&report), Swap::new(&starts, &targets).run());
    let all_their_steps = (their_steps * starts.len()) as f64;
    let makespans = (report.sim_time_s, their_steps as f64 * f64::from(dodgy::STEP));

    // Seconds for a step of a robot.
    let ours = || judged("circle swap", support::run(&prepared)).1 / our_steps;
    let traced = || judged("circle swap", support::run_traced(&prepared, "swap.mcap")).1 / our_steps;
    let theirs = || {
        let swap = Swap::new(&starts, &targets);
        support::seconds(|| swap.run()) / all_their_steps
    };
    let mut group = criterion.benchmark_group("swarm, circle of 250, a step of a robot");
    support::add(&mut group, "soifra", ours);
    support::add(&mut group, "soifra with trace", traced);
    support::add(&mut group, "dodgy_2d", theirs);
    group.finish();
    if support::trying() {
        return;
    }
    let what = format!("makespan {} s, that of dodgy_2d {} s", makespans.0, makespans.1);
    support::verdict("swarm_makespan", &what, makespans.0 / makespans.1, Some(2.0));
    let what = "time for a step of a robot to that of dodgy_2d";
    support::verdict("swarm_rate", what, support::ratio(25, ours, theirs), Some(1.0));
    let ratio = support::ratio(5, traced, theirs);
    support::verdict("swarm_rate_traced", &format!("{what}, trace on"), ratio, None);
}

/// Starts and targets of all robots.
fn places(prepared: &Prepared<'_>) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let robots = prepared.scene().robots.iter();
    robots
        .map(|r| {
            let [tx, ty, _] = r.target.unwrap_or_default();
            ([r.start[0], r.start[1]], [tx, ty])
        })
        .unzip()
}

fn many_circles(criterion: &mut criterion::Criterion) {
    let path = support::project("missions/swarm/many_circles.soi");
    let [few, many] = COLUMNS.map(|n| Compiled::new(&path, &[("columns", n.to_string())]));
    let [few, many] = [few.prepared(), many.prepared()];
    assert_eq!([&few, &many].map(|p| p.scene().robots.len()), ROBOTS);
    let cost = |prepared: &Prepared<'_>, run: &dyn Fn(&Prepared<'_>) -> (RunReport, f64)| {
        let (report, seconds) = judged("many circles", run(prepared));
        seconds / robot_steps(&report)
    };
    let plain: &dyn Fn(&Prepared<'_>) -> _ = &|p| support::run(p);
    let traced: &dyn Fn(&Prepared<'_>) -> _ = &|p| support::run_traced(p, "circles.mcap");
    // The small crowd is run so often that both take about as long.
    let small = |run| {
        let times = ROBOTS[1] / ROBOTS[0] / 4;
        (0..times).map(|_| cost(&few, run)).sum::<f64>() / times as f64
    };
    let mut group = criterion.benchmark_group("swarm, many circles, a step of a robot");
    support::add(&mut group, "100 robots", || cost(&few, plain));
    support::add(&mut group, "10,000 robots", || cost(&many, plain));
    group.finish();
    if support::trying() {
        return;
    }
    let what = "time for a step of a robot among 10,000 to that among 100";
    let ratio = support::ratio(5, || cost(&many, plain), || small(plain));
    support::verdict("swarm_scale", what, ratio, Some(2.0));
    let ratio = support::ratio(2, || cost(&many, traced), || small(traced));
    support::verdict("swarm_scale_traced", &format!("{what}, trace on"), ratio, None);

    let columns = format!("columns={}", COLUMNS[1]);
    for (name, trace, bar) in
        [("swarm_memory", "none", Some(1.0)), ("swarm_memory_traced", "circles.mcap", None)]
    {
        let trace = match trace {
            "none" => trace.to_string(),
            file => support::scratch(file, ""),
        };
        let arguments = ["run", &path, "--set", &columns, "--trace", &trace, "--format", "json"];
        match memory::peak(env!("CARGO_BIN_EXE_soifra"), &arguments) {
            Some(mb) => {
                let what = format!("peak memory at 10,000 robots, {mb:.0} MB, to {MEMORY} MB");
                support::verdict(name, &what, mb / MEMORY, bar);
            }
            None => println!("{name}: this system does not tell the peak memory of a process"),
        }
    }
}

fn main() {
    let mut criterion = support::criterion();
    circle(&mut criterion);
    many_circles(&mut criterion);
    criterion.final_summary();
}
