//! Whether outcomes are an allocation.

use super::{Outcome, Problem};
use std::collections::BTreeMap;

/// Checks that outcomes fit a problem: one for each task; every need of a served task has one of its
/// candidates, which is available; no exclusive agent serves two tasks. Says what is wrong.
///
/// It does not ask whether more tasks could be served.
pub fn check(problem: &Problem, outcomes: &[Outcome]) -> Result<(), String> {
    if outcomes.len() != problem.tasks.len() {
        return Err(format!("{} outcomes for {} tasks", outcomes.len(), problem.tasks.len()));
    }
    let mut holders = BTreeMap::new();
    for (task, outcome) in (0u32..).zip(outcomes) {
        let Some(choice) = outcome.choice() else { continue };
        let Some(way) = problem.ways(task).get(choice.way as usize) else {
            return Err(format!("task {task} has no way {}", choice.way));
        };
        if choice.label != way.label {
            return Err(format!("way {} of task {task} has another label", choice.way));
        }
        if choice.agents.len() != way.needs.len() {
            return Err(format!("task {task}: {} agents for {} needs", choice.agents.len(), way.needs.len()));
        }
        for (agent, need) in choice.agents.iter().copied().zip(&way.needs) {
            if !need.candidates.contains(&agent) {
                return Err(format!("agent {agent} is no candidate for a need of task {task}"));
            }
            if !problem.is_available(agent) {
                return Err(format!("agent {agent} of task {task} is not available"));
            }
            if problem.is_exclusive(agent) {
                match holders.insert(agent, task) {
                    Some(other) if other != task => {
                        return Err(format!(
                            "agent {agent} is exclusive and serves tasks {other} and {task}"
                        ));
                    }
                    _ => {}
                }
            }
        }
    }
    Ok(())
}
