//! What will happen: periodic releases, and what was put off to an instant.

use super::{
    cast::Timer,
    devices::DeviceUse,
    log::{Item, Log},
    planner::Notice,
    post::Letter,
    talks::Utterance,
};
use crate::Time;
use serde::{Deserialize, Serialize};
use soifra_graph::Role;
use std::{cmp::Reverse, collections::BinaryHeap, sync::Arc};

/// Something put off.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum Scheduled {
    /// A letter arrives at units.
    Deliver { letter: Arc<Letter>, to: Vec<u32> },
    /// A letter arrives at one unit.
    Hand { letter: Arc<Letter>, to: u32 },
    /// Outputs of an activation that took its time.
    Outputs { unit: u32, record: Option<u64>, log: Log },
    /// A use of a device is over.
    DeviceFree { device: u32, by: DeviceUse },
    /// A message of a conversation arrives.
    Utter(Utterance),
    /// A side of a conversation has waited long enough.
    Patience { branch: u64, by: Role, entry: u32 },
    /// A unit that was kept waiting may be released.
    Wake(u32),
    /// A periodic unit is released, later than its period says.
    Late { unit: u32, release: Time },
    /// Something is to be decided on a core.
    Core { core: u32, version: u64 },
    /// A unit is to be done by now.
    Deadline { unit: u32, release: Time },
    /// A message between planner, directory and agents.
    Notice(Box<Notice>),
    /// A declared fault kills an agent.
    Kill(u32),
    /// A unit hears that a parameter has changed.
    Heard(u32),
    /// Somebody outside asks for a goal.
    Post(String),
    /// A message that a declared fault has delayed is published.
    Publish { unit: u32, topic: u32, registers: Vec<f64>, record: Option<u64> },
    /// A side of a conversation learns that the other is dead.
    PeerGone { branch: u64, side: Role, record: Option<u64> },
}

/// The future.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    timers: Vec<Timer>,
    due: BinaryHeap<Reverse<(Time, u32)>>,
    /// When what was put off is due, with its number, and its place in `kept`: a heap moves what it holds, and
    /// what is put off is large. Most of it is put off to the end of the heap, where that costs least: how long
    /// somebody waits for an answer.
    scheduled: BinaryHeap<Reverse<(Time, u64, u32)>>,
    kept: Vec<Option<Scheduled>>,
    /// Places of `kept` that are free.
    free: Vec<u32>,
    count: u64,
}

/// What of the future changes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Agenda {
    /// When each timer is due next.
    timers: Vec<Time>,
    /// What was put off, with when and its number.
    scheduled: Vec<(Time, u64, Scheduled)>,
    count: u64,
}

impl Queue {
    /// What was put off, in no order.
    pub fn put_off(&self) -> impl Iterator<Item = &Scheduled> {
        self.kept.iter().flatten()
    }

    /// The future as it is now.
    pub fn agenda(&self) -> Agenda {
        let mut scheduled: Vec<_> = self.scheduled.iter().map(|Reverse(s)| *s).collect();
        scheduled.sort_unstable();
        let what = |at: u32| self.kept.get(at as usize).cloned().flatten();
        let scheduled = scheduled.into_iter().filter_map(|(t, n, at)| Some((t, n, what(at)?)));
        Agenda {
            timers: self.timers.iter().map(|t| t.next).collect(),
            scheduled: scheduled.collect(),
            count: self.count,
        }
    }

    /// Takes up the future of a run of the same mission with so many agents, units and cores; false when it is none.
    pub fn resume(&mut self, agenda: Agenda, [instances, units, cores]: [usize; 3]) -> bool {
        let known = |u: &u32| (*u as usize) < units;
        let fits = agenda.timers.len() == self.timers.len()
            && agenda.scheduled.iter().all(|(_, n, what)| {
                *n < agenda.count
                    && match what {
                        Scheduled::Deliver { to, .. } => to.iter().all(known),
                        Scheduled::Hand { to, .. } => known(to),
                        Scheduled::Outputs { unit, log, .. } => {
                            known(unit) && log.items.iter().all(Item::is_output)
                        }
                        Scheduled::Wake(unit)
                        | Scheduled::Late { unit, .. }
                        | Scheduled::Deadline { unit, .. } => known(unit),
                        Scheduled::Publish { unit, .. } | Scheduled::Heard(unit) => known(unit),
                        Scheduled::Kill(instance) => (*instance as usize) < instances,
                        Scheduled::Notice(notice) => notice.fits(instances),
                        Scheduled::Utter(_)
                        | Scheduled::Patience { .. }
                        | Scheduled::Post(_)
                        | Scheduled::PeerGone { .. } => true,
                        Scheduled::DeviceFree { by, .. } => by.fits(units),
                        Scheduled::Core { core, .. } => (*core as usize) < cores,
                    }
            });
        if !fits {
            return false;
        }
        for (timer, next) in self.timers.iter_mut().zip(agenda.timers) {
            timer.next = next;
        }
        self.due = self.timers.iter().enumerate().map(|(i, t)| Reverse((t.next, i as u32))).collect();
        (self.scheduled, self.kept, self.free) = Default::default();
        for (t, n, what) in agenda.scheduled {
            let at = self.keep(what);
            self.scheduled.push(Reverse((t, n, at)));
        }
        self.count = agenda.count;
        true
    }

    pub fn new(timers: Vec<Timer>) -> Self {
        let due = timers.iter().enumerate().map(|(i, t)| Reverse((t.next, i as u32))).collect();
        Queue { timers, due, ..Queue::default() }
    }

    /// Puts something off until `at`; what was put off first comes first.
    pub fn put(&mut self, at: Time, what: Scheduled) {
        let place = self.keep(what);
        self.scheduled.push(Reverse((at, self.count, place)));
        self.count += 1;
    }

    /// What was put off for some units is not to happen; messages to them are.
    pub fn drop_units(&mut self, units: &std::ops::Range<u32>) {
        let (kept, free) = (&mut self.kept, &mut self.free);
        self.scheduled.retain(|Reverse((_, _, at))| {
            let stays = match kept.get(*at as usize).and_then(Option::as_ref) {
                Some(
                    Scheduled::Outputs { unit, .. }
                    | Scheduled::Wake(unit)
                    | Scheduled::Late { unit, .. }
                    | Scheduled::Deadline { unit, .. },
                ) => !units.contains(unit),
                Some(Scheduled::DeviceFree { by, .. }) => !units.contains(&by.unit),
                _ => true,
            };
            if !stays {
                kept[*at as usize] = None;
                free.push(*at);
            }
            stays
        });
    }

    /// Keeps something; gives its place.
    fn keep(&mut self, what: Scheduled) -> u32 {
        match self.free.pop() {
            Some(at) => {
                self.kept[at as usize] = Some(what);
                at
            }
            None => {
                self.kept.push(Some(what));
                (self.kept.len() - 1) as u32
            }
        }
    }

    /// When something happens next.
    pub fn next(&self) -> Option<Time> {
        let timer = self.due.peek().map(|r| r.0.0);
        let scheduled = self.scheduled.peek().map(|r| r.0.0);
        [timer, scheduled].into_iter().flatten().min()
    }

    /// Takes what was put off until `now`.
    pub fn take(&mut self, now: Time) -> Option<Scheduled> {
        self.scheduled.peek().filter(|r| r.0.0 <= now)?;
        let Reverse((_, _, at)) = self.scheduled.pop()?;
        self.free.push(at);
        self.kept[at as usize].take()
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
