//! What a run may ask of its surroundings, and what it does to them.

use super::FaultKind;
use crate::{Distribution, Execution, Function, Govern, Name, Own, Run, Span, Truth, Type};

/// The surroundings of a run. Every method has a default that says "not available here", so that an
/// implementation answers only what may be asked in its place.
///
/// `out` slices are exactly as wide as the type of the expression, see [`crate::TypeTable::width`].
/// Within one run of a block, readings and messages heard do not change: a block may ask once and use
/// the answer several times.
pub trait Env {
    /// Seconds since the run began.
    fn now(&self) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("the time"))
    }
    /// Steps since the run began.
    fn steps(&self) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("the step clock"))
    }
    /// Seconds since the current state of the machine was entered.
    fn elapsed(&self) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("the time in a state"))
    }
    /// What the robot in question knows of itself.
    fn own(&self, _which: Own, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("the robot"))
    }
    /// The reading of the agent's sensor port: the value, or tag and value for an optional port.
    fn reading(&mut self, _port: u32, _optional: bool, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("a sensor"))
    }
    /// Messages heard on a topic: count, then items.
    fn heard(&mut self, _topic: u32, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("a topic"))
    }
    /// World truth about a robot.
    fn truth(&self, _robot: u32, _which: Truth, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("world truth"))
    }
    /// A fact about the run; a `Bool` is 0 or 1.
    fn run(&self, _which: Run) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("world truth"))
    }
    /// A state of an agent of a robot.
    fn believed(&self, _robot: u32, _agent: u32, _state: u32, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("the state of an agent"))
    }
    /// What is known of the executions of a unit of an agent of a robot.
    fn executed(&self, _robot: u32, _agent: u32, _unit: u32, _which: Execution) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("the executions of a unit"))
    }
    /// Whether a goal is achieved.
    fn achieved(&self, _goal: u32) -> Result<bool, FaultKind> {
        Err(FaultKind::Unavailable("the status of a goal"))
    }
    /// Number of robots, for quantified expressions; they are numbered from 0. More than
    /// [`MAX_ROBOTS`](super::MAX_ROBOTS) are a fault.
    fn robots(&self) -> Result<u32, FaultKind> {
        Err(FaultKind::Unavailable("the list of robots"))
    }
    /// The robot that a group (not an array) stands for.
    fn robot_of_group(&self, _group: u32) -> Option<u32> {
        None
    }
    /// The agents that offer a service: count, then numbers.
    fn offering(&mut self, _service: &str, _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("the directory"))
    }
    /// The robot in question: of which `own`, `truth` and `believed` speak.
    fn robot(&self) -> Option<u32> {
        None
    }
    /// Puts another robot in question. A run that does so puts the former one back, also on a fault.
    fn set_robot(&mut self, _robot: Option<u32>) {}
    /// What a service computes from arguments that lie one after the other.
    fn service(&mut self, _which: Function, _args: &[f64], _out: &mut [f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("a service"))
    }
    /// Whether a point of `map` is in a region of the world.
    fn inside(&self, _point: [f64; 3], _region: u32) -> Result<bool, FaultKind> {
        Err(FaultKind::Unavailable("the world"))
    }
    /// Draws from a distribution; [`sample`](super::sample) with a generator of the caller's choice.
    fn draw(&mut self, _from: Distribution) -> Result<f64, FaultKind> {
        Err(FaultKind::Unavailable("randomness"))
    }
    /// A command is proposed for an actuator port of the agent. Registers are as those of an [`Effect`].
    fn command(&mut self, _port: u32, _registers: &[f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("an actuator"))
    }
    /// A message is published on a topic. Registers are as those of an [`Effect`].
    fn publish(&mut self, _topic: u32, _registers: &[f64]) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("a topic"))
    }
    /// Something else done to the surroundings.
    fn effect(&mut self, _effect: Effect<'_>) -> Result<(), FaultKind> {
        Err(FaultKind::Unavailable("an effect"))
    }
}

/// An effect of a statement. Registers are finite, and unused list items and absent optionals are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effect<'a> {
    /// Another agent of the same robot is told something.
    Tell {
        /// Performative, lower case.
        performative: &'a str,
        /// Receiving agent.
        to: &'a str,
        /// Record type of the content.
        content: &'a Name,
        /// The content.
        registers: &'a [f64],
    },
    /// A device of the agent is used for so many seconds.
    Use {
        /// Device.
        device: u32,
        /// How long.
        seconds: f64,
    },
    /// A conversation is opened.
    Open {
        /// Conversation.
        conversation: u32,
        /// Performative, lower case.
        performative: &'a str,
        /// The content.
        registers: &'a [f64],
        /// Numbers of the agents it is opened with.
        to: &'a [f64],
        /// How long to wait, in seconds, when that is said.
        within: Option<f64>,
    },
    /// Something is said in a conversation.
    Reply {
        /// Conversation.
        conversation: u32,
        /// Performative, lower case.
        performative: &'a str,
        /// Why.
        reason: Option<&'a str>,
        /// The content.
        registers: &'a [f64],
        /// Which one.
        thread: f64,
    },
    /// A remark for the trace.
    Note {
        /// Text.
        text: &'a str,
        /// A value with its type.
        value: Option<(&'a Type, &'a [f64])>,
    },
    /// An event of the agent is raised.
    Raise(u32),
    /// Something about units, sub-goals or goals.
    Govern(&'a Govern),
    /// A mission parameter is set. This run goes on seeing the former value in its memory.
    SetParam {
        /// Parameter.
        param: u32,
        /// New value.
        registers: &'a [f64],
    },
    /// A rule fires; its body follows.
    RuleFired {
        /// Place in its `Rules` statement.
        rule: u32,
        /// The guard.
        at: Span,
    },
}

/// Surroundings that answer nothing: for constants.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoEnv;

impl Env for NoEnv {}
