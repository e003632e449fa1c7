//! A quick proof that tasks cannot all be served, whatever forms they take.
//!
//! Every form of a task demands an agent out of the smallest of its demands. If all these together are too
//! few for the tasks, no choice of forms helps; a search through the forms would have to try them all to find
//! that out.

use super::catalogue::Form;
use super::search::{Conflict, conflict};
use super::seating::{Hall, Post, Seating, Shortage};
use std::collections::BTreeSet;

impl Seating {
    /// Tasks that each need one of certain agents at least, of which there are too few, if a path from the
    /// empty seat of the shortage leads to such.
    pub(super) fn pigeonholes(&mut self, shortage: &Shortage, hall: &mut Hall) -> Option<Conflict> {
        let empty = self.seats.get(*shortage.seats.first()?)?;
        let (root, root_index) = (empty.task, empty.index);
        let (mut tasks, mut agents) = (BTreeSet::from([root]), BTreeSet::new());
        let mut sets = BTreeSet::new();
        let mut queue = vec![root];
        while let Some(task) = queue.pop() {
            let party = self.parties.get(&task)?;
            let (forms, open, form) = (party.forms.clone(), party.open.clone(), party.form);
            for number in open {
                let all = forms.all.get(number)?;
                let index = if (task, number) == (root, form) { root_index } else { smallest(all)? };
                let demand = all.get(index)?;
                for agent in Some(demand).filter(|d| sets.insert(d.set)).iter().flat_map(|d| d.order.iter()) {
                    hall.meter.steps += 1;
                    if !agents.insert(*agent) {
                        continue;
                    }
                    let Post::Seat(seat) = self.post(*agent, hall) else { return None };
                    let seat = self.seats.get(seat)?;
                    let party = self.parties.get(&seat.task)?;
                    // An agent in another seat of its task is not counted: the task might do without it.
                    let is_counted = party.forms.all.get(party.form).and_then(smallest) == Some(seat.index);
                    if !is_counted || seat.task == root {
                        return None;
                    }
                    if tasks.insert(seat.task) {
                        queue.push(seat.task);
                    }
                }
            }
        }
        Some(conflict(tasks, agents))
    }
}

/// The demand that the fewest agents can meet.
fn smallest(form: &Form) -> Option<usize> {
    (0..form.len()).min_by_key(|i| form.get(*i).map(|d| d.members.len()))
}
