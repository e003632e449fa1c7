//! Agents and tasks come and go.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::allocation::*;
use std::collections::BTreeSet;

#[derive(Debug, Clone)]
enum Event {
    Lost(u32),
    Returned(u32),
    Added(Agent, Vec<Place>),
    Task(Task),
    Removed(u32),
}

fn event() -> impl Strategy<Value = Event> {
    let place = (0..6u32, 0..3u32, 0..3u32, 0..4u32).prop_map(|(task, way, need, rank)| Place {
        task,
        way,
        need,
        rank,
    });
    let agent = (prop::bool::weighted(0.2), prop::bool::weighted(0.9));
    let agent = agent.prop_map(|(collaborative, available)| Agent { collaborative, available });
    prop_oneof![
        4 => (0..6u32).prop_map(Event::Lost),
        4 => (0..6u32).prop_map(Event::Returned),
        1 => (agent, prop::collection::vec(place, 0..4)).prop_map(|(a, p)| Event::Added(a, p)),
        1 => any_task().prop_map(Event::Task),
        2 => (0..6u32).prop_map(Event::Removed),
    ]
}

fn happen(matcher: &mut Matcher, event: &Event) -> Changes {
    match event {
        Event::Lost(agent) => matcher.agent_lost(*agent),
        Event::Returned(agent) => matcher.agent_returned(*agent),
        Event::Added(agent, places) => matcher.agent_added(*agent, places).1,
        Event::Task(task) => matcher.task_added(task.clone()).1,
        Event::Removed(task) => matcher.task_removed(*task),
    }
}

/// What an operation must have left.
fn judge(before: &Matcher, matcher: &Matcher, event: &Event, changes: &Changes) -> Result<(), TestCaseError> {
    let (problem, outcomes) = (matcher.problem(), matcher.outcomes());
    prop_assert_eq!(check(problem, outcomes), Ok(()));
    let (old, now) = (served(before.outcomes()), served(outcomes));
    for (task, outcome) in (0..).zip(outcomes) {
        match outcome {
            Outcome::Refused(refusal) => {
                prop_assert!(!can_serve(problem, &with(&now, task)), "task {} could be served", task);
                judge_refusal(problem, task, refusal, before.outcome(task) != outcome)?;
            }
            Outcome::Undecided => prop_assert!(false, "undecided"),
            Outcome::Served(_) | Outcome::Removed => {}
        }
        let has_lost = |choice: &Choice| matches!(event, Event::Lost(agent) if choice.agents.contains(agent));
        let was = before.outcome(task);
        if old.contains(&task) && !now.contains(&task) {
            prop_assert!(was.choice().is_some_and(has_lost) || *outcome == Outcome::Removed);
        }
        let change = changes.tasks.iter().find(|c| c.task == task);
        let is_new = task as usize >= before.outcomes().len();
        prop_assert_eq!(change.is_some(), is_new || was != outcome);
        if let Some(change) = change {
            prop_assert_eq!(change.before.as_ref(), was.choice());
            prop_assert_eq!(change.after.as_ref(), outcome.choice());
            let agents = |o: &Outcome| -> BTreeSet<u32> {
                o.choice().into_iter().flat_map(|c| c.agents.clone()).collect()
            };
            let (a, b) = (agents(was), agents(outcome));
            prop_assert_eq!(&change.released, &a.difference(&b).copied().collect::<Vec<_>>());
            prop_assert_eq!(&change.requested, &b.difference(&a).copied().collect::<Vec<_>>());
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn whatever_happens_whoever_can_be_served_is(
        problem in any_problem(),
        events in prop::collection::vec(event(), 1..12),
        is_solved in prop::bool::weighted(0.9),
    ) {
        let mut matcher = Matcher::new(problem);
        if is_solved {
            matcher.solve();
        } else {
            // Undecided tasks are taken up whenever somebody appears.
            matcher.agent_added(EXCLUSIVE, &[]);
        }
        for event in &events {
            let before = matcher.clone();
            let changes = happen(&mut matcher, event);
            judge(&before, &matcher, event, &changes)?;
            let mut again = before.clone();
            prop_assert_eq!(happen(&mut again, event), changes);
            prop_assert_eq!(&again, &matcher);
        }
        let text = serde_json::to_string(&matcher).unwrap();
        prop_assert_eq!(serde_json::from_str::<Matcher>(&text).unwrap(), matcher);
    }

    #[test]
    fn a_free_candidate_disturbs_nobody(problem in any_problem(), lost in 0..5u32) {
        let mut matcher = solved(&problem);
        let before = matcher.clone();
        matcher.agent_lost(lost);
        let bits = |task: u32| {
            before.outcome(task).choice().map_or(0, |c| c.agents.iter().fold(0, |b, a| b | 1 << a))
        };
        let collaborative = (0..).zip(&problem.agents).filter(|(_, a)| a.collaborative);
        let collaborative = collaborative.fold(0, |b, (a, _)| b | 1u32 << a);
        let tasks: Vec<u32> = (0..problem.tasks.len() as u32).collect();
        let hit: Vec<u32> = tasks.iter().copied().filter(|t| bits(*t) >> lost & 1 == 1).collect();
        let [hit] = hit[..] else { return Ok(()) };
        let others = tasks.iter().filter(|t| **t != hit).fold(0, |b, t| b | bits(*t)) & !collaborative;
        if choices(matcher.problem(), hit).iter().any(|(_, taken)| taken & others == 0) {
            for task in tasks.iter().copied().filter(|t| *t != hit && before.outcome(*t).choice().is_some()) {
                prop_assert_eq!(before.outcome(task), matcher.outcome(task));
            }
            prop_assert!(matcher.outcome(hit).choice().is_some());
        }
    }

    #[test]
    fn as_few_as_possible_move_where_one_agent_is_enough(
        problem in easy_problem(1),
        mut new in any_task(),
    ) {
        new.ways.truncate(1);
        new.ways.iter_mut().for_each(|way| way.needs.truncate(1));
        let before = solved(&problem);
        let mut matcher = before.clone();
        let (number, changes) = matcher.task_added(new);
        if matcher.outcome(number).choice().is_none() {
            return Ok(());
        }
        fn fewest(before: &Matcher, problem: &Problem, tasks: &[u32], taken: u32) -> Option<usize> {
            let Some((task, rest)) = tasks.split_first() else { return Some(0) };
            let open = choices(problem, *task).into_iter().filter(|(_, bits)| bits & taken == 0);
            open.filter_map(|(choice, bits)| {
                let moved = usize::from(before.outcome(*task).choice() != Some(&choice));
                Some(moved + fewest(before, problem, rest, taken | bits)?)
            })
            .min()
        }
        let tasks: Vec<u32> = served(matcher.outcomes()).into_iter().collect();
        prop_assert_eq!(Some(changes.tasks.len()), fewest(&before, matcher.problem(), &tasks, 0));
    }
}

#[test]
fn what_is_not_there_changes_nothing() {
    let mut matcher = solved(&problem(1, vec![task(&[&[&[0]]])]));
    let before = matcher.clone();
    assert_eq!(matcher.agent_lost(9), Changes::default());
    assert_eq!(matcher.agent_returned(0), Changes::default());
    assert_eq!(matcher.agent_returned(9), Changes::default());
    assert_eq!(matcher.task_removed(9), Changes::default());
    assert_eq!(matcher, before);
}

#[test]
fn a_task_keeps_its_way_when_it_moves() {
    // It has its second way when the first becomes possible; then it loses one of its two agents.
    let mut matcher = solved(&problem(5, vec![task(&[&[&[0]]]), task(&[&[&[0]], &[&[1], &[2, 3]]])]));
    assert_eq!(matcher.outcome(1).choice().unwrap().agents, [1, 2]);
    matcher.task_removed(0);
    assert_eq!(matcher.outcome(1).choice().unwrap().agents, [1, 2]);
    matcher.agent_lost(2);
    assert_eq!(matcher.outcome(1).choice().unwrap().agents, [1, 3]);
    matcher.agent_lost(3);
    assert_eq!(matcher.outcome(1).choice().unwrap().agents, [0]);
}

#[test]
fn the_refused_are_tried_again() {
    let one = task(&[&[&[0]]]);
    let mut matcher = solved(&problem(1, vec![one.clone(), one]));
    let changes = matcher.task_removed(0);
    assert_eq!(changes.tasks.iter().map(|c| c.task).collect::<Vec<_>>(), [0, 1]);
    assert_eq!((&changes.tasks[0].released[..], &changes.tasks[1].requested[..]), (&[0][..], &[0][..]));
    matcher.agent_lost(0);
    assert!(matcher.outcome(1).choice().is_none());
    matcher.agent_returned(0);
    assert!(matcher.outcome(1).choice().is_some());
    let place = Place { task: 2, way: 0, need: 0, rank: 0 };
    let (number, _) = matcher.task_added(task(&[&[&[]]]));
    assert_eq!(matcher.outcome(number), &Outcome::Refused(Refusal::NoCapable { needs: vec![0] }));
    let (agent, _) = matcher.agent_added(EXCLUSIVE, &[place, Place { task: 77, ..place }]);
    assert_eq!(matcher.outcome(number).choice().unwrap().agents, [agent]);
}
