//! Missions and tests.

use super::{Arg, Constant, Entry, Expr, Ident, Param};
use soifra_graph::{Keep, Span};

/// A mission.
#[derive(Debug, Clone)]
pub struct Mission {
    /// Name.
    pub name: Ident,
    /// What it extends.
    pub extends: Option<Ident>,
    /// Title.
    pub title: Option<String>,
    /// Members in order; once it is derived, those of what it extends too.
    pub members: Vec<MissionMember>,
}

/// A member of a mission.
#[derive(Debug, Clone)]
pub enum MissionMember {
    /// `param`
    Param(Param),
    /// `clock step`
    Clock(Expr),
    /// `robot`
    Robot(Robot),
    /// `host`
    Host(Host),
    /// `goal`
    Goal(Goal),
    /// `done when`
    Done(Expr, Span),
    /// `within`
    Within(Expr, Span),
    /// `expect`
    Expect(Expect),
    /// `metric`
    Metric(Metric),
    /// `let`
    Constant(Constant),
    /// `world NAME`
    World(Ident),
    /// A world entry of the mission's own.
    Entry(Entry),
}

/// A figure of the run.
#[derive(Debug, Clone)]
pub struct Metric {
    /// Name.
    pub name: Ident,
    /// Value, at the end or at every sample; none where samples are counted.
    pub value: Option<Expr>,
    /// When it is sampled; none for a value at the end.
    pub samples: Option<Samples>,
}

/// When a metric is sampled, and what becomes of the samples.
#[derive(Debug, Clone)]
pub struct Samples {
    /// `count` is the sum of ones.
    pub keep: Keep,
    /// Sampled whenever this changes ...
    pub upon: Expr,
    /// ... and this holds.
    pub when: Option<Expr>,
}

/// A robot, or an array of robots.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Name.
    pub name: Ident,
    /// Array size.
    pub count: Option<Expr>,
    /// Platforms, the first is used unless another is asked for.
    pub platforms: Vec<Ident>,
    /// Start.
    pub at: Expr,
    /// Target.
    pub target: Option<Expr>,
    /// Scatter.
    pub scatter: Option<Expr>,
    /// Agents.
    pub runs: Vec<(Ident, Vec<Arg>)>,
}

/// A computer without a body that runs agents, or an array of them.
#[derive(Debug, Clone)]
pub struct Host {
    /// Name.
    pub name: Ident,
    /// Array size.
    pub count: Option<Expr>,
    /// Agents.
    pub runs: Vec<(Ident, Vec<Arg>)>,
}

/// A goal with sub-goals: name, agent, condition.
#[derive(Debug, Clone)]
pub struct Goal {
    /// Name.
    pub name: Ident,
    /// Pursued only on request.
    pub on_request: bool,
    /// Sub-goals.
    pub subgoals: Vec<SubGoal>,
}

/// `[each robot:] subgoal name [by agent] [achieved when …]`
#[derive(Debug, Clone)]
pub struct SubGoal {
    /// Name.
    pub name: Ident,
    /// One for each robot.
    pub each_robot: bool,
    /// Agent; without one it is allocated.
    pub agent: Option<Ident>,
    /// Condition.
    pub achieved: Option<Expr>,
}

/// `plan name for goal when … { needs service  subgoal name }`
#[derive(Debug, Clone)]
pub struct LibraryPlan {
    /// Name.
    pub name: Ident,
    /// Goal or sub-goal.
    pub target: Ident,
    /// When it is one.
    pub when: Option<Expr>,
    /// Services it needs.
    pub needs: Vec<Ident>,
    /// Sub-goals it makes of a goal.
    pub subgoals: Vec<SubGoal>,
}

/// An expectation.
#[derive(Debug, Clone)]
pub struct Expect {
    /// For each robot by itself.
    pub each_robot: bool,
    /// What.
    pub kind: ExpectKind,
    /// All of it.
    pub span: Span,
}

/// Kinds of expectations.
#[derive(Debug, Clone)]
pub enum ExpectKind {
    /// `always`
    Always(Expr),
    /// `never`
    Never(Expr),
    /// `eventually … within`
    Eventually(Expr, Option<Expr>),
    /// `… until …`
    Until(Expr, Expr),
    /// `… leads to … within`
    LeadsTo(Expr, Expr, Option<Expr>),
    /// At the end.
    Finally(Expr),
}

/// `test`
#[derive(Debug, Clone)]
pub struct Test {
    /// Name.
    pub name: Ident,
    /// `run`
    pub run: Vec<Ident>,
    /// `seeds`
    pub seeds: Option<Expr>,
    /// `set`
    pub sets: Vec<Constant>,
    /// `expect outcome`
    pub outcome: Option<Ident>,
    /// `expect`
    pub expects: Vec<Expr>,
    /// `fault = …`
    pub faults: Vec<Entry>,
}
