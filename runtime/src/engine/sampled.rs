//! Metrics out of samples: what has been gathered of each so far.

use super::judge::Court;
use crate::{mission::code::SamplesCode, trace::exact};
use serde::{Deserialize, Serialize};
use soifra_graph::{
    Keep,
    eval::{Block, Fault},
};

/// What is gathered of a metric.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Gathered {
    /// What the samples are taken upon, as it was last.
    #[serde(with = "exact::optional")]
    last: Option<f64>,
    count: u64,
    /// The sum, or the best.
    #[serde(with = "exact::number")]
    kept: f64,
    /// A sample had no value: neither has the metric.
    failed: bool,
}

impl Gathered {
    /// Takes a sample when there is one to take.
    pub fn step(&mut self, value: &Block, samples: &SamplesCode, court: &mut Court<'_>, frame: &mut [f64]) {
        if !self.failed && self.sample(value, samples, court, frame).is_err() {
            self.failed = true;
        }
    }

    fn sample(
        &mut self,
        value: &Block,
        samples: &SamplesCode,
        court: &mut Court<'_>,
        frame: &mut [f64],
    ) -> Result<(), Fault> {
        let now = court.number(&samples.upon, frame)?;
        if self.last.replace(now).is_none_or(|last| last == now) {
            return Ok(());
        }
        if let Some(when) = &samples.when
            && court.number(when, frame)? == 0.0
        {
            return Ok(());
        }
        let x = court.number(value, frame)?;
        self.kept = match (samples.keep, self.count) {
            (Keep::Sum | Keep::Mean, _) => self.kept + x,
            (_, 0) => x,
            (Keep::Least, _) => self.kept.min(x),
            (Keep::Most, _) => self.kept.max(x),
        };
        self.count += 1;
        Ok(())
    }

    /// What comes of it; nothing without samples, but for a sum.
    pub fn value(&self, keep: Keep) -> Option<f64> {
        match (keep, self.count) {
            _ if self.failed => None,
            (Keep::Sum, _) => Some(self.kept),
            (_, 0) => None,
            (Keep::Mean, n) => Some(self.kept / n as f64),
            _ => Some(self.kept),
        }
    }
}
