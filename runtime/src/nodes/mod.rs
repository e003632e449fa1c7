//! Plan trees: ticked at every activation of their unit, each node at most once a tick.
//!
//! A tick returns running, success or failure. A node that is not running is idle; ticking an idle
//! node starts it. Halting a running node makes it and everything running below it idle. Each file
//! here states the result and the halt of one kind for every status of its children.
//!
//! What a tree remembers between ticks is two numbers a node, in flat arrays: see [`Memory`].
//!
//! Invariant: a tick visits each node at most once, so that its cost is bounded by the size of the tree;
//! what has to be tried again is tried at the next tick.

mod act;
mod check;
mod fallback;
mod invert;
mod parallel;
mod repeat;
mod retry;
mod sequence;
mod succeed;
mod timeout;
mod tree;
mod wait;
mod wait_until;

pub use tree::{Act, Code, Kind, MAX_DEPTH, Part, Tree, TreeError};

use crate::Time;
use serde::{Deserialize, Serialize};

/// What a tick returns; `Idle` is never returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[repr(u8)]
pub enum Status {
    /// Not running.
    Idle = 0,
    /// Needs more ticks.
    Running = 1,
    /// Ended well.
    Success = 2,
    /// Ended badly.
    Failure = 3,
}

/// How a node ended, for the trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ended {
    /// With this result.
    With(Status),
    /// It was halted while running.
    Halted,
}

impl Ended {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Ended::With(Status::Success) => "success",
            Ended::With(_) => "failure",
            Ended::Halted => "halted",
        }
    }
}

/// What a tree needs of its surroundings to evaluate the code of its leaves.
pub trait Host {
    /// What goes wrong there; it ends the tick at once.
    type Fault;
    /// The instant of the tick.
    fn now(&self) -> Time;
    /// Whether a condition holds.
    fn holds(&mut self, code: Code) -> Result<bool, Self::Fault>;
    /// A duration.
    fn duration(&mut self, code: Code) -> Result<Time, Self::Fault>;
    /// Runs statements.
    fn run(&mut self, code: Code) -> Result<(), Self::Fault>;
    /// A node ended: after it ran for a time, or with another result than the time before.
    fn ended(&mut self, node: u32, how: Ended);
}

/// What a tree remembers between ticks, one entry a node.
#[derive(Debug)]
pub struct Memory<'a> {
    /// Low two bits the [`Status`], next two the result of the time before.
    pub status: &'a mut [u8],
    /// Of a sequence or fallback with memory the running child, of retry and repeat the rounds so far,
    /// of timeout and wait when it ends, in nanoseconds.
    pub slot: &'a mut [i64],
}

/// A tree in the middle of a tick.
pub(crate) struct Ticker<'a, H: Host> {
    tree: &'a Tree,
    memory: Memory<'a>,
    host: &'a mut H,
}

/// Ticks the root. The memory has one entry a node.
pub fn tick<H: Host>(tree: &Tree, memory: Memory<'_>, host: &mut H) -> Result<Status, H::Fault> {
    Ticker { tree, memory, host }.tick(0)
}

/// Halts the root, if it is running.
pub fn halt<H: Host>(tree: &Tree, memory: Memory<'_>, host: &mut H) -> Result<(), H::Fault> {
    Ticker { tree, memory, host }.halt(0)
}

impl<H: Host> Ticker<'_, H> {
    /// Ticks a node and keeps its status.
    #[inline(always)]
    fn tick(&mut self, node: u32) -> Result<Status, H::Fault> {
        match self.tree.kind(node) {
            // Most nodes of most trees are conditions: they are spared the call.
            Kind::Check(condition) => {
                let result = self.check(condition)?;
                let kept = (result as u8) << 2;
                let status = &mut self.memory.status[node as usize];
                if *status != kept {
                    *status = kept;
                    self.host.ended(node, Ended::With(result));
                }
                Ok(result)
            }
            kind => self.tick_any(node, kind),
        }
    }

    fn tick_any(&mut self, node: u32, kind: Kind) -> Result<Status, H::Fault> {
        let n = node as usize;
        let before = self.memory.status[n];
        let fresh = before & 3 != Status::Running as u8;
        let result = match kind {
            Kind::Sequence { memory } => self.sequence(node, memory, fresh),
            Kind::Fallback { memory } => self.fallback(node, memory, fresh),
            Kind::Parallel { successes } => self.parallel(node, successes, fresh),
            Kind::Retry(times) => self.retry(node, times, fresh),
            Kind::Timeout(limit) => self.timeout(node, limit, fresh),
            Kind::Repeat { times, condition } => self.repeat(node, times, condition, fresh),
            Kind::Invert => self.invert(node),
            Kind::Succeed => self.succeed(node),
            Kind::Check(condition) => self.check(condition),
            Kind::Wait(duration) => self.wait(node, duration, fresh),
            Kind::WaitUntil(condition) => self.wait_until(condition),
            Kind::Act(act) => self.act(act),
        }?;
        let last = (before >> 2) & 3;
        if result == Status::Running {
            self.memory.status[n] = (last << 2) | Status::Running as u8;
        } else {
            self.memory.status[n] = (result as u8) << 2;
            if !fresh || last != result as u8 {
                self.host.ended(node, Ended::With(result));
            }
        }
        Ok(result)
    }

    fn is_running(&self, node: u32) -> bool {
        self.memory.status[node as usize] & 3 == Status::Running as u8
    }

    /// Halts a node and everything below it that is running, children first.
    fn halt(&mut self, node: u32) -> Result<(), H::Fault> {
        let tree = self.tree;
        if !self.is_running(node) {
            return Ok(());
        }
        for &child in tree.children(node) {
            self.halt(child)?;
        }
        if let Kind::Act(act) = tree.kind(node) {
            self.halt_act(act)?;
        }
        self.memory.status[node as usize] &= !3;
        self.host.ended(node, Ended::Halted);
        Ok(())
    }

    /// Halts the children after the `from`-th.
    fn halt_after(&mut self, node: u32, from: usize) -> Result<(), H::Fault> {
        let tree = self.tree;
        for &child in tree.children(node).get(from + 1..).unwrap_or_default() {
            if self.is_running(child) {
                self.halt(child)?;
            }
        }
        Ok(())
    }
}
