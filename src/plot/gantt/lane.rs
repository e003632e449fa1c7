//! One lane of a schedule: what a unit did, or who used a device.

use super::window::Window;
use soifra_runtime::Time;
use std::collections::BTreeSet;

/// What a unit or device did in the stretch of time that is shown. What is too near to something of the same
/// kind to be told apart is left out.
#[derive(Debug, Default)]
pub(super) struct Lane {
    pub robot: u32,
    pub name: String,
    pub kind: Kind,
    /// Whether it ever ran, also outside the stretch.
    pub ran: bool,
    /// From when to when it ran.
    pub bars: Vec<Bar>,
    /// From release to completion.
    pub pending: Vec<(Time, Time)>,
    pub releases: BTreeSet<Time>,
    pub skips: Vec<Time>,
    pub completions: Vec<Time>,
    /// Deadlines that were missed.
    pub misses: Vec<Time>,
    /// When it was asked for too soon, and until when it had to wait.
    pub deferrals: Vec<(Time, Time)>,
    /// So many waited for a device from then on.
    pub waiting: Vec<(Time, u32)>,
    /// Release of what is not done yet.
    pub open: Option<Time>,
}

/// A stretch of running.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    pub from: Time,
    pub to: Time,
    /// Who used the device.
    pub text: String,
}

/// What a lane is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A unit on a core.
    Core(u32),
    /// A unit without a core, as far as is known.
    #[default]
    NoCore,
    Device,
}

impl Lane {
    pub(super) fn bar(&mut self, window: &mut Window, from: Time, to: Time, text: &str) {
        self.ran = true;
        if from >= to || !window.meets(from, to) {
            return;
        }
        window.note(from);
        let grain = window.grain();
        match self.bars.last_mut() {
            Some(last) if last.text == text && from >= last.from && from <= last.to + grain => {
                last.to = last.to.max(to);
            }
            // Of users that change too fast to be seen the first stands for all.
            Some(last) if to - last.from < grain => {}
            _ => self.bars.push(Bar { from, to, text: text.to_string() }),
        }
        window.end_when_full(to, 0, self.bars.len());
    }

    pub(super) fn release(&mut self, window: &mut Window, t: Time) {
        if !window.meets(t, t) || self.releases.contains(&t) {
            return;
        }
        window.note(t);
        let grain = window.grain();
        if grain > Time(1) && self.releases.range(t - grain..=t + grain).next().is_some() {
            return;
        }
        self.releases.insert(t);
        window.end_when_full(t, self.releases.len(), 0);
    }

    /// It is done, and was released at `release`.
    pub(super) fn complete(&mut self, window: &mut Window, release: Time, t: Time) {
        self.release(window, release);
        self.wait(window, release, t);
        if self.open == Some(release) {
            self.open = None;
        }
        instant(&mut self.completions, window, t);
    }

    /// It has been released, and was not done until `t`.
    pub(super) fn wait(&mut self, window: &mut Window, release: Time, t: Time) {
        if release >= t || !window.meets(release, t) {
            return;
        }
        match self.pending.last_mut() {
            Some((from, to)) if release >= *from && release <= *to + window.grain() => *to = (*to).max(t),
            _ => self.pending.push((release, t)),
        }
    }

    pub(super) fn skip(&mut self, window: &mut Window, t: Time) {
        self.release(window, t);
        instant(&mut self.skips, window, t);
    }

    pub(super) fn miss(&mut self, window: &mut Window, release: Time, deadline: Time) {
        self.release(window, release);
        instant(&mut self.misses, window, deadline);
    }

    pub(super) fn defer(&mut self, window: &mut Window, t: Time, until: Time) {
        if window.meets(t, until) && !hides(self.deferrals.last().map(|d| d.0), t, window.grain()) {
            window.note(t);
            self.deferrals.push((t, until));
        }
    }

    pub(super) fn queue(&mut self, window: &mut Window, t: Time, waiting: u32) {
        let last = self.waiting.last();
        let news = waiting != last.map_or(0, |w| w.1);
        if news && window.meets(t, t) && !hides(last.map(|w| w.0), t, window.grain()) {
            window.note(t);
            self.waiting.push((t, waiting));
        }
    }
}

/// Adds an instant that lies in the window.
fn instant(all: &mut Vec<Time>, window: &mut Window, t: Time) {
    if window.meets(t, t) && !hides(all.last().copied(), t, window.grain()) {
        window.note(t);
        all.push(t);
    }
}

/// Whether a mark stands where another of its kind is seen.
fn hides(last: Option<Time>, t: Time, grain: Time) -> bool {
    last.is_some_and(|last| t >= last && grain > Time::ZERO && t - last <= grain)
}

impl Lane {
    /// Whether there is something to tell: it ran, or should have.
    pub(super) fn is_shown(&self) -> bool {
        self.ran || !self.misses.is_empty()
    }

    /// The last instant of anything in it.
    pub(super) fn last(&self) -> Option<Time> {
        let ends = self.bars.last().map(|b| b.to).into_iter();
        let ends = ends.chain(self.pending.iter().map(|p| p.1)).chain(self.releases.last().copied());
        let ends = ends.chain(self.skips.last().copied()).chain(self.completions.last().copied());
        let ends = ends.chain(self.misses.last().copied()).chain(self.deferrals.last().map(|d| d.1));
        ends.chain(self.waiting.last().map(|w| w.0)).max()
    }
}
