//! Evaluates one activation: a service, a machine or a plan, and what it believes of its sub-goals.

use super::{
    board::Near,
    cores::Anytime,
    env::{AgentEnv, Instant},
    log::{Item, Log},
    minds::{ACHIEVED, ACTIVE, FAILED, MindMut, Position},
    post::Letter,
};
use crate::{
    Time,
    mission::code::{AgentCode, AnytimeCode, BeliefCode, KindCode, PlanCode, StateCode},
    nodes::{self, Code, Ended, Host, Status},
};
use soifra_graph::{
    Span,
    eval::{Block, Fault, FaultKind, Memory, Program},
};
use std::sync::Arc;

/// A unit that is to be activated.
#[derive(Debug, Clone)]
pub(crate) struct Release {
    pub unit: u32,
    pub release: Time,
    pub start: Time,
    /// The record that brought it about, if one did and a trace is kept.
    pub cause: Option<u64>,
    pub letter: Option<Arc<Letter>>,
    /// An anytime service whose time is over.
    pub finish: Option<Finish>,
}

/// What an anytime service goes on from.
#[derive(Debug, Clone)]
pub(crate) struct Finish {
    pub frame: Vec<f64>,
    /// Rounds that were paid for.
    pub rounds: u32,
}

/// What became of an activation.
#[derive(Debug, Clone, Default)]
pub(crate) struct Outcome {
    /// The log that has its items, and which.
    pub log: u32,
    pub from: u32,
    pub to: u32,
    /// The sensor port without a reading because of which it was skipped, and the reason.
    pub absent: Option<(u32, usize)>,
    /// It had nothing to do any more.
    pub over: bool,
    pub fault: Option<Box<Fault>>,
    /// An anytime service that has begun.
    pub anytime: Option<Box<Anytime>>,
}

/// Room for evaluating activations, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    pub frame: Vec<f64>,
    pub log: Log,
    pub near: Near,
    pub heard: Vec<u64>,
    pub before: Vec<f64>,
    pub arguments: Vec<f64>,
}

/// Activates a unit.
pub(crate) fn activate(
    instant: &Instant<'_>,
    mind: MindMut<'_>,
    desk: &mut Desk,
    release: &Release,
) -> Outcome {
    let mut outcome = Outcome { from: desk.log.items.len() as u32, ..Outcome::default() };
    let info = &instant.cast.units[release.unit as usize];
    let who = &instant.cast.instances[info.instance as usize];
    let agent = &instant.mission.agents[who.agent as usize];
    let unit = &agent.units[info.unit as usize];
    let binding = &instant.mission.groups[instant.scene.robots[who.robot as usize].group as usize].agents
        [who.binding as usize];
    for &port in &unit.requires {
        let sensor = binding.sensors[port as usize];
        if let Err(reason) = instant.senses.get(who.robot, sensor, instant.now) {
            outcome.absent = Some((port, reason));
            outcome.to = outcome.from;
            return outcome;
        }
    }
    let rounds = info.work.map_or(0, |w| instant.cast.works[w as usize].rounds);
    desk.frame[..unit.locals].fill(0.0);
    if let (Some((at, width)), Some(letter)) = (unit.letter, &release.letter)
        && letter.registers.len() == width
    {
        desk.frame[at..at + width].copy_from_slice(&letter.registers);
    }
    if let (Some(at), Some(letter)) = (unit.envelope, &release.letter)
        && let Some(envelope) = letter.envelope
    {
        for (register, x) in at.into_iter().zip(envelope) {
            desk.frame[register] = x;
        }
    }
    if instant.trace {
        desk.before.clear();
        desk.before.extend_from_slice(mind.states);
    }
    let mut run = Run {
        program: &instant.mission.program,
        frame: &mut desk.frame,
        memory: Memory {
            states: mind.states,
            arguments: instant.cast.arguments_of(info.instance as usize),
            params: instant.params,
        },
        env: AgentEnv {
            instant,
            instance: info.instance,
            who,
            binding,
            log: &mut desk.log,
            near: &mut desk.near,
            heard: &mut desk.heard,
            drawn: mind.drawn,
            entered: Time::ZERO,
        },
    };
    let position = &mut mind.positions[info.unit as usize];
    let result = match &unit.kind {
        KindCode::Service(block) => run.perhaps(*block),
        KindCode::Anytime(code) => match &release.finish {
            Some(finish) => run.answer(code, finish),
            None => run.begin(code, rounds).map(|a| outcome.anytime = Some(Box::new(a))),
        },
        KindCode::Machine { prelude, states } => {
            run.machine(*prelude, states, position, agent, &mut desk.arguments)
        }
        KindCode::Plan(_) if position.begun => {
            outcome.over = true;
            Ok(())
        }
        KindCode::Plan(plan) => {
            let nodes = plan.nodes_at..plan.nodes_at + plan.tree.len();
            let memory =
                nodes::Memory { status: &mut mind.status[nodes.clone()], slot: &mut mind.slots[nodes] };
            run.plan(plan, memory, position, mind.subgoals)
        }
    };
    let result = result.and_then(|()| run.subgoals(agent, mind.subgoals));
    if let Err(fault) = result {
        outcome.fault = Some(Box::new(fault));
        desk.log.items.truncate(outcome.from as usize);
    } else if instant.trace {
        changes(agent, &desk.before, mind.states, &mut desk.log);
    }
    outcome.to = desk.log.items.len() as u32;
    outcome
}

/// Which states have changed.
fn changes(agent: &AgentCode, before: &[f64], after: &[f64], log: &mut Log) {
    for state in 0..agent.states.slots() {
        let Some(range) = agent.states.range(state) else { continue };
        let (old, new) = (&before[range.clone()], &after[range]);
        if old.iter().zip(new).any(|(a, b)| a.to_bits() != b.to_bits()) {
            let registers = log.keep(new);
            log.items.push(Item::State { state: state as u32, registers });
        }
    }
}

/// A piece of code and what it works on.
struct Run<'a, 'i> {
    program: &'a Program,
    frame: &'a mut Vec<f64>,
    memory: Memory<'a>,
    env: AgentEnv<'a, 'i>,
}

impl Run<'_, '_> {
    fn block(&mut self, block: &Block) -> Result<(), Fault> {
        self.program.run(block, self.frame, &mut self.memory, &mut self.env)
    }

    fn perhaps(&mut self, block: Option<Block>) -> Result<(), Fault> {
        match block {
            Some(b) => self.block(&b),
            None => Ok(()),
        }
    }

    fn number(&mut self, block: &Block) -> Result<f64, Fault> {
        self.block(block)?;
        Ok(self.frame.get(block.result as usize).copied().unwrap_or(0.0))
    }

    fn holds(&mut self, block: &Block) -> Result<bool, Fault> {
        Ok(self.number(block)? != 0.0)
    }

    /// An anytime service: what comes before its rounds, and how many it makes use of. The rounds are not
    /// made yet: how many are paid for is known when the time is over.
    fn begin(&mut self, code: &AnytimeCode, most: u32) -> Result<Anytime, Fault> {
        self.perhaps(code.before)?;
        self.block(&code.first)?;
        self.keep(code, &code.first);
        let frame = self.frame.clone();
        let mut rounds = most;
        if let Some(until) = &code.until {
            let drawn = *self.env.drawn;
            rounds = 0;
            while rounds < most && !self.holds(until)? {
                self.block(&code.step)?;
                self.keep(code, &code.step);
                rounds += 1;
            }
            *self.env.drawn = drawn;
        }
        Ok(Anytime { frame, rounds })
    }

    /// Makes the rounds that were paid for, and what follows from the value.
    fn answer(&mut self, code: &AnytimeCode, finish: &Finish) -> Result<(), Fault> {
        if finish.frame.len() == self.frame.len() {
            self.frame.copy_from_slice(&finish.frame);
        }
        for _ in 0..finish.rounds {
            self.block(&code.step)?;
            self.keep(code, &code.step);
        }
        self.perhaps(code.after)
    }

    /// Makes the result of a block the value that is refined.
    fn keep(&mut self, code: &AnytimeCode, block: &Block) {
        let from = block.result as usize;
        let to = from + block.width as usize;
        if to <= self.frame.len() && code.local + block.width as usize <= self.frame.len() {
            self.frame.copy_within(from..to, code.local);
        }
    }

    /// A machine: transitions first, in order, at most one; then the body of the state it is in. The
    /// first activation enters the first state before. A transition evaluates the values for its target,
    /// then come the exit, the body of the transition, the data of the target and its entry.
    fn machine(
        &mut self,
        prelude: Option<Block>,
        states: &[StateCode],
        position: &mut Position,
        agent: &AgentCode,
        arguments: &mut Vec<f64>,
    ) -> Result<(), Fault> {
        let now = self.env.instant.now;
        self.perhaps(prelude)?;
        if !position.begun {
            *position = Position { state: 0, entered: now, begun: true };
            self.env.entered = now;
            self.perhaps(states[0].entry)?;
        }
        self.env.entered = position.entered;
        let from = position.state;
        for t in &states[from as usize].transitions {
            if !self.holds(&t.guard)? {
                continue;
            }
            arguments.clear();
            for (value, _) in &t.arguments {
                self.block(value)?;
                let result = value.result as usize..(value.result + value.width) as usize;
                arguments.extend_from_slice(self.frame.get(result).unwrap_or_default());
            }
            self.perhaps(states[from as usize].exit)?;
            self.perhaps(t.body)?;
            let mut at = 0;
            for (value, slot) in &t.arguments {
                let range = agent.states.range(*slot as usize).unwrap_or_default();
                let given = arguments.get(at..at + value.width as usize);
                if let (Some(state), Some(given)) = (self.memory.states.get_mut(range), given)
                    && state.len() == given.len()
                {
                    state.copy_from_slice(given);
                }
                at += value.width as usize;
            }
            *position = Position { state: t.target, entered: now, begun: true };
            self.env.entered = now;
            if self.env.instant.trace {
                self.env.log.items.push(Item::Transition { from, to: t.target });
            }
            self.perhaps(states[t.target as usize].entry)?;
            break;
        }
        self.perhaps(states[position.state as usize].body)
    }

    /// A plan. When it is for a sub-goal, its success achieves that and ends the plan; a failure is the
    /// status of the sub-goal until the next tick begins the plan anew.
    fn plan(
        &mut self,
        plan: &PlanCode,
        memory: nodes::Memory<'_>,
        position: &mut Position,
        subgoals: &mut [u8],
    ) -> Result<(), Fault> {
        self.perhaps(plan.prelude)?;
        let result = nodes::tick(&plan.tree, memory, &mut PlanHost { run: self, plan }).map_err(|f| *f)?;
        if let Some(s) = plan.subgoal {
            let now = match result {
                Status::Success => ACHIEVED,
                Status::Failure => FAILED,
                Status::Idle | Status::Running => ACTIVE,
            };
            position.begun = result == Status::Success;
            self.subgoal(s, now, subgoals);
        }
        Ok(())
    }

    /// Sub-goals that are achieved by belief.
    fn subgoals(&mut self, agent: &AgentCode, subgoals: &mut [u8]) -> Result<(), Fault> {
        for (i, s) in agent.subgoals.iter().enumerate() {
            let holds = match &s.achieved {
                Some(BeliefCode::State(at)) => self.memory.states.get(*at).is_some_and(|x| *x != 0.0),
                Some(BeliefCode::Condition(block)) => self.holds(block)?,
                None => continue,
            };
            self.subgoal(i as u32, if holds { ACHIEVED } else { ACTIVE }, subgoals);
        }
        Ok(())
    }

    fn subgoal(&mut self, index: u32, now: u8, subgoals: &mut [u8]) {
        let Some(status) = subgoals.get_mut(index as usize) else { return };
        if *status != now {
            *status = now;
            self.env.log.items.push(Item::Subgoal { index, status: now });
        }
    }
}

struct PlanHost<'r, 'a, 'i> {
    run: &'r mut Run<'a, 'i>,
    plan: &'r PlanCode,
}

impl PlanHost<'_, '_, '_> {
    /// Runs a piece of code and returns the first register of its result.
    #[inline(always)]
    fn evaluate(&mut self, code: Code) -> Result<f64, Box<Fault>> {
        let Some(block) = self.plan.code.get(code as usize) else { return Err(malformed()) };
        let run = &mut *self.run;
        match run.program.run(block, run.frame, &mut run.memory, &mut run.env) {
            Ok(()) => Ok(run.frame.get(block.result as usize).copied().unwrap_or(0.0)),
            Err(fault) => Err(Box::new(fault)),
        }
    }
}

#[cold]
fn malformed() -> Box<Fault> {
    Box::new(Fault { kind: FaultKind::Malformed, at: Span::default() })
}

impl Host for PlanHost<'_, '_, '_> {
    /// Boxed, because every node returns one or a status.
    type Fault = Box<Fault>;

    fn now(&self) -> Time {
        self.run.env.instant.now
    }

    #[inline(always)]
    fn holds(&mut self, code: Code) -> Result<bool, Box<Fault>> {
        Ok(self.evaluate(code)? != 0.0)
    }

    fn duration(&mut self, code: Code) -> Result<Time, Box<Fault>> {
        let s = self.evaluate(code)?;
        Ok(Time::from_seconds(s.max(0.0)).unwrap_or(Time::MAX))
    }

    fn run(&mut self, code: Code) -> Result<(), Box<Fault>> {
        self.evaluate(code).map(|_| ())
    }

    fn ended(&mut self, node: u32, how: Ended) {
        if self.run.env.instant.trace {
            self.run.env.log.items.push(Item::Node { node, how });
        }
    }
}
