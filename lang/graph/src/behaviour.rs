//! The behaviour of an agent: state, ports, and units (services, machines, plans) made of statements
//! and nodes.

use crate::{Expr, Name, Span, Type};
use serde::{Deserialize, Serialize};

/// An agent type: a container of state and services on one robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Agent {
    /// Name.
    pub name: Name,
    /// Whether it serves several sub-goals at a time; otherwise it is exclusive.
    pub collaborative: bool,
    /// Parameters, given by the robot that runs it ([`crate::Op::Argument`]).
    pub parameters: Vec<(Name, Type)>,
    /// What it offers to others.
    pub offers: Vec<Offer>,
    /// Sensors it needs, by the platform's sensor name.
    pub sensors: Vec<Port>,
    /// Actuators it commands, by the platform's actuator name.
    pub actuators: Vec<Port>,
    /// State slots ([`crate::Op::State`]).
    pub states: Vec<State>,
    /// Events its units raise and wait for.
    pub events: Vec<Name>,
    /// What its units use one after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub devices: Vec<Device>,
    /// Services, machines and plans, in declaration order.
    pub units: Vec<Unit>,
    /// One for each actuator that several units command.
    pub arbiters: Vec<Arbiter>,
    /// What happens when it fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restart: Option<Restart>,
    /// Where it was written.
    pub span: Span,
}

/// How often an agent that fails is started again. One without this ends the run by its fault.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Restart {
    /// How often at most in any span of so long; once more, and it stays dead.
    pub times: u32,
    /// The span.
    pub within: Expr,
}

/// A service an agent offers in the directory: a unit of it, or a conversation of that name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Name.
    pub name: Name,
    /// The unit, which runs only while the planner-matcher has engaged the agent for it. Absent: a conversation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<u32>,
    /// Whether the agent agrees when it is asked: over its states and parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<Expr>,
    /// Where it was written.
    pub span: Span,
}

/// A sensor or actuator an agent uses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Port {
    /// Name of the platform's sensor or actuator.
    pub name: Name,
    /// Type of a reading or command, without the optional.
    pub ty: Type,
    /// Sensors only: the agent handles absence itself (`T?`). Otherwise a unit that reads this sensor
    /// is skipped while the reading is absent or expired.
    #[serde(default)]
    pub optional: bool,
    /// Where it was written.
    pub span: Span,
}

/// Something that serves so many uses at a time; others wait, first come, first served.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Device {
    /// Name.
    pub name: Name,
    /// How many uses at a time.
    pub capacity: u32,
    /// Where it was written.
    pub span: Span,
}

/// A state slot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Name; `machine.state.field` for the data of a machine state.
    pub name: Name,
    /// Type.
    pub ty: Type,
    /// Initial value: constants, parameters and agent arguments only.
    pub initial: Expr,
    /// Where it was written.
    pub span: Span,
}

/// Something with a trigger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Name.
    pub name: Name,
    /// What sets it off.
    pub trigger: Trigger,
    /// Declared timing.
    #[serde(default)]
    pub timing: Timing,
    /// Whether it waits to be started by the agent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    /// Types of its locals.
    pub locals: Vec<Type>,
    /// Agent-level `let`s it uses, evaluated first at every activation.
    pub prelude: Vec<Stmt>,
    /// What it does.
    pub kind: UnitKind,
    /// Where it was written.
    pub span: Span,
}

/// The three ways to write behaviour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnitKind {
    /// Statements, run once an activation.
    Service(Vec<Stmt>),
    /// A state machine; the first state is the initial one.
    Machine(Vec<MachineState>),
    /// A plan tree; node 0 is the root. With a sub-goal, its success achieves it.
    Plan {
        /// Nodes, parents before children.
        nodes: Vec<PlanNode>,
        /// Name of the sub-goal this is a plan for.
        subgoal: Option<Name>,
    },
}

/// When a unit is released.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Trigger {
    /// Every period, first at `offset`: durations, constant at the start of a run.
    Every {
        /// Period.
        period: Expr,
        /// First release.
        offset: Option<Expr>,
    },
    /// At every tick of the step clock, `offset` after it.
    Step {
        /// Delay after the tick.
        offset: Option<Expr>,
    },
    /// When a message on a topic is delivered; it is bound to a local.
    Message {
        /// Topic.
        topic: u32,
        /// Local for the message.
        local: u32,
    },
    /// When a message told to this agent is delivered; it is bound to a local.
    Told {
        /// Performative, lower case (`inform`).
        performative: Name,
        /// Record type of the content.
        content: Name,
        /// Sending agent, any when absent.
        from: Option<Name>,
        /// Local for the content.
        local: u32,
    },
    /// When something happens in a conversation of this agent.
    Talk {
        /// Conversation.
        conversation: u32,
        /// What.
        what: Talk,
        /// Local for the other agent.
        sender: u32,
        /// Local for the conversation.
        thread: u32,
    },
    /// When a reading of a sensor port is delivered.
    Reading(u32),
    /// When an event of the agent is raised.
    Event(u32),
    /// When a parameter of the mission is set.
    Param(u32),
}

/// What may happen in a conversation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Talk {
    /// A message comes.
    Message {
        /// Performative, lower case.
        performative: Name,
        /// Local for the content, when there is one.
        content: Option<u32>,
    },
    /// Nothing has come in time.
    Timeout,
    /// Everybody whom one message opened the conversation with has answered, or the time is over.
    Settled,
}

/// Declared timing; durations constant at the start of a run. Analysed by the checker, charged by the
/// simulator.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Timing {
    /// Relative deadline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deadline: Option<Expr>,
    /// What a missed deadline means.
    #[serde(default, skip_serializing_if = "Misses::is_hard")]
    pub misses: Misses,
    /// Worst-case execution time, which is charged unless `takes` says less.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_case: Option<Expr>,
    /// Execution time that is charged: a distribution, cut off at the worst case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub takes: Option<Expr>,
    /// A periodic release may come so much later than its period says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jitter: Option<Expr>,
    /// Resources that are held at the beginning of the execution, one after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shares: Vec<Share>,
    /// Least time between two releases of a unit that is not periodic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most_every: Option<Expr>,
    /// Fixed priority; higher runs first among releases of one instant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub priority: Option<i64>,
    /// Core it is bound to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub core: Option<i64>,
    /// Budget of an anytime service: time for the rounds of its `refine`, besides `worst_case`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<Expr>,
}

/// What a missed deadline means. Every miss is traced and counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Misses {
    /// It must not happen: refused by the checker where it can.
    #[default]
    Hard,
    /// It may happen.
    Soft,
    /// So many in a row may happen; one more is a fault of the agent.
    AtMost(u32),
}

impl Misses {
    fn is_hard(&self) -> bool {
        *self == Misses::Hard
    }
}

/// A resource that units of one robot share, one at a time (immediate priority ceiling).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Its name: the same for all units of the robot.
    pub resource: Name,
    /// How long it is held at most.
    pub time: Expr,
    /// Where it was written.
    pub at: Span,
}

/// A statement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stmt {
    /// What it does.
    #[serde(flatten)]
    pub kind: StmtKind,
    /// Where it was written.
    pub at: Span,
}

/// Kinds of statements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StmtKind {
    /// Binds a local.
    Let(u32, Expr),
    /// Sets a state slot.
    Set(u32, Expr),
    /// Proposes a command for an actuator port.
    Command(u32, Expr),
    /// Publishes a record on a topic.
    Publish(u32, Expr),
    /// Tells another agent on the same robot.
    Tell {
        /// Performative, lower case.
        performative: Name,
        /// Receiving agent.
        to: Name,
        /// A record.
        content: Expr,
    },
    /// Writes a remark into the trace.
    Note(String, Option<Expr>),
    /// Opens a conversation with one agent or each of a list.
    Open(Box<Open>),
    /// Says something in a conversation that is going on.
    Reply(Box<Reply>),
    /// Statements for each item of a list.
    Each(Box<Each>),
    /// Improves a value round by round while the budget of the unit lasts; directly in a service only.
    Refine(Box<Refine>),
    /// Uses a device for a duration; what follows is sent when that is over.
    Use(u32, Expr),
    /// Raises an event of the agent.
    Raise(u32),
    /// Governs units, sub-goals and goals.
    Govern(Govern),
    /// Sets a mission parameter.
    SetParam(u32, Expr),
    /// Condition, then, else.
    If(Expr, Vec<Stmt>, Vec<Stmt>),
    /// Two ways on an optional.
    IfSome {
        /// The optional.
        value: Expr,
        /// Local for the value.
        local: u32,
        /// Local for the reason.
        reason: Option<u32>,
        /// With the value.
        then: Vec<Stmt>,
        /// Without.
        otherwise: Vec<Stmt>,
    },
    /// One way for each variant of an enum.
    Switch {
        /// The enum value.
        value: Expr,
        /// Variants and what to do.
        arms: Vec<(Vec<u32>, Vec<Stmt>)>,
        /// What to do for all others.
        rest: Option<Vec<Stmt>>,
    },
    /// The first rule whose guard holds acts; the trace says which.
    Rules(Vec<Rule>),
}

/// What an agent decides about its units, and tells the planner-matcher.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Govern {
    /// A unit of the agent is released from now on.
    Start(u32),
    /// A unit of the agent is released no more.
    Stop(u32),
    /// What the unit was engaged for is achieved.
    Achieve,
    /// What the unit was engaged for cannot be achieved by this agent, and why.
    Fail(String),
    /// A goal of the mission that is pursued on request is wanted.
    Pursue(u32),
    /// What the agent offers is in the directory from now on.
    Offer(u32),
    /// What the agent offers is in the directory no more.
    Withdraw(u32),
}

/// The first message of a conversation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Open {
    /// Conversation.
    pub conversation: u32,
    /// Performative, lower case.
    pub performative: Name,
    /// A record, when the protocol wants one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Expr>,
    /// An `Agent`, or a list of them.
    pub to: Expr,
    /// How long to wait for answers, in place of what the protocol says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<Expr>,
}

/// A further message of a conversation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reply {
    /// Conversation.
    pub conversation: u32,
    /// Performative, lower case.
    pub performative: Name,
    /// A record, when the protocol wants one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<Expr>,
    /// Why, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Which one: a `Conversation<…>`.
    pub thread: Expr,
}

/// A loop over a list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Each {
    /// The list.
    pub list: Expr,
    /// Local for the item.
    pub local: u32,
    /// What is done.
    pub body: Vec<Stmt>,
}

/// What an anytime service improves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refine {
    /// Local for the value: the last round's, or the first value.
    pub local: u32,
    /// First value, always computed.
    pub first: Expr,
    /// Next value, from the local.
    pub step: Expr,
    /// What a round costs: a duration, constant at the start of a run.
    pub cost: Expr,
    /// Whether the value is good enough, from the local.
    pub until: Option<Expr>,
}

/// A guarded rule. An empty guard always holds (`otherwise`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// All must hold, in order; a bound local can be used further right and in the body.
    pub guard: Vec<Conjunct>,
    /// What it does.
    pub body: Vec<Stmt>,
    /// The guard's place.
    pub at: Span,
}

/// A part of a guard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Conjunct {
    /// A condition.
    Holds(Expr),
    /// `optional is some(local)`.
    Binds(u32, Expr),
}

/// A state of a machine. At each activation the transitions are tried first, in order; at most one is
/// taken; then the body of the state the machine is in runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineState {
    /// Name.
    pub name: Name,
    /// Data carried by the state: slots of the agent, assigned on entry.
    pub data: Vec<u32>,
    /// On entry, after the data are assigned.
    pub entry: Vec<Stmt>,
    /// Every activation.
    pub body: Vec<Stmt>,
    /// On leaving.
    pub exit: Vec<Stmt>,
    /// Ways out.
    pub transitions: Vec<Transition>,
    /// Where it was written.
    pub at: Span,
}

/// A way from one state to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// When it is taken.
    pub guard: Vec<Conjunct>,
    /// Index of the target state.
    pub target: u32,
    /// One value for each datum of the target.
    pub arguments: Vec<Expr>,
    /// What it does, after the exit actions and before the entry actions.
    pub body: Vec<Stmt>,
    /// Where it was written.
    pub at: Span,
}

/// A node of a plan tree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanNode {
    /// Kind.
    pub kind: PlanKind,
    /// Children, by index.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<u32>,
    /// Name shown in pictures and traces.
    pub label: String,
    /// Where it was written.
    pub at: Span,
}

/// Kinds of plan nodes; `runtime/src/nodes/` has one file each with its result and halt semantics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanKind {
    /// Children in order until one fails. With memory it resumes at the running child; reactive starts
    /// again at the first at every tick.
    Sequence {
        /// Resumes at the running child.
        memory: bool,
    },
    /// Children in order until one succeeds.
    Fallback {
        /// Resumes at the running child.
        memory: bool,
    },
    /// All children at every tick; succeeds when `successes` of them have (all when absent), fails when
    /// that cannot be reached any more.
    Parallel {
        /// How many must succeed.
        successes: Option<u32>,
    },
    /// Ticks its child again when it failed, so many times.
    Retry(u32),
    /// Fails when its child runs longer.
    Timeout(Expr),
    /// Ticks its child again when it succeeded: so many times, or while a condition holds.
    Repeat {
        /// How many times.
        times: Option<u32>,
        /// While this holds; tested before every round.
        condition: Option<Expr>,
    },
    /// Turns success into failure and failure into success.
    Invert,
    /// Failure becomes success.
    Succeed,
    /// Succeeds when the condition holds, else fails.
    Check(Expr),
    /// Runs for a duration, then succeeds.
    Wait(Expr),
    /// Runs until the condition holds, then succeeds.
    WaitUntil(Expr),
    /// Statements. Without `until` they run once and succeed; with it they run at every tick until it holds.
    Act {
        /// Evaluated before `until` and `fails`.
        prelude: Vec<Stmt>,
        /// What it does.
        body: Vec<Stmt>,
        /// Success.
        until: Option<Expr>,
        /// Failure.
        fails: Option<Expr>,
        /// What it does when it is halted while running.
        halt: Vec<Stmt>,
    },
}

/// Decides which of several proposals an actuator gets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Arbiter {
    /// Actuator port of the owning agent.
    pub actuator: u32,
    /// The units it listens to.
    pub sources: Vec<Source>,
    /// How it decides.
    pub strategy: Strategy,
    /// Types of the locals of its expressions.
    pub locals: Vec<Type>,
    /// Agent-level `let`s its expressions use.
    pub prelude: Vec<Stmt>,
    /// Where it was written.
    pub at: Span,
}

/// A unit that proposes commands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// Agent type.
    pub agent: u32,
    /// Unit of it.
    pub unit: u32,
    /// Where it was written.
    pub at: Span,
}

/// Arbitration strategies. A proposal counts while it is alive (two periods of its unit). When nobody
/// proposes, the safe action runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strategy {
    /// The highest index wins, evaluated at each decision; the first source wins a tie.
    Priority(Vec<Expr>),
    /// Subsumption: the topmost layer that proposes and is not inhibited wins; what it suppresses loses.
    Layers(Vec<Layer>),
    /// The first source with a proposal wins.
    Switch,
    /// Weighted mean of the proposals that are alive (twists and vectors only).
    Blend(Vec<Expr>),
}

/// A subsumption layer; same order as the sources, topmost first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Sources it suppresses while it proposes.
    pub suppresses: Vec<u32>,
    /// How long it goes on suppressing after its last proposal.
    pub hold: Option<Expr>,
    /// While this holds its proposals do not count.
    pub inhibited: Option<Expr>,
}
