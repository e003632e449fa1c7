//! What an allocation costs, in candidates and tasks looked at: no clock.

use crate::support::*;
use soifra_graph::allocation::*;

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
}

/// Tasks with 10 candidates each, one of which makes it certain that all can be served.
fn sparse(tasks: u32, agents: u32) -> Problem {
    let mut draws = Draws(1);
    let sure = draws.shuffled(agents);
    let mut one = |sure: &u32| {
        let mut candidates: Vec<u32> = (0..9).map(|_| draws.below(agents)).collect();
        candidates.push(*sure);
        task(&[&[&candidates]])
    };
    let tasks = sure.iter().take(tasks as usize).map(&mut one).collect();
    problem(agents as usize, tasks)
}

/// Tasks for which every agent is a candidate, in the same order for each.
fn dense(tasks: u32, agents: u32) -> Problem {
    let all: Vec<u32> = (0..agents).collect();
    problem(agents as usize, vec![task(&[&[&all]]); tasks as usize])
}

/// The same in another order for each.
fn shuffled(tasks: u32, agents: u32) -> Problem {
    let mut draws = Draws(2);
    let tasks = (0..tasks).map(|_| task(&[&[&draws.shuffled(agents)]])).collect();
    problem(agents as usize, tasks)
}

/// Tasks of two ways with two needs of five candidates each.
fn general(tasks: u32, agents: u32) -> Problem {
    let mut draws = Draws(3);
    let mut need = || Need { candidates: (0..5).map(|_| draws.below(agents)).collect() };
    let mut way = |label| Way { label, needs: vec![need(), need()] };
    let tasks = (0..tasks).map(|_| Task { ways: vec![way(0), way(1)] }).collect();
    problem(agents as usize, tasks)
}

fn steps(problem: &Problem) -> u64 {
    let mut matcher = Matcher::new(problem.clone());
    let changes = matcher.solve();
    assert_eq!(served(matcher.outcomes()).len(), problem.tasks.len());
    assert_eq!(check(problem, matcher.outcomes()), Ok(()));
    changes.steps
}

#[test]
fn ten_times_as_many_cost_at_most_two_hundred_times_as_much() {
    for make in [sparse, dense, shuffled] {
        let (small, large) = (steps(&make(100, 100)), steps(&make(1000, 1000)));
        assert!(large <= 200 * small, "{large} steps, {small} for a tenth");
    }
    let (small, large) = (steps(&general(100, 250)), steps(&general(1000, 2500)));
    assert!(large <= 200 * small, "{large} steps, {small} for a tenth");
}

#[test]
fn a_failure_touches_a_handful() {
    for (make, handful) in [(sparse as fn(u32, u32) -> Problem, 8), (dense, 1), (shuffled, 1)] {
        let problem = make(900, 1000);
        let mut matcher = solved(&problem);
        let (mut looked_at, mut changed) = (0, 0);
        for agent in 0..1000 {
            let serves =
                matcher.outcomes().iter().filter_map(Outcome::choice).any(|c| c.agents.contains(&agent));
            let changes = matcher.agent_lost(agent);
            assert_eq!(changes.tasks.is_empty(), !serves);
            assert_eq!(served(matcher.outcomes()).len(), 900);
            looked_at += changes.looked_at;
            changed = changed.max(changes.tasks.len());
            assert_eq!(matcher.agent_returned(agent), Changes::default());
        }
        assert!(changed <= handful, "{changed} tasks changed");
        assert!(looked_at <= handful * 1000, "{looked_at} tasks looked at");
    }
}

#[test]
fn the_same_refusal_is_not_proved_again() {
    let mut matcher = Matcher::new(dense(1000, 900));
    let changes = matcher.solve();
    assert!(changes.steps < 4_000_000, "{} steps", changes.steps);
    let Outcome::Refused(Refusal::NotAvailable { tasks, agents, unavailable }) = matcher.outcome(999) else {
        panic!("{:?}", matcher.outcome(999));
    };
    assert_eq!((tasks.len(), agents.len(), unavailable.len()), (901, 900, 0));
    assert_eq!((tasks[899], tasks[900]), (899, 999));
}

/// Tasks that need two agents each, twice as many as there are agents for, in two ways: hard.
fn hard() -> Problem {
    let mut draws = Draws(4);
    let mut need = || Need { candidates: vec![draws.below(60), draws.below(60)] };
    let mut way = |label| Way { label, needs: vec![need(), need()] };
    let tasks = (0..60).map(|_| Task { ways: vec![way(0), way(1)] }).collect();
    problem(60, tasks)
}

#[test]
fn the_limit_is_for_one_component() {
    let mut both = hard();
    both.agents.resize(160, EXCLUSIVE);
    let easy = sparse(100, 100);
    for mut task in easy.tasks {
        task.ways[0].needs[0].candidates.iter_mut().for_each(|agent| *agent += 60);
        both.tasks.push(task);
    }
    let mut matcher = Matcher::with_limit(both.clone(), 10_000);
    let changes = matcher.solve();
    assert_eq!(check(&both, matcher.outcomes()), Ok(()));
    let undecided: Vec<usize> =
        (0..160).filter(|task| matcher.outcomes()[*task] == Outcome::Undecided).collect();
    assert!(!undecided.is_empty() && undecided.iter().all(|task| *task < 60), "{undecided:?}");
    assert!(served(matcher.outcomes()).range(60..).count() == 100);
    assert!(changes.steps < 1_000_000, "{} steps", changes.steps);
    // They are tried again when somebody is free.
    let tried = matcher.task_removed(*served(matcher.outcomes()).first().unwrap());
    assert!(tried.looked_at >= undecided.len());
    assert_eq!(check(matcher.problem(), matcher.outcomes()), Ok(()));
}

#[test]
fn more_needs_than_can_be_grouped_are_undecided_at_worst() {
    // Neighbouring needs have an agent in common, so that half the agents would do; but nobody looks at that.
    let needs: Vec<[u32; 2]> = (0..3000).map(|i| [i, i + 1]).collect();
    let needs: Vec<&[u32]> = needs.iter().map(|n| &n[..]).collect();
    let others = [0, 3000, 2].map(|agent| task(&[&[&[agent]]]));
    let matcher = solved(&problem(3001, [vec![task(&[&needs])], others.to_vec()].concat()));
    assert_eq!(check(matcher.problem(), matcher.outcomes()), Ok(()));
    assert_eq!(served(matcher.outcomes()), [0, 1, 2].into());
    assert_eq!(matcher.outcome(3), &Outcome::Undecided);
}
