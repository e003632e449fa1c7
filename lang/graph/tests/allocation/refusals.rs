//! Why tasks are refused.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::allocation::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn a_refusal_is_true_and_names_nobody_needlessly(problem in any_or_crowded()) {
        let matcher = solved(&problem);
        for (task, outcome) in (0..).zip(matcher.outcomes()) {
            if let Outcome::Refused(refusal) = outcome {
                judge_refusal(&problem, task, refusal, true)?;
            }
        }
    }

    #[test]
    fn agents_of_a_conflict_are_all_candidates(problem in easy_problem(1)) {
        let matcher = solved(&problem);
        for outcome in matcher.outcomes() {
            let Outcome::Refused(Refusal::NotAvailable { tasks, agents, unavailable }) = outcome else {
                continue;
            };
            let needs = tasks.iter().map(|t| &problem.tasks[*t as usize].ways[0].needs[0]);
            for agent in needs.flat_map(|n| &n.candidates).filter(|a| (**a as usize) < problem.agents.len()) {
                prop_assert!(agents.contains(agent) || unavailable.contains(agent));
            }
        }
    }
}

fn refused(problem: Problem, task: u32) -> Refusal {
    match solved(&problem).outcome(task) {
        Outcome::Refused(refusal) => refusal.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn reasons_come_in_order() {
    assert_eq!(refused(problem(1, vec![task(&[])]), 0), Refusal::NoPlan);
    let incapable = task(&[&[&[0], &[]], &[&[7]]]);
    assert_eq!(refused(problem(1, vec![incapable]), 0), Refusal::NoCapable { needs: vec![1, 0] });
    let mut lost = problem(2, vec![task(&[&[&[0], &[1]]])]);
    lost.agents[1].available = false;
    let nobody = Refusal::NotAvailable { tasks: vec![0], agents: vec![], unavailable: vec![1] };
    assert_eq!(refused(lost, 0), nobody);
}

#[test]
fn bystanders_are_no_part_of_a_conflict() {
    let pair = task(&[&[&[0, 1]]]);
    let tasks = vec![pair.clone(), task(&[&[&[2, 3]]]), pair.clone(), task(&[&[&[3, 2]]]), pair];
    let conflict = Refusal::NotAvailable { tasks: vec![0, 2, 4], agents: vec![0, 1], unavailable: vec![] };
    assert_eq!(refused(problem(4, tasks), 4), conflict);
}
