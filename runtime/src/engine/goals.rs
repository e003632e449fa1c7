//! Goals: what all robots together believe to have achieved.

use super::{
    cast::Cast,
    minds::{ACHIEVED, ACTIVE, FAILED},
};
use crate::{Mission, Scene, Time};
use serde::{Deserialize, Serialize};
use soifra_graph::SubGoal;

/// Counts of sub-goals by goal and by robot.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Goals {
    goals: Vec<Count>,
    /// Of sub-goals that agents are allocated to, by goal.
    allocated: Vec<Count>,
    robots: Vec<Count>,
    /// When each robot had achieved all its sub-goals for the first time.
    pub reached: Vec<Option<Time>>,
    /// Status of each goal that was traced last.
    traced: Vec<u8>,
    changed: bool,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Count {
    all: u32,
    achieved: u32,
    failed: u32,
}

impl Count {
    fn status(&self) -> u8 {
        match self {
            c if c.all > 0 && c.achieved == c.all => ACHIEVED,
            c if c.failed > 0 => FAILED,
            _ => ACTIVE,
        }
    }

    fn change(&mut self, before: u8, after: u8) {
        let mut add = |status: u8, by: i32| match status {
            ACHIEVED => self.achieved = self.achieved.saturating_add_signed(by),
            FAILED => self.failed = self.failed.saturating_add_signed(by),
            _ => {}
        };
        add(before, -1);
        add(after, 1);
    }
}

/// A status in words.
pub(crate) fn word(status: u8) -> &'static str {
    match status {
        ACHIEVED => "achieved",
        FAILED => "failed",
        _ => "active",
    }
}

impl Goals {
    pub fn new(mission: &Mission, scene: &Scene, cast: &Cast) -> Self {
        let mut g = Goals {
            goals: vec![Count::default(); mission.graph.goals.len()],
            allocated: vec![Count::default(); mission.graph.goals.len()],
            robots: vec![Count::default(); scene.robots.len()],
            reached: vec![None; scene.robots.len()],
            traced: vec![ACTIVE; mission.graph.goals.len()],
            changed: false,
        };
        // Nothing is allocated yet, and so nothing is achieved.
        for (count, goal) in g.allocated.iter_mut().zip(&mission.graph.goals) {
            count.all = goal.subgoals.iter().filter(|s| s.agent.is_none()).count() as u32;
        }
        for i in &cast.instances {
            for s in &mission.agents[i.agent as usize].subgoals {
                g.goals[s.goal as usize].all += 1;
                g.robots[i.robot as usize].all += 1;
            }
        }
        // A goal with a sub-goal that nobody pursues is never achieved.
        for (count, goal) in g.goals.iter_mut().zip(&mission.graph.goals) {
            let pursued = |agent: u32| cast.instances.iter().any(|i| i.agent == agent);
            let by_nobody = |s: &&SubGoal| s.agent.is_some_and(|a| !pursued(a));
            count.all += goal.subgoals.iter().filter(by_nobody).count() as u32;
        }
        g
    }

    /// Whether these are counts of as many goals and robots.
    pub fn fits(&self, other: &Goals) -> bool {
        let all = |counts: &[Count]| counts.iter().map(|c| c.all).collect::<Vec<_>>();
        let shape =
            |g: &Goals| (all(&g.goals), all(&g.robots), g.allocated.len(), g.reached.len(), g.traced.len());
        shape(self) == shape(other)
    }

    /// A sub-goal of a robot changes its status.
    pub fn change(&mut self, now: Time, goal: u32, robot: u32, before: u8, after: u8) {
        self.goals[goal as usize].change(before, after);
        let robot_count = &mut self.robots[robot as usize];
        robot_count.change(before, after);
        if robot_count.status() == ACHIEVED {
            self.reached[robot as usize].get_or_insert(now);
        }
        self.changed = true;
    }

    /// How many sub-goals of each goal are allocated: all, achieved, failed.
    pub fn set_allocated(&mut self, counts: &[[u32; 3]]) {
        for (count, [all, achieved, failed]) in self.allocated.iter_mut().zip(counts) {
            *count = Count { all: *all, achieved: *achieved, failed: *failed };
        }
        self.changed = true;
    }

    /// All sub-goals of a goal.
    fn whole(&self, goal: usize) -> Option<Count> {
        let (a, b) = (self.goals.get(goal)?, self.allocated.get(goal)?);
        let sum = |f: fn(&Count) -> u32| f(a) + f(b);
        Some(Count { all: sum(|c| c.all), achieved: sum(|c| c.achieved), failed: sum(|c| c.failed) })
    }

    /// Whether a goal is achieved.
    pub fn achieved(&self, goal: u32) -> Option<bool> {
        self.whole(goal as usize).map(|c| c.status() == ACHIEVED)
    }

    /// Whether a robot believes that it has achieved all its sub-goals.
    pub fn robot_reached(&self, robot: usize) -> bool {
        self.robots.get(robot).is_some_and(|c| c.status() == ACHIEVED)
    }

    /// Status of a goal, in words.
    pub fn status(&self, goal: usize) -> &'static str {
        self.whole(goal).map_or("active", |c| word(c.status()))
    }

    /// Goals whose status has changed since they were asked for last.
    pub fn changes(&mut self) -> Vec<(usize, &'static str)> {
        if !std::mem::take(&mut self.changed) {
            return Vec::new();
        }
        let mut out = Vec::new();
        for i in 0..self.traced.len() {
            let status = self.whole(i).map_or(ACTIVE, |c| c.status());
            let traced = &mut self.traced[i];
            if status != *traced {
                *traced = status;
                out.push((i, word(*traced)));
            }
        }
        out
    }
}
