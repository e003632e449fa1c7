//! The graph: everything a run is a function of, besides seed and recorded inputs.

use crate::{
    Agent, Conversation, Expr, Name, Source, Span, Texts, Type, TypeTable, UserFunction, Value, span,
};
use serde::{Deserialize, Serialize};

/// Version of the graph's form; a reader refuses others.
pub const SCHEMA: u32 = 1;

/// A mission, compiled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Graph {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Language edition of the sources.
    pub edition: u32,
    /// Mission name.
    pub name: Name,
    /// Title.
    pub title: String,
    /// Sources, for spans.
    pub sources: Vec<span::Source>,
    /// Records and enums.
    pub types: TypeTable,
    /// Constant texts.
    pub texts: Texts,
    /// Parameters.
    pub params: Vec<Param>,
    /// Functions of the sources.
    pub functions: Vec<UserFunction>,
    /// World: bounds, walls, obstacles, regions, movers, materials.
    pub world: Vec<Component>,
    /// Platform profiles that robots use.
    pub platforms: Vec<Platform>,
    /// Topics.
    pub topics: Vec<Topic>,
    /// Conversations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conversations: Vec<Conversation>,
    /// Agent types.
    pub agents: Vec<Agent>,
    /// Robots, or arrays of them.
    pub robots: Vec<RobotGroup>,
    /// Step of the step clock: a duration.
    pub step: Option<Expr>,
    /// Goals.
    pub goals: Vec<Goal>,
    /// Plans for them, from the plan library.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plans: Vec<LibraryPlan>,
    /// What goes wrong, on purpose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Component>,
    /// When the mission has succeeded.
    pub done: Expr,
    /// Time limit: `Duration` or `Steps`.
    pub within: Option<Expr>,
    /// Expectations.
    pub expects: Vec<Expectation>,
    /// Metrics.
    pub metrics: Vec<Metric>,
}

/// A parameter of the mission.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Param {
    /// Name, as `--set` takes it.
    pub name: Name,
    /// Type.
    pub ty: Type,
    /// Value unless set.
    pub default: Value,
    /// Where it was written.
    pub at: Span,
}

/// A declared thing of the world or of a platform: `sensor ir = infrared(bearings: …)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Component {
    /// `sensor`, `wall`, `mover`, `drive`, … see [`crate::component`].
    pub role: Name,
    /// Its name; empty for roles that stand alone.
    pub name: Name,
    /// The model, `infrared`.
    pub model: Name,
    /// Every argument of the model's signature, defaults filled in. Constants, parameters, and draws;
    /// for arrays local 0 is the index.
    pub args: Vec<(Name, Expr)>,
    /// Number of instances, for arrays.
    pub count: Option<Expr>,
    /// Type of a reading or a command.
    pub ty: Option<Type>,
    /// Where it was written.
    pub at: Span,
}

/// A platform profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Platform {
    /// Name.
    pub name: Name,
    /// Its parts.
    pub components: Vec<Component>,
    /// Where it was written.
    pub at: Span,
}

impl Platform {
    /// The parts of a role, in order.
    pub fn of_role<'a>(&'a self, role: &'a str) -> impl Iterator<Item = &'a Component> {
        self.components.iter().filter(move |c| &*c.role == role)
    }
}

/// A topic: typed messages between agents. `model` and `args` say how they travel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Topic {
    /// Record type of its messages.
    pub ty: Type,
    /// Role `topic`, its name, model and arguments.
    pub channel: Component,
}

/// A robot, or an array of robots (`count`); in its expressions local 0 is the index in the array.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotGroup {
    /// Name; array members are `name[0]`, `name[1]`, …
    pub name: Name,
    /// Number of robots, for arrays.
    pub count: Option<Expr>,
    /// Index of its platform.
    pub platform: u32,
    /// Other platforms it may be run on, by name.
    pub alternatives: Vec<Name>,
    /// `Pose<map>`.
    pub start: Expr,
    /// Scatter of the start position on each axis: `Distribution<Length>`.
    pub scatter: Option<Expr>,
    /// `Point<map>`.
    pub target: Option<Expr>,
    /// Agents it runs.
    pub agents: Vec<AgentBinding>,
    /// Agents that offer services and were to run here, but whose ports the platform does not have.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unfit: Vec<Unfit>,
    /// A computer without a body: its platform has no parts, and it is nowhere. Hosts come after robots.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub host: bool,
    /// Where it was written.
    pub at: Span,
}

/// An agent on a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AgentBinding {
    /// Index of the agent type.
    pub agent: u32,
    /// One value for each of its parameters.
    pub arguments: Vec<Expr>,
    /// Where it was written.
    pub at: Span,
}

/// An agent that is not functionally capable on a platform.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unfit {
    /// Index of the agent type.
    pub agent: u32,
    /// `sensor` or `actuator`.
    pub role: Name,
    /// The port that the platform does not have, or has of another type.
    pub port: Name,
    /// Where the robot runs it.
    pub at: Span,
}

/// A goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Name.
    pub name: Name,
    /// Pursued only when an agent asks for it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub on_request: bool,
    /// Sub-goals; the goal is achieved when all are.
    pub subgoals: Vec<SubGoal>,
    /// Where it was written.
    pub at: Span,
}

/// A sub-goal: pursued by an agent on every robot that runs it, or by whom the planner-matcher allocates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SubGoal {
    /// Name.
    pub name: Name,
    /// Index of the agent type. Absent: the planner-matcher finds agents by the plans for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agent: Option<u32>,
    /// When the agent believes it achieved: over the agent's states and parameters. Absent: when the
    /// agent's plan for it succeeds, or, of allocated ones, when an agent says so.
    pub achieved: Option<Expr>,
    /// Allocated: each robot has one of its own. Otherwise the mission has one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub each_robot: bool,
    /// Wanted only while this is the plan for the goal, by index.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<u32>,
    /// Where it was written.
    pub at: Span,
}

/// A plan of the plan library: a way to a goal or sub-goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LibraryPlan {
    /// Name.
    pub name: Name,
    /// Name of the goal or sub-goal it is for.
    pub target: Name,
    /// Whether it is one at present: over the parameters of the mission.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Expr>,
    /// Services that agents must offer, all of them on one robot or on hosts.
    pub needs: Vec<(Name, Span)>,
    /// Where it was written.
    pub at: Span,
}

/// An expectation; the mission's test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expectation {
    /// As written.
    pub text: String,
    /// Watched for each robot by itself.
    pub each_robot: bool,
    /// What is expected.
    pub kind: ExpectKind,
    /// Where it was written.
    pub at: Span,
}

/// Kinds of expectations, evaluated at every event. Conditions are `Bool`; where one is a comparison
/// of quantities its margin is the distance to the bound, positive when it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExpectKind {
    /// At every event.
    Always(Expr),
    /// At no event.
    Never(Expr),
    /// At some event, within a time from the start (the whole run when absent).
    Eventually(Expr, Option<Expr>),
    /// The first holds until the second does, which must happen.
    Until(Expr, Expr),
    /// Whenever the first holds, the second holds within a time from then.
    LeadsTo(Expr, Expr, Option<Expr>),
    /// At the end of the run.
    Finally(Expr),
}

/// What becomes of the samples of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// Their sum; 0 without samples.
    Sum,
    /// Their mean.
    Mean,
    /// The least.
    Least,
    /// The greatest.
    Most,
}

/// When a metric is sampled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// What becomes of the samples.
    pub keep: Keep,
    /// A sample is taken at the end of every instant at which this has changed ...
    pub upon: Expr,
    /// ... and this holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Expr>,
}

/// A figure of the run, evaluated at its end or out of samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// Name.
    pub name: Name,
    /// Value; stored in SI units.
    pub value: Expr,
    /// When it is sampled; at the end of the run when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<Samples>,
    /// Where it was written.
    pub at: Span,
}

impl Metric {
    /// All its expressions.
    pub fn exprs(&self) -> impl Iterator<Item = &Expr> {
        let samples = self.samples.iter().flat_map(|s| std::iter::once(&s.upon).chain(&s.when));
        std::iter::once(&self.value).chain(samples)
    }
}

impl Graph {
    /// Robots with a body.
    pub fn bodies(&self) -> impl Iterator<Item = &RobotGroup> {
        self.robots.iter().filter(|r| !r.host)
    }

    /// Label for a source of arbiter proposals: `agent.unit`.
    pub fn source_name(&self, s: &Source) -> String {
        let agent = self.agents.get(s.agent as usize);
        let unit = agent.and_then(|a| a.units.get(s.unit as usize));
        format!("{}.{}", agent.map_or("?", |a| &*a.name), unit.map_or("?", |u| &*u.name))
    }
}
