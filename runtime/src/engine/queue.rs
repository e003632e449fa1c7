//! What will happen: periodic releases, and what was put off to an instant.

use super::{cast::Timer, log::Log, post::Letter};
use crate::Time;
use std::{
    cmp::Reverse,
    collections::{BTreeMap, BinaryHeap},
    sync::Arc,
};

/// Something put off.
#[derive(Debug)]
pub(crate) enum Scheduled {
    /// A letter arrives at units.
    Deliver { letter: Arc<Letter>, to: Vec<u32> },
    /// Outputs of an activation that took its time.
    Outputs { unit: u32, record: Option<u64>, log: Log },
    /// A unit that was kept waiting may be released.
    Wake(u32),
}

/// The future.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    timers: Vec<Timer>,
    due: BinaryHeap<Reverse<(Time, u32)>>,
    scheduled: BTreeMap<(Time, u64), Scheduled>,
    count: u64,
}

impl Queue {
    pub fn new(timers: Vec<Timer>) -> Self {
        let due = timers.iter().enumerate().map(|(i, t)| Reverse((t.next, i as u32))).collect();
        Queue { timers, due, ..Queue::default() }
    }

    /// Puts something off until `at`; what was put off first comes first.
    pub fn put(&mut self, at: Time, what: Scheduled) {
        self.scheduled.insert((at, self.count), what);
        self.count += 1;
    }

    /// When something happens next.
    pub fn next(&self) -> Option<Time> {
        let timer = self.due.peek().map(|r| r.0.0);
        let scheduled = self.scheduled.first_key_value().map(|(k, _)| k.0);
        [timer, scheduled].into_iter().flatten().min()
    }

    /// Takes what was put off until `now`.
    pub fn take(&mut self, now: Time) -> Option<Scheduled> {
        let first = self.scheduled.first_entry()?;
        (first.key().0 <= now).then(|| first.remove())
    }

    /// Visits the units of all timers that are due at `now`, and sets the timers to their next instant.
    pub fn tick(&mut self, now: Time, mut visit: impl FnMut(u32)) {
        while let Some(&Reverse((at, i))) = self.due.peek() {
            if at > now {
                break;
            }
            self.due.pop();
            let timer = &mut self.timers[i as usize];
            timer.members.iter().for_each(|&u| visit(u));
            timer.next = at + timer.period;
            self.due.push(Reverse((timer.next, i)));
        }
    }
}
