//! The compiler: what it knows, scopes, blocks, registers and instructions. What becomes of expressions
//! and statements is in the files below.

mod arithmetic;
mod branch;
mod builtin;
mod emit;
mod expr;
mod fold;
mod function;
mod list;
mod parts;
mod robots;
mod slots;
mod stmt;

use self::emit::error;
use super::code::{Instr, Program, Space};
use super::widths::Widths;
use super::{CompileError, Layout, MAX_FRAME};
use crate::{
    Agent, Conjunct, Expr, Goal, Graph, Op, Port, RobotGroup, Span, Stmt, Texts, Topic, Type, TypeTable,
    UserFunction,
};
use std::{borrow::Cow, collections::BTreeMap};

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
    /// States, arguments and parameters that were loaded before the loop that is being compiled: where
    /// they lie, and the registers they were loaded into.
    pub loaded: Vec<(Place, u32)>,
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
    pub units: usize,
    pub devices: u32,
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
    pub(super) params: Cow<'g, Layout>,
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
            params: Cow::default(),
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
            params: Cow::Owned(Layout::params(graph)),
            ..Compiler::new(&graph.types, texts, &graph.functions)
        }
    }

    /// Expressions may name these parameters from now on.
    pub fn params(&mut self, layout: &'g Layout) {
        self.params = Cow::Borrowed(layout);
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
                units: agent.units.len(),
                devices: agent.devices.len() as u32,
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
        self.block(scope, &mut |visit| stmt::walk(stmts, visit), &mut |c| {
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
}
