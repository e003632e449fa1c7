//! Which stretch of time a schedule shows.

use soifra_runtime::Time;

/// Releases of the most frequent unit that are shown when nobody says how long the stretch is.
const RELEASES: usize = 60;
/// A stretch ends in any case when a lane has so many bars: switches without releases must not fill the
/// memory.
const BARS: usize = 2000;
/// A stretch in which nothing happens has this length.
const LEAST: Time = Time(1_000_000);

/// A stretch of time, whose end may not be known yet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    from: Option<Time>,
    to: Option<Time>,
    /// First instant at which something happened in it.
    first: Option<Time>,
}

impl Window {
    pub(super) fn new(from: Option<Time>, to: Option<Time>) -> Window {
        Window { from, to, first: None }
    }

    /// Whether something that lasts lies in it at least in part, as far as is known.
    pub(super) fn meets(&self, from: Time, to: Time) -> bool {
        self.from.is_none_or(|t| to >= t) && self.to.is_none_or(|t| from <= t) && from <= to
    }

    /// Notes an instant at which something happens.
    pub(super) fn note(&mut self, t: Time) {
        if self.meets(t, t) {
            self.first = Some(self.first.map_or(t, |first| first.min(t)));
        }
    }

    /// Ends it at `t` when a lane has more releases or bars than can be told apart.
    pub(super) fn end_when_full(&mut self, t: Time, releases: usize, bars: usize) {
        if self.to.is_none() && (releases > RELEASES || bars > BARS) {
            self.to = Some(t);
        }
    }

    /// A time that is too short to be seen; nothing while its end is not known.
    pub(super) fn grain(&self) -> Time {
        match (self.from.or(self.first), self.to) {
            (Some(from), Some(to)) => Time((to - from).0 / 4000),
            _ => Time::ZERO,
        }
    }

    /// Beginning and end, the latter when the last thing in it happens at `last` unless it was known before.
    pub(super) fn close(&self, last: Time) -> (Time, Time) {
        let from = self.from.or(self.first).unwrap_or(self.to.map_or(Time::ZERO, |to| to.min(Time::ZERO)));
        let to = self.to.unwrap_or(last);
        if to > from { (from, to) } else { (from, from + LEAST) }
    }
}
