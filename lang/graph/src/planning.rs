//! From a mission to an allocation: which sub-goals want agents, by which plans, and who could serve them.
//!
//! The checker asks before a run, with parameters at their defaults; the planner-matcher of the runtime asks
//! with what it knows then. Agents on robots have the same numbers as in the runtime: robots in order, on
//! each the agents in order.

use crate::{
    Graph, Name,
    allocation::{Need, Task, Way},
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An agent on a robot or host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    /// Robot.
    pub robot: u32,
    /// Agent type.
    pub agent: u32,
}

/// Everybody who could serve, by what they offer.
#[derive(Debug, Clone, Default)]
pub struct Pool {
    members: Vec<Member>,
    /// How many robots have a body; they come first.
    bodies: u32,
    /// By service and robot, in order.
    on_robots: BTreeMap<Name, BTreeMap<u32, Vec<u32>>>,
}

/// A sub-goal that wants agents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Wanted {
    /// Goal.
    pub goal: u32,
    /// Sub-goal of it.
    pub subgoal: u32,
    /// Robot, when each has one of its own.
    pub robot: Option<u32>,
}

/// A plan, and the robot whose agents carry it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Means {
    /// Plan of the library.
    pub plan: u32,
    /// Robot; none when agents of hosts do everything.
    pub robot: Option<u32>,
}

impl Pool {
    /// Everybody, given the group that each robot belongs to.
    pub fn new(g: &Graph, groups: &[u32]) -> Pool {
        let mut pool = Pool::default();
        for (robot, group) in (0..).zip(groups) {
            let Some(group) = g.robots.get(*group as usize) else { continue };
            if !group.host {
                pool.bodies = robot + 1;
            }
            for b in &group.agents {
                let number = pool.members.len() as u32;
                pool.members.push(Member { robot, agent: b.agent });
                let offers = g.agents.get(b.agent as usize).into_iter().flat_map(|a| &a.offers);
                // A conversation is no service that a plan could need.
                for offer in offers.filter(|o| o.unit.is_some()) {
                    let of = pool.on_robots.entry(offer.name.clone()).or_default();
                    of.entry(robot).or_default().push(number);
                }
            }
        }
        pool
    }

    /// Agents on robots by their numbers.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Those who offer a service, in order.
    pub fn offering<'p>(&'p self, service: &str) -> impl Iterator<Item = u32> + 'p {
        self.on_robots.get(service).into_iter().flat_map(|r| r.values()).flatten().copied()
    }

    /// Those who could serve a need on a robot: its own first, then those of hosts.
    fn candidates(&self, service: &str, robot: Option<u32>) -> Vec<u32> {
        let Some(of) = self.on_robots.get(service) else { return Vec::new() };
        let own = robot.and_then(|r| of.get(&r)).into_iter().flatten();
        own.chain(of.range(self.bodies..).flat_map(|(_, all)| all)).copied().collect()
    }

    /// Robots with a body on which somebody offers one of these services.
    fn places<'n>(&self, services: impl Iterator<Item = &'n Name>) -> Vec<u32> {
        let of = services.filter_map(|s| self.on_robots.get(s));
        let mut robots: Vec<u32> = of.flat_map(|r| r.range(..self.bodies).map(|(robot, _)| *robot)).collect();
        robots.sort_unstable();
        robots.dedup();
        robots
    }

    /// A sub-goal as a task for the matcher, and what the label of each way stands for. `holds` tells which
    /// plans are ways at present.
    pub fn task(&self, g: &Graph, wanted: Wanted, holds: &dyn Fn(u32) -> bool) -> (Task, Vec<Means>) {
        let subgoal = g.goals.get(wanted.goal as usize).and_then(|x| x.subgoals.get(wanted.subgoal as usize));
        let Some(subgoal) = subgoal else { return Default::default() };
        let (mut ways, mut means) = (Vec::new(), Vec::new());
        for (p, plan) in (0..).zip(&g.plans) {
            if plan.target != subgoal.name || plan.needs.is_empty() || !holds(p) {
                continue;
            }
            let mut add = |robot: Option<u32>| {
                let need = |(service, _): &(Name, _)| Need { candidates: self.candidates(service, robot) };
                let label = means.len() as u32;
                ways.push(Way { label, needs: plan.needs.iter().map(need).collect() });
                means.push(Means { plan: p, robot });
            };
            if let Some(robot) = wanted.robot {
                add(Some(robot));
                continue;
            }
            let places = self.places(plan.needs.iter().map(|(s, _)| s));
            let by_hosts = plan.needs.iter().all(|(s, _)| !self.candidates(s, None).is_empty());
            let alone = places.is_empty();
            places.into_iter().for_each(|robot| add(Some(robot)));
            // Without anybody it still is a plan, for which nobody is capable.
            if by_hosts || alone {
                add(None);
            }
        }
        (Task { ways }, means)
    }
}

impl Graph {
    /// The plan for a goal that the library has: its first that holds. None for a goal that brings its sub-goals.
    pub fn plan_of_goal(&self, goal: u32, holds: &dyn Fn(u32) -> bool) -> Option<u32> {
        let of = &self.goals.get(goal as usize)?.subgoals;
        (0..self.plans.len() as u32).find(|p| of.iter().any(|s| s.plan == Some(*p)) && holds(*p))
    }

    /// Sub-goals of a goal that agents are to be found for, on so many robots with a body.
    pub fn wanted(&self, goal: u32, bodies: u32, holds: &dyn Fn(u32) -> bool) -> Vec<Wanted> {
        let Some(of) = self.goals.get(goal as usize) else { return Vec::new() };
        let current = self.plan_of_goal(goal, holds);
        let mut out = Vec::new();
        for (subgoal, s) in (0..).zip(&of.subgoals) {
            if s.agent.is_some() || (s.plan.is_some() && s.plan != current) {
                continue;
            }
            match s.each_robot {
                true => out.extend((0..bodies).map(|r| Wanted { goal, subgoal, robot: Some(r) })),
                false => out.push(Wanted { goal, subgoal, robot: None }),
            }
        }
        out
    }

    /// Whether agents of this type pursue a sub-goal whatever the planner-matcher says.
    pub fn is_bound(&self, agent: u32) -> bool {
        self.goals.iter().flat_map(|g| &g.subgoals).any(|s| s.agent == Some(agent))
    }
}
