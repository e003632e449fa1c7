//! A platform that hands over what another one handed over in a recorded run.

use super::tape::Tape;
use crate::{
    Event, Platform, Readings, Report, Snapshot, Time, WorldTruth, engine::report::LOST, objects::Retake,
};
use soifra_graph::component::MODELS;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most names of safe actions that are not those of a model.
const MOST_NAMES: usize = 64;

/// A robot of which no pose has been recorded.
const IDENTITY: [f64; 7] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A recorded platform.
pub(super) struct Recorded<'t, 'r> {
    tape: &'t Tape<'r>,
    stop: &'t AtomicBool,
    truth: Option<Truth>,
    names: Vec<&'static str>,
    cameras: Option<Box<dyn Retake>>,
}

/// World truth as recorded.
#[derive(Default)]
struct Truth {
    poses: Vec<[f64; 7]>,
    paths: Vec<f64>,
    /// In the order in which they were recorded first, which is that of the platform.
    movers: Vec<(String, [f64; 7])>,
    collisions: Vec<u32>,
    touching: Vec<u32>,
    total: u32,
}

impl<'t, 'r> Recorded<'t, 'r> {
    pub(super) fn new(
        tape: &'t Tape<'r>,
        robots: usize,
        stop: &'t AtomicBool,
        cameras: Option<Box<dyn Retake>>,
    ) -> Self {
        tape.pull(Time::ZERO);
        let truth = tape.has_poses().then(|| Truth {
            poses: vec![IDENTITY; robots],
            paths: vec![0.0; robots],
            collisions: vec![0; robots],
            touching: vec![0; robots],
            ..Truth::default()
        });
        Recorded { tape, stop, truth, names: Vec::new(), cameras }
    }

    /// The rest of a run, from a snapshot on, of which the tape has the records after it.
    pub(super) fn resumed(
        tape: &'t Tape<'r>,
        snapshot: &Snapshot,
        stop: &'t AtomicBool,
        cameras: Option<Box<dyn Retake>>,
    ) -> Self {
        tape.pull(snapshot.t);
        // The operator stopped the run while it waited for what comes after the snapshot.
        stop.store(tape.interrupted(snapshot.t), Ordering::Relaxed);
        let truth = snapshot.truth().map(|t| Truth {
            poses: t.poses.iter().map(|p| p.map_or(IDENTITY, |p| p.0)).collect(),
            paths: t.poses.iter().map(|p| p.map_or(0.0, |p| p.1)).collect(),
            movers: t.movers.to_vec(),
            collisions: t.contacts.of_robot.clone(),
            touching: t.contacts.touching.clone(),
            total: t.contacts.total,
        });
        Recorded { tape, stop, truth, names: Vec::new(), cameras }
    }
}

impl Platform for Recorded<'_, '_> {
    fn next_due(&self) -> Option<Time> {
        self.tape.next_input()
    }

    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>) {
        self.tape.pull(now);
        if self.tape.interrupted(now) {
            self.stop.store(true, Ordering::Relaxed);
        }
        while let Some(input) = self.tape.input(now) {
            let at = input.t;
            match input.event {
                Event::Reading { robot, sensor, captured, registers } => {
                    readings.push(robot, sensor, captured, at, &registers);
                }
                Event::Image { robot, sensor, captured, view, .. } => {
                    let taken = self.cameras.as_mut();
                    // An image that cannot be taken again is none; the comparison finds the first that is missing.
                    if let Some(image) = taken.and_then(|c| c.retake(robot, sensor, captured, &view)) {
                        readings.push_image(robot, sensor, captured, at, image);
                    }
                }
                Event::Contact { robot, other, with, begin } => {
                    if let Some(truth) = &mut self.truth {
                        truth.contact(robot, other, begin);
                    }
                    reports.push(if begin {
                        Report::ContactBegin { at, robot, other, with }
                    } else {
                        Report::ContactEnd { at, robot, other, with }
                    });
                }
                Event::Fault { robot: Some(robot), text, .. } => {
                    let reason = text.strip_prefix(LOST).unwrap_or(&text).to_string();
                    reports.push(Report::Lost { at, robot, reason });
                }
                Event::Pose { robot, pose, path_m } => {
                    if let Some(t) = &mut self.truth
                        && let (Some(p), Some(l)) =
                            (t.poses.get_mut(robot as usize), t.paths.get_mut(robot as usize))
                    {
                        (*p, *l) = (pose, path_m);
                    }
                }
                Event::Mover { name, pose } => {
                    if let Some(t) = &mut self.truth {
                        match t.movers.iter_mut().find(|m| m.0 == name) {
                            Some(m) => m.1 = pose,
                            None => t.movers.push((name, pose)),
                        }
                    }
                }
                // What every robot does at the end of a recording: no other safe action is an input.
                Event::SafeAction { .. } => reports.push(Report::Over { at }),
                _ => {}
            }
        }
    }

    fn send(&mut self, _: Time, _: u32, _: u32, _: &[f64], _: Time) {}

    fn safe_action(&mut self, _: Time, robot: u32) -> &'static str {
        let Some(name) = self.tape.safe_action(robot) else { return "none recorded" };
        let models =
            MODELS.iter().filter(|m| matches!(m.role, "safe" | "finish")).map(|m| &*m.signature.name);
        if let Some(known) = models.chain(self.names.iter().copied()).find(|n| *n == name) {
            return known;
        }
        if self.names.len() == MOST_NAMES {
            return "one name too many";
        }
        // A driver's own name: it must live as long as the contract says, and there are few.
        let name: &'static str = Box::leak(name.into_boxed_str());
        self.names.push(name);
        name
    }

    fn truth(&self) -> Option<&dyn WorldTruth> {
        self.truth.as_ref().map(|t| t as &dyn WorldTruth)
    }
}

impl Truth {
    fn contact(&mut self, robot: u32, other: Option<u32>, begin: bool) {
        self.total += u32::from(begin);
        for r in std::iter::once(robot).chain(other) {
            if let (Some(c), Some(t)) =
                (self.collisions.get_mut(r as usize), self.touching.get_mut(r as usize))
            {
                *c += u32::from(begin);
                *t = if begin { *t + 1 } else { t.saturating_sub(1) };
            }
        }
    }
}

impl WorldTruth for Truth {
    fn pose(&self, robot: u32) -> [f64; 7] {
        self.poses.get(robot as usize).copied().unwrap_or([f64::NAN; 7])
    }
    fn path_length(&self, robot: u32) -> f64 {
        self.paths.get(robot as usize).copied().unwrap_or(f64::NAN)
    }
    fn collisions(&self, robot: u32) -> u32 {
        self.collisions.get(robot as usize).copied().unwrap_or(0)
    }
    fn in_collision(&self, robot: u32) -> bool {
        self.touching.get(robot as usize).is_some_and(|t| *t > 0)
    }
    fn total_collisions(&self) -> u32 {
        self.total
    }
    fn movers(&self) -> Vec<(String, [f64; 7])> {
        self.movers.clone()
    }
}
