//! The records of a trace.

use super::exact;
use crate::time::Time;
use serde::{Deserialize, Serialize};

/// One record. Numbers count from 0 without gaps; `causes` are numbers of earlier records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Number.
    pub n: u64,
    /// Virtual time.
    pub t: Time,
    /// What brought it about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub causes: Vec<u64>,
    /// What happened.
    pub event: Event,
}

/// What ties a FIPA-ACL message to others.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Thread {
    /// The conversation it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conversation_id: Option<String>,
    /// Its protocol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub protocol: Option<String>,
    /// The ontology of its content.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ontology: Option<String>,
    /// What an answer refers to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply_with: Option<String>,
    /// What it answers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_reply_to: Option<String>,
    /// When an answer comes too late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reply_by: Option<Time>,
}

impl Thread {
    fn is_empty(&self) -> bool {
        *self == Thread::default()
    }
}

/// What happened. Agents are `agent@robot`; values are in register form unless said otherwise.
#[allow(missing_docs, reason = "the fields are what the comment of their variant says")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event {
    /// A reading crossed a port: the input of a run.
    Reading {
        robot: u32,
        sensor: u32,
        captured: Time,
        #[serde(with = "exact::registers")]
        registers: Vec<f64>,
    },
    /// An image crossed a port: a reading of which only the digest is kept, and from what it can be taken again.
    Image {
        robot: u32,
        sensor: u32,
        captured: Time,
        width: u32,
        height: u32,
        digest: String,
        #[serde(with = "exact::registers")]
        view: Vec<f64>,
    },
    /// A unit was released, ran, and finished. `skipped` says why it did not run. When a unit on a core
    /// finishes, a [`Event::Completion`] tells.
    Activation {
        robot: u32,
        agent: String,
        unit: String,
        release: Time,
        start: Time,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        finish: Option<Time>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        skipped: Option<String>,
    },
    /// A unit that comes too soon after its last release waits.
    Deferral { robot: u32, agent: String, unit: String, until: Time },
    /// A core goes on with another unit, or stands idle.
    Switch {
        robot: u32,
        core: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        agent: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        unit: Option<String>,
    },
    /// A unit on a core is done. `rounds` are those of an anytime service.
    Completion {
        robot: u32,
        agent: String,
        unit: String,
        release: Time,
        start: Time,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        rounds: Option<u32>,
    },
    /// A unit is not done by its deadline.
    Miss { robot: u32, agent: String, unit: String, release: Time, deadline: Time },
    /// A rule fired: its place among the rules of its unit and its guard as written.
    Rule { robot: u32, agent: String, unit: String, rule: u32, guard: String },
    /// A machine went from one state to another.
    Transition { robot: u32, agent: String, unit: String, from: String, to: String },
    /// A plan node ended or was halted: `success`, `failure`, `halted`.
    Node { robot: u32, agent: String, unit: String, node: u32, label: String, result: String },
    /// A state of an agent changed.
    State {
        robot: u32,
        agent: String,
        state: String,
        #[serde(with = "exact::registers")]
        registers: Vec<f64>,
    },
    /// A message was published on a topic.
    Message {
        robot: u32,
        agent: String,
        topic: String,
        #[serde(with = "exact::registers")]
        registers: Vec<f64>,
    },
    /// A FIPA-ACL message was sent. `content` is the record it carries, if it does.
    Acl {
        robot: u32,
        performative: String,
        sender: String,
        receiver: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        content: Option<String>,
        #[serde(default, skip_serializing_if = "Vec::is_empty", with = "exact::registers")]
        registers: Vec<f64>,
        /// A reason in words, as that of a refusal.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
        #[serde(default, skip_serializing_if = "Thread::is_empty")]
        thread: Box<Thread>,
    },
    /// A conversation of an agent went into another state; in the last one it is over.
    Conversation { robot: u32, agent: String, conversation_id: String, state: String, over: bool },
    /// A service of an agent was started or stopped; for a sub-goal, when the planner-matcher did it.
    Service {
        robot: u32,
        agent: String,
        service: String,
        running: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        subgoal: Option<String>,
    },
    /// An agent is `running`, `dead`, `restarted`; and why.
    Life { robot: u32, agent: String, status: String, reason: String },
    /// A device of an agent is used by a unit, or free; so many wait for it.
    Device {
        robot: u32,
        agent: String,
        device: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        unit: Option<String>,
        waiting: u32,
    },
    /// A message was delivered to a mailbox, or dropped on the way (`dropped` says why).
    Delivery {
        robot: u32,
        agent: String,
        topic: String,
        message: u64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        dropped: Option<String>,
    },
    /// An arbiter decided. Each loser comes with the reason.
    Arbitration { robot: u32, actuator: String, winner: Option<String>, losers: Vec<(String, String)> },
    /// A command crossed a port.
    Command {
        robot: u32,
        actuator: u32,
        #[serde(with = "exact::registers")]
        registers: Vec<f64>,
        expires: Time,
    },
    /// A safe action began, and why.
    SafeAction { robot: u32, action: String, reason: String },
    /// A parameter was changed by an agent, or by `operator`.
    Param {
        agent: String,
        param: String,
        #[serde(with = "exact::registers")]
        registers: Vec<f64>,
    },
    /// A declared fault strikes a sensor, `robot.sensor`.
    Trouble { target: String, text: String },
    /// An operator did something, in these words: `kill` an `agent`, `set` a `param` to `registers`, or `stop`
    /// the run. An input of the run, like a reading.
    Input {
        text: String,
        operation: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        agent: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        param: Option<String>,
        #[serde(default, skip_serializing_if = "Vec::is_empty", with = "exact::registers")]
        registers: Vec<f64>,
    },
    /// A remark.
    Note { robot: u32, agent: String, text: String },
    /// World truth of a robot, for pictures, reports and replays; `path_m` is the length of its path so far.
    Pose {
        robot: u32,
        #[serde(with = "exact::pose")]
        pose: [f64; 7],
        #[serde(default, with = "exact::number")]
        path_m: f64,
    },
    /// World truth of a mover, for pictures.
    Mover {
        name: String,
        #[serde(with = "exact::pose")]
        pose: [f64; 7],
    },
    /// Two bodies touched or parted.
    Contact {
        robot: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        other: Option<u32>,
        with: String,
        begin: bool,
    },
    /// A goal or sub-goal changed its status: `active`, `achieved`, `failed`. `robot` is absent for goals.
    Goal {
        goal: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        robot: Option<u32>,
        status: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
    },
    /// An expectation was decided: held or violated, with its margin.
    Expectation {
        index: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        robot: Option<u32>,
        held: bool,
        #[serde(default, skip_serializing_if = "Option::is_none", with = "exact::optional")]
        margin: Option<f64>,
    },
    /// Something went wrong in an activation or a platform.
    Fault {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        robot: Option<u32>,
        agent: String,
        text: String,
    },
    /// The run ended: `success`, `failed`, `timeout`, `aborted`.
    End { outcome: String, reason: String },
}
