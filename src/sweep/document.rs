//! The JSON document of a sweep or of a shard of one, and how shards become the whole again.

use super::plan::{Case, Plan};
use crate::{output::SCHEMA, statistics::Summary};
use serde::{Deserialize, Serialize};
use soifra_runtime::RunReport;
use std::collections::BTreeMap;

/// Missions with at most so many robots have figures of each robot in their summaries.
const ROBOTS: usize = 24;

/// A sweep's results. Nothing in it depends on the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// Version of the form.
    pub schema: u32,
    /// Mission name.
    pub mission: String,
    /// Digest of the graph for each platform of the plan; one without a name for the mission's own.
    pub graph_digests: BTreeMap<String, String>,
    /// What was to be run.
    pub plan: Plan,
    /// Which part of the plan this is, `(i, n)`; absent for the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<(usize, usize)>,
    /// Whether every run of the plan, or of the shard, is here.
    pub complete: bool,
    /// Runs in the plan's order.
    pub runs: Vec<Run>,
    /// Figures over all runs.
    pub summary: BTreeMap<String, Summary>,
    /// Figures for each combination of platform and parameters.
    pub groups: Vec<Group>,
}

/// One run, brief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its place in the plan.
    pub index: usize,
    #[serde(flatten)]
    /// Platform and parameters.
    pub case: Case,
    /// Seed.
    pub seed: u64,
    /// Outcome.
    pub outcome: String,
    /// Why, in one line.
    pub reason: String,
    /// Virtual time at the end.
    pub sim_time_s: Option<f64>,
    /// Contacts of all robots, each counted once.
    pub collisions: u32,
    /// Expectations in order.
    pub expectations: Vec<Expectation>,
    /// Goals in order.
    pub goals: Vec<Goal>,
    /// Robots in order.
    pub robots: Vec<Robot>,
    /// Metrics; absent where they cannot be computed.
    pub metrics: BTreeMap<String, Option<f64>>,
}

/// An expectation, brief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expectation {
    /// As written.
    pub text: String,
    /// Whether it held.
    pub held: Option<bool>,
    /// Least distance to the bound.
    pub margin: Option<f64>,
}

/// A goal, brief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Name.
    pub name: String,
    /// `active`, `achieved` or `failed`.
    pub status: String,
}

/// A robot, brief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Name.
    pub name: String,
    /// Profile.
    pub platform: String,
    /// True path length.
    pub path_length_m: Option<f64>,
    /// Ticks of the step clock until it had achieved its sub-goals.
    pub steps: Option<u64>,
    /// Whether it believes so.
    pub reached: bool,
    /// True distance from its target.
    pub distance_to_target_m: Option<f64>,
    /// Contacts it took part in.
    pub collisions: u32,
}

/// Figures of one combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// Platform and parameters.
    #[serde(flatten)]
    pub case: Case,
    /// Figures by name.
    pub summary: BTreeMap<String, Summary>,
}

impl Run {
    /// The brief form of a report.
    pub fn of(index: usize, case: &Case, r: &RunReport) -> Run {
        let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
        Run {
            index,
            case: case.clone(),
            seed: r.seed,
            outcome: r.outcome.name().to_string(),
            reason: r.reason.clone(),
            sim_time_s: finite(Some(r.sim_time_s)),
            collisions: r.collisions,
            expectations: r
                .expectations
                .iter()
                .map(|e| Expectation { text: e.text.clone(), held: e.held, margin: finite(e.margin) })
                .collect(),
            goals: r
                .goals
                .iter()
                .map(|g| Goal { name: g.name.clone(), status: g.status.to_string() })
                .collect(),
            robots: r
                .robots
                .iter()
                .map(|b| Robot {
                    name: b.name.clone(),
                    platform: b.platform.clone(),
                    path_length_m: finite(b.path_length_m),
                    steps: b.steps,
                    reached: b.reached,
                    distance_to_target_m: finite(b.distance_to_target_m),
                    collisions: b.collisions,
                })
                .collect(),
            metrics: r.metrics.iter().map(|(n, v)| (n.clone(), finite(*v))).collect(),
        }
    }

    /// Every figure of the run by name.
    pub fn figures(&self) -> Vec<(String, Option<f64>)> {
        let truth = |b: bool| Some(f64::from(u8::from(b)));
        let mut out = vec![
            ("success".to_string(), truth(self.outcome == "success")),
            ("sim_time_s".to_string(), self.sim_time_s),
            ("collisions".to_string(), Some(f64::from(self.collisions))),
            ("collided".to_string(), truth(self.collisions > 0)),
        ];
        if self.robots.len() <= ROBOTS {
            for b in &self.robots {
                out.push((format!("{}.steps", b.name), b.steps.map(|n| n as f64)));
                out.push((format!("{}.distance_to_target_m", b.name), b.distance_to_target_m));
                out.push((format!("{}.path_length_m", b.name), b.path_length_m));
                out.push((format!("{}.reached", b.name), truth(b.reached)));
                out.push((format!("{}.collisions", b.name), Some(f64::from(b.collisions))));
            }
        }
        out.extend(self.metrics.iter().map(|(n, v)| (n.clone(), *v)));
        out
    }
}

/// Figures over runs.
pub fn summarise<'a>(runs: impl Iterator<Item = &'a Run>) -> BTreeMap<String, Summary> {
    let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for (name, value) in runs.flat_map(Run::figures) {
        values.entry(name).or_default().extend(value);
    }
    values.into_iter().map(|(name, v)| (name, Summary::of(v))).collect()
}

impl Document {
    /// The document for runs of a plan.
    pub fn new(
        mission: String,
        graph_digests: BTreeMap<String, String>,
        plan: Plan,
        shard: Option<(usize, usize)>,
        complete: bool,
        mut runs: Vec<Run>,
    ) -> Document {
        runs.sort_by_key(|r| r.index);
        let summary = summarise(runs.iter());
        let groups = plan
            .cases()
            .into_iter()
            .map(|case| Group { summary: summarise(runs.iter().filter(|r| r.case == case)), case })
            .collect();
        Document { schema: SCHEMA, mission, graph_digests, plan, shard, complete, runs, summary, groups }
    }

    /// The whole sweep from all its shards, in any order.
    ///
    /// # Errors
    /// What does not go together, in words.
    pub fn merge(shards: Vec<(String, Document)>) -> Result<Document, String> {
        let (first_path, first) = shards.first().ok_or("no file was given")?;
        let Some((_, count)) = first.shard else {
            return Err(format!("`{first_path}` is no shard, but a whole sweep"));
        };
        let (mission, digests, plan) =
            (first.mission.clone(), first.graph_digests.clone(), first.plan.clone());
        let mut seen: BTreeMap<usize, String> = BTreeMap::new();
        let mut runs = Vec::new();
        for (path, shard) in shards {
            if shard.schema != SCHEMA {
                return Err(format!("`{path}` has schema version {}, not {SCHEMA}", shard.schema));
            }
            if shard.mission != mission || shard.graph_digests != digests {
                return Err(format!("`{path}` is of another mission or another version of it"));
            }
            if shard.plan != plan {
                return Err(format!("`{path}` has other seeds, parameters or platforms"));
            }
            if !shard.complete {
                return Err(format!("`{path}` was interrupted; run its shard again"));
            }
            let Some((i, n)) = shard.shard else {
                return Err(format!("`{path}` is no shard, but a whole sweep"));
            };
            if n != count {
                return Err(format!("`{path}` is one of {n} shards, the first file one of {count}"));
            }
            if let Some(other) = seen.insert(i, path.clone()) {
                return Err(format!("`{path}` and `{other}` are both shard {i}"));
            }
            runs.extend(shard.runs);
        }
        if let Some(i) = (1..=count).find(|i| !seen.contains_key(i)) {
            return Err(format!("shard {i} of {count} is missing"));
        }
        if plan.runs() != Some(runs.len()) {
            return Err("the shards do not hold every run of the plan exactly once".into());
        }
        Ok(Document::new(mission, digests, plan, None, true, runs))
    }
}
