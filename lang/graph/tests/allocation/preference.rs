//! Earlier ways and candidates, where that costs nothing.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::allocation::*;

fn rank(problem: &Problem, task: u32, choice: &Choice) -> (u32, Vec<usize>) {
    let way = &problem.tasks[task as usize].ways[choice.way as usize];
    let ranks = way.needs.iter().zip(&choice.agents);
    (choice.way, ranks.map(|(n, a)| n.candidates.iter().position(|c| c == a).unwrap()).collect())
}

/// The exclusive ones among agents, as bits.
fn exclusive(problem: &Problem, agents: &[u32]) -> u32 {
    let is_exclusive = |agent: &&u32| !problem.agents[**agent as usize].collaborative;
    agents.iter().filter(is_exclusive).fold(0, |bits, agent| bits | 1 << agent)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn nobody_could_have_better_without_taking_from_others(problem in any_problem()) {
        let matcher = solved(&problem);
        let bits = |task: u32| match matcher.outcome(task).choice() {
            Some(c) => exclusive(&problem, &c.agents),
            None => 0,
        };
        let tasks = 0..problem.tasks.len() as u32;
        for task in tasks.clone() {
            let Some(choice) = matcher.outcome(task).choice() else { continue };
            let others = tasks.clone().filter(|t| *t != task).fold(0, |b, t| b | bits(t));
            for (other, taken) in choices(&problem, task) {
                prop_assert!(
                    taken & others != 0 || rank(&problem, task, choice) <= rank(&problem, task, &other),
                    "task {} could have {:?}", task, other
                );
            }
        }
    }
}

#[test]
fn the_first_comes_first() {
    let matcher = solved(&problem(3, vec![task(&[&[&[2, 1]]]), task(&[&[&[2, 0]]]), task(&[&[&[0, 1]]])]));
    let agents: Vec<u32> =
        matcher.outcomes().iter().flat_map(|o| o.choice().unwrap().agents.clone()).collect();
    assert_eq!(agents, [2, 0, 1]);
}

#[test]
fn an_earlier_way_is_given_up_for_another_task_only() {
    let both = task(&[&[&[0], &[1]], &[&[2]]]);
    let alone = solved(&problem(3, vec![both.clone()]));
    assert_eq!(alone.outcome(0), &Outcome::Served(Choice { way: 0, label: 10, agents: vec![0, 1] }));
    let two = solved(&problem(3, vec![both, task(&[&[&[1]]])]));
    assert_eq!(two.outcome(0), &Outcome::Served(Choice { way: 1, label: 11, agents: vec![2] }));
}
