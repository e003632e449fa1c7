//! Whether and when a unit is released: mailboxes, least distances, units that still run, and floods.

use super::{
    Due, Engine,
    activate::Release,
    lives::FLOOD,
    post::{Delivered, Letter},
    queue::Scheduled,
};
use crate::{Event, Time};
use std::sync::Arc;

impl Engine<'_> {
    /// The record of a delivery to a unit that runs; to others nothing is delivered.
    pub(super) fn delivered(&mut self, unit: u32, letter: &Letter) -> Option<u64> {
        if self.lives.is_on(unit) { self.trace_delivery(unit, letter, None) } else { None }
    }

    /// Puts a letter into a mailbox, whose oldest is lost when it is full.
    pub(super) fn put_letter(&mut self, unit: u32, letter: Arc<Letter>, record: Option<u64>) {
        if !self.lives.is_on(unit) {
            let dead = self.lives.is_dead(self.cast.units[unit as usize].instance);
            self.trace_delivery(
                unit,
                &letter,
                Some(if dead { "the agent is dead" } else { "it does not run" }),
            );
            return;
        }
        if let Some(oldest) = self.mail.put(unit, Delivered { letter, record }) {
            self.trace_delivery(unit, &oldest.letter, Some("the mailbox is full"));
        }
    }

    /// Releases a unit for as many of its letters as it may handle now.
    pub(super) fn open_mailbox(&mut self, unit: u32) {
        while self.mail.waits(unit) {
            if let Some(free) = self.blocked(unit) {
                self.wake(unit, free);
                return;
            }
            let Some(d) = self.mail.take(unit) else { return };
            self.release(unit, self.now, d.record, Some(d.letter));
        }
    }

    /// Until when a unit may not be released; `None` when it may now, [`Time::MAX`] when that is not known
    /// yet.
    pub(super) fn blocked(&self, unit: u32) -> Option<Time> {
        if self.is_pending(unit) {
            return Some(Time::MAX);
        }
        let (clock, info) = (&self.clocks[unit as usize], &self.cast.units[unit as usize]);
        let gap = self.earliest(unit);
        // A unit that takes its time is busy from its release on.
        let alone = info.worst > Time::ZERO && self.core_of(unit).is_none();
        let running = clock.last.filter(|_| alone).map_or(Time::ZERO, |t| t + info.worst);
        let free = gap.max(clock.busy).max(running);
        (free > self.now).then_some(free)
    }

    pub(super) fn wake(&mut self, unit: u32, at: Time) {
        let clock = &mut self.clocks[unit as usize];
        if !clock.waiting {
            clock.waiting = true;
            // A job on a core wakes it when it is done.
            if at < Time::MAX {
                self.queue.put(at, Scheduled::Wake(unit));
            }
        }
    }

    /// A unit is to be released, now or as soon as it may. Of several releases that wait, one remains; a
    /// periodic unit that is still running is skipped.
    pub(super) fn admit(&mut self, unit: u32, cause: Option<u64>) {
        self.admit_since(unit, self.now, cause);
    }

    /// As [`Engine::admit`], for one that was to be released at `release`.
    pub(super) fn admit_since(&mut self, unit: u32, release: Time, cause: Option<u64>) {
        if !self.lives.is_on(unit) {
            return;
        }
        let Some(free) = self.blocked(unit) else {
            self.release(unit, release, cause, None);
            return;
        };
        if self.cast.units[unit as usize].period.is_some() {
            self.trace_overrun(unit, cause);
            return;
        }
        let due = self.clocks[unit as usize].due.is_some();
        // What comes too soon is released when it may: its deadline counts from then.
        let gap = self.earliest(unit);
        self.clocks[unit as usize].due.get_or_insert(Due { release: release.max(gap), cause });
        if !due && gap > self.now {
            self.trace_deferral(unit, gap, cause);
        }
        self.wake(unit, free);
    }

    /// When the least distance of its releases is over.
    pub(super) fn earliest(&self, unit: u32) -> Time {
        let info = &self.cast.units[unit as usize];
        let last = self.clocks[unit as usize].last.filter(|_| info.gap > Time::ZERO);
        last.map_or(Time::ZERO, |t| t + info.gap)
    }

    pub(super) fn trace_deferral(&mut self, unit: u32, until: Time, cause: Option<u64>) {
        if self.recorder.on() {
            let (agent, name) = self.names(unit);
            let robot = self.cast.instances[self.cast.units[unit as usize].instance as usize].robot;
            self.recorder.record(self.now, cause, || Event::Deferral { robot, agent, unit: name, until });
        }
    }

    pub(super) fn trace_overrun(&mut self, unit: u32, cause: Option<u64>) {
        if !self.recorder.on() {
            return;
        }
        let (agent, name) = self.names(unit);
        let robot = self.cast.instances[self.cast.units[unit as usize].instance as usize].robot;
        let now = self.now;
        self.recorder.record(now, cause, || Event::Activation {
            robot,
            agent,
            unit: name,
            release: now,
            start: now,
            finish: Some(now),
            skipped: Some("the activation before it is still running".into()),
        });
    }

    pub(super) fn release(
        &mut self,
        unit: u32,
        release: Time,
        cause: Option<u64>,
        letter: Option<std::sync::Arc<super::post::Letter>>,
    ) {
        if !self.lives.is_on(unit) {
            return;
        }
        let instance = self.cast.units[unit as usize].instance;
        if self.lives.floods(instance, self.now) {
            let why = format!("it floods: more than {FLOOD} activations within 100 ms");
            self.kill(instance, &why, cause);
            return;
        }
        self.clocks[unit as usize].last = Some(self.now);
        let release = Release { unit, release, start: self.now, cause, letter, finish: None };
        match self.core_of(unit) {
            Some(core) => self.enqueue(core, release),
            None => self.releases.push(release),
        }
    }
}
