//! Virtual cores: units with a core are executed by preemptive fixed priorities, and what they do appears
//! when they are done.
//!
//! Of the jobs of a core the one with the highest priority runs; of equals the one declared first. A unit
//! evaluates its statements when it gets the core for the first time, and is charged its execution time from
//! then on. A job that holds a shared resource, which it does at the beginning of its execution, runs at the
//! resource's ceiling. An anytime service is charged its worst case and then round by round; when its budget
//! or its deadline has come, it answers with the rounds that were paid for.

use super::{
    Engine,
    activate::{Finish, Outcome, Release},
    cast::Rank,
    log::Log,
    post::Letter,
    queue::Scheduled,
};
use crate::{Event, Time, seed::Stream};
use serde::{Deserialize, Serialize};
use soifra_graph::{Distribution, Misses};
use std::{cmp::Reverse, sync::Arc};

/// A released unit that is not done yet.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Job {
    pub unit: u32,
    pub release: Time,
    cause: Option<u64>,
    letter: Option<Arc<Letter>>,
    /// When it got the core first.
    started: Option<Time>,
    /// Execution so far, and in all; unknown before it has started.
    done: Time,
    need: Option<Time>,
    /// Of it, what has to be done before the first round of an anytime service.
    mandatory: Time,
    /// Its activation.
    record: Option<u64>,
    /// What it will do.
    log: Log,
    /// An anytime service, begun.
    anytime: Option<Anytime>,
}

/// Where an anytime service waits for its time to be over.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Anytime {
    /// Its frame, with the first value.
    pub frame: Vec<f64>,
    /// The most rounds it makes use of.
    pub rounds: u32,
}

/// A core.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct CoreState {
    /// Jobs, in order of their release.
    jobs: Vec<Job>,
    /// Unit of the running job, and since when it has been running.
    running: Option<u32>,
    since: Time,
    /// Numbers the instants at which something is to be decided, so that outdated ones are passed over.
    version: u64,
    /// Who the trace says is running.
    traced: Option<u32>,
}

/// What is known of the executions of a unit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Tally {
    /// Activations that were not skipped.
    pub activations: u64,
    /// Deadlines missed.
    pub misses: u64,
    /// Of them, those since it was on time last.
    pub in_a_row: u32,
    /// Longest time from release to completion.
    pub response: Time,
    /// Words drawn for execution times and jitter.
    drawn: u64,
}

impl CoreState {
    fn position(&self, unit: u32) -> Option<usize> {
        self.jobs.iter().position(|j| j.unit == unit)
    }

    /// Charges the running job what it has had since it was looked at last.
    fn charge(&mut self, now: Time) {
        if let Some(job) = self.running.and_then(|u| self.position(u)).and_then(|i| self.jobs.get_mut(i)) {
            job.done = job.done + (now - self.since);
        }
        self.since = now;
    }

    /// Drops the job of a unit; whether it had one.
    pub fn drop_unit(&mut self, unit: u32, now: Time) -> bool {
        self.charge(now);
        let Some(i) = self.position(unit) else { return false };
        self.jobs.remove(i);
        if self.running == Some(unit) {
            self.running = None;
        }
        true
    }

    /// Registers that its jobs work with or have yet to hand out.
    pub fn registers(&self) -> impl Iterator<Item = &[f64]> {
        self.jobs.iter().flat_map(|j| {
            let letter = j.letter.iter().map(|l| l.registers.as_slice());
            letter.chain([j.log.registers.as_slice()]).chain(j.anytime.iter().map(|a| a.frame.as_slice()))
        })
    }

    /// Whether a snapshot of it can be one of this core.
    pub fn fits(&self, units: usize) -> bool {
        self.jobs
            .iter()
            .all(|j| (j.unit as usize) < units && j.log.items.iter().all(super::log::Item::is_output))
    }
}

impl Engine<'_> {
    /// Core of a unit.
    pub(super) fn core_of(&self, unit: u32) -> Option<u32> {
        let work = self.cast.units[unit as usize].work?;
        self.cast.works[work as usize].core
    }

    /// Whether a unit has a job on its core.
    pub(super) fn is_pending(&self, unit: u32) -> bool {
        self.core_of(unit).is_some_and(|c| self.cores[c as usize].position(unit).is_some())
    }

    /// A released unit asks for its core.
    pub(super) fn enqueue(&mut self, core: u32, release: Release) {
        let Release { unit, release, cause, letter, .. } = release;
        let deadline = self.cast.units[unit as usize].deadline;
        if deadline < Time::MAX {
            self.queue.put((release + deadline).max(self.now), Scheduled::Deadline { unit, release });
        }
        self.cores[core as usize].jobs.push(Job {
            unit,
            release,
            cause,
            letter,
            started: None,
            done: Time::ZERO,
            need: None,
            mandatory: Time::ZERO,
            record: None,
            log: Log::default(),
            anytime: None,
        });
        self.touched.push(core);
    }

    /// Gives each core that something happened to, to its most urgent job. Jobs that begin are released.
    pub(super) fn dispatch(&mut self) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        for &c in &touched {
            self.cores[c as usize].charge(self.now);
            let next = (0..self.cores[c as usize].jobs.len()).min_by_key(|&i| self.rank(c, i));
            let core = &mut self.cores[c as usize];
            core.version += 1;
            core.running = next.map(|i| core.jobs[i].unit);
            let Some(job) = next.and_then(|i| core.jobs.get_mut(i)) else {
                self.trace_switch(c, None);
                continue;
            };
            let unit = job.unit;
            match job.need {
                None => {
                    job.started = Some(self.now);
                    self.releases.push(Release {
                        unit,
                        release: job.release,
                        start: self.now,
                        cause: job.cause,
                        letter: job.letter.take(),
                        finish: None,
                    });
                }
                Some(need) => {
                    let (left, done) = (need - job.done, job.done);
                    let until = self.section_end(unit, done).map_or(left, |end| left.min(end - done));
                    let at = self.now + until.max(Time::ZERO);
                    let version = self.cores[c as usize].version;
                    self.queue.put(at, Scheduled::Core { core: c, version });
                }
            }
            self.trace_switch(c, Some(unit));
        }
        touched.clear();
        if self.touched.is_empty() {
            self.touched = touched;
        }
    }

    /// Rank of a job: its own, or the ceiling of what it holds.
    fn rank(&self, core: u32, job: usize) -> Rank {
        let job = &self.cores[core as usize].jobs[job];
        let info = &self.cast.units[job.unit as usize];
        let own = (Reverse(info.priority), job.unit);
        let Some(work) = info.work.map(|w| &self.cast.works[w as usize]) else { return own };
        let mut end = Time::ZERO;
        for (ceiling, time) in &work.sections {
            end = end + *time;
            if job.started.is_some() && job.done < end {
                // Whose rank is the ceiling came later, and the first of equals goes on.
                return own.min(*ceiling);
            }
        }
        own
    }

    /// When the section that a job is in ends, counted in its execution.
    fn section_end(&self, unit: u32, done: Time) -> Option<Time> {
        let work = self.cast.units[unit as usize].work?;
        let mut end = Time::ZERO;
        for (_, time) in &self.cast.works[work as usize].sections {
            end = end + *time;
            if done < end {
                return Some(end);
            }
        }
        None
    }

    /// The instant at which a core wanted to be looked at.
    pub(super) fn core_due(&mut self, core: u32, version: u64) {
        let Some(state) = self.cores.get_mut(core as usize).filter(|c| c.version == version) else { return };
        state.charge(self.now);
        self.touched.push(core);
        if let Some(i) = state.running.and_then(|u| state.position(u))
            && state.jobs[i].need.is_some_and(|n| state.jobs[i].done >= n)
        {
            self.complete(core, i);
        }
    }

    /// A deadline has come.
    pub(super) fn deadline_due(&mut self, unit: u32, release: Time) {
        let Some(c) = self.core_of(unit) else { return };
        let core = &mut self.cores[c as usize];
        core.charge(self.now);
        let Some(i) = core.position(unit).filter(|&i| core.jobs[i].release == release) else { return };
        let job = &mut core.jobs[i];
        if job.need.is_some_and(|n| job.done >= n) {
            return;
        }
        self.touched.push(c);
        if job.anytime.is_some() {
            // Time is over: it answers with what was paid for, when that is an answer at all.
            job.need = Some(job.mandatory.max(job.done));
            if job.done >= job.mandatory {
                self.complete(c, i);
                return;
            }
        }
        let (cause, deadline) = (job.record.or(job.cause), self.now);
        self.missed(unit, release, deadline, cause);
    }

    /// A unit is late.
    pub(super) fn missed(&mut self, unit: u32, release: Time, deadline: Time, cause: Option<u64>) {
        let (agent, name) = self.names(unit);
        let info = self.cast.units[unit as usize];
        let robot = self.cast.instances[info.instance as usize].robot;
        let tally = &mut self.tallies[unit as usize];
        tally.misses += 1;
        tally.in_a_row += 1;
        let in_a_row = tally.in_a_row;
        let record = self.recorder.record(self.now, cause, || Event::Miss {
            robot,
            agent: agent.clone(),
            unit: name.clone(),
            release,
            deadline,
        });
        let misses = info.work.map_or(Misses::Soft, |w| self.cast.works[w as usize].misses);
        if let Misses::AtMost(n) = misses
            && in_a_row > n
        {
            let text = format!("{name} has missed {in_a_row} deadlines in a row");
            self.unit_fails(unit, text, record);
        }
    }

    /// A unit is done: counted, and on time when it was.
    pub(super) fn done(&mut self, unit: u32, release: Time, finish: Time) {
        let deadline = self.cast.units[unit as usize].deadline;
        let tally = &mut self.tallies[unit as usize];
        tally.response = tally.response.max(finish - release);
        if finish - release <= deadline {
            tally.in_a_row = 0;
        }
    }

    /// A job is done: what it did appears.
    fn complete(&mut self, core: u32, index: usize) {
        let job = self.cores[core as usize].jobs.remove(index);
        let unit = job.unit;
        if self.cores[core as usize].running == Some(unit) {
            self.cores[core as usize].running = None;
        }
        self.done(unit, job.release, self.now);
        let cost =
            self.cast.units[unit as usize].work.map_or(Time::ZERO, |w| self.cast.works[w as usize].cost);
        let rounds = job.anytime.as_ref().map(|a| {
            let paid = if cost > Time::ZERO { (job.done - job.mandatory).0 / cost.0 } else { 0 };
            a.rounds.min(u32::try_from(paid.max(0)).unwrap_or(u32::MAX))
        });
        let (agent, name) = self.names(unit);
        let robot = self.cast.cores[core as usize].robot;
        let record = self.recorder.record(self.now, job.record, || Event::Completion {
            robot,
            agent,
            unit: name,
            release: job.release,
            start: job.started.unwrap_or(self.now),
            rounds,
        });
        self.apply_all(unit, &job.log.items, &job.log, record);
        if let Some(a) = job.anytime {
            self.releases.push(Release {
                unit,
                release: job.release,
                start: self.now,
                cause: record,
                letter: None,
                finish: Some(Finish { frame: a.frame, rounds: rounds.unwrap_or(0) }),
            });
        }
        self.free(unit);
    }

    /// A unit has no job any more: what waited for that may be released.
    fn free(&mut self, unit: u32) {
        if self.clocks[unit as usize].waiting {
            self.queue.put(self.now, Scheduled::Wake(unit));
        }
    }

    /// A job has been evaluated for the first time, or was skipped.
    pub(super) fn begun(
        &mut self,
        core: u32,
        unit: u32,
        outcome: &mut Outcome,
        record: Option<u64>,
        log: Log,
    ) {
        let worst = self.execution_time(unit);
        let work = self.cast.units[unit as usize].work.map(|w| &self.cast.works[w as usize]);
        let cost = work.map_or(Time::ZERO, |w| w.cost);
        let deadline = self.cast.units[unit as usize].deadline;
        let state = &mut self.cores[core as usize];
        let Some(i) = state.position(unit) else { return };
        self.touched.push(core);
        if outcome.absent.is_some() {
            state.jobs.remove(i);
            state.running = None;
            self.free(unit);
            return;
        }
        let job = &mut state.jobs[i];
        job.record = record;
        job.log = log;
        job.mandatory = worst;
        job.anytime = outcome.anytime.take().map(|a| *a);
        // What begins after its deadline has no time for rounds.
        let in_time = self.now - job.release < deadline;
        let rounds = job.anytime.as_ref().filter(|_| in_time).map_or(0, |a| i64::from(a.rounds));
        job.need = Some(worst + Time(cost.0.saturating_mul(rounds)));
    }

    /// How long an activation of a unit takes: its worst case, or what is drawn.
    pub(super) fn execution_time(&mut self, unit: u32) -> Time {
        let info = self.cast.units[unit as usize];
        let takes = info.work.and_then(|w| self.cast.works[w as usize].takes);
        match takes {
            Some(d) => self.draw_time(unit, d).clamp(Time::ZERO, info.worst),
            None => info.worst,
        }
    }

    /// How much later than its period says a unit is released.
    pub(super) fn jitter(&mut self, unit: u32) -> Time {
        let work = self.cast.units[unit as usize].work;
        match work.map(|w| self.cast.works[w as usize].jitter) {
            Some(j) if j > Time::ZERO => {
                self.draw_time(unit, Distribution::Uniform(0.0, j.seconds())).clamp(Time::ZERO, j)
            }
            _ => Time::ZERO,
        }
    }

    fn draw_time(&mut self, unit: u32, from: Distribution) -> Time {
        let Some(work) = self.cast.units[unit as usize].work else { return Time::ZERO };
        let tally = &mut self.tallies[unit as usize];
        let mut stream = Stream::at(self.seed, self.cast.works[work as usize].stream, tally.drawn);
        let s = stream.draw(from);
        tally.drawn = stream.position();
        Time::from_seconds(s).unwrap_or(Time::ZERO)
    }

    fn trace_switch(&mut self, core: u32, unit: Option<u32>) {
        if !self.recorder.on() || self.cores[core as usize].traced == unit {
            return;
        }
        let info = self.cast.cores[core as usize];
        let Some(number) = info.number else { return };
        self.cores[core as usize].traced = unit;
        let names = unit.map(|u| self.names(u));
        let (agent, unit) = names.map_or((None, None), |(a, u)| (Some(a), Some(u)));
        self.recorder.record(self.now, None, || Event::Switch {
            robot: info.robot,
            core: number,
            agent,
            unit,
        });
    }
}
