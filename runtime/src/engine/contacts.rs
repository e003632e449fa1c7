//! Contacts, counted from what the platform reports.

use crate::Time;
use serde::{Deserialize, Serialize};

/// Collisions so far and contacts that last.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Contacts {
    /// Contacts of all robots, each counted once.
    pub total: u32,
    /// Contacts each robot took part in.
    pub of_robot: Vec<u32>,
    /// Contacts each robot is in now.
    pub touching: Vec<u32>,
    /// Robots whose contact began at the instant that is being judged.
    began: Vec<u32>,
    lasting: u32,
    /// The first of them.
    pub first: Vec<Touch>,
}

/// A contact: when, which robot, with what.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Touch {
    pub at: Time,
    pub robot: u32,
    pub with: String,
}

/// How many contacts a report tells of; the trace has them all.
const TOLD: usize = 20;

impl Contacts {
    pub fn new(robots: usize) -> Self {
        Contacts { of_robot: vec![0; robots], touching: vec![0; robots], ..Contacts::default() }
    }

    /// Whether these are contacts of as many robots.
    pub fn fits(&self, other: &Contacts) -> bool {
        (self.of_robot.len(), self.touching.len()) == (other.of_robot.len(), other.touching.len())
    }

    /// A contact begins.
    pub fn begin(&mut self, at: Time, robot: u32, other: Option<u32>, with: &str) {
        if self.first.len() < TOLD {
            self.first.push(Touch { at, robot, with: with.to_string() });
        }
        self.total += 1;
        self.lasting += 1;
        for r in std::iter::once(robot).chain(other) {
            if let (Some(n), Some(t)) = (self.of_robot.get_mut(r as usize), self.touching.get_mut(r as usize))
            {
                *n += 1;
                *t += 1;
                self.began.push(r);
            }
        }
    }

    /// A contact ends.
    pub fn end(&mut self, robot: u32, other: Option<u32>) {
        self.lasting = self.lasting.saturating_sub(1);
        for r in std::iter::once(robot).chain(other) {
            if let Some(t) = self.touching.get_mut(r as usize) {
                *t = t.saturating_sub(1);
            }
        }
    }

    /// The instant at which contacts began has been judged.
    pub fn judged(&mut self) {
        self.began.clear();
    }

    /// Whether a robot is in contact, or was at the instant that is being judged.
    pub fn touches(&self, robot: u32) -> bool {
        self.touching.get(robot as usize).is_some_and(|t| *t > 0) || self.began.contains(&robot)
    }

    /// Whether any robot is.
    pub fn any(&self) -> bool {
        self.lasting > 0 || !self.began.is_empty()
    }
}
