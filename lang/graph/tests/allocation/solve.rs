//! An allocation is found whenever there is one.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::allocation::*;
use std::collections::BTreeSet;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn a_task_is_served_if_it_can_be_with_those_before(problem in any_or_crowded()) {
        let matcher = solved(&problem);
        prop_assert_eq!(check(&problem, matcher.outcomes()), Ok(()));
        let served = served(matcher.outcomes());
        let mut before = BTreeSet::new();
        for task in 0..problem.tasks.len() as u32 {
            let can = can_serve(&problem, &with(&before, task));
            prop_assert_eq!(can, served.contains(&task), "task {}", task);
            prop_assert!(can || matches!(matcher.outcome(task), Outcome::Refused(_)));
            if can {
                before.insert(task);
            }
        }
        let all: BTreeSet<u32> = (0..problem.tasks.len() as u32).collect();
        prop_assert_eq!(can_serve(&problem, &all), served == all);
    }

    #[test]
    fn as_many_as_possible_are_served_where_one_agent_is_enough(problem in easy_problem(3)) {
        let served = served(solved(&problem).outcomes()).len() as u32;
        let subsets = (0..1u32 << problem.tasks.len()).map(|bits| {
            (0..problem.tasks.len() as u32).filter(|t| bits >> t & 1 == 1).collect::<BTreeSet<u32>>()
        });
        let most = subsets.filter(|s| can_serve(&problem, s)).map(|s| s.len() as u32).max();
        prop_assert_eq!(Some(served), most);
    }

    #[test]
    fn the_same_problem_has_the_same_allocation(problem in any_problem()) {
        let (mut a, b) = (solved(&problem), solved(&problem));
        prop_assert_eq!(&a, &b);
        let again = a.solve();
        prop_assert_eq!(again.tasks, vec![]);
        prop_assert_eq!(&a, &b);
    }

    #[test]
    fn a_matcher_survives_a_file(problem in any_problem()) {
        let matcher = solved(&problem);
        let text = serde_json::to_string(&matcher).unwrap();
        prop_assert_eq!(serde_json::from_str::<Matcher>(&text).unwrap(), matcher);
    }
}

#[test]
fn a_file_that_is_no_allocation_is_refused() {
    let matcher = solved(&problem(2, vec![task(&[&[&[0, 1]]]), task(&[&[&[0, 1]]])]));
    let text = serde_json::to_string(&matcher).unwrap();
    assert!(text.contains(r#""agents":[1]"#), "{text}");
    for (right, wrong) in [
        (r#""agents":[1]"#, r#""agents":[0]"#),
        (r#""agents":[1]"#, r#""agents":[7]"#),
        (r#""agents":[1]"#, r#""agents":[]"#),
        (r#"{"way":0"#, r#"{"way":1"#),
        (r#"{"way":0,"label":10"#, r#"{"way":0,"label":11"#),
        (r#""available":true"#, r#""available":false"#),
    ] {
        assert!(serde_json::from_str::<Matcher>(&text.replace(right, wrong)).is_err(), "{wrong}");
    }
}

#[test]
fn a_task_that_needs_nothing_is_served() {
    let matcher = solved(&problem(0, vec![task(&[&[]]), task(&[])]));
    assert_eq!(matcher.outcome(0), &Outcome::Served(Choice { way: 0, label: 10, agents: vec![] }));
    assert_eq!(matcher.outcome(1), &Outcome::Refused(Refusal::NoPlan));
    assert_eq!(matcher.outcome(2), &Outcome::Removed);
}

#[test]
fn one_agent_may_serve_two_needs_of_a_task() {
    let matcher = solved(&problem(3, vec![task(&[&[&[0, 1], &[1, 2]]]), task(&[&[&[0]]]), task(&[&[&[2]]])]));
    assert_eq!(matcher.outcome(0).choice().unwrap().agents, [1, 1]);
    assert_eq!(served(matcher.outcomes()).len(), 3);
}

#[test]
fn pigeonholes_are_no_search() {
    // Nine tasks, eight pairs of agents, and each task needs both of a pair: 9! orders to try.
    let pairs: Vec<[[u32; 1]; 2]> = (0..8).map(|i| [[2 * i], [2 * i + 1]]).collect();
    let ways: Vec<Vec<&[u32]>> = pairs.iter().map(|pair| pair.iter().map(|n| &n[..]).collect()).collect();
    let ways: Vec<&[&[u32]]> = ways.iter().map(|w| &w[..]).collect();
    let mut matcher = Matcher::with_limit(problem(16, vec![task(&ways); 9]), 2000);
    matcher.solve();
    assert_eq!(served(matcher.outcomes()).len(), 8);
    let Outcome::Refused(Refusal::NotAvailable { tasks, .. }) = matcher.outcome(8) else {
        panic!("{:?}", matcher.outcome(8));
    };
    assert_eq!(tasks.len(), 9);
}
