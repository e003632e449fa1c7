//! Follows expectations through a run.
//!
//! Margins are quantitative: `always` and `never` keep the least margin over time, `eventually` the
//! greatest, `until` the greatest of the second condition's, each limited by the first condition's least
//! margin before; `leads to within` the least time left, in seconds; `finally` the margin at the end.

use crate::{
    Time,
    mission::{
        code::{Condition, ExpectKindCode},
        margin::BOOLEAN,
    },
    trace::exact,
};
use serde::{Deserialize, Serialize};

/// What a condition is at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Answer {
    pub holds: bool,
    pub margin: Option<f64>,
}

/// How far an expectation has come, for one robot or for the run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Track {
    /// Decided: whether it held.
    pub held: Option<bool>,
    /// When it was violated first.
    pub violated: Option<Time>,
    #[serde(with = "exact::optional")]
    margin: Option<f64>,
    /// Until: least margin of the first condition so far.
    #[serde(with = "exact::number")]
    guard: f64,
    /// Leads to: since when an answer is due.
    pending: Option<Time>,
    /// Leads to: the slowest answer so far.
    slowest: Option<Time>,
}

impl Default for Track {
    fn default() -> Self {
        Track { held: None, violated: None, margin: None, guard: BOOLEAN, pending: None, slowest: None }
    }
}

impl Track {
    /// Whether further instants cannot change anything.
    pub fn is_over(&self, kind: &ExpectKindCode) -> bool {
        let measured = match kind {
            ExpectKindCode::Always(c) | ExpectKindCode::Never(c) | ExpectKindCode::Eventually(c, _) => {
                c.margin.is_some()
            }
            ExpectKindCode::Finally(_) => return true,
            ExpectKindCode::Until(first, second) => first.margin.is_some() || second.margin.is_some(),
            // The margin is the slowest answer, also after one came too late.
            ExpectKindCode::LeadsTo(_, _, limit) => limit.is_some(),
        };
        self.held.is_some() && !measured
    }

    fn least(&mut self, m: Option<f64>) {
        if let Some(m) = m {
            self.margin = Some(self.margin.map_or(m, |x| x.min(m)));
        }
    }

    fn greatest(&mut self, m: Option<f64>) {
        if let Some(m) = m {
            self.margin = Some(self.margin.map_or(m, |x| x.max(m)));
        }
    }

    /// It has not held, and did so at this time first, unless it is decided.
    pub fn violate(&mut self, at: Time) {
        if self.held.is_none() {
            (self.held, self.violated) = (Some(false), Some(at));
        }
    }

    /// An instant. `limit` is the time the kind gives; `ask` answers its conditions.
    pub fn step<E>(
        &mut self,
        kind: &ExpectKindCode,
        limit: Option<Time>,
        now: Time,
        ask: &mut impl FnMut(&Condition) -> Result<Answer, E>,
    ) -> Result<(), E> {
        match kind {
            ExpectKindCode::Always(c) => {
                let a = ask(c)?;
                self.least(a.margin);
                if !a.holds {
                    self.violate(now);
                }
            }
            ExpectKindCode::Never(c) => {
                let a = ask(c)?;
                self.least(a.margin.map(|m| -m));
                if a.holds {
                    self.violate(now);
                }
            }
            ExpectKindCode::Eventually(c, _) => {
                if let Some(limit) = limit
                    && now > limit
                {
                    self.violate(limit);
                    return Ok(());
                }
                let a = ask(c)?;
                self.greatest(a.margin);
                if a.holds && self.held.is_none() {
                    self.held = Some(true);
                }
            }
            ExpectKindCode::Until(first, second) => {
                let (a, b) = (ask(first)?, ask(second)?);
                if first.margin.is_some() || second.margin.is_some() {
                    let reached = b.margin.unwrap_or(if b.holds { BOOLEAN } else { -BOOLEAN });
                    self.greatest(Some(reached.min(self.guard)));
                    self.guard = self.guard.min(a.margin.unwrap_or(if a.holds { BOOLEAN } else { -BOOLEAN }));
                }
                if self.held.is_none() && b.holds {
                    self.held = Some(true);
                } else if !a.holds {
                    self.violate(now);
                }
            }
            ExpectKindCode::LeadsTo(first, second, _) => {
                self.overdue(limit, now);
                let (a, b) = (ask(first)?, ask(second)?);
                if a.holds {
                    self.pending.get_or_insert(now);
                }
                if b.holds
                    && let Some(since) = self.pending.take()
                {
                    let took = now - since;
                    self.slowest = Some(self.slowest.map_or(took, |s| s.max(took)));
                }
            }
            ExpectKindCode::Finally(_) => {}
        }
        Ok(())
    }

    fn overdue(&mut self, limit: Option<Time>, now: Time) {
        if let (Some(since), Some(limit)) = (self.pending, limit)
            && now > since + limit
        {
            self.violate(since + limit);
        }
    }

    /// The end of the run, after its last instant has been judged. An answer that may still come is not
    /// missed.
    pub fn end<E>(
        &mut self,
        kind: &ExpectKindCode,
        limit: Option<Time>,
        now: Time,
        ask: &mut impl FnMut(&Condition) -> Result<Answer, E>,
    ) -> Result<(), E> {
        match kind {
            ExpectKindCode::Always(_) | ExpectKindCode::Never(_) => {}
            ExpectKindCode::Eventually(..) | ExpectKindCode::Until(..) => self.violate(now),
            ExpectKindCode::LeadsTo(..) => {
                if let Some(since) = self.pending {
                    let last = limit.map_or(now, |l| since + l);
                    if last <= now {
                        self.violate(last);
                    }
                }
                if let Some(limit) = limit {
                    let waiting = self.pending.map(|since| now - since);
                    let slowest = self.slowest.into_iter().chain(waiting).max();
                    self.margin = slowest.map(|s| (limit - s).seconds());
                }
            }
            ExpectKindCode::Finally(c) => {
                let a = ask(c)?;
                self.margin = a.margin;
                if !a.holds {
                    self.violate(now);
                }
            }
        }
        self.held.get_or_insert(true);
        Ok(())
    }

    /// The margin, where it is a distance.
    pub fn margin(&self) -> Option<f64> {
        self.margin.filter(|m| m.is_finite() && m.abs() < BOOLEAN / 2.0)
    }
}
