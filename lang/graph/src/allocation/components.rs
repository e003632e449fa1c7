//! Tasks that compete with each other, over whatever detour.

use super::Problem;
use super::work::Meter;

/// A number for each task, the same for tasks of one component: two tasks are in one if an available
/// exclusive agent is a candidate of both.
pub(super) fn components(problem: &Problem, meter: &mut Meter) -> Vec<u32> {
    let mut parents: Vec<u32> = (0u32..).take(problem.tasks.len()).collect();
    let mut first: Vec<Option<u32>> = vec![None; problem.agents.len()];
    for (number, task) in (0u32..).zip(&problem.tasks) {
        for agent in task.ways.iter().flat_map(|w| &w.needs).flat_map(|n| n.candidates.iter().copied()) {
            meter.steps += 1;
            if !problem.is_available(agent) || !problem.is_exclusive(agent) {
                continue;
            }
            let Some(first) = first.get_mut(agent as usize) else { continue };
            let (a, b) = (root(&mut parents, number), root(&mut parents, *first.get_or_insert(number)));
            if let Some(parent) = parents.get_mut(a.max(b) as usize) {
                *parent = a.min(b);
            }
        }
    }
    let all = (0u32..).take(parents.len());
    all.map(|task| root(&mut parents, task)).collect()
}

/// The least task that is known to be in the same component; shortens the way to it.
fn root(parents: &mut [u32], task: u32) -> u32 {
    let mut here = task;
    while let Some(parent) = parents.get(here as usize).copied().filter(|p| *p != here) {
        let above = parents.get(parent as usize).copied().unwrap_or(parent);
        if let Some(place) = parents.get_mut(here as usize) {
            *place = above;
        }
        here = above;
    }
    here
}
