//! The machine that runs bytecode.
//!
//! Every access to a register is checked: the compiler makes only code whose registers lie in the frame,
//! and were it ever wrong, the run would end in [`FaultKind::Malformed`].

use super::code::{EffectCode, Instr, Program};
use super::{Block, Effect, Env, Fault, FaultKind, MAX_ROBOTS, Memory, builtins, geometry as g, lists};
use crate::{Distribution, Span};

/// Beyond this, whole numbers have gaps.
pub(super) const MAX_INT: f64 = 9_007_199_254_740_992.0;

/// What a run changes besides its frame.
pub(super) struct Machine<'m, 'a> {
    pub memory: &'m mut Memory<'a>,
    pub env: &'m mut dyn Env,
    /// The robot in question before this run put another one there.
    former: Option<Option<u32>>,
}

impl<'m, 'a> Machine<'m, 'a> {
    pub fn new(memory: &'m mut Memory<'a>, env: &'m mut dyn Env) -> Self {
        Machine { memory, env, former: None }
    }

    /// Puts a robot in question; returns the former one in the form of a register.
    fn set_robot(&mut self, robot: u32) -> f64 {
        let before = self.env.robot();
        self.former.get_or_insert(before);
        self.env.set_robot(Some(robot));
        f64::from_bits(before.map_or(0, |r| u64::from(r) + 1))
    }

    fn restore_robot(&mut self, register: f64) {
        let r = register.to_bits();
        self.env.set_robot(r.checked_sub(1).map(|r| r as u32));
    }

    fn robot(&self) -> Result<u32, FaultKind> {
        self.env.robot().ok_or(FaultKind::Unavailable("a robot in question"))
    }
}

impl Program {
    /// Runs a block. `frame` has at least [`Block::frame`] registers; blocks of one scope are given the
    /// same frame. The result is in `frame[block.result..][..block.width]`.
    ///
    /// # Errors
    /// A [`Fault`] ends the run; effects and states until then stay.
    pub fn run(
        &self,
        block: &Block,
        frame: &mut [f64],
        memory: &mut Memory<'_>,
        env: &mut dyn Env,
    ) -> Result<(), Fault> {
        let mut machine = Machine::new(memory, env);
        let done = self.execute(block.start as usize, frame, &mut machine);
        if let (Err(_), Some(former)) = (&done, machine.former) {
            machine.env.set_robot(former);
        }
        done
    }

    #[allow(clippy::too_many_lines)] // One arm an instruction; splitting it would cost every dispatch a call.
    pub(super) fn execute(
        &self,
        start: usize,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
    ) -> Result<(), Fault> {
        let code = self.code.as_slice();
        let constants = self.constants.as_slice();
        let mut pc = start;
        let kind = 'fault: {
            macro_rules! fault {
                ($kind:expr) => {
                    break 'fault $kind
                };
            }
            macro_rules! try_ {
                ($result:expr) => {
                    match $result {
                        Ok(v) => v,
                        Err(kind) => fault!(kind),
                    }
                };
            }
            macro_rules! some {
                ($option:expr) => {
                    match $option {
                        Some(v) => v,
                        None => fault!(FaultKind::Malformed),
                    }
                };
            }
            macro_rules! get {
                ($a:expr) => {
                    *some!(frame.get($a as usize))
                };
            }
            macro_rules! set {
                ($d:expr, $v:expr) => {{
                    let v: f64 = $v;
                    *some!(frame.get_mut($d as usize)) = v
                }};
            }
            macro_rules! finite {
                ($d:expr, $v:expr) => {{
                    let v: f64 = $v;
                    if !v.is_finite() {
                        fault!(FaultKind::NotFinite)
                    }
                    set!($d, v)
                }};
            }
            macro_rules! int {
                ($d:expr, $v:expr) => {{
                    let v: f64 = $v;
                    if v.is_nan() || v.abs() > MAX_INT {
                        fault!(FaultKind::Overflow)
                    }
                    set!($d, v)
                }};
            }
            macro_rules! truth {
                ($d:expr, $v:expr) => {{
                    let v: bool = $v;
                    set!($d, f64::from(u8::from(v)))
                }};
            }
            macro_rules! k {
                ($k:expr) => {
                    *some!(constants.get($k as usize))
                };
            }
            macro_rules! span {
                ($a:expr, $n:expr) => {{
                    let (a, n) = ($a as usize, $n as usize);
                    some!(frame.get_mut(a..a + n))
                }};
            }
            macro_rules! jump {
                ($when:expr, $to:expr) => {
                    if $when {
                        pc = $to as usize;
                    }
                };
            }
            macro_rules! vector {
                ($a:expr) => {
                    some!(array::<3>(frame, $a))
                };
            }
            macro_rules! set_vector {
                ($d:expr, $v:expr) => {{
                    let v: [f64; 3] = $v;
                    if !(v[0].is_finite() && v[1].is_finite() && v[2].is_finite()) {
                        fault!(FaultKind::NotFinite)
                    }
                    span!($d, 3usize).copy_from_slice(&v)
                }};
            }
            loop {
                let instr = *some!(code.get(pc));
                pc += 1;
                match instr {
                    Instr::End => return Ok(()),
                    Instr::Fail => fault!(FaultKind::Malformed),

                    Instr::Jump { to } => pc = to as usize,
                    Instr::JumpIf { a, to } => jump!(get!(a) != 0.0, to),
                    Instr::JumpUnless { a, to } => jump!(get!(a) == 0.0, to),
                    Instr::JumpLt { a, b, to } => jump!(get!(a) < get!(b), to),
                    Instr::JumpLe { a, b, to } => jump!(get!(a) <= get!(b), to),
                    Instr::JumpEq { a, b, to } => jump!(get!(a) == get!(b), to),
                    Instr::JumpNe { a, b, to } => jump!(get!(a) != get!(b), to),
                    Instr::JumpLtK { a, k, to } => jump!(get!(a) < k!(k), to),
                    Instr::JumpLeK { a, k, to } => jump!(get!(a) <= k!(k), to),
                    Instr::JumpGtK { a, k, to } => jump!(get!(a) > k!(k), to),
                    Instr::JumpGeK { a, k, to } => jump!(get!(a) >= k!(k), to),
                    Instr::JumpEqK { a, k, to } => jump!(get!(a) == k!(k), to),
                    Instr::JumpNeK { a, k, to } => jump!(get!(a) != k!(k), to),

                    Instr::Const { d, k } => set!(d, k!(k)),
                    Instr::Move { d, a } => set!(d, get!(a)),
                    Instr::LoadState { d, at } => set!(d, *some!(m.memory.states.get(at as usize))),
                    Instr::Load { space, d, at } => {
                        try_!(self.transfer(space, at as usize, frame, d as usize, 1, m.memory));
                    }
                    Instr::Copy { space, d, at, n } => {
                        try_!(self.transfer(space, at as usize, frame, d as usize, n as usize, m.memory));
                    }

                    Instr::Add { d, a, b } => finite!(d, get!(a) + get!(b)),
                    Instr::Sub { d, a, b } => finite!(d, get!(a) - get!(b)),
                    Instr::Mul { d, a, b } => finite!(d, get!(a) * get!(b)),
                    Instr::Div { d, a, b } => {
                        let by = get!(b);
                        if by == 0.0 {
                            fault!(FaultKind::DivisionByZero)
                        }
                        finite!(d, get!(a) / by)
                    }
                    Instr::AddK { d, a, k } => finite!(d, get!(a) + k!(k)),
                    Instr::SubFromK { d, a, k } => finite!(d, k!(k) - get!(a)),
                    Instr::MulK { d, a, k } => finite!(d, get!(a) * k!(k)),
                    Instr::DivK { d, a, k } => finite!(d, get!(a) / k!(k)),
                    Instr::AddInt { d, a, b } => int!(d, get!(a) + get!(b)),
                    Instr::SubInt { d, a, b } => int!(d, get!(a) - get!(b)),
                    Instr::MulInt { d, a, b } => int!(d, get!(a) * get!(b)),
                    Instr::AddWrap { d, a, b } => finite!(d, g::wrap(get!(a) + get!(b))),
                    Instr::SubWrap { d, a, b } => finite!(d, g::wrap(get!(a) - get!(b))),
                    Instr::Neg { d, a } => set!(d, -get!(a)),
                    Instr::Not { d, a } => truth!(d, get!(a) == 0.0),
                    Instr::Sqrt { d, a } => {
                        let x = get!(a);
                        if x < 0.0 {
                            fault!(FaultKind::Domain("the square root of a negative number"))
                        }
                        finite!(d, x.sqrt())
                    }
                    Instr::Abs { d, a } => set!(d, get!(a).abs()),
                    Instr::Min { d, a, b } => {
                        let (x, y) = (get!(a), get!(b));
                        set!(d, if y < x { y } else { x })
                    }
                    Instr::Max { d, a, b } => {
                        let (x, y) = (get!(a), get!(b));
                        set!(d, if y > x { y } else { x })
                    }
                    Instr::Power { d, a, n } => {
                        let x = get!(a);
                        if n < 0 && x == 0.0 {
                            fault!(FaultKind::DivisionByZero)
                        }
                        finite!(d, builtins::power(x, n))
                    }
                    Instr::PowerInt { d, a, n } => int!(d, builtins::power(get!(a), n)),

                    Instr::Lt { d, a, b } => truth!(d, get!(a) < get!(b)),
                    Instr::Le { d, a, b } => truth!(d, get!(a) <= get!(b)),
                    Instr::Eq { d, a, b } => truth!(d, get!(a) == get!(b)),
                    Instr::Ne { d, a, b } => truth!(d, get!(a) != get!(b)),
                    Instr::LtK { d, a, k } => truth!(d, get!(a) < k!(k)),
                    Instr::LeK { d, a, k } => truth!(d, get!(a) <= k!(k)),
                    Instr::GtK { d, a, k } => truth!(d, get!(a) > k!(k)),
                    Instr::GeK { d, a, k } => truth!(d, get!(a) >= k!(k)),
                    Instr::EqK { d, a, k } => truth!(d, get!(a) == k!(k)),
                    Instr::NeK { d, a, k } => truth!(d, get!(a) != k!(k)),
                    Instr::EqN { n, d, a, b } => {
                        let n = u32::from(n);
                        let mut equal = true;
                        for i in 0..n {
                            equal &= get!(a + i) == get!(b + i);
                        }
                        truth!(d, equal)
                    }

                    Instr::Add3 { d, a, b } => set_vector!(d, g::add(vector!(a), vector!(b))),
                    Instr::Sub3 { d, a, b } => set_vector!(d, g::sub(vector!(a), vector!(b))),
                    Instr::AddN { n, d, a, b } => {
                        for i in 0..u32::from(n) {
                            finite!(d + i, get!(a + i) + get!(b + i));
                        }
                    }
                    Instr::SubN { n, d, a, b } => {
                        for i in 0..u32::from(n) {
                            finite!(d + i, get!(a + i) - get!(b + i));
                        }
                    }
                    Instr::NegN { n, d, a } => {
                        for i in 0..u32::from(n) {
                            set!(d + i, -get!(a + i));
                        }
                    }
                    Instr::ScaleN { n, d, a, b } => {
                        let by = get!(b);
                        for i in 0..u32::from(n) {
                            finite!(d + i, get!(a + i) * by);
                        }
                    }
                    Instr::DivN { n, d, a, b } => {
                        let by = get!(b);
                        if by == 0.0 {
                            fault!(FaultKind::DivisionByZero)
                        }
                        for i in 0..u32::from(n) {
                            finite!(d + i, get!(a + i) / by);
                        }
                    }
                    Instr::Dot { d, a, b } => {
                        let ([ax, ay, az], [bx, by, bz]) = (vector!(a), vector!(b));
                        finite!(d, ax * bx + ay * by + az * bz)
                    }
                    Instr::Norm { d, a } => finite!(d, g::norm(vector!(a))),
                    Instr::Distance { d, a, b } => finite!(d, g::norm(g::sub(vector!(a), vector!(b)))),

                    Instr::Yaw { d, a } => finite!(d, g::yaw(g::orientation(some!(array::<7>(frame, a))))),
                    Instr::Roll { d, a } => finite!(d, g::roll(g::orientation(some!(array::<7>(frame, a))))),
                    Instr::Pitch { d, a } => {
                        finite!(d, g::pitch(g::orientation(some!(array::<7>(frame, a)))));
                    }
                    Instr::Function1 { f, d, a } => {
                        let x = get!(a);
                        finite!(d, try_!(builtins::one(f, x)))
                    }
                    Instr::Function2 { f, d, a, b } => {
                        let (x, y) = (get!(a), get!(b));
                        finite!(d, try_!(builtins::two(f, x, y)))
                    }
                    Instr::FunctionN { f, d, a } => {
                        try_!(builtins::many(f, frame, d as usize, a as usize));
                    }

                    Instr::MatrixProduct { r, n, c, d, a, b } => {
                        try_!(builtins::matrix_product([r, n, c], frame, d as usize, a as usize, b as usize));
                    }
                    Instr::Transpose { r, c, d, a } => {
                        for i in 0..u32::from(r) {
                            for j in 0..u32::from(c) {
                                set!(d + j * u32::from(r) + i, get!(a + i * u32::from(c) + j));
                            }
                        }
                    }
                    Instr::Inverse { n, d, a } => try_!(builtins::inverse(n, frame, d as usize, a as usize)),

                    Instr::Call { function, base } => {
                        let f = some!(self.functions.get(function as usize));
                        let callee = some!(frame.get_mut(base as usize..));
                        self.execute(f.start as usize, callee, m)?;
                    }

                    Instr::Now { d } => finite!(d, try_!(m.env.now())),
                    Instr::Steps { d } => finite!(d, try_!(m.env.steps())),
                    Instr::Elapsed { d } => finite!(d, try_!(m.env.elapsed())),
                    Instr::Own { which, d, n } => try_!(m.env.own(which, span!(d, n))),
                    Instr::Reading { optional, d, port, n } => {
                        try_!(m.env.reading(port, optional, span!(d, n)));
                    }
                    Instr::Heard { d, topic, n } => try_!(m.env.heard(topic, span!(d, n))),
                    Instr::Truth { which, d, n } => {
                        let robot = try_!(m.robot());
                        try_!(m.env.truth(robot, which, span!(d, n)));
                    }
                    Instr::RunFact { which, d } => finite!(d, try_!(m.env.run(which))),
                    Instr::Believed { d, state } => {
                        let (agent, state, n) = *some!(self.believed.get(state as usize));
                        let robot = try_!(m.robot());
                        try_!(m.env.believed(robot, agent, state, span!(d, n)));
                    }
                    Instr::Achieved { d, goal } => truth!(d, try_!(m.env.achieved(goal))),
                    Instr::Inside { d, a, b } => {
                        truth!(d, try_!(m.env.inside(vector!(a), get!(b) as u32)));
                    }
                    Instr::Draw { d, a } => {
                        let from = Distribution::from_registers(&some!(array::<4>(frame, a)));
                        try_!(builtins::can_draw(from));
                        finite!(d, try_!(m.env.draw(from)))
                    }

                    Instr::RobotFirst { q, to } => {
                        let count = try_!(m.env.robots());
                        if count > MAX_ROBOTS {
                            fault!(FaultKind::Overflow)
                        }
                        set!(q + 1, f64::from_bits(0));
                        set!(q + 2, f64::from_bits(u64::from(count)));
                        if count == 0 {
                            pc = to as usize;
                        } else {
                            set!(q, m.set_robot(0));
                        }
                    }
                    Instr::RobotNext { q, to } => {
                        let (next, count) = (get!(q + 1).to_bits() + 1, get!(q + 2).to_bits());
                        if next < count {
                            set!(q + 1, f64::from_bits(next));
                            m.env.set_robot(Some(next as u32));
                            pc = to as usize;
                        } else {
                            m.restore_robot(get!(q));
                        }
                    }
                    Instr::RobotSet { q, group } => match m.env.robot_of_group(group) {
                        Some(robot) => set!(q, m.set_robot(robot)),
                        None => fault!(FaultKind::Unavailable("this robot")),
                    },
                    Instr::RobotRestore { q } => m.restore_robot(get!(q)),
                    Instr::RobotCount { d, q } => set!(d, get!(q + 2).to_bits() as f64),

                    Instr::ListFirst { list, to } => {
                        let l = some!(self.lists.get(list as usize));
                        let count = try_!(self.count(l, frame, m.memory));
                        if count == 0 {
                            pc = to as usize;
                        } else {
                            set!(l.state, f64::from_bits(0));
                            set!(l.state + 1, f64::from_bits(count as u64));
                            try_!(self.item(l, 0, frame, m.memory));
                        }
                    }
                    Instr::ListNext { list, to } => {
                        let l = some!(self.lists.get(list as usize));
                        let (next, count) = (get!(l.state).to_bits() + 1, get!(l.state + 1).to_bits());
                        if next < count {
                            set!(l.state, f64::from_bits(next));
                            try_!(self.item(l, next as usize, frame, m.memory));
                            pc = to as usize;
                        }
                    }
                    Instr::Keep { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let i = get!(l.state).to_bits() as usize;
                        try_!(self.keep(l, i, frame, d as usize, m.memory));
                    }
                    Instr::Append { list, d, a } => {
                        let l = some!(self.lists.get(list as usize));
                        try_!(lists::append(l, frame, d as usize, a as usize));
                    }
                    Instr::Found { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let i = get!(l.state).to_bits() as usize;
                        try_!(self.found(l, i, frame, d as usize, m.memory));
                    }
                    Instr::Least { list, d, a } => {
                        let l = some!(self.lists.get(list as usize));
                        let (i, key) = (get!(l.state).to_bits() as usize, get!(a));
                        if i == 0 || key < get!(l.state + 2) {
                            set!(l.state + 2, key);
                            try_!(self.found(l, i, frame, d as usize, m.memory));
                        }
                    }
                    Instr::Greatest { list, d, a } => {
                        let l = some!(self.lists.get(list as usize));
                        let (i, key) = (get!(l.state).to_bits() as usize, get!(a));
                        if i == 0 || key > get!(l.state + 2) {
                            set!(l.state + 2, key);
                            try_!(self.found(l, i, frame, d as usize, m.memory));
                        }
                    }
                    Instr::ListLength { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        set!(d, try_!(self.count(l, frame, m.memory)) as f64)
                    }
                    Instr::ListAt { list, d, a } => {
                        let l = some!(self.lists.get(list as usize));
                        let index = get!(a);
                        try_!(self.at(l, index, frame, d as usize, m.memory));
                    }
                    Instr::ListLast { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let count = try_!(self.count(l, frame, m.memory));
                        try_!(self.at(l, count as f64 - 1.0, frame, d as usize, m.memory));
                    }
                    Instr::ListPush { list, d, a } => {
                        let l = some!(self.lists.get(list as usize));
                        try_!(self.push(l, frame, d as usize, a as usize, m.memory));
                    }
                    Instr::ListSum { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let items = try_!(self.items(l, frame, m.memory));
                        finite!(d, items.iter().fold(0.0, |s, x| s + x))
                    }
                    Instr::ListSmallest { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let best = try_!(self.items(l, frame, m.memory)).iter().copied();
                        let best = best.reduce(|a, b| if b < a { b } else { a });
                        try_!(lists::optional(best, frame, d as usize));
                    }
                    Instr::ListLargest { list, d } => {
                        let l = some!(self.lists.get(list as usize));
                        let best = try_!(self.items(l, frame, m.memory)).iter().copied();
                        let best = best.reduce(|a, b| if b > a { b } else { a });
                        try_!(lists::optional(best, frame, d as usize));
                    }

                    Instr::Tidy { a, shape } => {
                        let shape = some!(self.shapes.get(shape as usize));
                        try_!(shape.tidy(some!(frame.get_mut(a as usize..))));
                    }
                    Instr::Do { effect, a } => {
                        let effect = some!(self.effects.get(effect as usize));
                        try_!(perform(effect, some!(frame.get(a as usize..)), m));
                    }
                }
            }
        };
        Err(Fault { kind, at: self.span(pc) })
    }

    /// Where the instruction before `pc` was written.
    #[cold]
    fn span(&self, pc: usize) -> Span {
        self.spans.get(pc.saturating_sub(1)).copied().unwrap_or_default()
    }
}

/// `N` registers from `a`.
#[inline]
fn array<const N: usize>(frame: &[f64], a: u32) -> Option<[f64; N]> {
    frame.get(a as usize..)?.first_chunk::<N>().copied()
}

/// Does an effect; `r` begins with its value.
fn perform(effect: &EffectCode, r: &[f64], m: &mut Machine<'_, '_>) -> Result<(), FaultKind> {
    let value = |n: u32| {
        let registers = r.get(..n as usize).ok_or(FaultKind::Malformed)?;
        if registers.iter().all(|x| x.is_finite()) { Ok(registers) } else { Err(FaultKind::NotFinite) }
    };
    let effect = match effect {
        EffectCode::State { state, at, n } => {
            let registers = value(*n)?;
            let slot = m.memory.states.get_mut(*at as usize..(*at + *n) as usize);
            slot.ok_or(FaultKind::Malformed)?.copy_from_slice(registers);
            Effect::StateSet { state: *state, registers }
        }
        EffectCode::Command { port, n } => Effect::Command { port: *port, registers: value(*n)? },
        EffectCode::Publish { topic, n } => Effect::Publish { topic: *topic, registers: value(*n)? },
        EffectCode::Tell { performative, to, content, n } => {
            Effect::Tell { performative, to, content, registers: value(*n)? }
        }
        EffectCode::Note { text, value: None } => Effect::Note { text, value: None },
        EffectCode::Note { text, value: Some((ty, n)) } => {
            Effect::Note { text, value: Some((ty, value(*n)?)) }
        }
        EffectCode::Raise(event) => Effect::Raise(*event),
        EffectCode::SetParam { param, n } => Effect::SetParam { param: *param, registers: value(*n)? },
        EffectCode::Rule { rule, at } => Effect::RuleFired { rule: *rule, at: *at },
    };
    m.env.effect(effect)
}
