//! The compiler: what it knows, scopes, blocks, registers and instructions. What becomes of expressions
//! and statements is in `compile_*.rs`.

use super::code::{FunctionCode, Instr, Program, Space};
use super::widths::Widths;
use super::{CompileError, Layout, MAX_FRAME};
use crate::{
    Agent, Conjunct, Expr, Goal, Graph, Op, Port, RobotGroup, Span, Stmt, Texts, Topic, Type, TypeTable,
    UserFunction,
};
use std::collections::BTreeMap;

/// Result of a step of the compiler; boxed, for the compiler recurses as deep as expressions nest.
pub(super) type Compiled<T> = Result<T, Box<CompileError>>;

/// Takes expressions one by one.
type Visit<'v> = dyn FnMut(&Expr) + 'v;

/// How deep expressions and statements may nest: 2048 sums, as in a graph file, or fewer of the operators
/// for which the compiler needs more of the stack. So it gets by with the 2 MB a thread has.
pub(super) const MAX_DEPTH: u32 = 2048;

/// Compiled code with its place in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// First instruction.
    pub(super) start: u32,
    /// First register of the result.
    pub result: u32,
    /// Registers of the result.
    pub width: u32,
    /// Registers the frame must have.
    pub frame: u32,
    /// The most instructions a run executes; saturates.
    pub bound: u64,
}

/// The frame layout of one unit, arbiter, expectation or scene expression: each local has a fixed
/// register range.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    pub(super) locals: Vec<(u32, Type)>,
    pub(super) floor: u32,
    pub(super) frame: u32,
}

impl Scope {
    /// First register of local `index`.
    pub fn local(&self, index: u32) -> Option<u32> {
        self.locals.get(index as usize).map(|l| l.0)
    }

    /// Registers a frame needs for every block compiled in this scope so far.
    pub fn frame(&self) -> usize {
        self.frame as usize
    }
}

/// Where a value lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub space: Space,
    pub at: u32,
}

impl Place {
    pub fn frame(at: u32) -> Self {
        Place { space: Space::Frame, at }
    }

    /// So many registers further on.
    pub fn plus(self, n: u32) -> Self {
        Place { at: self.at + n, ..self }
    }
}

/// A reading or the messages of a topic: fetched once a block, kept in registers of its own.
#[derive(Debug)]
pub(super) struct Fetched {
    pub op: Op,
    pub ty: Type,
    pub at: u32,
    pub width: u32,
    pub span: Span,
    pub optional: bool,
    /// How often the block names it.
    pub uses: u32,
    /// For what is named more than once: a register that is not 0 once it has been fetched.
    pub flag: Option<u32>,
    /// Whether the instructions so far have fetched it on every way that leads here.
    pub done: bool,
}

impl Fetched {
    fn new(e: &Expr) -> Self {
        let (op, ty, span) = (e.op.clone(), e.ty.clone(), e.span);
        Fetched { op, ty, at: 0, width: 0, span, optional: false, uses: 1, flag: None, done: false }
    }
}

/// The block or function that is being compiled.
#[derive(Debug, Default)]
pub(super) struct Body {
    /// First register and type of each local.
    pub locals: Vec<(u32, Type)>,
    /// Locals of `let`s and patterns in expressions that stand for a value somewhere else.
    pub bound: Vec<Option<Place>>,
    /// First free register.
    pub top: u32,
    /// Most registers so far.
    pub peak: u32,
    /// Most instructions until here.
    pub cost: u64,
    pub depth: u32,
    /// How often something was compiled that is not constant.
    pub variable: u64,
    pub fetched: Vec<Fetched>,
    /// Everything that is fetched in a loop was fetched before it.
    pub in_loop: bool,
    /// How deep the functions called here call.
    pub calls: u32,
}

/// The agent that blocks belong to.
#[derive(Debug)]
pub(super) struct AgentView<'g> {
    pub states: Layout,
    pub arguments: Layout,
    pub sensors: &'g [Port],
    pub actuators: &'g [Port],
    pub events: usize,
}

/// Compiles expressions and statements into one [`Program`].
#[derive(Debug)]
pub struct Compiler<'g> {
    pub(super) widths: Widths<'g>,
    pub(super) texts: &'g mut Texts,
    pub(super) functions: &'g [UserFunction],
    pub(super) agents: &'g [Agent],
    pub(super) topics: &'g [Topic],
    pub(super) goals: &'g [Goal],
    pub(super) robots: &'g [RobotGroup],
    pub(super) params: Layout,
    pub(super) agent: Option<AgentView<'g>>,
    pub(super) program: Program,
    /// Indices of single constants by their bits.
    pub(super) pool: BTreeMap<u64, u32>,
    /// Functions compiled so far: their place in the program, or what is wrong.
    pub(super) compiled: BTreeMap<u32, Result<u32, CompileError>>,
    pub(super) body: Body,
    /// Registers for the folding of constants.
    pub(super) scratch: Vec<f64>,
}

impl<'g> Compiler<'g> {
    /// A compiler that knows types and functions only: no parameters, topics, agents or goals.
    pub fn new(types: &'g TypeTable, texts: &'g mut Texts, functions: &'g [UserFunction]) -> Self {
        Compiler {
            widths: Widths::new(types),
            texts,
            functions,
            agents: &[],
            topics: &[],
            goals: &[],
            robots: &[],
            params: Layout::default(),
            agent: None,
            program: Program::default(),
            pool: BTreeMap::new(),
            compiled: BTreeMap::new(),
            body: Body::default(),
            scratch: Vec::new(),
        }
    }

    /// A compiler for everything in a graph. `texts` is a copy of the graph's; texts that are new are
    /// added to it.
    pub fn for_graph(graph: &'g Graph, texts: &'g mut Texts) -> Self {
        Compiler {
            agents: &graph.agents,
            topics: &graph.topics,
            goals: &graph.goals,
            robots: &graph.robots,
            params: Layout::params(graph),
            ..Compiler::new(&graph.types, texts, &graph.functions)
        }
    }

    /// Expressions may name parameters of these types from now on.
    pub fn params<'t>(&mut self, types: impl IntoIterator<Item = &'t Type>) {
        self.params = Layout::new(self.widths.table, types);
    }

    /// What is compiled from now on belongs to this agent of the graph (its states, arguments, ports and
    /// events), or to none. At the beginning it belongs to none.
    ///
    /// # Errors
    /// When the graph has no such agent.
    pub fn agent(&mut self, agent: Option<u32>) -> Result<(), CompileError> {
        self.agent = None;
        if let Some(index) = agent {
            let missing = || CompileError::new(Span::default(), format!("there is no agent {index}"));
            let agent = self.agents.get(index as usize).ok_or_else(missing)?;
            self.agent = Some(AgentView {
                states: Layout::states(self.widths.table, agent),
                arguments: Layout::arguments(self.widths.table, agent),
                sensors: &agent.sensors,
                actuators: &agent.actuators,
                events: agent.events.len(),
            });
        }
        Ok(())
    }

    /// A frame layout with these locals.
    ///
    /// # Errors
    /// When a type has no layout, or they need more than [`MAX_FRAME`] registers.
    pub fn scope(&mut self, locals: &[Type]) -> Result<Scope, CompileError> {
        let (locals, floor) = self.lay_out(locals, Span::default()).map_err(|e| *e)?;
        Ok(Scope { locals, floor, frame: floor })
    }

    fn lay_out(&mut self, types: &[Type], at: Span) -> Compiled<(Vec<(u32, Type)>, u32)> {
        let (mut locals, mut floor) = (Vec::new(), 0);
        for t in types {
            locals.push((floor, t.clone()));
            floor += self.width(t, at)?;
            if floor as usize > MAX_FRAME {
                return error(at, "the locals take too many registers");
            }
        }
        Ok((locals, floor))
    }

    /// Compiles an expression; its value is the result.
    ///
    /// # Errors
    /// When the expression is malformed.
    pub fn expr(&mut self, scope: &mut Scope, e: &Expr) -> Result<Block, CompileError> {
        self.expr_as(scope, e, &e.ty)
    }

    /// As [`Compiler::expr`], with the layout of `wanted` for the result: a value for an optional, a
    /// short list for a longer one.
    ///
    /// # Errors
    /// When the expression is malformed, or does not fit.
    pub fn expr_as(&mut self, scope: &mut Scope, e: &Expr, wanted: &Type) -> Result<Block, CompileError> {
        self.block(scope, &mut |visit| e.walk(visit), &mut |c| {
            let width = c.width(wanted, e.span)?;
            let place = c.gen_as(e, wanted, None)?;
            let at = c.in_frame(place, width, e.span)?;
            c.tidy(at, wanted, e.span)?;
            Ok((at, width))
        })
    }

    /// Compiles statements; there is no result.
    ///
    /// # Errors
    /// When a statement is malformed.
    pub fn stmts(&mut self, scope: &mut Scope, stmts: &[Stmt]) -> Result<Block, CompileError> {
        self.block(scope, &mut |visit| super::compile_stmt::walk(stmts, visit), &mut |c| {
            c.gen_stmts(stmts)?;
            Ok((0, 0))
        })
    }

    /// Compiles a guard; the result is one `Bool`, and locals are bound when it is true.
    ///
    /// # Errors
    /// When a conjunct is malformed.
    pub fn guard(&mut self, scope: &mut Scope, guard: &[Conjunct]) -> Result<Block, CompileError> {
        let at = guard.first().map(|c| c.expr().span).unwrap_or_default();
        let walk = |visit: &mut dyn FnMut(&Expr)| guard.iter().for_each(|c| c.expr().walk(visit));
        self.block(scope, &mut |visit| walk(visit), &mut |c| {
            let d = c.alloc(1, at)?;
            c.constant_into(d, 0.0, at);
            let mut fails = Vec::new();
            c.gen_guard(guard, &mut fails)?;
            c.constant_into(d, 1.0, at);
            c.land(&fails);
            Ok((d, 1))
        })
    }

    /// The program of all blocks compiled so far.
    pub fn finish(self) -> Program {
        self.program
    }

    /// Compiles a block in a scope. `walk` visits its expressions, `make` makes the code and returns the
    /// place and width of the result.
    fn block(
        &mut self,
        scope: &mut Scope,
        walk: &mut dyn FnMut(&mut Visit<'_>),
        make: &mut dyn FnMut(&mut Self) -> Compiled<(u32, u32)>,
    ) -> Result<Block, CompileError> {
        let mut called = Vec::new();
        let mut read: Vec<Fetched> = Vec::new();
        walk(&mut |e| match &e.op {
            Op::Call(f) => called.push((*f, e.span)),
            Op::Reading(_) | Op::Heard(_) => match read.iter_mut().find(|r| r.op == e.op) {
                Some(r) => r.uses += 1,
                None => read.push(Fetched::new(e)),
            },
            _ => {}
        });
        for (f, at) in called {
            self.ensure_function(f, at).map_err(|e| *e)?;
        }
        let locals = std::mem::take(&mut scope.locals);
        let bound = vec![None; locals.len()];
        let (top, peak) = (scope.floor, scope.floor);
        self.body = Body { locals, bound, top, peak, ..Body::default() };
        let start = self.program.code.len();
        let made = self.reserve(read).and_then(|()| make(self));
        scope.locals = std::mem::take(&mut self.body.locals);
        match made {
            Ok((result, width)) => {
                self.emit(Instr::End, Span::default());
                scope.frame = scope.frame.max(self.body.peak);
                let (frame, bound) = (self.body.peak, self.body.cost);
                Ok(Block { start: start as u32, result, width, frame, bound })
            }
            Err(e) => {
                self.program.code.truncate(start);
                self.program.spans.truncate(start);
                Err(*e)
            }
        }
    }

    /// Gives every reading and topic of the block its registers.
    fn reserve(&mut self, read: Vec<Fetched>) -> Compiled<()> {
        for mut r in read {
            r.optional = self.check_fetched(&r.op, &r.ty, r.span)?;
            r.width = self.width(&r.ty, r.span)?;
            r.at = self.alloc(r.width, r.span)?;
            if r.uses > 1 {
                let flag = self.alloc(1, r.span)?;
                self.constant_into(flag, 0.0, r.span);
                r.flag = Some(flag);
            }
            self.body.fetched.push(r);
        }
        Ok(())
    }

    /// Compiles a function and all those it calls.
    fn ensure_function(&mut self, root: u32, at: Span) -> Compiled<()> {
        let mut waiting: Vec<(u32, Vec<u32>)> = Vec::new();
        let mut next = Some(root);
        loop {
            if let Some(f) = next.take()
                && !self.compiled.contains_key(&f)
            {
                let function = self.functions.get(f as usize);
                let Some(function) = function else {
                    return error(at, format!("there is no function {f}"));
                };
                if waiting.iter().any(|(g, _)| *g == f) {
                    return error(function.span, format!("the function `{}` calls itself", function.name));
                }
                let mut callees = Vec::new();
                function.body.walk(&mut |e| {
                    if let Op::Call(g) = e.op {
                        callees.push(g);
                    }
                });
                waiting.push((f, callees));
            }
            let Some((f, callees)) = waiting.last_mut() else {
                return Ok(());
            };
            next = callees.pop();
            if next.is_none() {
                let f = *f;
                waiting.pop();
                let made = self.function(f).map_err(|e| *e);
                self.compiled.insert(f, made);
            }
        }
    }

    /// Compiles a function whose callees are compiled; returns its place in the program.
    fn function(&mut self, index: u32) -> Compiled<u32> {
        let Some(function) = self.functions.get(index as usize) else {
            return error(Span::default(), format!("there is no function {index}"));
        };
        let at = function.span;
        let parameters = function.parameters.iter().map(|(_, t)| t);
        if !function.locals.iter().take(function.parameters.len()).eq(parameters) {
            return error(at, "the parameters of a function are its first locals");
        }
        let (locals, top) = self.lay_out(&function.locals, at)?;
        let bound = vec![None; locals.len()];
        self.body = Body { locals, bound, top, peak: top, ..Body::default() };
        // A function belongs to no agent, whoever calls it.
        let agent = self.agent.take();
        let start = self.program.code.len();
        let made = self.function_body(&function.body);
        self.agent = agent;
        match made {
            Ok(result) => {
                let (frame, bound) = (self.body.peak, self.body.cost);
                let depth = self.body.calls + 1;
                if depth > MAX_CALLS {
                    return error(at, format!("functions call each other more than {MAX_CALLS} deep"));
                }
                let code = FunctionCode { start: start as u32, result, frame, bound, depth };
                self.program.functions.push(code);
                Ok((self.program.functions.len() - 1) as u32)
            }
            Err(e) => {
                self.program.code.truncate(start);
                self.program.spans.truncate(start);
                Err(e)
            }
        }
    }

    fn function_body(&mut self, e: &Expr) -> Compiled<u32> {
        let width = self.width(&e.ty, e.span)?;
        let place = self.generate(e, None)?;
        let at = self.in_frame(place, width, e.span)?;
        self.emit(Instr::End, e.span);
        Ok(at)
    }

    /// Registers of a type.
    pub(super) fn width(&mut self, t: &Type, at: Span) -> Compiled<u32> {
        self.widths.width(t).or_else(|text| error(at, text))
    }

    /// Free registers.
    pub(super) fn alloc(&mut self, n: u32, at: Span) -> Compiled<u32> {
        let d = self.body.top;
        if d as usize + n as usize > MAX_FRAME {
            return error(at, "the values here take too many registers");
        }
        self.body.top = d + n;
        self.body.peak = self.body.peak.max(self.body.top);
        Ok(d)
    }

    /// The registers wanted, or free ones.
    pub(super) fn dest(&mut self, dest: Option<u32>, n: u32, at: Span) -> Compiled<u32> {
        dest.map_or_else(|| self.alloc(n, at), Ok)
    }

    /// Appends an instruction.
    pub(super) fn emit(&mut self, instr: Instr, at: Span) {
        self.program.code.push(instr);
        self.program.spans.push(at);
        self.body.cost = self.body.cost.saturating_add(1);
    }

    /// The next instruction.
    pub(super) fn here(&self) -> u32 {
        self.program.code.len() as u32
    }

    /// Appends a jump whose target is set by [`Compiler::land`].
    pub(super) fn jump(&mut self, instr: Instr, jumps: &mut Vec<u32>, at: Span) {
        jumps.push(self.here());
        self.emit(instr, at);
    }

    /// Lets jumps come here.
    pub(super) fn land(&mut self, jumps: &[u32]) {
        let here = self.here();
        for j in jumps {
            if let Some(to) = self.program.code.get_mut(*j as usize).and_then(Instr::target) {
                *to = here;
            }
        }
    }

    /// Index of a constant in the pool.
    pub(super) fn pooled(&mut self, x: f64) -> u32 {
        let constants = &mut self.program.constants;
        *self.pool.entry(x.to_bits()).or_insert_with(|| {
            constants.push(x);
            (constants.len() - 1) as u32
        })
    }

    /// Sets a register to a constant.
    pub(super) fn constant_into(&mut self, d: u32, x: f64, at: Span) {
        let k = self.pooled(x);
        self.emit(Instr::Const { d, k }, at);
    }

    /// Copies a value of `n` registers to `d`, unless it is there.
    pub(super) fn copy(&mut self, place: Place, d: u32, n: u32, at: Span) {
        let Place { space, at: from } = place;
        if n == 0 || place == Place::frame(d) {
            return;
        }
        let instr = match (space, n) {
            (Space::Frame, 1) => Instr::Move { d, a: from },
            (Space::Constants, 1) => Instr::Const { d, k: from },
            (Space::States, 1) => Instr::LoadState { d, at: from },
            (_, 1) => Instr::Load { space, d, at: from },
            _ => Instr::Copy { space, d, at: from, n },
        };
        self.emit(instr, at);
    }

    /// The value where it is wanted, or where it is when nobody cares.
    pub(super) fn settle(&mut self, place: Place, dest: Option<u32>, n: u32, at: Span) -> Place {
        match dest {
            Some(d) => {
                self.copy(place, d, n, at);
                Place::frame(d)
            }
            None => place,
        }
    }

    /// First register of a value, which is loaded when it is not in the frame.
    pub(super) fn in_frame(&mut self, place: Place, n: u32, at: Span) -> Compiled<u32> {
        if place.space == Space::Frame {
            return Ok(place.at);
        }
        let d = self.alloc(n, at)?;
        self.copy(place, d, n, at);
        Ok(d)
    }

    /// Zeroes what a value of type `t` does not use.
    pub(super) fn tidy(&mut self, a: u32, t: &Type, at: Span) -> Compiled<()> {
        let shape = self.widths.shape(t).or_else(|text| error(at, text))?;
        if let Some(shape) = shape {
            let index = self.program.shapes.iter().position(|s| *s == shape).unwrap_or_else(|| {
                self.program.shapes.push(shape);
                self.program.shapes.len() - 1
            });
            self.emit(Instr::Tidy { a, shape: index as u32 }, at);
        }
        Ok(())
    }

    /// Type of a local.
    pub(super) fn local(&self, index: u32, at: Span) -> Compiled<(u32, Type)> {
        match self.body.locals.get(index as usize) {
            Some((register, t)) => Ok((*register, t.clone())),
            None => error(at, format!("there is no local {index}")),
        }
    }
}

/// How deep functions may call each other.
const MAX_CALLS: u32 = 64;

/// A refusal.
#[cold]
pub(super) fn error<T>(at: Span, text: impl Into<String>) -> Compiled<T> {
    Err(Box::new(CompileError::new(at, text)))
}

impl Conjunct {
    /// The expression that is evaluated.
    pub(super) fn expr(&self) -> &Expr {
        match self {
            Conjunct::Holds(e) | Conjunct::Binds(_, e) => e,
        }
    }
}

impl Instr {
    /// The target, when this is a jump.
    fn target(&mut self) -> Option<&mut u32> {
        match self {
            Instr::Jump { to }
            | Instr::JumpIf { to, .. }
            | Instr::JumpUnless { to, .. }
            | Instr::JumpLt { to, .. }
            | Instr::JumpLe { to, .. }
            | Instr::JumpEq { to, .. }
            | Instr::JumpNe { to, .. }
            | Instr::JumpLtK { to, .. }
            | Instr::JumpLeK { to, .. }
            | Instr::JumpGtK { to, .. }
            | Instr::JumpGeK { to, .. }
            | Instr::JumpEqK { to, .. }
            | Instr::JumpNeK { to, .. }
            | Instr::RobotFirst { to, .. }
            | Instr::RobotNext { to, .. }
            | Instr::ListFirst { to, .. }
            | Instr::ListNext { to, .. } => Some(to),
            _ => None,
        }
    }
}
