//! Goldens: what a run came to when somebody last looked at it and was content.
//!
//! Events are compared in order and exactly, figures within a tolerance. A digest of every record
//! detects what these two do not show; it counts only on the kind of machine that wrote it.

use crate::graph_file::hex;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use soifra_runtime::{Event, Record, RunReport, TraceSink};
use std::collections::BTreeMap;

/// Relative difference of figures that does not count, and absolute one near zero.
const TOLERANCE: f64 = 1e-6;
/// Most events kept; the digest covers the rest.
const EVENTS: usize = 4000;

/// An accepted run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Golden {
    /// Mission name.
    pub mission: String,
    /// Seed.
    pub seed: u64,
    /// Outcome.
    pub outcome: String,
    /// Figures by name: of the run, its robots and its metrics.
    pub figures: BTreeMap<String, Option<f64>>,
    /// What happened, in order: time in seconds, and what.
    pub events: Vec<(f64, String)>,
    /// Kind of machine the digest is of.
    pub machine: String,
    /// SHA-256 of all records.
    pub digest: String,
}

/// Gathers a golden while a run goes on.
#[derive(Default)]
pub struct Gatherer {
    robots: Vec<String>,
    hash: Sha256,
    events: Vec<(f64, String)>,
    buffer: Vec<u8>,
}

impl Gatherer {
    /// For a scene with these robots.
    pub fn new(robots: Vec<String>) -> Self {
        Gatherer { robots, ..Gatherer::default() }
    }

    /// The golden of the finished run.
    pub fn finish(self, report: &RunReport) -> Golden {
        let mut figures = BTreeMap::from([
            ("sim_time_s".to_string(), Some(report.sim_time_s)),
            ("collisions".to_string(), Some(f64::from(report.collisions))),
        ]);
        for r in &report.robots {
            figures.insert(format!("{}.steps", r.name), r.steps.map(|n| n as f64));
            figures.insert(format!("{}.path_length_m", r.name), r.path_length_m);
            figures.insert(format!("{}.distance_to_target_m", r.name), r.distance_to_target_m);
        }
        figures.extend(report.metrics.iter().map(|(n, v)| (n.clone(), *v)));
        Golden {
            mission: report.mission.clone(),
            seed: report.seed,
            outcome: report.outcome.name().to_string(),
            figures,
            events: self.events,
            machine: machine(),
            digest: hex(&self.hash.finalize()),
        }
    }

    fn robot(&self, index: u32) -> &str {
        self.robots.get(index as usize).map_or("?", String::as_str)
    }

    /// The line of an event that tells the course of a run; none for those that are legion.
    fn line(&self, event: &Event) -> Option<String> {
        Some(match event {
            Event::Transition { robot, agent, unit, from, to } => {
                format!("{}: {agent}.{unit} {from} -> {to}", self.robot(*robot))
            }
            Event::Arbitration { robot, actuator, winner, .. } => {
                format!(
                    "{}: {actuator} goes to {}",
                    self.robot(*robot),
                    winner.as_deref().unwrap_or("nobody")
                )
            }
            Event::SafeAction { robot, action, reason, .. } => {
                format!("{}: safe action {action}, {reason}", self.robot(*robot))
            }
            Event::Contact { robot, with, begin, .. } => {
                format!("{}: {} {with}", self.robot(*robot), if *begin { "touches" } else { "parts from" })
            }
            Event::Goal { goal, robot, status, reason } => {
                let robot = robot.map_or(String::new(), |r| format!("{}: ", self.robot(r)));
                let reason = reason.as_ref().map_or(String::new(), |why| format!(", {why}"));
                format!("{robot}{goal} {status}{reason}")
            }
            Event::Life { agent, status, reason, .. } => match reason.as_str() {
                "" => format!("{agent} is {status}"),
                _ => format!("{agent} is {status}: {reason}"),
            },
            Event::Service { agent, service, running, subgoal, .. } => {
                let subgoal = subgoal.as_ref().map_or(String::new(), |s| format!(" for {s}"));
                format!("{agent}.{service} {}{subgoal}", if *running { "starts" } else { "stops" })
            }
            Event::Expectation { index, held, .. } => {
                format!("expectation {index} {}", if *held { "held" } else { "violated" })
            }
            Event::Fault { agent, text, .. } => format!("fault in {agent}: {text}"),
            Event::End { outcome, reason } => format!("end: {outcome} {reason}"),
            _ => return None,
        })
    }
}

impl TraceSink for Gatherer {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        self.buffer.clear();
        serde_json::to_writer(&mut self.buffer, record).map_err(|e| e.to_string())?;
        self.hash.update(&self.buffer);
        if self.events.len() < EVENTS
            && let Some(line) = self.line(&record.event)
        {
            self.events.push((record.t.seconds(), line));
        }
        Ok(())
    }
}

/// Kind of machine, for digests.
fn machine() -> String {
    format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS)
}

impl Golden {
    /// The first thing in which `now` differs from this golden, in words.
    pub fn difference(&self, now: &Golden) -> Option<String> {
        let text = |g: &Golden, i: usize| {
            g.events.get(i).map_or("nothing more".to_string(), |(t, e)| format!("{e} at {t} s"))
        };
        for i in 0..self.events.len().max(now.events.len()) {
            let same = match (self.events.get(i), now.events.get(i)) {
                (Some(a), Some(b)) => a.1 == b.1 && near(a.0, b.0),
                _ => false,
            };
            if !same {
                return Some(format!(
                    "event {}: accepted was `{}`, now it is `{}`",
                    i + 1,
                    text(self, i),
                    text(now, i)
                ));
            }
        }
        if self.outcome != now.outcome {
            return Some(format!("the outcome was {}, now it is {}", self.outcome, now.outcome));
        }
        for name in self.figures.keys().chain(now.figures.keys()) {
            let (a, b) =
                (self.figures.get(name).copied().flatten(), now.figures.get(name).copied().flatten());
            let same = match (a, b) {
                (Some(a), Some(b)) => near(a, b),
                (a, b) => a == b,
            };
            if !same {
                let show = |x: Option<f64>| x.map_or("absent".to_string(), |x| x.to_string());
                return Some(format!("{name} was {}, now it is {}", show(a), show(b)));
            }
        }
        (self.machine == now.machine && self.digest != now.digest)
            .then(|| "events and figures are the same, but some other record differs".to_string())
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= TOLERANCE * a.abs().max(b.abs()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn golden() -> Golden {
        Golden {
            mission: "m".into(),
            seed: 1,
            outcome: "success".into(),
            figures: BTreeMap::from([("x".into(), Some(1.0)), ("y".into(), None)]),
            events: vec![(0.5, "a".into()), (1.0, "b".into())],
            machine: machine(),
            digest: "00".into(),
        }
    }

    #[test]
    fn differences_are_named() {
        let a = golden();
        assert_eq!(a.difference(&a), None);
        let with = |f: &dyn Fn(&mut Golden)| {
            let mut b = golden();
            f(&mut b);
            a.difference(&b).unwrap_or_default()
        };
        assert_eq!(with(&|g| g.figures.insert("x".into(), Some(1.0 + 1e-9)).map_or((), |_| ())), "");
        assert!(with(&|g| _ = g.figures.insert("x".into(), Some(1.1))).starts_with("x was 1"));
        assert!(with(&|g| g.events.swap(0, 1)).starts_with("event 1"));
        assert!(with(&|g| _ = g.events.pop()).contains("nothing more"));
        assert!(with(&|g| g.digest = "01".into()).contains("some other record"));
        assert_eq!(with(&|g| (g.digest, g.machine) = ("01".into(), "other".into())), "");
    }
}
