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
mod quantifiers;
mod ranges;
mod reachability;
mod schedulability;
mod timing;
mod topics;
mod types;
pub mod walk;

pub use allocation::{Allotted, allocation};
pub(crate) use capability::fits;
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
    out.extend(goals::check(graph));
    out.extend(capability::check(graph));
    out.extend(allocation::check(graph));
    out.extend(faults::check(graph));
    out.extend(hosts::check(graph));
    out.extend(quantifiers::check(graph));
    out.extend(clock::check(graph));
    out.extend(arbitration::check(graph));
    out.extend(reachability::check(graph));
    out.extend(topics::check(graph));
    out.extend(conversations::check(graph));
    out.extend(events::check(graph));
    out.extend(timing::check(graph));
    out.extend(anytime::check(graph));
    out.extend(schedulability::check(graph));
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

/// Agents that some robot runs, by index.
fn used_agents(graph: &Graph) -> Vec<bool> {
    let mut used = vec![false; graph.agents.len()];
    for b in graph.robots.iter().flat_map(|r| &r.agents) {
        if let Some(u) = used.get_mut(b.agent as usize) {
            *u = true;
        }
    }
    used
}
