//! Agents and what they do.

use super::{Arg, Constant, Expr, Ident, Stmt, TypeRef};
use soifra_graph::{Misses, Span};

/// An agent.
#[derive(Debug, Clone)]
pub struct Agent {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Collaborative.
    pub collaborative: bool,
    /// `restart n within …`
    pub restart: Option<(i64, Expr)>,
    /// Members in order.
    pub members: Vec<AgentMember>,
}

/// A member of an agent.
#[derive(Debug, Clone)]
pub enum AgentMember {
    /// `offers … when`
    Offers(Ident, Option<Expr>),
    /// `sensor`
    Sensor(Ident, TypeRef),
    /// `actuator`
    Actuator(Ident, TypeRef),
    /// `state`
    State(Ident, Option<TypeRef>, Expr),
    /// `event`
    Event(Ident),
    /// `device`, with its capacity
    Device(Ident, i64),
    /// `let`
    Constant(Constant),
    /// `action`
    Action(Action),
    /// `service`, `machine`, `plan`
    Unit(Box<Unit>),
    /// `arbitrate`
    Arbiter(Arbiter),
}

/// An action.
#[derive(Debug, Clone)]
pub struct Action {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Success.
    pub until: Option<Expr>,
    /// Failure.
    pub fails: Option<Expr>,
    /// What it does.
    pub body: Vec<Stmt>,
    /// When halted.
    pub halt: Vec<Stmt>,
}

/// A service, machine or plan.
#[derive(Debug, Clone)]
pub struct Unit {
    /// Name.
    pub name: Ident,
    /// Trigger.
    pub trigger: Trigger,
    /// Timing clauses.
    pub timing: Vec<Timing>,
    /// What.
    pub kind: UnitKind,
}

/// Kinds of units.
#[derive(Debug, Clone)]
pub enum UnitKind {
    /// `service`
    Service(Vec<Stmt>),
    /// `machine`
    Machine(Vec<MachineState>),
    /// `plan [for sub-goal]`
    Plan(Option<Ident>, Box<PlanNode>),
}

/// A trigger.
#[derive(Debug, Clone)]
pub struct Trigger {
    /// What.
    pub kind: TriggerKind,
    /// Where.
    pub span: Span,
}

/// Kinds of triggers.
#[derive(Debug, Clone)]
pub enum TriggerKind {
    /// `every step after …`
    Step(Option<Expr>),
    /// `every … after …`
    Every(Expr, Option<Expr>),
    /// `on event`
    Event(Ident),
    /// `on sensor`
    Sensor(Ident),
    /// `on inform Record(x) from agent`
    Told(Ident, Ident, Ident, Option<Ident>),
    /// `on param`
    Param(Ident),
    /// `on topic(x)`
    Topic(Ident, Ident),
    /// `on conversation refuse`
    Talk(Ident, Ident),
}

/// A timing clause.
#[derive(Debug, Clone)]
pub enum Timing {
    /// `deadline`, with what a miss means
    Deadline(Expr, Misses),
    /// `worst`
    Worst(Expr),
    /// `takes`
    Takes(Expr),
    /// `jitter`
    Jitter(Expr),
    /// `shares … for`
    Shares(Ident, Expr),
    /// `budget`
    Budget(Expr),
    /// `at most every`
    AtMostEvery(Expr),
    /// `priority`
    Priority(i64),
    /// `core`
    Core(i64),
    /// `stopped`
    Stopped,
}

/// A state of a machine.
#[derive(Debug, Clone)]
pub struct MachineState {
    /// Name.
    pub name: Ident,
    /// Data it carries.
    pub data: Vec<(Ident, TypeRef)>,
    /// On entry.
    pub entry: Vec<Stmt>,
    /// On exit.
    pub exit: Vec<Stmt>,
    /// Body.
    pub body: Vec<Stmt>,
    /// Ways out.
    pub transitions: Vec<Transition>,
}

/// `when … -> target(args) { … }`
#[derive(Debug, Clone)]
pub struct Transition {
    /// Guard.
    pub guard: Expr,
    /// Target.
    pub target: Ident,
    /// Data of the target.
    pub args: Vec<Arg>,
    /// Actions.
    pub body: Vec<Stmt>,
}

/// A plan node.
#[derive(Debug, Clone)]
pub struct PlanNode {
    /// What.
    pub kind: PlanKind,
    /// Children.
    pub children: Vec<PlanNode>,
    /// Where.
    pub span: Span,
}

/// Kinds of plan nodes.
#[derive(Debug, Clone)]
pub enum PlanKind {
    /// `[reactive] sequence`
    Sequence(bool),
    /// `[reactive] fallback`
    Fallback(bool),
    /// `parallel [n]`
    Parallel(Option<i64>),
    /// `retry n`
    Retry(i64),
    /// `timeout d`
    Timeout(Expr),
    /// `repeat n`
    Repeat(i64),
    /// `repeat while c`
    RepeatWhile(Expr),
    /// `invert`
    Invert,
    /// `succeed`
    Succeed,
    /// `check c`
    Check(Expr),
    /// `wait d`
    Wait(Expr),
    /// `wait until c`
    WaitUntil(Expr),
    /// A statement.
    Stmt(Stmt),
}

/// An arbiter.
#[derive(Debug, Clone)]
pub struct Arbiter {
    /// Actuator.
    pub actuator: Ident,
    /// Strategy.
    pub strategy: Strategy,
    /// Where.
    pub span: Span,
}

/// `unit` or `agent.unit`
#[derive(Debug, Clone)]
pub struct Source {
    /// Agent, when it is another's unit.
    pub agent: Option<Ident>,
    /// Unit.
    pub unit: Ident,
}

/// Strategies.
#[derive(Debug, Clone)]
pub enum Strategy {
    /// Index for each source.
    Priority(Vec<(Source, Expr)>),
    /// Weight for each source.
    Blend(Vec<(Source, Expr)>),
    /// Order.
    Switch(Vec<Source>),
    /// Layers, topmost first.
    Layers(Vec<Layer>),
}

/// A layer.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Who.
    pub source: Source,
    /// Whom it suppresses; all below when absent.
    pub suppresses: Option<Vec<Source>>,
    /// For how long.
    pub hold: Option<Expr>,
    /// While this, it does not count.
    pub inhibited: Option<Expr>,
}
