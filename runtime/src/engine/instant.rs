//! One instant after the other.

use super::{
    Engine, Outcome,
    activate::Release,
    env::Instant,
    judge::{Court, Occasion},
    queue::Scheduled,
    report::{INTERRUPTED, OVER, RunReport},
};
use crate::{Event, Reading, Report, Time, objects::Frame};
use std::sync::{Arc, atomic::Ordering};

/// The fewest activations at one instant that are too many.
const TOO_MANY: usize = 1_000_000;

/// Who subscribes to a parameter hears of a change after this time.
const HEARD: Time = Time(1_000);

/// Nothing happens for longer than this only where it is asked whether the run is to stop.
const IDLE: Time = Time(60_000_000_000);

/// How a run ends.
pub(super) struct End {
    pub outcome: Outcome,
    pub reason: String,
}

impl Engine<'_> {
    /// Runs to the end.
    pub fn run(mut self) -> RunReport {
        if !self.resumed {
            self.open_planner();
        }
        self.operator.begin(self.now);
        let end = loop {
            // The instant of a snapshot is over.
            if !std::mem::take(&mut self.resumed) {
                if let Some(end) = self.instant() {
                    break end;
                }
                if self.stop.load(Ordering::Relaxed) || self.operator.stopped() {
                    break End { outcome: Outcome::Aborted, reason: INTERRUPTED.into() };
                }
            }
            let Some(next) = self.next() else {
                break End { outcome: Outcome::Failed, reason: "nothing is left to happen".into() };
            };
            if next > self.now {
                self.snapshot();
                let Some(next) = self.pace(next).filter(|t| self.idle(*t)) else {
                    break End { outcome: Outcome::Aborted, reason: INTERRUPTED.into() };
                };
                self.events = 0;
                self.now = next;
            }
        };
        self.finish(end)
    }

    /// Lets time pass on the way to a far instant; false when the operator stops the run meanwhile.
    fn idle(&mut self, to: Time) -> bool {
        let mut t = self.now;
        while to - t > IDLE {
            t = t + IDLE;
            self.platform.advance(t);
            if self.stop.load(Ordering::Relaxed) {
                return false;
            }
        }
        true
    }

    /// The next instant.
    fn next(&self) -> Option<Time> {
        let all = [self.platform.next_due(), self.queue.next(), self.actuators.next()];
        let next = all.into_iter().flatten().filter(|t| *t < Time::MAX).min()?;
        Some(self.limit.map_or(next, |l| l.min(next)))
    }

    /// Everything that happens at this instant.
    fn instant(&mut self) -> Option<End> {
        self.events += 1;
        let limit = self.most_events();
        if self.events > limit && self.aborted.is_none() {
            let text = format!("something is due more than {limit} times at one instant");
            self.fail(None, "platform", text, None);
        }
        self.poll();
        self.operate_all();
        self.arrive();
        self.activate_all();
        self.tidy_store();
        self.forget_talks();
        self.decide();
        self.judge_instant()
    }

    /// The most activations and polls at one instant.
    fn most_events(&self) -> usize {
        TOO_MANY.max(100 * self.cast.units.len())
    }

    /// Takes what the platform hands over.
    fn poll(&mut self) {
        let before = self.polled;
        let mut readings = std::mem::take(&mut self.readings);
        let mut reports = std::mem::take(&mut self.reports);
        readings.clear();
        reports.clear();
        self.platform.poll(self.now, &mut readings, &mut reports);
        self.contacts_begin_and_end(&reports, before);
        for report in &reports {
            match report {
                Report::Lost { robot, reason, .. } => {
                    let text = format!("{}{reason}", super::report::LOST);
                    self.fail(Some(*robot), super::report::PLATFORM, text, None);
                }
                Report::Over { .. } => self.over = true,
                Report::ContactBegin { .. } | Report::ContactEnd { .. } => {}
            }
        }
        self.trace_poses();
        for r in &readings.items {
            let registers = readings.registers.get(r.from as usize..r.to as usize).unwrap_or_default();
            let number;
            let (registers, record) = match r.image.and_then(|i| readings.images.get(i as usize)) {
                Some(image) => {
                    number = [self.store.deliver(Arc::clone(image) as _)];
                    (number.as_slice(), self.trace_image(r, image))
                }
                None => {
                    let record = self.recorder.record(self.now, None, || Event::Reading {
                        robot: r.robot,
                        sensor: r.sensor,
                        captured: r.captured,
                        registers: registers.to_vec(),
                    });
                    (registers, record)
                }
            };
            let altered;
            let registers = if self.troubles_sensors() {
                let Some(left) = self.troubled(r.robot, r.sensor, registers, record) else { continue };
                altered = left;
                altered.as_slice()
            } else {
                registers
            };
            if self.senses.take(r, registers, record.unwrap_or(0))
                && let Some(units) = self.on_reading.get(&(r.robot, r.sensor))
            {
                for u in units.clone() {
                    self.admit(u, record);
                }
            }
        }
        self.readings = readings;
        self.reports = reports;
    }

    fn trace_image(&mut self, r: &Reading, image: &Frame) -> Option<u64> {
        self.recorder.record(self.now, None, || Event::Image {
            robot: r.robot,
            sensor: r.sensor,
            captured: r.captured,
            width: image.width,
            height: image.height,
            digest: format!("{:016x}", image.digest),
            view: image.view.clone(),
        })
    }

    /// Counts contacts and judges what asks for them, at the instants at which they began.
    fn contacts_begin_and_end(&mut self, reports: &[Report], before: Time) {
        let mut began: Option<Time> = None;
        for report in reports {
            let (at, robot, other, with, begin) = match report {
                Report::ContactBegin { at, robot, other, with } => (*at, *robot, *other, with, true),
                Report::ContactEnd { at, robot, other, with } => (*at, *robot, *other, with, false),
                Report::Lost { .. } | Report::Over { .. } => continue,
            };
            let at = at.max(before).min(self.now);
            if let Some(t) = began
                && at > t
            {
                self.judge_contact(t);
                began = None;
            }
            self.recorder.record(at, None, || Event::Contact { robot, other, with: with.clone(), begin });
            if begin {
                self.contacts.begin(at, robot, other, with);
                began = Some(at);
            } else {
                self.contacts.end(robot, other);
            }
        }
        if let Some(t) = began {
            self.judge_contact(t);
        }
        self.polled = self.now;
    }

    /// Records poses that have changed.
    fn trace_poses(&mut self) {
        if !self.recorder.on() {
            return;
        }
        let Some(truth) = self.platform.truth() else { return };
        for (r, last) in self.poses.iter_mut().enumerate() {
            let robot = r as u32;
            let now = (truth.pose(robot), truth.path_length(robot));
            if *last != Some(now) {
                *last = Some(now);
                let (pose, path_m) = now;
                self.recorder.record(self.now, None, || Event::Pose { robot, pose, path_m });
            }
        }
        for (name, pose) in truth.movers() {
            if self.movers.get(&name) != Some(&pose) {
                self.movers.insert(name.clone(), pose);
                self.recorder.record(self.now, None, || Event::Mover { name, pose });
            }
        }
    }

    /// Delivers what was put off until now, and releases periodic units.
    fn arrive(&mut self) {
        let now = self.now;
        let mut mailboxes = std::mem::take(&mut self.arriving);
        while let Some(what) = self.queue.take(now) {
            match what {
                Scheduled::Outputs { unit, record, log } => {
                    self.apply_all(unit, &log.items, &log, record);
                }
                Scheduled::Deliver { letter, to } => {
                    for unit in to {
                        let record = self.delivered(unit, &letter);
                        self.put_letter(unit, letter.clone(), record);
                        mailboxes.push(unit);
                    }
                }
                Scheduled::Hand { letter, to } => {
                    let record = self.delivered(to, &letter);
                    self.put_letter(to, letter, record);
                    mailboxes.push(to);
                }
                Scheduled::DeviceFree { device, by } => self.device_free(device, by),
                Scheduled::Utter(u) => self.hear(u),
                Scheduled::Notice(notice) => self.notice(*notice),
                Scheduled::Kill(instance) => self.kill(instance, "killed by a declared fault", None),
                Scheduled::Heard(unit) => self.admit(unit, None),
                Scheduled::Post(goal) => self.post_goal(&goal),
                Scheduled::Publish { unit, topic, registers, record } => {
                    self.publish(unit, topic, &registers, record);
                }
                Scheduled::PeerGone { branch, side, record } => self.peer_gone(branch, side, record),
                Scheduled::Patience { branch, by, entry } => self.patience(branch, by, entry),
                Scheduled::Late { unit, release } => self.admit_since(unit, release, None),
                Scheduled::Core { core, version } => self.core_due(core, version),
                Scheduled::Deadline { unit, release } => self.deadline_due(unit, release),
                Scheduled::Wake(unit) => {
                    self.clocks[unit as usize].waiting = false;
                    if self.clocks[unit as usize].due.is_some()
                        && let Some(free) = self.blocked(unit)
                    {
                        self.wake(unit, free);
                    } else if let Some(due) = self.clocks[unit as usize].due.take() {
                        self.release(unit, due.release, due.cause, None);
                    }
                    if self.mail.waits(unit) {
                        mailboxes.push(unit);
                    }
                }
            }
        }
        mailboxes.sort_unstable();
        mailboxes.dedup();
        for &unit in &mailboxes {
            self.open_mailbox(unit);
        }
        mailboxes.clear();
        let mut due = mailboxes;
        self.queue.tick(now, |unit| due.push(unit));
        for &unit in &due {
            match self.jitter(unit) {
                Time::ZERO => self.admit(unit, None),
                late => self.queue.put(now + late, Scheduled::Late { unit, release: now }),
            }
        }
        due.clear();
        self.arriving = due;
    }

    /// Makes boards and places ready for units of some robots that hear topics.
    pub(super) fn prepare(&mut self, topics: impl Iterator<Item = u32>, robots: impl Iterator<Item = u32>) {
        let mut placed = false;
        for t in topics {
            if let Some(board) = self.boards.get_mut(t as usize) {
                placed |= board.placed();
                board.prepare(self.now);
            }
        }
        if placed && let Some(truth) = self.platform.truth() {
            for r in robots {
                if let Some(place) = self.places.get_mut(r as usize) {
                    *place = truth.position(r);
                }
            }
        }
    }

    /// Evaluates released units in waves: what one wave raises makes the next.
    fn activate_all(&mut self) {
        loop {
            if !self.touched.is_empty() {
                self.dispatch();
            }
            if self.releases.is_empty() || self.aborted.is_some() {
                return;
            }
            let mut releases = std::mem::take(&mut self.releases);
            let limit = self.most_events();
            self.events += releases.len();
            if self.events > limit {
                let text = format!("more than {limit} activations at one instant");
                let (agent, _) = self.names(releases[0].unit);
                let robot = self.cast.units[releases[0].unit as usize].instance;
                let robot = self.cast.instances[robot as usize].robot;
                self.fail(Some(robot), &agent, text, None);
                return;
            }
            let order = |r: &Release| (std::cmp::Reverse(self.cast.units[r.unit as usize].priority), r.unit);
            if !releases.is_sorted_by_key(order) {
                releases.sort_by_key(order);
            }
            self.prepare_wave(&releases);
            let mut workers = std::mem::take(&mut self.workers);
            let mut outcomes = std::mem::take(&mut self.outcomes);
            let instant = Instant {
                mission: self.mission,
                scene: self.scene,
                cast: &self.cast,
                senses: &self.senses,
                boards: &self.boards,
                regions: &self.regions,
                params: &self.params,
                texts: &self.texts,
                directory: &self.directory,
                store: &self.store,
                places: &self.places,
                now: self.now,
                seed: self.seed,
                trace: self.recorder.on(),
                threads: workers.threads(),
            };
            workers.evaluate(&instant, &mut self.minds, &releases, &mut outcomes);
            for desk in &mut workers.desks {
                self.store.commit(desk.log.made.drain(..));
            }
            // Who died before is not among those who were evaluated.
            self.reset.clear();
            for (release, outcome) in releases.iter().zip(&mut outcomes) {
                if let Some(desk) = workers.desks.get(outcome.log as usize) {
                    self.commit(release, outcome, &desk.log);
                }
            }
            self.reset.clear();
            let new = std::mem::take(&mut self.new_params);
            for (param, registers) in &new {
                if let Some(range) = self.mission.params.range(*param as usize)
                    && let Some(slot) = self.params.get_mut(range)
                    && slot.len() == registers.len()
                {
                    slot.copy_from_slice(registers);
                }
            }
            if !new.is_empty() {
                let set: Vec<u32> = new.into_iter().map(|(param, _)| param).collect();
                self.params_set(&set, None);
            }
            self.workers = workers;
            self.outcomes = outcomes;
            if self.releases.is_empty() {
                releases.clear();
                self.releases = releases;
            }
        }
    }

    /// These parameters have been set: who subscribes to them hears of it, and other plans may hold.
    pub(super) fn params_set(&mut self, params: &[u32], cause: Option<u64>) {
        let mut heard: Vec<u32> =
            params.iter().filter_map(|p| self.on_param.get(p)).flatten().copied().collect();
        heard.sort_unstable();
        heard.dedup();
        for unit in heard {
            self.queue.put(self.now + HEARD, Scheduled::Heard(unit));
        }
        self.params_changed(cause);
    }

    fn prepare_wave(&mut self, releases: &[Release]) {
        if self.boards.is_empty() {
            return;
        }
        let mission = self.mission;
        let mut topics: Vec<u32> = Vec::new();
        let mut robots: Vec<u32> = Vec::new();
        let mut before: &[u32] = &[];
        for r in releases {
            let info = &self.cast.units[r.unit as usize];
            let who = &self.cast.instances[info.instance as usize];
            let hears = &mission.agents[who.agent as usize].units[info.unit as usize].hears;
            if hears.is_empty() {
                continue;
            }
            if !std::ptr::eq(before, hears.as_slice()) {
                topics.extend(hears);
                before = hears;
            }
            if robots.last() != Some(&who.robot) {
                robots.push(who.robot);
            }
        }
        topics.sort_unstable();
        topics.dedup();
        self.prepare(topics.into_iter(), robots.into_iter());
    }

    /// Judges what asks for contacts at the instant at which one began.
    fn judge_contact(&mut self, at: Time) {
        if self.mission.judge.expects.iter().any(|e| e.contacts) {
            self.judge_expectations(at, Occasion::Contact);
        }
        self.contacts.judged();
    }

    /// Judges expectations; a fault ends the run.
    pub(super) fn judge_expectations(&mut self, at: Time, occasion: Occasion) {
        let mut judge = std::mem::take(&mut self.judge);
        let result = judge.judge(&mut self.court(at), occasion);
        for (index, watch) in judge.watches.iter_mut().enumerate() {
            for (track, t) in watch.decided.drain(..) {
                let each = self.mission.judge.expects[index].each_robot;
                let track_ = &watch.tracks[track as usize];
                let (held, margin) = (track_.held == Some(true), track_.margin());
                self.recorder.record(t, None, || Event::Expectation {
                    index: index as u32,
                    robot: each.then_some(track),
                    held,
                    margin,
                });
            }
        }
        self.judge = judge;
        if let Err(fault) = result {
            self.fault(None, "expectation", &fault, None);
        }
    }

    /// What conditions of the mission are about.
    pub(super) fn court(&self, now: Time) -> Court<'_> {
        Court {
            mission: self.mission,
            scene: self.scene,
            cast: &self.cast,
            states: &self.minds.states,
            tallies: &self.tallies,
            params: &self.params,
            truth: self.platform.truth(),
            contacts: &self.contacts,
            goals: &self.goals,
            regions: &self.regions,
            store: &self.store,
            made: Vec::new(),
            now,
            robot: None,
        }
    }

    /// Goals, expectations, the done condition and the time limit; and whether something ends the run.
    fn judge_instant(&mut self) -> Option<End> {
        let now = self.now;
        for (goal, status) in self.goals.changes() {
            let name = self.mission.graph.goals[goal].name.to_string();
            let status = status.to_string();
            self.recorder.record(now, None, || Event::Goal { goal: name, robot: None, status, reason: None });
        }
        self.judge_expectations(now, Occasion::Instant);
        let mut frame = std::mem::take(&mut self.judge.frame);
        let mission = self.mission;
        let done = match self.court(now).number(&mission.judge.done, &mut frame) {
            Ok(x) => x != 0.0,
            Err(fault) => {
                // Without world truth a condition about it is never met.
                if self.platform.truth().is_some() {
                    self.fault(None, "done condition", &fault, None);
                }
                false
            }
        };
        self.judge.frame = frame;
        if let Some(error) = &self.recorder.failed {
            let reason = format!("the trace cannot be written: {error}");
            return Some(End { outcome: Outcome::Aborted, reason });
        }
        if let Some(reason) = &self.aborted {
            return Some(End { outcome: Outcome::Aborted, reason: reason.clone() });
        }
        if done {
            return Some(End { outcome: Outcome::Success, reason: "done".into() });
        }
        if self.over {
            return Some(End { outcome: Outcome::Success, reason: OVER.into() });
        }
        if self.limit.is_some_and(|l| now >= l) {
            let reason = format!("not done within {} s", now.seconds());
            return Some(End { outcome: Outcome::Timeout, reason });
        }
        None
    }
}
