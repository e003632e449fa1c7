//! Ends a run and reports on it.

use super::{
    Engine, Outcome,
    contacts::Touch,
    instant::End,
    judge::Occasion,
    report::{ContactReport, ExpectationReport, GoalReport, INTERRUPTED, OVER, RobotReport, RunReport},
};
use crate::Event;
use std::collections::BTreeMap;

impl Engine<'_> {
    /// Starts every robot's safe action, decides what is open, and reports.
    pub(super) fn finish(mut self, mut end: End) -> RunReport {
        let why = match end.outcome {
            Outcome::Aborted if end.reason == INTERRUPTED => INTERRUPTED.to_string(),
            Outcome::Aborted => format!("the run is aborted: {}", end.reason),
            // A replay finds the end of the recording by these words.
            _ if end.reason == OVER => OVER.to_string(),
            _ => "the run has ended".to_string(),
        };
        let cause = if why == INTERRUPTED { self.operator.cause() } else { None };
        for r in 0..self.scene.bodies().len() {
            // It says nothing about the run, and is not counted.
            self.finish_robot(r as u32, &why, cause);
        }
        self.judge_expectations(self.now, Occasion::End);
        let expectations = self.expectations();
        if end.outcome == Outcome::Success
            && let Some(first) = expectations.iter().find(|e| e.held == Some(false))
        {
            end.outcome = Outcome::Failed;
            end.reason = format!("an expectation is violated: {}", first.text);
        }
        let metrics = self.metrics();
        let (outcome, reason) = (end.outcome.name().to_string(), end.reason.clone());
        self.recorder.record(self.now, cause, || Event::End { outcome, reason });
        if let Some(error) = self.recorder.failed.take()
            && end.outcome != Outcome::Aborted
        {
            end = End { outcome: Outcome::Aborted, reason: format!("the trace cannot be written: {error}") };
        }
        RunReport {
            mission: self.mission.graph.name.to_string(),
            seed: self.seed,
            outcome: end.outcome,
            reason: end.reason,
            sim_time_s: self.now.seconds(),
            collisions: self.contacts.total,
            contacts: self.contacts(),
            expectations,
            goals: self.goals(),
            robots: (0..self.scene.bodies().len()).map(|r| self.robot(r)).collect(),
            metrics,
            missed_deadlines: self.tallies.iter().map(|t| t.misses).sum(),
            faults: self.faults,
        }
    }

    fn contacts(&self) -> Vec<ContactReport> {
        let name =
            |r: u32| self.scene.robots.get(r as usize).map_or_else(String::new, |r| r.name.to_string());
        let told =
            |t: &Touch| ContactReport { at_s: t.at.seconds(), robot: name(t.robot), with: t.with.clone() };
        self.contacts.first.iter().map(told).collect()
    }

    fn expectations(&self) -> Vec<ExpectationReport> {
        let graph = &self.mission.graph;
        let of_watch = graph.expects.iter().zip(&self.judge.watches).map(|(e, watch)| {
            let held = watch.tracks.iter().all(|t| t.held == Some(true));
            let violated = watch.tracks.iter().filter_map(|t| t.violated).min();
            let margin = watch.tracks.iter().filter_map(|t| t.margin()).reduce(f64::min);
            ExpectationReport {
                text: e.text.clone(),
                held: (!watch.blind).then_some(held),
                first_violation_s: violated.map(|t| t.seconds()),
                margin,
            }
        });
        of_watch.collect()
    }

    fn goals(&self) -> Vec<GoalReport> {
        let goals = self.mission.graph.goals.iter().enumerate();
        goals
            .map(|(g, goal)| GoalReport {
                name: goal.name.to_string(),
                status: self.goals.status(g),
                reason: self.unserved(g as u32),
            })
            .collect()
    }

    fn metrics(&mut self) -> BTreeMap<String, Option<f64>> {
        let mission = self.mission;
        let mut frame = std::mem::take(&mut self.judge.frame);
        let gathered = std::mem::take(&mut self.judge.gathered);
        let mut court = self.court(self.now);
        let mut out = BTreeMap::new();
        for (metric, gathered) in mission.judge.metrics.iter().zip(&gathered) {
            let value = match &metric.samples {
                Some(s) => gathered.value(s.keep),
                None => court.number(&metric.value, &mut frame).ok(),
            };
            out.insert(metric.name.to_string(), value.filter(|x| x.is_finite()));
        }
        out
    }

    fn robot(&self, r: usize) -> RobotReport {
        let robot = &self.scene.robots[r];
        let truth = self.platform.truth();
        let last = truth.map(|t| t.pose(r as u32));
        let finite = |x: f64| x.is_finite().then_some(x);
        let distance = |last: [f64; 7], t: [f64; 3]| {
            let d = [0, 1, 2].map(|a| last[a] - t[a]);
            (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
        };
        let step = self.scene.step.filter(|s| s.0 > 0);
        let reached = self.goals.reached.get(r).copied().flatten();
        let steps = reached.zip(step).map(|(t, s)| (t.0 / s.0).max(0) as u64);
        let platform = self.scene.platforms.get(robot.platform as usize);
        RobotReport {
            name: robot.name.clone(),
            platform: platform.map_or_else(String::new, |p| p.name.to_string()),
            start: robot.start.into(),
            last: last.filter(|p| p.iter().all(|x| x.is_finite())).map(Into::into),
            path_length_m: truth.and_then(|t| finite(t.path_length(r as u32))),
            steps,
            reached: self.goals.robot_reached(r),
            distance_to_target_m: last.zip(robot.target).and_then(|(p, t)| finite(distance(p, t))),
            collisions: self.contacts.of_robot.get(r).copied().unwrap_or(0),
            safe_actions: self.actuators.safe_actions.get(&(r as u32)).copied().unwrap_or(0),
        }
    }
}
