//! The recording, read ahead as far as the replay needs to know its inputs.

use crate::{
    Event, Record, Time,
    engine::report::{INTERRUPTED, OVER, PLATFORM},
    ports::{Input, Pacer},
};
use std::{cell::RefCell, collections::VecDeque};

/// A recording, shared between the platform that plays its inputs and the sink that compares.
pub(super) struct Tape<'r>(RefCell<State<'r>>);

struct State<'r> {
    source: Box<dyn Iterator<Item = Record> + 'r>,
    /// Read but not compared.
    ahead: VecDeque<Record>,
    /// Inputs that were read but not played.
    inputs: VecDeque<Record>,
    /// What an operator did, and is still to do again.
    operator: VecDeque<(Time, Input)>,
    /// Time of the last record that was read.
    read: Option<Time>,
    /// When the operator stopped the run.
    interrupted: Option<Time>,
    /// The recording has been read to its end, and whether that is the end of the run.
    over: Option<bool>,
}

impl<'r> Tape<'r> {
    pub fn new(source: impl Iterator<Item = Record> + 'r) -> Self {
        Tape(RefCell::new(State {
            source: Box::new(source),
            ahead: VecDeque::new(),
            inputs: VecDeque::new(),
            operator: VecDeque::new(),
            read: None,
            interrupted: None,
            over: None,
        }))
    }

    /// Reads on until everything up to `now` has been read.
    pub fn pull(&self, now: Time) {
        let mut s = self.0.borrow_mut();
        while s.over.is_none() && s.read.is_none_or(|t| t <= now) {
            s.read_one();
        }
    }

    /// When the next input was taken. A contact was taken with the first other input at or after it.
    pub fn next_input(&self) -> Option<Time> {
        let mut s = self.0.borrow_mut();
        let plain = |r: &Record| !matches!(r.event, Event::Contact { .. });
        loop {
            if let Some(r) = s.inputs.iter().find(|r| plain(r)) {
                return Some(r.t);
            }
            if s.over.is_some() {
                return s.inputs.front().map(|r| r.t);
            }
            s.read_one();
        }
    }

    /// Takes the next input that was taken at `now` or before.
    pub fn input(&self, now: Time) -> Option<Record> {
        let mut s = self.0.borrow_mut();
        if s.inputs.front().is_some_and(|r| r.t <= now) { s.inputs.pop_front() } else { None }
    }

    /// Whether there is a pose among the inputs that were read.
    pub fn has_poses(&self) -> bool {
        self.0.borrow().inputs.iter().any(|r| matches!(r.event, Event::Pose { .. }))
    }

    /// Whether the operator stopped the run at `now`.
    pub fn interrupted(&self, now: Time) -> bool {
        self.0.borrow().interrupted == Some(now)
    }

    /// Takes the next record to compare.
    pub fn next(&self) -> Option<Record> {
        let mut s = self.0.borrow_mut();
        if s.ahead.is_empty() {
            s.read_one();
        }
        s.ahead.pop_front()
    }

    /// The name of the safe action, when that is the next record to compare.
    pub fn safe_action(&self, of: u32) -> Option<String> {
        let mut s = self.0.borrow_mut();
        if s.ahead.is_empty() {
            s.read_one();
        }
        match s.ahead.front().map(|r| &r.event) {
            Some(Event::SafeAction { robot, action, .. }) if *robot == of => Some(action.clone()),
            _ => None,
        }
    }

    /// Whether the recording ended before the run did.
    pub fn cut_off(&self) -> bool {
        self.0.borrow().over == Some(false)
    }
}

/// Whoever operated the recorded run does the same again, at the same instants.
pub(super) struct Again<'t, 'r>(pub &'t Tape<'r>);

impl Pacer for Again<'_, '_> {
    fn pace(&mut self, _: Time, next: Time, inputs: &mut Vec<Input>) -> Time {
        self.0.pull(next);
        let mut s = self.0.0.borrow_mut();
        let Some(at) = s.operator.front().map(|o| o.0).filter(|t| *t <= next) else { return next };
        let together = s.operator.iter().take_while(|o| o.0 == at).count();
        inputs.extend(s.operator.drain(..together).map(|o| o.1));
        at
    }
}

impl State<'_> {
    fn read_one(&mut self) {
        if self.over.is_some() {
            return;
        }
        let Some(r) = self.source.next() else {
            let last = self.ahead.back().map(|r| &r.event);
            self.over = Some(matches!(last, Some(Event::End { .. })));
            return;
        };
        self.read = Some(r.t);
        let input = match &r.event {
            Event::Reading { .. }
            | Event::Image { .. }
            | Event::Pose { .. }
            | Event::Mover { .. }
            | Event::Contact { .. } => true,
            Event::Fault { agent, .. } => agent == PLATFORM,
            Event::SafeAction { reason, .. } if reason == OVER => true,
            Event::SafeAction { reason, .. } | Event::End { reason, .. } if reason == INTERRUPTED => {
                self.interrupted = Some(r.t);
                false
            }
            _ => false,
        };
        if let Some(input) = Input::of(&r.event) {
            self.operator.push_back((r.t, input));
        }
        if input {
            self.inputs.push_back(r.clone());
        }
        let ended = matches!(r.event, Event::End { .. });
        self.ahead.push_back(r);
        if ended {
            self.over = Some(true);
        }
    }
}
