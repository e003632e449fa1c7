//! Code for expressions.
//!
//! [`Compiler::generate`] makes the code of one expression and says where its value lies. With a `dest`
//! the value comes to lie there; without one it stays where it is when it lies somewhere already (a local,
//! a state, a constant), so that nothing is copied for nothing. Whatever depends on nothing is run once,
//! here, and replaced by its value.

use super::code::{Instr, Space};
use super::compile::{Compiled, Compiler, MAX_DEPTH, Place, error};
use super::run::Machine;
use super::widths::same_layout;
use super::{Memory, NoEnv};
use crate::{Expr, Own, Part, Run, Span, Truth, Type, Value, expr::Op, reason, typing};

/// Widest constant that is folded, and most registers a folded expression may need.
const FOLD_WIDTH: u32 = 4096;
const FOLD_FRAME: u32 = 1 << 16;

/// How much of the stack the compiler needs for an operator, relative to a sum.
fn weight(op: &Op) -> u32 {
    match op {
        Op::IfSome { .. } | Op::List(..) | Op::Fold(..) => 3,
        Op::Switch { .. } | Op::Quantified(_) | Op::If | Op::Let(_) => 2,
        _ => 1,
    }
}

/// An operand of an instruction.
pub(super) enum Operand {
    /// A register.
    Register(u32),
    /// A constant of the pool.
    Constant(u32),
}

/// The arguments of an operator that takes `N`.
pub(super) fn arguments<const N: usize>(e: &Expr) -> Compiled<&[Expr; N]> {
    match <&[Expr; N]>::try_from(e.args.as_slice()) {
        Ok(args) => Ok(args),
        Err(_) => error(e.span, format!("{N} arguments are wanted here, not {}", e.args.len())),
    }
}

/// Refuses an expression whose type is not laid out as what its operator gives.
pub(super) fn gives(e: &Expr, given: &Type) -> Compiled<()> {
    if same_layout(&e.ty, given) {
        return Ok(());
    }
    error(e.span, format!("this is {given}, and said to be {}", e.ty))
}

fn fits(e: &Expr, wanted: &Type) -> Compiled<()> {
    if same_layout(&e.ty, wanted) {
        return Ok(());
    }
    error(e.span, format!("{wanted} is wanted here, not {}", e.ty))
}

impl Compiler<'_> {
    /// Code for `e`; see the module.
    pub(super) fn generate(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let weight = weight(&e.op);
        if self.body.depth + weight > MAX_DEPTH {
            return error(e.span, "this nests too deep");
        }
        self.body.depth += weight;
        let (start, variable, cost, top) = (self.here(), self.body.variable, self.body.cost, self.body.top);
        let place = self.dispatch(e, dest)?;
        self.body.depth -= weight;
        if variable == self.body.variable && self.here() > start {
            return self.folded(e, start, place, cost, top, dest);
        }
        Ok(place)
    }

    /// The value of constant code from `start` instead of that code, when it has one.
    #[inline(never)]
    fn folded(
        &mut self,
        e: &Expr,
        start: u32,
        place: Place,
        cost: u64,
        top: u32,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        match self.fold(&e.ty, start, place, e.span) {
            Some(folded) => {
                self.body.cost = cost;
                self.body.top = top;
                let n = self.width(&e.ty, e.span)?;
                Ok(self.settle(folded, dest, n, e.span))
            }
            None => Ok(place),
        }
    }

    /// Code for `e` in the layout of `wanted`, which may be an optional of its type or a longer list.
    pub(super) fn gen_as(&mut self, e: &Expr, wanted: &Type, dest: Option<u32>) -> Compiled<Place> {
        if same_layout(&e.ty, wanted) {
            return self.generate(e, dest);
        }
        match (&e.ty, wanted) {
            (Type::List(a, n), Type::List(b, m)) if n <= m && (*n == 0 || same_layout(a, b)) => {
                let width = self.width(wanted, e.span)?;
                let d = self.dest(dest, width, e.span)?;
                self.generate(e, Some(d))
            }
            (Type::Option(_), _) => self.refuse(e, wanted),
            (_, Type::Option(value)) => {
                let width = self.width(wanted, e.span)?;
                let d = self.dest(dest, width, e.span)?;
                self.constant_into(d, 0.0, e.span);
                self.gen_as(e, value, Some(d + 1))?;
                Ok(Place::frame(d))
            }
            _ => self.refuse(e, wanted),
        }
    }

    fn refuse(&self, e: &Expr, wanted: &Type) -> Compiled<Place> {
        error(e.span, format!("{wanted} is wanted here, not {}", e.ty))
    }

    /// Runs the code from `start`, which depends on nothing, and takes it back for its value. When it
    /// faults it stays: the fault belongs to the run.
    #[inline(never)]
    fn fold(&mut self, t: &Type, start: u32, place: Place, at: Span) -> Option<Place> {
        let n = self.width(t, at).ok()?;
        if n > FOLD_WIDTH || self.body.peak > FOLD_FRAME {
            return None;
        }
        let from = match place.space {
            Space::Frame => place.at as usize,
            _ => return None,
        };
        self.program.code.push(Instr::End);
        self.program.spans.push(at);
        if self.scratch.len() < self.body.peak as usize {
            self.scratch.resize(self.body.peak as usize, 0.0);
        }
        let mut memory = Memory { states: &mut [], arguments: &[], params: &[] };
        let ran = self.program.execute(
            start as usize,
            &mut self.scratch,
            &mut Machine::new(&mut memory, &mut NoEnv),
        );
        self.program.code.pop();
        self.program.spans.pop();
        ran.ok()?;
        let shape = self.widths.shape(t).ok()?;
        let value = self.scratch.get_mut(from..from + n as usize)?;
        if let Some(shape) = shape {
            shape.tidy(value).ok()?;
        }
        self.program.code.truncate(start as usize);
        self.program.spans.truncate(start as usize);
        if let [x] = value {
            let x = *x;
            return Some(Place { space: Space::Constants, at: self.pooled(x) });
        }
        let k = self.program.constants.len() as u32;
        self.program.constants.extend_from_slice(value);
        Some(Place { space: Space::Constants, at: k })
    }

    /// Code for a number, truth value or other value of one register; returns the register.
    pub(super) fn scalar(&mut self, e: &Expr) -> Compiled<u32> {
        self.one_register(e)?;
        let place = self.generate(e, None)?;
        self.in_frame(place, 1, e.span)
    }

    fn one_register(&mut self, e: &Expr) -> Compiled<()> {
        match self.width(&e.ty, e.span)? {
            1 => Ok(()),
            _ => error(e.span, format!("a single number is wanted here, not {}", e.ty)),
        }
    }

    /// As [`Compiler::scalar`], but a constant is not loaded.
    pub(super) fn operand(&mut self, e: &Expr) -> Compiled<Operand> {
        self.one_register(e)?;
        let place = self.generate(e, None)?;
        Ok(match place.space {
            Space::Constants => Operand::Constant(place.at),
            _ => Operand::Register(self.in_frame(place, 1, e.span)?),
        })
    }

    /// Code for a value whose registers an instruction reads.
    pub(super) fn registers(&mut self, e: &Expr) -> Compiled<u32> {
        let n = self.width(&e.ty, e.span)?;
        let place = self.generate(e, None)?;
        self.in_frame(place, n, e.span)
    }

    /// Lets a local of an expression stand for a value that lies elsewhere while `body` is compiled.
    pub(super) fn with_bound<T>(
        &mut self,
        local: u32,
        place: Option<Place>,
        body: impl FnOnce(&mut Self) -> Compiled<T>,
    ) -> Compiled<T> {
        let set = |c: &mut Self, place| match c.body.bound.get_mut(local as usize) {
            Some(b) => std::mem::replace(b, place),
            None => None,
        };
        let before = set(self, place);
        let made = body(self);
        set(self, before);
        made
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

    fn dispatch(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        match &e.op {
            Op::Const(value) => self.gen_const(e, value, dest),
            Op::Local(_) | Op::State(_) | Op::Param(_) | Op::Argument(_) => self.gen_slot(e, dest),
            Op::Reading(_) | Op::Heard(_) => self.gen_fetched(e, dest),
            Op::Now
            | Op::StepCount
            | Op::Elapsed
            | Op::Own(_)
            | Op::Truth(_)
            | Op::Run(_)
            | Op::Believed(..)
            | Op::Achieved(_) => self.gen_question(e, dest),
            Op::Quantified(q) => self.gen_quantified(e, *q, dest),
            Op::OfRobot(group) => self.gen_of_robot(e, *group, dest),
            Op::Call(function) => self.gen_call(e, *function, dest),
            Op::Builtin(f) => self.gen_builtin(e, *f, dest),
            Op::Binary(op) => self.gen_binary(e, *op, dest),
            Op::Sqrt | Op::Power(_) | Op::Neg | Op::Dot => self.gen_arithmetic(e, dest),
            Op::Not => self.gen_not(e, dest),
            Op::If => self.gen_if(e, dest),
            Op::Let(local) => self.gen_let(e, *local, dest),
            Op::IfSome { local, reason } => self.gen_if_some(e, *local, *reason, dest),
            Op::Switch { variants, rest } => self.gen_switch(e, variants, *rest, dest),
            Op::MakeRecord
            | Op::MakeList
            | Op::MakeVector
            | Op::MakeRange
            | Op::MakeMatrix
            | Op::MakeSome
            | Op::MakeNone(_) => self.gen_make(e, dest),
            Op::Field(_) | Op::Item(..) => self.gen_field(e, dest),
            Op::Part(part) => self.gen_part(e, *part, dest),
            Op::List(op, local) => self.gen_list(e, *op, *local, dest),
            Op::Fold(acc, item) => self.gen_fold(e, *acc, *item, dest),
            Op::Transpose | Op::Inverse => self.gen_matrix(e, dest),
        }
    }

    #[inline(never)]
    fn gen_const(&mut self, e: &Expr, value: &Value, dest: Option<u32>) -> Compiled<Place> {
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
    fn gen_slot(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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
        let agent = self.agent.as_ref();
        let (space, layout, i, what) = match e.op {
            Op::State(i) => (Space::States, agent.map(|a| &a.states), i, "state of the agent"),
            Op::Argument(i) => (Space::Arguments, agent.map(|a| &a.arguments), i, "argument of the agent"),
            Op::Param(i) => (Space::Params, Some(&self.params), i, "parameter"),
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
        Ok(self.settle(Place { space, at: range.start as u32 }, dest, n, e.span))
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
    fn gen_fetched(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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

    /// Fetches, before a loop, what its body reads.
    pub(super) fn fetch_for_loop(&mut self, body: &Expr) {
        if self.body.in_loop || self.body.fetched.iter().all(|f| f.done) {
            return;
        }
        let mut wanted = Vec::new();
        body.walk(&mut |e| {
            if matches!(e.op, Op::Reading(_) | Op::Heard(_)) {
                wanted.push(e.op.clone());
            }
        });
        for i in 0..self.body.fetched.len() {
            if wanted.contains(&self.body.fetched[i].op) {
                self.fetch(i);
            }
        }
    }

    #[inline(never)]
    fn gen_question(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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
            Op::Believed(agent, state) => {
                self.program.believed.push((agent, state, n));
                Instr::Believed { d, state: (self.program.believed.len() - 1) as u32 }
            }
            _ => return error(e.span, "no question"),
        };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    #[inline(never)]
    fn gen_call(&mut self, e: &Expr, function: u32, dest: Option<u32>) -> Compiled<Place> {
        let index = match self.compiled.get(&function) {
            Some(Ok(index)) => *index,
            Some(Err(why)) => return Err(Box::new(why.clone())),
            None => return error(e.span, format!("there is no function {function} here")),
        };
        let (Some(f), Some(code)) =
            (self.functions.get(function as usize), self.program.functions.get(index as usize).copied())
        else {
            return error(e.span, format!("there is no function {function}"));
        };
        if e.args.len() != f.parameters.len() {
            return error(e.span, format!("`{}` takes {} arguments", f.name, f.parameters.len()));
        }
        gives(e, &f.body.ty)?;
        let n = self.width(&e.ty, e.span)?;
        let base = self.alloc(code.frame, e.span)?;
        let mut at = base;
        for (arg, (_, t)) in e.args.iter().zip(&f.parameters) {
            let top = self.body.top;
            self.gen_as(arg, t, Some(at))?;
            self.body.top = top;
            at += self.width(t, arg.span)?;
        }
        self.body.variable += 1;
        self.body.calls = self.body.calls.max(code.depth);
        self.emit(Instr::Call { function: index, base }, e.span);
        self.body.cost = self.body.cost.saturating_add(code.bound);
        Ok(self.settle(Place::frame(base + code.result), dest, n, e.span))
    }

    #[inline(never)]
    fn gen_make(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let wrong = || error(e.span, format!("the parts given do not make a {}", e.ty));
        match (&e.op, &e.ty) {
            (Op::MakeRecord, Type::Record(name)) => {
                let record = self.widths.table.records.get(name);
                let Some(record) = record.filter(|r| r.fields.len() == e.args.len()) else {
                    return wrong();
                };
                let mut at = d;
                for (arg, (_, t)) in e.args.iter().zip(&record.fields) {
                    self.gen_as(arg, t, Some(at))?;
                    self.body.top = top;
                    at += self.width(t, arg.span)?;
                }
            }
            (Op::MakeList, Type::List(t, capacity)) if e.args.len() <= *capacity as usize => {
                self.constant_into(d, e.args.len() as f64, e.span);
                let mut at = d + 1;
                for arg in &e.args {
                    self.gen_as(arg, t, Some(at))?;
                    self.body.top = top;
                    at += self.width(t, arg.span)?;
                }
            }
            (Op::MakeVector, Type::Point(_) | Type::Vector(..))
            | (Op::MakeRange, Type::Range(_))
            | (Op::MakeMatrix, Type::Matrix(..))
                if e.args.len() == n as usize =>
            {
                for (i, arg) in e.args.iter().enumerate() {
                    fits(arg, &Type::NUMBER)?;
                    self.generate(arg, Some(d + i as u32))?;
                    self.body.top = top;
                }
            }
            (Op::MakeSome, Type::Option(t)) => {
                let [value] = arguments(e)?;
                self.constant_into(d, 0.0, e.span);
                self.gen_as(value, t, Some(d + 1))?;
                self.body.top = top;
            }
            (Op::MakeNone(why), Type::Option(_)) => {
                arguments::<0>(e)?;
                let tag = reason::tag(self.texts.intern(why));
                self.constant_into(d, tag, e.span);
            }
            _ => return wrong(),
        }
        Ok(Place::frame(d))
    }

    #[inline(never)]
    fn gen_field(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        let (offset, t) = self.offset(e, of)?;
        gives(e, &t)?;
        let n = self.width(&t, e.span)?;
        let place = self.generate(of, None)?;
        Ok(self.settle(place.plus(offset), dest, n, e.span))
    }

    /// Where in `of` the part lies that `e` takes, and its type.
    #[inline(never)]
    fn offset(&mut self, e: &Expr, of: &Expr) -> Compiled<(u32, Type)> {
        match (&e.op, &of.ty) {
            (Op::Field(i), Type::Record(name)) => {
                let field = self.widths.field(name, *i).or_else(|text| error(e.span, text))?;
                Ok((field.0, field.1.clone()))
            }
            (Op::Item(row, column), Type::Matrix(r, c)) if row < r && column < c => {
                Ok((u32::from(*row) * u32::from(*c) + u32::from(*column), Type::NUMBER))
            }
            (Op::Part(part), t) => match (part, t) {
                (Part::X, Type::Point(_) | Type::Vector(..)) => Ok((0, Type::NUMBER)),
                (Part::Y, Type::Point(_) | Type::Vector(..)) => Ok((1, Type::NUMBER)),
                (Part::Z, Type::Point(_) | Type::Vector(..)) => Ok((2, Type::NUMBER)),
                (Part::Position, Type::Pose(f)) => Ok((0, Type::Point(f.clone()))),
                (Part::Forward, Type::Twist) => Ok((0, Type::NUMBER)),
                (Part::Left, Type::Twist) => Ok((1, Type::NUMBER)),
                (Part::Up, Type::Twist) => Ok((2, Type::NUMBER)),
                (Part::Turn, Type::Twist) => Ok((5, Type::NUMBER)),
                _ => error(e.span, format!("{t} has no such part")),
            },
            (_, t) => error(e.span, format!("{t} has no such part")),
        }
    }

    #[inline(never)]
    fn gen_part(&mut self, e: &Expr, part: Part, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        if !matches!((part, &of.ty), (Part::Heading | Part::Roll | Part::Pitch, Type::Pose(_))) {
            return self.gen_field(e, dest);
        }
        gives(e, &Type::NUMBER)?;
        let top = self.body.top;
        let a = self.registers(of)?;
        self.body.top = top;
        let d = self.dest(dest, 1, e.span)?;
        let instr = match part {
            Part::Heading => Instr::Yaw { d, a },
            Part::Roll => Instr::Roll { d, a },
            _ => Instr::Pitch { d, a },
        };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    #[inline(never)]
    fn gen_matrix(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        let Type::Matrix(r, c) = of.ty else {
            return error(e.span, format!("{} is no matrix", of.ty));
        };
        let transpose = e.op == Op::Transpose;
        if !transpose && (r != c || r > 8) {
            return error(e.span, "a matrix of at most 8 rows and as many columns is wanted here");
        }
        let t = if transpose { Type::Matrix(c, r) } else { of.ty.clone().optional() };
        gives(e, &t)?;
        let n = self.width(&t, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let a = self.registers(of)?;
        self.body.top = top;
        let instr = if transpose { Instr::Transpose { r, c, d, a } } else { Instr::Inverse { n: r, d, a } };
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    /// The part of a local that an expression reads, from which register and how many: what a loop has
    /// to copy of an item.
    pub(super) fn part_read(&mut self, body: &Expr, local: u32) -> Compiled<(u32, u32)> {
        let (mut low, mut high) = (u32::MAX, 0);
        let mut waiting = vec![body];
        while let Some(e) = waiting.pop() {
            match self.path(e, local)? {
                Some((from, n)) => (low, high) = (low.min(from), high.max(from + n)),
                None => waiting.extend(&e.args),
            }
        }
        Ok(if low >= high { (0, 0) } else { (low, high - low) })
    }

    /// Offset and width of the part of a local that `e` is, if it is one.
    #[inline(never)]
    fn path(&mut self, e: &Expr, local: u32) -> Compiled<Option<(u32, u32)>> {
        let (mut at, mut offset) = (e, 0);
        loop {
            match (&at.op, at.args.as_slice()) {
                (Op::Local(l), _) if *l == local => return Ok(Some((offset, self.width(&e.ty, e.span)?))),
                (Op::Part(Part::Heading | Part::Roll | Part::Pitch), _) => return Ok(None),
                (Op::Field(_) | Op::Item(..) | Op::Part(_), [of]) => {
                    offset += self.offset(at, of)?.0;
                    at = of;
                }
                _ => return Ok(None),
            }
        }
    }
}

/// Whether the value of `e` is written by one last instruction that has read its operands before.
pub(super) fn writes_last(e: &Expr) -> bool {
    use crate::{Binary as B, Function as F};
    let arithmetic =
        matches!(e.op, Op::Binary(B::Add | B::Sub | B::Mul | B::Div) | Op::Builtin(F::Min | F::Max | F::Abs));
    arithmetic && same_layout(&e.ty, &Type::NUMBER) && typing::number(&e.ty).is_some()
}
