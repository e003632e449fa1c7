//! The machine that runs bytecode: the loop, and the instructions that are frequent. The others are in
//! `run_other.rs`, so that the loop keeps its registers.
//!
//! Every access to a register is checked: the compiler makes only code whose registers lie in the frame,
//! and were it ever wrong, the run would end in [`FaultKind::Malformed`].

use super::code::{Instr, Program, Space};
use super::run_other::finite_part;
use super::{Block, Env, Fault, FaultKind, Memory, copy_registers, geometry as g};

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
    pub fn set_robot(&mut self, robot: u32) -> f64 {
        let before = self.env.robot();
        self.former.get_or_insert(before);
        self.env.set_robot(Some(robot));
        f64::from_bits(before.map_or(0, |r| u64::from(r) + 1))
    }

    pub fn restore_robot(&mut self, register: f64) {
        let r = register.to_bits();
        self.env.set_robot(r.checked_sub(1).map(|r| r as u32));
    }

    pub fn robot(&self) -> Result<u32, FaultKind> {
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
        let mut rest = code.get(start..).unwrap_or_default().iter();
        macro_rules! some {
            ($option:expr) => {
                match $option {
                    Some(v) => v,
                    None => return self.malformed(rest.len()),
                }
            };
        }
        macro_rules! try_ {
            ($result:expr) => {
                match $result {
                    Ok(v) => v,
                    Err(kind) => return self.fault(kind, rest.len()),
                }
            };
        }
        macro_rules! get {
            ($a:expr) => {
                *some!(frame.get($a as usize))
            };
        }
        macro_rules! k {
            ($k:expr) => {
                *some!(constants.get($k as usize))
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
                // What is not finite is not zero away from itself.
                if (v - v).is_nan() {
                    return self.not_finite(rest.len());
                }
                set!($d, v)
            }};
        }
        macro_rules! int {
            // `exact` tells whether a result of 2^53 is so or was rounded to it.
            ($d:expr, $v:expr, $exact:expr) => {{
                let v: f64 = $v;
                let inside = v.abs() < MAX_INT || (v.abs() == MAX_INT && $exact(v));
                if !inside {
                    return self.overflow(rest.len());
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
        macro_rules! go {
            ($to:expr) => {
                rest = some!(code.get($to as usize..)).iter()
            };
        }
        macro_rules! jump {
            ($when:expr, $to:expr) => {
                if $when {
                    go!($to);
                }
            };
        }
        macro_rules! vector {
            ($a:expr) => {
                some!(array::<3>(frame, $a as usize))
            };
        }
        macro_rules! put_vector {
            ($d:expr, $v:expr) => {{
                let (d, v): (usize, [f64; 3]) = ($d as usize, $v);
                *some!(some!(frame.get_mut(d..d + 3)).first_chunk_mut::<3>()) = v;
            }};
        }
        macro_rules! set_vector {
            ($d:expr, $v:expr) => {{
                let v: [f64; 3] = $v;
                if ((v[0] - v[0]) + (v[1] - v[1]) + (v[2] - v[2])).is_nan() {
                    return self.not_finite(rest.len());
                }
                put_vector!($d, v);
            }};
        }
        loop {
            let instr = some!(rest.next());
            match *instr {
                Instr::End => return Ok(()),

                Instr::Jump { to } => go!(to),
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
                Instr::Move3 { d, a } => {
                    let v = vector!(a);
                    put_vector!(d, v);
                }
                Instr::LoadState { d, at } => set!(d, *some!(m.memory.states.get(at as usize))),
                Instr::Load { space, d, at } => {
                    let slots = match space {
                        Space::Params => m.memory.params,
                        _ => m.memory.arguments,
                    };
                    set!(d, *some!(slots.get(at as usize)));
                }
                Instr::Copy { space, d, at, n } => {
                    some!(self.transfer(space, at as usize, frame, d as usize, n as usize, m.memory));
                }

                Instr::Add { d, a, b } => finite!(d, get!(a) + get!(b)),
                Instr::Sub { d, a, b } => finite!(d, get!(a) - get!(b)),
                Instr::Mul { d, a, b } => finite!(d, get!(a) * get!(b)),
                Instr::Div { d, a, b } => {
                    let by = get!(b);
                    if by == 0.0 {
                        return self.division_by_zero(rest.len());
                    }
                    finite!(d, get!(a) / by)
                }
                Instr::AddK { d, a, k } => finite!(d, get!(a) + k!(k)),
                Instr::SubFromK { d, a, k } => finite!(d, k!(k) - get!(a)),
                Instr::MulK { d, a, k } => finite!(d, get!(a) * k!(k)),
                Instr::DivK { d, a, k } => finite!(d, get!(a) / k!(k)),
                Instr::AddInt { d, a, b } => {
                    let (x, y) = (get!(a), get!(b));
                    int!(d, x + y, |v| v - x == y)
                }
                Instr::SubInt { d, a, b } => {
                    let (x, y) = (get!(a), get!(b));
                    int!(d, x - y, |v| x - v == y)
                }
                Instr::MulInt { d, a, b } => {
                    let (x, y) = (get!(a), get!(b));
                    int!(d, x * y, |v| v / x == y)
                }
                Instr::Neg { d, a } => set!(d, -get!(a)),
                Instr::Not { d, a } => truth!(d, get!(a) == 0.0),
                Instr::Sqrt { d, a } => {
                    let x = get!(a);
                    if x < 0.0 {
                        return self.negative_root(rest.len());
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
                Instr::MinK { d, a, k } => {
                    let (x, y) = (get!(a), k!(k));
                    set!(d, if y < x { y } else { x })
                }
                Instr::MaxK { d, a, k } => {
                    let (x, y) = (get!(a), k!(k));
                    set!(d, if y > x { y } else { x })
                }

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

                Instr::Add3 { d, a, b } => set_vector!(d, g::add(vector!(a), vector!(b))),
                Instr::Sub3 { d, a, b } => set_vector!(d, g::sub(vector!(a), vector!(b))),
                Instr::Scale3 { d, a, b } => {
                    let (v, by) = (vector!(a), get!(b));
                    set_vector!(d, v.map(|x| x * by))
                }
                Instr::Div3 { d, a, b } => {
                    let (v, by) = (vector!(a), get!(b));
                    if by == 0.0 {
                        return self.division_by_zero(rest.len());
                    }
                    set_vector!(d, v.map(|x| x / by))
                }
                Instr::TurnK { d, a, k } => {
                    let turn = some!(array::<2>(constants, k as usize));
                    set_vector!(d, g::turned(vector!(a), turn));
                }
                Instr::Dot { d, a, b } => {
                    let ([ax, ay, az], [bx, by, bz]) = (vector!(a), vector!(b));
                    finite!(d, ax * bx + ay * by + az * bz)
                }
                Instr::Norm { d, a } => finite!(d, g::norm(vector!(a))),
                Instr::Distance { d, a, b } => finite!(d, g::norm(g::sub(vector!(a), vector!(b)))),

                Instr::Call { function, base } => self.call(function, base, frame, m, rest.len())?,

                Instr::ListFirst { list, to } => {
                    if !some!(self.first_item(list, frame, m.memory)) {
                        go!(to);
                    }
                }
                Instr::ListNext { list, to } => {
                    if some!(self.next_item(list, frame, m.memory)) {
                        go!(to);
                    }
                }
                Instr::ListFirst3 { list, to } => {
                    let l = some!(self.lists.get(list as usize));
                    let count = (get!(l.at) as u32).min(l.capacity);
                    if count == 0 {
                        go!(to);
                    } else {
                        let first = u64::from(l.at) + 1 + u64::from(l.part.0);
                        let v = vector!(first);
                        put_vector!(l.item as usize + l.part.0 as usize, v);
                        set!(l.state, f64::from_bits(first));
                        set!(l.state + 1, f64::from_bits(first + u64::from(count) * u64::from(l.width)));
                    }
                }
                Instr::ListNext3 { stride, q, item, to } => {
                    let next = get!(q).to_bits() + u64::from(stride);
                    if next < get!(q + 1).to_bits() {
                        set!(q, f64::from_bits(next));
                        let v = vector!(next);
                        put_vector!(item, v);
                        go!(to);
                    }
                }
                Instr::Keep { list, d } => some!(self.keep(list, frame, d as usize, m.memory)),
                Instr::Append3 { most, d, a } => {
                    let n = get!(d);
                    if n >= f64::from(most) {
                        return self.malformed(rest.len());
                    }
                    let v = vector!(a);
                    put_vector!(d as usize + 1 + 3 * (n as u32 as usize), v);
                    set!(d, n + 1.0);
                }
                Instr::Append { list, d, a } => {
                    some!(self.append(list, frame, d as usize, a as usize, m.memory));
                }
                Instr::Least { list, d, a } => {
                    some!(self.least(list, frame, d as usize, a as usize, m.memory));
                }

                Instr::RobotFirst { .. } | Instr::RobotNext { .. } => {
                    if let Some(to) = try_!(self.robot_loop(instr, frame, m)) {
                        go!(to);
                    }
                }
                Instr::Now { d } => finite!(d, try_!(m.env.now())),
                Instr::Own { .. } | Instr::Reading { .. } | Instr::Heard { .. } => {
                    try_!(self.question(instr, frame, m));
                }
                Instr::StoreState { at, a, n } => {
                    let value = try_!(finite_part(frame, a, n));
                    let at = at as usize;
                    copy_registers(value, some!(m.memory.states.get_mut(at..at + value.len())));
                }
                Instr::Command { port, a, n } => {
                    let registers = try_!(finite_part(frame, a, n));
                    try_!(m.env.command(port, registers));
                }
                Instr::Publish { topic, a, n } => {
                    let registers = try_!(finite_part(frame, a, n));
                    try_!(m.env.publish(topic, registers));
                }
                Instr::Do { effect, a } => {
                    try_!(self.perform(effect, some!(frame.get(a as usize..)), m));
                }
                _ => try_!(self.other(instr, frame, m)),
            }
        }
    }

    /// A fault of the instruction after which `left` are left.
    #[cold]
    fn fault(&self, kind: FaultKind, left: usize) -> Result<(), Fault> {
        let at = self.spans.get(self.spans.len().wrapping_sub(left + 1)).copied().unwrap_or_default();
        Err(Fault { kind, at })
    }

    // One function a fault: were they one, its argument would be made ready on the way that is no fault.

    #[cold]
    #[inline(never)]
    fn malformed(&self, left: usize) -> Result<(), Fault> {
        self.fault(FaultKind::Malformed, left)
    }

    #[cold]
    #[inline(never)]
    fn not_finite(&self, left: usize) -> Result<(), Fault> {
        self.fault(FaultKind::NotFinite, left)
    }

    #[cold]
    #[inline(never)]
    fn overflow(&self, left: usize) -> Result<(), Fault> {
        self.fault(FaultKind::Overflow, left)
    }

    #[cold]
    #[inline(never)]
    fn division_by_zero(&self, left: usize) -> Result<(), Fault> {
        self.fault(FaultKind::DivisionByZero, left)
    }

    #[cold]
    #[inline(never)]
    fn negative_root(&self, left: usize) -> Result<(), Fault> {
        self.fault(FaultKind::Domain("the square root of a negative number"), left)
    }

    /// Runs a function whose frame begins at `base`.
    #[inline(never)]
    fn call(
        &self,
        function: u32,
        base: u32,
        frame: &mut [f64],
        m: &mut Machine<'_, '_>,
        left: usize,
    ) -> Result<(), Fault> {
        match (self.functions.get(function as usize), frame.get_mut(base as usize..)) {
            (Some(f), Some(frame)) => self.execute(f.start as usize, frame, m),
            _ => self.malformed(left),
        }
    }
}

/// `N` registers from `a`.
#[inline]
pub(super) fn array<const N: usize>(frame: &[f64], a: usize) -> Option<[f64; N]> {
    // One comparison, where a beginning and a length would take two.
    frame.get(a..a.checked_add(N)?)?.first_chunk::<N>().copied()
}
