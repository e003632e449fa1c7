//! The instructions that are rare, or do so much that a call more does not matter.

use super::code::{EffectCode, Instr, Program, Recipients};
use super::run::{MAX_INT, Machine, array};
use super::{Effect, FaultKind, MAX_ROBOTS, builtins, geometry as g, lists};
use crate::Distribution;

/// What must be there, for the compiler made it so.
fn some<T>(option: Option<T>) -> Result<T, FaultKind> {
    option.ok_or(FaultKind::Malformed)
}

fn get(frame: &[f64], a: u32) -> Result<f64, FaultKind> {
    some(frame.get(a as usize).copied())
}

fn set(frame: &mut [f64], d: u32, x: f64) -> Result<(), FaultKind> {
    *some(frame.get_mut(d as usize))? = x;
    Ok(())
}

fn finite(frame: &mut [f64], d: u32, x: f64) -> Result<(), FaultKind> {
    if x.is_finite() { set(frame, d, x) } else { Err(FaultKind::NotFinite) }
}

fn truth(frame: &mut [f64], d: u32, x: bool) -> Result<(), FaultKind> {
    set(frame, d, f64::from(u8::from(x)))
}

/// `n` registers from `a`, which are to leave the frame.
#[inline]
pub(super) fn finite_part(frame: &[f64], a: u32, n: u32) -> Result<&[f64], FaultKind> {
    let a = a as usize;
    let registers = some(frame.get(a..a + n as usize))?;
    if registers.iter().all(|x| x.is_finite()) { Ok(registers) } else { Err(FaultKind::NotFinite) }
}

/// `n` registers from `d`, to be filled.
fn out(frame: &mut [f64], d: u32, n: u32) -> Result<&mut [f64], FaultKind> {
    let d = d as usize;
    some(frame.get_mut(d..d + n as usize))
}

/// `n` results of a function of the operand's index.
fn each(
    frame: &mut [f64],
    d: u32,
    n: u16,
    f: impl Fn(&[f64], u32) -> Result<f64, FaultKind>,
) -> Result<(), FaultKind> {
    for i in 0..u32::from(n) {
        let x = f(frame, i)?;
        finite(frame, d + i, x)?;
    }
    Ok(())
}

impl Program {
    /// Any instruction that the loop of the machine does not know and that does not jump.
    #[inline(never)]
    pub(super) fn other(
        &self,
        instr: &Instr,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
    ) -> Result<(), FaultKind> {
        match *instr {
            Instr::AddWrap { d, a, b } => {
                let x = g::wrap(get(frame, a)? + get(frame, b)?);
                finite(frame, d, x)
            }
            Instr::SubWrap { d, a, b } => {
                let x = g::wrap(get(frame, a)? - get(frame, b)?);
                finite(frame, d, x)
            }
            Instr::Power { d, a, n } => match get(frame, a)? {
                0.0 if n < 0 => Err(FaultKind::DivisionByZero),
                x => finite(frame, d, builtins::power(x, n)),
            },
            Instr::PowerInt { d, a, n } => {
                let x = builtins::power(get(frame, a)?, n);
                if x.abs() <= MAX_INT { set(frame, d, x) } else { Err(FaultKind::Overflow) }
            }
            Instr::EqN { n, d, a, b } => {
                let n = usize::from(n);
                let (a, b) = (a as usize, b as usize);
                let equal = some(frame.get(a..a + n))? == some(frame.get(b..b + n))?;
                truth(frame, d, equal)
            }
            Instr::AddN { n, d, a, b } => each(frame, d, n, |f, i| Ok(get(f, a + i)? + get(f, b + i)?)),
            Instr::SubN { n, d, a, b } => each(frame, d, n, |f, i| Ok(get(f, a + i)? - get(f, b + i)?)),
            Instr::NegN { n, d, a } => each(frame, d, n, |f, i| Ok(-get(f, a + i)?)),
            Instr::ScaleN { n, d, a, b } => {
                let by = get(frame, b)?;
                each(frame, d, n, |f, i| Ok(get(f, a + i)? * by))
            }
            Instr::DivN { n, d, a, b } => match get(frame, b)? {
                0.0 => Err(FaultKind::DivisionByZero),
                by => each(frame, d, n, |f, i| Ok(get(f, a + i)? / by)),
            },
            Instr::Yaw { d, a } => {
                let x = g::yaw(g::orientation(some(array::<7>(frame, a as usize))?));
                finite(frame, d, x)
            }
            Instr::Roll { d, a } => {
                let x = g::roll(g::orientation(some(array::<7>(frame, a as usize))?));
                finite(frame, d, x)
            }
            Instr::Pitch { d, a } => {
                let x = g::pitch(g::orientation(some(array::<7>(frame, a as usize))?));
                finite(frame, d, x)
            }
            Instr::Function1 { f, d, a } => {
                let x = builtins::one(f, get(frame, a)?)?;
                finite(frame, d, x)
            }
            Instr::Function2 { f, d, a, b } => {
                let x = builtins::two(f, get(frame, a)?, get(frame, b)?)?;
                finite(frame, d, x)
            }
            Instr::FunctionN { f, d, a } => builtins::many(f, frame, d as usize, a as usize),
            Instr::MatrixProduct { r, n, c, d, a, b } => {
                builtins::matrix_product([r, n, c], frame, d as usize, a as usize, b as usize)
            }
            Instr::Transpose { r, c, d, a } => {
                let (r, c) = (u32::from(r), u32::from(c));
                for i in 0..r * c {
                    let x = get(frame, a + i)?;
                    set(frame, d + i % c * r + i / c, x)?;
                }
                Ok(())
            }
            Instr::Inverse { n, d, a } => builtins::inverse(n, frame, d as usize, a as usize),
            Instr::Tidy { a, shape } => {
                some(self.shapes.get(shape as usize))?.tidy(some(frame.get_mut(a as usize..))?)
            }
            _ => self.list_or_question(instr, frame, m),
        }
    }

    fn list_or_question(
        &self,
        instr: &Instr,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
    ) -> Result<(), FaultKind> {
        let list = |list: u32| some(self.lists.get(list as usize));
        match *instr {
            Instr::Found { list: l, d } => {
                let l = list(l)?;
                let item = some(Program::current(l, frame))?;
                some(self.found(l, item, frame, d as usize, m.memory))
            }
            Instr::Greatest { list: l, d, a } => {
                let l = list(l)?;
                let (item, key) = (some(Program::current(l, frame))?, get(frame, a)?);
                if item == Program::first_place(l) || key > get(frame, l.state + 2)? {
                    set(frame, l.state + 2, key)?;
                    some(self.found(l, item, frame, d as usize, m.memory))?;
                }
                Ok(())
            }
            Instr::ListLength { list: l, d } => {
                let n = some(self.count(list(l)?, frame, m.memory))?;
                set(frame, d, n as f64)
            }
            Instr::ListAt { list: l, d, a } => {
                let index = get(frame, a)?;
                some(self.at(list(l)?, index, frame, d as usize, m.memory))
            }
            Instr::ListLast { list: l, d } => {
                let l = list(l)?;
                let last = some(self.count(l, frame, m.memory))? as f64 - 1.0;
                some(self.at(l, last, frame, d as usize, m.memory))
            }
            Instr::ListPush { list: l, d, a } => {
                some(self.push(list(l)?, frame, d as usize, a as usize, m.memory))
            }
            Instr::ListSum { list: l, d } => {
                let sum = some(self.items(list(l)?, frame, m.memory))?.iter().fold(0.0, |s, x| s + x);
                finite(frame, d, sum)
            }
            Instr::ListSmallest { list: l, d } => {
                let items = some(self.items(list(l)?, frame, m.memory))?;
                let best = items.iter().copied().reduce(|a, b| if b < a { b } else { a });
                some(lists::optional(best, frame, d as usize))
            }
            Instr::ListLargest { list: l, d } => {
                let items = some(self.items(list(l)?, frame, m.memory))?;
                let best = items.iter().copied().reduce(|a, b| if b > a { b } else { a });
                some(lists::optional(best, frame, d as usize))
            }
            _ => self.question(instr, frame, m),
        }
    }

    /// What is asked of the surroundings.
    #[inline(never)]
    pub(super) fn question(
        &self,
        instr: &Instr,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
    ) -> Result<(), FaultKind> {
        match *instr {
            Instr::Steps { d } => finite(frame, d, m.env.steps()?),
            Instr::Elapsed { d } => finite(frame, d, m.env.elapsed()?),
            Instr::Own { which, d, n } => m.env.own(which, out(frame, d, n)?),
            Instr::Reading { optional, d, port, n } => m.env.reading(port, optional, out(frame, d, n)?),
            Instr::Heard { d, topic, n } => m.env.heard(topic, out(frame, d, n)?),
            Instr::Truth { which, d, n } => {
                let robot = m.robot()?;
                m.env.truth(robot, which, out(frame, d, n)?)
            }
            Instr::RunFact { which, d } => finite(frame, d, m.env.run(which)?),
            Instr::Believed { d, state } => {
                let (agent, state, n) = *some(self.believed.get(state as usize))?;
                let robot = m.robot()?;
                m.env.believed(robot, agent, state, out(frame, d, n)?)
            }
            Instr::Offering { d, service, n } => {
                m.env.offering(some(self.services.get(service as usize))?, out(frame, d, n)?)
            }
            Instr::Executed { d, unit } => {
                let (agent, unit, which) = *some(self.executed.get(unit as usize))?;
                let robot = m.robot()?;
                finite(frame, d, m.env.executed(robot, agent, unit, which)?)
            }
            Instr::Achieved { d, goal } => truth(frame, d, m.env.achieved(goal)?),
            Instr::Inside { d, a, b } => {
                let inside = m.env.inside(some(array::<3>(frame, a as usize))?, get(frame, b)? as u32)?;
                truth(frame, d, inside)
            }
            Instr::Service { f, d, a, sizes } => {
                let (args, n) = *some(self.sizes.get(sizes as usize))?;
                // What it is given and where its value goes may lie anywhere; a copy is nothing beside the work.
                let args = some(frame.get(a as usize..(a + args) as usize))?.to_vec();
                let out = out(frame, d, n)?;
                m.env.service(f, &args, out)?;
                if out.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(FaultKind::NotFinite) }
            }
            Instr::Draw { d, a } => {
                let from = Distribution::from_registers(&some(array::<4>(frame, a as usize))?);
                builtins::can_draw(from)?;
                finite(frame, d, m.env.draw(from)?)
            }
            Instr::RobotSet { q, group } => {
                let robot = m.env.robot_of_group(group).ok_or(FaultKind::Unavailable("this robot"))?;
                let before = m.set_robot(robot);
                set(frame, q, before)
            }
            Instr::RobotRestore { q } => {
                m.restore_robot(get(frame, q)?);
                Ok(())
            }
            Instr::RobotCount { d, q } => {
                let count = get(frame, q + 2)?.to_bits() as f64;
                set(frame, d, count)
            }
            _ => Err(FaultKind::Malformed),
        }
    }

    /// Begin and end of a loop over the robots; returns where to jump.
    #[inline(never)]
    pub(super) fn robot_loop(
        &self,
        instr: &Instr,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
    ) -> Result<Option<u32>, FaultKind> {
        match *instr {
            Instr::RobotFirst { q, to } => {
                let count = m.env.robots()?;
                if count > MAX_ROBOTS {
                    return Err(FaultKind::Overflow);
                }
                set(frame, q + 1, f64::from_bits(0))?;
                set(frame, q + 2, f64::from_bits(u64::from(count)))?;
                if count == 0 {
                    return Ok(Some(to));
                }
                let before = m.set_robot(0);
                set(frame, q, before)?;
                Ok(None)
            }
            Instr::RobotNext { q, to } => {
                let (next, count) = (get(frame, q + 1)?.to_bits() + 1, get(frame, q + 2)?.to_bits());
                if next < count {
                    set(frame, q + 1, f64::from_bits(next))?;
                    m.env.set_robot(Some(next as u32));
                    return Ok(Some(to));
                }
                m.restore_robot(get(frame, q)?);
                Ok(None)
            }
            _ => Err(FaultKind::Malformed),
        }
    }
}

impl Program {
    /// Does an effect; `r` begins with its value.
    #[inline(never)]
    pub(super) fn perform(&self, effect: u32, r: &[f64], m: &mut Machine<'_, '_>) -> Result<(), FaultKind> {
        let value = |n: u32| finite_part(r, 0, n);
        let effect = match some(self.effects.get(effect as usize))? {
            EffectCode::Tell { performative, to, content, n } => {
                Effect::Tell { performative, to, content, registers: value(*n)? }
            }
            EffectCode::Use(device) => Effect::Use { device: *device, seconds: get(r, 0)? },
            EffectCode::Open { conversation, performative, n, to, within } => {
                let (from, capacity) = match to {
                    Recipients::One => (*n, 0),
                    Recipients::List(c) => (*n, *c),
                };
                let (agents, end) = match to {
                    Recipients::One => (finite_part(r, from, 1)?, from + 1),
                    Recipients::List(_) => {
                        let count = (get(r, from)? as u32).min(capacity);
                        (finite_part(r, from + 1, count)?, from + 1 + capacity)
                    }
                };
                let within = if *within { Some(get(r, end)?) } else { None };
                Effect::Open {
                    conversation: *conversation,
                    performative,
                    registers: value(*n)?,
                    to: agents,
                    within,
                }
            }
            EffectCode::Reply { conversation, performative, reason, n } => Effect::Reply {
                conversation: *conversation,
                performative,
                reason: reason.as_deref(),
                registers: value(*n)?,
                thread: get(r, *n)?,
            },
            EffectCode::Note { text, value: None } => Effect::Note { text, value: None },
            EffectCode::Note { text, value: Some((ty, n)) } => {
                Effect::Note { text, value: Some((ty, value(*n)?)) }
            }
            EffectCode::Raise(event) => Effect::Raise(*event),
            EffectCode::Govern(what) => Effect::Govern(what),
            EffectCode::SetParam { param, n } => Effect::SetParam { param: *param, registers: value(*n)? },
            EffectCode::Rule { rule, at } => Effect::RuleFired { rule: *rule, at: *at },
        };
        m.env.effect(effect)
    }
}
