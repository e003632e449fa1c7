//! Code for what is read: constants, locals, slots of memory, readings, questions to the surroundings.

use super::emit::error;
use super::expr::{arguments, gives};
use super::{Compiled, Compiler, Place};
use crate::{
    Expr, Op, Own, Run, Span, Truth, Type, Value,
    eval::{
        code::{Instr, Space},
        widths::same_layout,
    },
};

/// Widest slot that is loaded before a loop.
const LOAD_WIDTH: u32 = 8;

impl Compiler<'_> {
    #[inline(never)]
    pub(super) fn gen_const(&mut self, e: &Expr, value: &Value, dest: Option<u32>) -> Compiled<Place> {
        arguments::<0>(e)?;
        let n = self.width(&e.ty, e.span)?;
        let mut flat = Vec::new();
        let fits = value.flatten(&e.ty, self.widths.table, self.texts, &mut flat);
        if fits.is_none() || flat.len() != n as usize || !flat.iter().all(|x| x.is_finite()) {
            return error(e.span, format!("the constant is no {}", e.ty));
        }
        let at = match flat.as_slice() {
            [x] => self.pooled(*x),
            _ => {
                let k = self.program.constants.len() as u32;
                self.program.constants.extend_from_slice(&flat);
                k
            }
        };
        Ok(self.settle(Place { space: Space::Constants, at }, dest, n, e.span))
    }

    #[inline(never)]
    pub(super) fn gen_slot(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        arguments::<0>(e)?;
        if let Op::Local(i) = e.op {
            let (register, t) = self.local(i, e.span)?;
            gives(e, &t)?;
            let n = self.width(&t, e.span)?;
            let bound = self.body.bound.get(i as usize).copied().flatten();
            let place = bound.unwrap_or(Place::frame(register));
            if place.space != Space::Constants {
                self.body.variable += 1;
            }
            return Ok(self.settle(place, dest, n, e.span));
        }
        self.body.variable += 1;
        let (place, n) = self.slot(e)?;
        let loaded = self.body.loaded.iter().find(|l| l.0 == place);
        let place = loaded.map_or(place, |l| Place::frame(l.1));
        Ok(self.settle(place, dest, n, e.span))
    }

    /// Where a state, argument or parameter lies, and its width.
    fn slot(&mut self, e: &Expr) -> Compiled<(Place, u32)> {
        let agent = self.agent.as_ref();
        let (space, layout, i, what) = match e.op {
            Op::State(i) => (Space::States, agent.map(|a| &a.states), i, "state of the agent"),
            Op::Argument(i) => (Space::Arguments, agent.map(|a| &a.arguments), i, "argument of the agent"),
            Op::Param(i) => (Space::Params, Some(&*self.params), i, "parameter"),
            _ => return error(e.span, "no slot"),
        };
        let slot = layout.and_then(|l| Some((l.range(i as usize)?, l.ty(i as usize)?.clone())));
        let Some((range, t)) = slot else {
            return error(e.span, format!("there is no {what} {i} here"));
        };
        gives(e, &t)?;
        let n = self.width(&t, e.span)?;
        if range.len() != n as usize {
            return error(e.span, format!("the {what} {i} has no layout"));
        }
        Ok((Place { space, at: range.start as u32 }, n))
    }

    /// Checks the type of a reading or of what is heard; returns whether the reading is optional.
    #[inline(never)]
    pub(super) fn check_fetched(&self, op: &Op, t: &Type, at: Span) -> Compiled<bool> {
        match (op, t) {
            (Op::Reading(i), _) => {
                let port = self.agent.as_ref().and_then(|a| a.sensors.get(*i as usize));
                let Some(port) = port else {
                    return error(at, format!("there is no sensor {i} here"));
                };
                let fits = match t {
                    Type::Option(value) if port.optional => same_layout(value, &port.ty),
                    _ => !port.optional && same_layout(t, &port.ty),
                };
                if fits {
                    Ok(port.optional)
                } else {
                    error(at, format!("the sensor gives {}, not {t}", port.ty))
                }
            }
            (Op::Heard(i), Type::List(item, _)) if self.agent.is_some() => {
                match self.topics.get(*i as usize) {
                    Some(topic) if same_layout(&topic.ty, item) => Ok(false),
                    Some(topic) => error(at, format!("the topic carries {}, not {item}", topic.ty)),
                    None => error(at, format!("there is no topic {i}")),
                }
            }
            _ => error(at, "nothing is heard here"),
        }
    }

    #[inline(never)]
    pub(super) fn gen_fetched(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        arguments::<0>(e)?;
        self.body.variable += 1;
        let Some(i) = self.body.fetched.iter().position(|f| f.op == e.op) else {
            return error(e.span, "no sensor or topic can be read here");
        };
        let t = self.body.fetched[i].ty.clone();
        gives(e, &t)?;
        self.fetch(i);
        let f = &self.body.fetched[i];
        let (at, n) = (f.at, f.width);
        Ok(self.settle(Place::frame(at), dest, n, e.span))
    }

    /// Fetches a reading or the messages of a topic unless that has been done.
    fn fetch(&mut self, i: usize) {
        let Some(f) = self.body.fetched.get_mut(i).filter(|f| !f.done) else {
            return;
        };
        f.done = true;
        let (d, n, span, flag) = (f.at, f.width, f.span, f.flag);
        let instr = match f.op {
            Op::Heard(topic) => Instr::Heard { d, topic, n },
            Op::Reading(port) => Instr::Reading { optional: f.optional, d, port, n },
            _ => return,
        };
        // On some way that leads here it may have been fetched.
        let mut fetched = Vec::new();
        if let Some(a) = flag {
            self.jump(Instr::JumpIf { a, to: 0 }, &mut fetched, span);
        }
        self.emit(instr, span);
        if let Some(flag) = flag {
            self.constant_into(flag, 1.0, span);
        }
        self.land(&fetched);
    }

    /// Compiles something that may not be executed: what it fetches does not count as fetched after it.
    pub(super) fn perhaps<T>(&mut self, body: impl FnOnce(&mut Self) -> Compiled<T>) -> Compiled<T> {
        let done = self.fetched();
        let made = body(self);
        self.set_fetched(done);
        made
    }

    /// What has been fetched on every way that leads here.
    pub(super) fn fetched(&self) -> Vec<bool> {
        self.body.fetched.iter().map(|f| f.done).collect()
    }

    pub(super) fn set_fetched(&mut self, done: Vec<bool>) {
        for (f, done) in self.body.fetched.iter_mut().zip(done) {
            f.done = done;
        }
    }

    /// Fetches and loads, before an outermost loop, what its body reads. What was loaded is forgotten at
    /// [`Compiler::end_loop`].
    pub(super) fn begin_loop(&mut self, body: &Expr) -> Compiled<()> {
        if self.body.in_loop {
            return Ok(());
        }
        let (mut fetched, mut slots) = (Vec::new(), Vec::new());
        body.walk(&mut |e| match e.op {
            Op::Reading(_) | Op::Heard(_) => fetched.push(e.op.clone()),
            Op::State(_) | Op::Argument(_) | Op::Param(_) => slots.push(e),
            _ => {}
        });
        for i in 0..self.body.fetched.len() {
            if fetched.contains(&self.body.fetched[i].op) {
                self.fetch(i);
            }
        }
        for e in slots {
            let (place, n) = self.slot(e)?;
            if n <= LOAD_WIDTH && self.body.loaded.iter().all(|l| l.0 != place) {
                let register = self.in_frame(place, n, e.span)?;
                self.body.loaded.push((place, register));
            }
        }
        Ok(())
    }

    /// What was loaded before a loop may not have been loaded where its code does not run.
    pub(super) fn end_loop(&mut self) {
        if !self.body.in_loop {
            self.body.loaded.clear();
        }
    }

    #[inline(never)]
    pub(super) fn gen_question(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        arguments::<0>(e)?;
        self.body.variable += 1;
        let point = Type::Point(crate::Frame::map());
        let pose = Type::Pose(crate::Frame::map());
        let t = match e.op {
            Op::Own(Own::Start) | Op::Truth(Truth::Pose) => pose,
            Op::Own(Own::Target) => point,
            Op::Believed(agent, state) => {
                let state = self.agents.get(agent as usize).and_then(|a| a.states.get(state as usize));
                match state {
                    Some(s) => s.ty.clone(),
                    None => return error(e.span, "there is no such agent or state"),
                }
            }
            Op::Offering(_) => match &e.ty {
                Type::List(item, _) if **item == Type::Agent => e.ty.clone(),
                _ => return error(e.span, "the directory gives a list of agents"),
            },
            Op::Achieved(goal) if goal as usize >= self.goals.len() => {
                return error(e.span, format!("there is no goal {goal}"));
            }
            _ => Type::NUMBER,
        };
        gives(e, &t)?;
        let n = self.width(&t, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let instr = match e.op {
            Op::Now => Instr::Now { d },
            Op::StepCount => Instr::Steps { d },
            Op::Elapsed => Instr::Elapsed { d },
            Op::Own(which) => Instr::Own { which, d, n },
            Op::Truth(which) => Instr::Truth { which, d, n },
            Op::Run(which @ (Run::Collisions | Run::InCollision)) => Instr::RunFact { which, d },
            Op::Achieved(goal) => Instr::Achieved { d, goal },
            Op::Offering(ref service) => {
                self.program.services.push(service.clone());
                Instr::Offering { d, service: (self.program.services.len() - 1) as u32, n }
            }
            Op::Executed(agent, unit, which) => {
                self.program.executed.push((agent, unit, which));
                Instr::Executed { d, unit: (self.program.executed.len() - 1) as u32 }
            }
            Op::Believed(agent, state) => {
                self.program.believed.push((agent, state, n));
                Instr::Believed { d, state: (self.program.believed.len() - 1) as u32 }
            }
            _ => return error(e.span, "no question"),
        };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }
}
