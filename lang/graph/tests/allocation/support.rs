//! Random problems, and the answers that trying everything gives.

use proptest::prelude::*;
use soifra_graph::allocation::*;
use std::collections::BTreeSet;

/// How many random problems each property is tried on.
pub const CASES: u32 = 3000;

/// An agent that serves one task at most.
pub const EXCLUSIVE: Agent = Agent { collaborative: false, available: true };

/// A task of one way for each list of needs.
pub fn task(ways: &[&[&[u32]]]) -> Task {
    let need = |candidates: &&[u32]| Need { candidates: candidates.to_vec() };
    let way = |(label, needs): (u32, &&[&[u32]])| Way { label, needs: needs.iter().map(need).collect() };
    Task { ways: (10..).zip(ways).map(way).collect() }
}

/// Exclusive agents that are all available, and tasks.
pub fn problem(agents: usize, tasks: Vec<Task>) -> Problem {
    Problem { agents: vec![EXCLUSIVE; agents], tasks }
}

fn agent() -> impl Strategy<Value = Agent> {
    let (collaborative, available) = (prop::bool::weighted(0.15), prop::bool::weighted(0.85));
    (collaborative, available).prop_map(|(collaborative, available)| Agent { collaborative, available })
}

fn need() -> impl Strategy<Value = Need> {
    // Agent 5 is never there.
    prop::collection::vec(prop_oneof![20 => 0..5u32, 1 => Just(5u32)], 0..=4)
        .prop_map(|candidates| Need { candidates })
}

/// Any task.
pub fn any_task() -> impl Strategy<Value = Task> {
    let needs = prop::collection::vec(need(), 0..=3);
    let way = (any::<u32>(), needs).prop_map(|(label, needs)| Way { label, needs });
    prop::collection::vec(way, 0..=3).prop_map(|ways| Task { ways })
}

/// A task for which one agent is enough in each way.
fn easy_task(ways: usize) -> impl Strategy<Value = Task> {
    let way = (any::<u32>(), need()).prop_map(|(label, need)| Way { label, needs: vec![need] });
    prop::collection::vec(way, 1..=ways).prop_map(|ways| Task { ways })
}

/// A task with more needs than agents for them.
fn tight_task() -> impl Strategy<Value = Task> {
    let need = prop::collection::vec(0..5u32, 1..=3).prop_map(|candidates| Need { candidates });
    let way =
        (any::<u32>(), prop::collection::vec(need, 1..=3)).prop_map(|(label, needs)| Way { label, needs });
    prop::collection::vec(way, 1..=3).prop_map(|ways| Task { ways })
}

fn of<S: Strategy<Value = Task>>(task: S) -> impl Strategy<Value = Problem> {
    (prop::collection::vec(agent(), 0..=5), prop::collection::vec(task, 0..=5))
        .prop_map(|(agents, tasks)| Problem { agents, tasks })
}

/// Any problem of at most 5 agents and 5 tasks.
pub fn any_problem() -> impl Strategy<Value = Problem> {
    let exclusive = of(tight_task()).prop_map(|mut problem| {
        problem.agents.resize(5, EXCLUSIVE);
        problem
    });
    prop_oneof![of(any_task()), of(tight_task()), exclusive, of(easy_task(3))]
}

/// Eight tasks that take about as many agents as there are, so that a search has to go back often.
fn crowded_problem() -> impl Strategy<Value = Problem> {
    let need = prop::collection::vec(0..12u32, 2).prop_map(|candidates| Need { candidates });
    let way = prop::collection::vec(need, 2).prop_map(|needs| Way { label: 0, needs });
    let task = prop::collection::vec(way, 1..=3).prop_map(|ways| Task { ways });
    prop::collection::vec(task, 8).prop_map(|tasks| problem(12, tasks))
}

/// Any of these.
pub fn any_or_crowded() -> impl Strategy<Value = Problem> {
    prop_oneof![3 => any_problem(), 1 => crowded_problem()]
}

/// A problem in which one agent is enough for each task.
pub fn easy_problem(ways: usize) -> impl Strategy<Value = Problem> {
    of(easy_task(ways))
}

/// All ways to serve a task: the choice, and the exclusive agents that it takes, as bits.
pub fn choices(problem: &Problem, task: u32) -> Vec<(Choice, u32)> {
    let mut all = Vec::new();
    for (number, way) in (0..).zip(&problem.tasks[task as usize].ways) {
        let mut picks = vec![(Vec::new(), 0)];
        for need in &way.needs {
            let mut longer = Vec::new();
            for (agents, bits) in &picks {
                for a in need.candidates.iter().copied() {
                    let Some(agent) = problem.agents.get(a as usize).filter(|a| a.available) else {
                        continue;
                    };
                    let bit = if agent.collaborative { 0 } else { 1 << a };
                    longer.push(([agents.as_slice(), &[a]].concat(), bits | bit));
                }
            }
            picks = longer;
        }
        let choice = |agents| Choice { way: number, label: way.label, agents };
        all.extend(picks.into_iter().map(|(agents, bits)| (choice(agents), bits)));
    }
    all
}

/// Whether these tasks can be served together.
pub fn can_serve(problem: &Problem, tasks: &BTreeSet<u32>) -> bool {
    fn from(sets: &[BTreeSet<u32>], taken: u32) -> bool {
        let Some((first, rest)) = sets.split_first() else { return true };
        first.iter().any(|bits| bits & taken == 0 && from(rest, taken | bits))
    }
    let bits = |task: &u32| choices(problem, *task).into_iter().map(|(_, bits)| bits).collect();
    from(&tasks.iter().map(bits).collect::<Vec<_>>(), 0)
}

/// The tasks that are served.
pub fn served(outcomes: &[Outcome]) -> BTreeSet<u32> {
    (0..).zip(outcomes).filter(|(_, o)| o.choice().is_some()).map(|(task, _)| task).collect()
}

/// These tasks and another.
pub fn with(tasks: &BTreeSet<u32>, task: u32) -> BTreeSet<u32> {
    tasks.iter().copied().chain([task]).collect()
}

/// These tasks but one.
pub fn without(tasks: &BTreeSet<u32>, task: u32) -> BTreeSet<u32> {
    tasks.iter().copied().filter(|t| *t != task).collect()
}

/// A solved problem.
pub fn solved(problem: &Problem) -> Matcher {
    let mut matcher = Matcher::new(problem.clone());
    matcher.solve();
    matcher
}

/// What must hold of a refusal, whatever happened before; and that it names nobody needlessly if it is new.
pub fn judge_refusal(
    problem: &Problem,
    task: u32,
    refusal: &Refusal,
    is_new: bool,
) -> Result<(), TestCaseError> {
    let ways = &problem.tasks[task as usize].ways;
    let exists = |a: &u32| (*a as usize) < problem.agents.len();
    let lacks =
        |way: &Way| (0u32..).zip(&way.needs).find(|(_, n)| !n.candidates.iter().any(exists)).map(|x| x.0);
    let lacking: Option<Vec<u32>> = ways.iter().map(lacks).collect();
    match refusal {
        Refusal::NoPlan => prop_assert!(ways.is_empty()),
        Refusal::NoCapable { needs } => {
            prop_assert!(!ways.is_empty());
            prop_assert_eq!(Some(needs), lacking.as_ref());
        }
        Refusal::NotAvailable { tasks, agents, unavailable } => {
            prop_assert!(!ways.is_empty() && lacking.is_none());
            let set: BTreeSet<u32> = tasks.iter().copied().collect();
            prop_assert!(set.contains(&task) && set.len() == tasks.len());
            prop_assert!(!can_serve(problem, &set), "no conflict");
            for other in &set {
                prop_assert!(!is_new || can_serve(problem, &without(&set, *other)), "{} is needless", other);
            }
            let mut generous = problem.clone();
            for (number, agent) in (0..).zip(&mut generous.agents) {
                if agents.contains(&number) {
                    prop_assert!(agent.available && !agent.collaborative);
                } else {
                    agent.collaborative = true;
                }
            }
            prop_assert!(!can_serve(&generous, &set), "it is not these agents");
            if set.iter().all(|t| problem.tasks[*t as usize].ways.iter().all(|w| w.needs.len() == 1)) {
                prop_assert_eq!(agents.len() + 1, tasks.len());
            }
            let mut returned = problem.clone();
            for agent in unavailable {
                prop_assert!(!problem.agents[*agent as usize].available);
            }
            for (number, agent) in (0..).zip(&mut returned.agents) {
                agent.available |= !unavailable.contains(&number);
            }
            prop_assert!(!can_serve(&returned, &set), "the return of another agent would help");
        }
    }
    Ok(())
}
