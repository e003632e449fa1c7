//! The planner-matcher: 1,000 agents and 1,000 sub-goals against 100 and 100, and a repair against solving
//! anew. A hundred times as many pairs of them, so twice that much time at most.
//!
//! Several kinds of problem; the worst of them is what counts.
#![expect(clippy::print_stdout, reason = "a bench tells its figures on the terminal")]

mod support;

use soifra_graph::allocation::{Agent, Matcher, Need, Outcome, Problem, Task, Way, check};
use support::seconds;

/// Agents and sub-goals.
const FEW: u32 = 100;
const MANY: u32 = 1_000;

/// A small generator, so that the problems are the same everywhere.
struct Draws(u64);

impl Draws {
    fn below(&mut self, n: u32) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % u64::from(n)) as u32
    }

    fn shuffled(&mut self, n: u32) -> Vec<u32> {
        let mut all: Vec<u32> = (0..n).collect();
        for i in (1..n).rev() {
            all.swap(i as usize, self.below(i + 1) as usize);
        }
        all
    }

    /// Some agents; it may name one twice.
    fn need(&mut self, candidates: u32, agents: u32) -> Need {
        Need { candidates: (0..candidates).map(|_| self.below(agents)).collect() }
    }
}

/// A kind of problem.
struct Kind {
    name: &'static str,
    make: fn(u32) -> Problem,
    /// Whether every sub-goal can be served.
    all: bool,
    /// Pairs of solutions that are compared, and agents that are lost in turn: fewer where each takes long.
    pairs: usize,
    losses: u32,
}

impl Kind {
    const fn new(name: &'static str, make: fn(u32) -> Problem, all: bool) -> Kind {
        Kind { name, make, all, pairs: 15, losses: 50 }
    }
}

const KINDS: [Kind; 6] = [
    Kind::new("all for all", all_for_all, true),
    Kind::new("all for all, each in its order", own_order, true),
    Kind::new("ten for each", ten_for_each, true),
    Kind::new("two for each", two_for_each, false),
    Kind::new("pairs", pairs, true),
    Kind { pairs: 3, losses: 1, ..Kind::new("pairs, too many", too_many_pairs, false) },
];

fn exclusive(agents: u32, tasks: Vec<Task>) -> Problem {
    Problem { agents: vec![Agent { collaborative: false, available: true }; agents as usize], tasks }
}

/// A sub-goal for which one agent is enough.
fn simple(candidates: Vec<u32>) -> Task {
    Task { ways: vec![Way { label: 0, needs: vec![Need { candidates }] }] }
}

/// Every agent can serve every sub-goal, and all prefer the same one.
fn all_for_all(n: u32) -> Problem {
    exclusive(n, vec![simple((0..n).collect()); n as usize])
}

/// Every agent can serve every sub-goal, and each sub-goal has an order of its own.
fn own_order(n: u32) -> Problem {
    let mut draws = Draws(2);
    exclusive(n, (0..n).map(|_| simple(draws.shuffled(n))).collect())
}

/// Ten agents can serve a sub-goal, one of which makes it certain that all are served: as tight as can be.
fn ten_for_each(n: u32) -> Problem {
    let mut draws = Draws(1);
    let sure = draws.shuffled(n);
    let mut one = |sure: &u32| {
        let mut candidates = draws.need(9, n).candidates;
        candidates.push(*sure);
        simple(candidates)
    };
    exclusive(n, sure.iter().map(&mut one).collect())
}

/// Two agents can serve a sub-goal: some are left without, and are told why.
fn two_for_each(n: u32) -> Problem {
    let mut draws = Draws(5);
    exclusive(n, (0..n).map(|_| simple(draws.need(2, n).candidates)).collect())
}

/// Two ways with two needs of five candidates each; every fourth agent is collaborative.
fn pairs(n: u32) -> Problem {
    let mut problem = too_many_pairs(n);
    for agent in problem.agents.iter_mut().step_by(4) {
        agent.collaborative = true;
    }
    problem
}

/// The same where every agent is exclusive: twice as many needs as agents. Which sub-goals must go without is
/// so hard that the search gives up at its limit about many of them; that is told, too.
fn too_many_pairs(n: u32) -> Problem {
    let mut draws = Draws(3);
    let mut way = |label| Way { label, needs: vec![draws.need(5, n), draws.need(5, n)] };
    exclusive(n, (0..n).map(|_| Task { ways: vec![way(0), way(1)] }).collect())
}

/// Seconds to solve a problem from nothing, and how it stands then.
fn solve(problem: &Problem) -> (f64, Matcher) {
    let mut matcher = Matcher::new(problem.clone());
    let time = seconds(|| matcher.solve());
    (time, matcher)
}

/// Seconds to solve it, in the mean of so many times.
fn mean(problem: &Problem, times: u32) -> f64 {
    (0..times).map(|_| solve(problem).0).sum::<f64>() / f64::from(times)
}

/// Seconds for the repair after the loss of an agent that serves, in the mean of agents from all over; each
/// returns before the next is lost.
fn repair(problem: &Problem, losses: u32) -> f64 {
    let mut matcher = solve(problem).1;
    let (mut time, mut lost) = (0.0, 0);
    for agent in (0..losses).map(|i| i * MANY / losses) {
        if matcher.outcomes().iter().filter_map(Outcome::choice).any(|c| c.agents.contains(&agent)) {
            time += seconds(|| matcher.agent_lost(agent));
            lost += 1;
            matcher.agent_returned(agent);
        }
    }
    time / f64::from(lost)
}

/// What came out must be an allocation, complete where that is possible; tells how many are undecided.
fn judged(kind: &Kind, problem: &Problem) -> usize {
    let matcher = solve(problem).1;
    assert_eq!(check(problem, matcher.outcomes()), Ok(()), "{}", kind.name);
    let count = |is_meant: fn(&Outcome) -> bool| matcher.outcomes().iter().filter(|o| is_meant(o)).count();
    let served = count(|o| o.choice().is_some());
    assert!(!kind.all || served == problem.tasks.len(), "{}: {served} served", kind.name);
    count(|o| *o == Outcome::Undecided)
}

fn main() {
    let mut criterion = support::criterion();
    let mut group = criterion.benchmark_group("matcher");
    let (mut ratios, mut repairs) = (Vec::new(), Vec::new());
    for kind in &KINDS {
        let [few, many] = [FEW, MANY].map(kind.make);
        let name = kind.name;
        support::add(&mut group, &format!("{name}, 100 x 100"), || solve(&few).0);
        support::add(&mut group, &format!("{name}, 1,000 x 1,000"), || solve(&many).0);
        if support::trying() {
            continue;
        }
        let undecided = judged(kind, &many);
        // The small problem is solved so often that both take about as long.
        let times = if kind.pairs < 10 { 1 } else { 30 };
        let ratio = support::ratio(kind.pairs, || solve(&many).0, || mean(&few, times));
        let repaired = support::ratio(kind.pairs, || repair(&many, kind.losses), || solve(&many).0);
        println!("{name}: {ratio:.1}, {undecided} undecided; a repair {repaired:.4} of solving it");
        ratios.push((ratio, name));
        repairs.push((repaired, name));
    }
    group.finish();
    if !support::trying() {
        let worst = |all: Vec<(f64, &'static str)>| all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (ratio, name) = worst(ratios).expect("a kind");
        let what = format!("time for 1,000 agents and sub-goals to that for 100, at worst ({name})");
        support::verdict("matcher_scale", &what, ratio, Some(200.0));
        let (ratio, name) = worst(repairs).expect("a kind");
        let what = format!("time for a repair to that for solving 1,000 x 1,000, at worst ({name})");
        support::verdict("matcher_repair", &what, ratio, None);
    }
    criterion.final_summary();
}
