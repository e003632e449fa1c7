//! The compiler: what it knows, scopes, blocks.

use super::{CompileError, Program};
use crate::{Conjunct, Expr, Graph, Span, Stmt, Texts, Type, TypeTable, UserFunction};

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

/// Compiles expressions and statements into one [`Program`].
#[derive(Debug)]
pub struct Compiler<'g> {
    types: &'g TypeTable,
    texts: &'g mut Texts,
    functions: &'g [UserFunction],
}

impl<'g> Compiler<'g> {
    /// A compiler that knows types and functions only: no parameters, topics, agents or goals.
    pub fn new(types: &'g TypeTable, texts: &'g mut Texts, functions: &'g [UserFunction]) -> Self {
        Compiler { types, texts, functions }
    }

    /// A compiler for everything in a graph. `texts` is a copy of the graph's; texts that are new are
    /// added to it.
    pub fn for_graph(graph: &'g Graph, texts: &'g mut Texts) -> Self {
        Compiler { types: &graph.types, texts, functions: &graph.functions }
    }

    /// Expressions may name parameters of these types from now on.
    pub fn params<'t>(&mut self, types: impl IntoIterator<Item = &'t Type>) {
        let _ = types.into_iter().count();
    }

    /// What is compiled from now on belongs to this agent of the graph (its states, arguments, ports and
    /// events), or to none. At the beginning it belongs to none.
    ///
    /// # Errors
    /// When the graph has no such agent.
    pub fn agent(&mut self, agent: Option<u32>) -> Result<(), CompileError> {
        let _ = (agent, self.functions.len(), self.texts.0.len());
        Ok(())
    }

    /// A frame layout with these locals.
    ///
    /// # Errors
    /// When they need more than [`MAX_FRAME`](super::MAX_FRAME) registers.
    pub fn scope(&mut self, locals: &[Type]) -> Result<Scope, CompileError> {
        let mut scope = Scope { locals: Vec::new(), floor: 0, frame: 0 };
        for t in locals {
            scope.locals.push((scope.floor, t.clone()));
            scope.floor += self.types.width(t) as u32;
        }
        scope.frame = scope.floor;
        Ok(scope)
    }

    /// Compiles an expression; its value is the result.
    ///
    /// # Errors
    /// When the expression is malformed.
    pub fn expr(&mut self, scope: &mut Scope, e: &Expr) -> Result<Block, CompileError> {
        let _ = scope;
        Err(CompileError::new(e.span, "expressions are not compiled yet"))
    }

    /// As [`Compiler::expr`], with the layout of `wanted` for the result: a value for an optional, a
    /// short list for a longer one.
    ///
    /// # Errors
    /// When the expression is malformed, or does not fit.
    pub fn expr_as(&mut self, scope: &mut Scope, e: &Expr, wanted: &Type) -> Result<Block, CompileError> {
        let _ = wanted;
        self.expr(scope, e)
    }

    /// Compiles statements; there is no result.
    ///
    /// # Errors
    /// When a statement is malformed.
    pub fn stmts(&mut self, scope: &mut Scope, stmts: &[Stmt]) -> Result<Block, CompileError> {
        let _ = (scope, stmts);
        Err(CompileError::new(Span::default(), "statements are not compiled yet"))
    }

    /// Compiles a guard; the result is one `Bool`, and locals are bound when it is true.
    ///
    /// # Errors
    /// When a conjunct is malformed.
    pub fn guard(&mut self, scope: &mut Scope, guard: &[Conjunct]) -> Result<Block, CompileError> {
        let _ = (scope, guard);
        Err(CompileError::new(Span::default(), "guards are not compiled yet"))
    }

    /// The program of all blocks compiled so far.
    pub fn finish(self) -> Program {
        Program::default()
    }
}
