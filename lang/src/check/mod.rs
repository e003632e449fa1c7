//! What can be known before anything moves: checks on the graph, one file for each question. They run on
//! graphs from sources and from graph files alike.

mod allocation;
mod anytime;
mod arbitration;
mod bounds;
mod capability;
mod clock;
mod computable;
mod constants;
mod conversations;
mod effects;
mod events;
mod faults;
mod form;
mod goals;
mod hosts;
mod knowledge;
mod lists;
mod materials;
mod placement;
mod possible;
mod quantifiers;
mod ranges;
mod reachability;
mod schedulability;
mod shares;
mod timing;
mod topics;
mod types;
pub mod walk;

pub use allocation::{Allotted, allocation};
pub(crate) use constants::{Constants, not_computable};
pub(crate) use ranges::wrong_period;

use soifra_graph::{Diagnostic, Graph};

/// All checks, in the order of what the later ones take for granted: types first, since a graph file may
/// hold anything; a graph whose parts do not fit together is not looked at further.
pub fn verify(graph: &Graph) -> Vec<Diagnostic> {
    let mut out = types::check(graph);
    if !out.is_empty() {
        return out;
    }
    out.extend(form::check(graph));
    out.extend(knowledge::check(graph));
    let allocation = allocation::check(graph);
    // Where agents are missing for want of their ports, what is said of them or commanded by them alone is no
    // mistake of its own.
    let maimed = allocation.iter().any(|d| d.code == crate::code::NO_CAPABLE)
        && graph.robots.iter().any(|r| !r.unfit.is_empty());
    out.extend(allocation);
    out.extend(goals::check(graph).into_iter().filter(|d| !maimed || d.code != crate::code::NO_AGENT));
    out.extend(capability::check(graph));
    out.extend(faults::check(graph));
    out.extend(hosts::check(graph));
    out.extend(quantifiers::check(graph));
    out.extend(clock::check(graph));
    if !maimed {
        out.extend(arbitration::check(graph));
    }
    out.extend(reachability::check(graph));
    out.extend(topics::check(graph));
    out.extend(conversations::check(graph));
    out.extend(events::check(graph));
    out.extend(timing::check(graph));
    out.extend(anytime::check(graph));
    out.extend(schedulability::check(graph));
    out.extend(shares::check(graph));
    out.extend(effects::check(graph));
    out.extend(lists::check(graph));
    out.extend(computable::check(graph));
    out.extend(materials::check(graph));
    out.extend(bounds::check(graph));
    let ranges = ranges::check(graph);
    // Where things stand means nothing while their sizes are impossible.
    let possible = ranges.is_empty();
    out.extend(ranges);
    if possible {
        out.extend(placement::check(graph));
    }
    out
}

/// Whether the parts of a graph fit together, so that it can be asked about.
pub(crate) fn fits_together(graph: &Graph) -> bool {
    types::check(graph).is_empty()
}

/// Agents that some robot runs, or would run if its platform had their ports, by index.
fn used_agents(graph: &Graph) -> Vec<bool> {
    let mut used = vec![false; graph.agents.len()];
    let unfit = graph.robots.iter().flat_map(|r| &r.unfit).map(|u| u.agent);
    for agent in graph.robots.iter().flat_map(|r| &r.agents).map(|b| b.agent).chain(unfit) {
        if let Some(u) = used.get_mut(agent as usize) {
            *u = true;
        }
    }
    used
}
