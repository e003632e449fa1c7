//! All configurations that can be reached, in order of the fewest steps to them.

use super::configuration::{Configuration, Product};
use super::finding::{Finding, Step, Wait};
use super::protocol::{Party, Protocol, Queues, Role};
use std::collections::BTreeSet;
use std::rc::Rc;

/// The most configurations to visit, where there is no reason for another number: a second or so. A protocol of
/// the usual kind has fewer than a hundred.
pub const MOST: usize = 100_000;

/// Messages under way in a configuration, on average, for which there is memory. Without this bound a large
/// capacity would cost the square of the number of configurations.
const MESSAGES: usize = 32;

/// What came out of an exploration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Explored {
    /// What goes wrong, each once, what takes fewest steps first.
    pub findings: Vec<Finding>,
    /// How many configurations were visited.
    pub seen: usize,
    /// Whether that is all there are; else there may be more findings than told.
    pub complete: bool,
    /// The most messages under way at once, by the role that sends them, in what was visited.
    pub most_under_way: [usize; 2],
    /// Whether a role, by index, could once send a message that did not fit. When neither could and the
    /// exploration is complete, all that is told holds for greater capacities too.
    pub blocked: [bool; 2],
}

/// Visits what a conversation can come to, up to `most` configurations; fewer, when so many messages are under
/// way in them that capacities up to 16 would not allow it. Parties are by role.
///
/// Cost: some steps and comparisons for each configuration, times the logarithm of their number.
pub fn explore(protocol: &Protocol, parties: &[Party; 2], queues: Queues, most: usize) -> Explored {
    let product = Product { protocol, parties, queues };
    let mut visits = Visits { most, complete: true, messages: 0, list: Vec::new(), known: BTreeSet::new() };
    let mut told = Told::default();
    let (mut most_under_way, mut blocked) = ([0; 2], [false; 2]);
    visits.add(Configuration::default(), None);
    let mut i = 0;
    while let Some(c) = visits.list.get(i).map(|v| Rc::clone(&v.configuration)) {
        for role in Role::BOTH {
            let r = role.index();
            most_under_way[r] = c.under_way[r].len().max(most_under_way[r]);
            blocked[r] |= product.is_blocked(&c, role);
            if let Some((state, message)) = product.unexpected(&c, role)
                && told.unexpected.insert((role, state, message))
            {
                let witness = visits.witness(i);
                told.findings.push(Finding::Unexpected { role, state, message, witness });
            }
        }
        let waits = product.stuck(&c);
        if !waits.is_empty() && told.stuck.insert(waits.clone()) {
            told.findings.push(Finding::Stuck { waits, witness: visits.witness(i) });
        }
        for (step, next) in product.steps(&c) {
            visits.add(next, Some((i, step)));
        }
        i += 1;
    }
    let Visits { complete, list, .. } = visits;
    if !complete && told.findings.is_empty() {
        told.findings.push(Finding::NotProven { seen: list.len() });
    }
    Explored { findings: told.findings, seen: list.len(), complete, most_under_way, blocked }
}

/// Findings so far, and what makes them distinct.
#[derive(Default)]
struct Told {
    findings: Vec<Finding>,
    unexpected: BTreeSet<(Role, u32, u32)>,
    stuck: BTreeSet<Vec<Wait>>,
}

/// A configuration and the last step of a shortest way to it: from which visit, by index, and what happened.
struct Visit {
    configuration: Rc<Configuration>,
    from: Option<(usize, Step)>,
}

/// Configurations in the order in which they were met; the list is its own queue.
struct Visits {
    most: usize,
    complete: bool,
    /// All messages under way in the list.
    messages: usize,
    list: Vec<Visit>,
    known: BTreeSet<Rc<Configuration>>,
}

impl Visits {
    fn add(&mut self, configuration: Configuration, from: Option<(usize, Step)>) {
        // After the first that is left out all are, so that ways to what is here are the shortest there are.
        if !self.complete || self.known.contains(&configuration) {
            return;
        }
        let messages: usize = configuration.under_way.iter().map(Vec::len).sum();
        let sum = self.messages.saturating_add(messages);
        if self.list.len() >= self.most || sum > self.most.saturating_mul(MESSAGES) {
            self.complete = false;
            return;
        }
        self.messages = sum;
        let configuration = Rc::new(configuration);
        self.known.insert(Rc::clone(&configuration));
        self.list.push(Visit { configuration, from });
    }

    /// The steps from the start to a visit.
    fn witness(&self, at: usize) -> Vec<Step> {
        let last = |i: usize| self.list.get(i).and_then(|v| v.from);
        let mut steps: Vec<Step> =
            std::iter::successors(last(at), |(i, _)| last(*i)).map(|(_, step)| step).collect();
        steps.reverse();
        steps
    }
}
