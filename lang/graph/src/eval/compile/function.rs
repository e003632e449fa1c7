//! Functions of the mission: compiled once, before the block that calls them. Short ones are written out
//! where they are called: their arguments need not be copied then.

use super::emit::error;
use super::expr::gives;
use super::{Body, Compiled, Compiler, MAX_DEPTH, Place};
use crate::{
    Expr, Op, Span, UserFunction,
    eval::code::{FunctionCode, Instr},
};

impl<'g> Compiler<'g> {
    /// Compiles a function and all those it calls.
    pub(super) fn ensure_function(&mut self, root: u32, at: Span) -> Compiled<()> {
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
                let short =
                    self.program.code.len() - start <= SHORT && operators(&function.body) <= SHORT_TEXT;
                let depth = self.body.calls + 1;
                if depth > MAX_CALLS {
                    return error(at, format!("functions call each other more than {MAX_CALLS} deep"));
                }
                let code = FunctionCode { start: start as u32, short, result, frame, bound, depth };
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

    /// A function that is called, and its code.
    fn callee(&self, e: &Expr, function: u32) -> Compiled<(&'g UserFunction, u32, FunctionCode)> {
        let index = match self.compiled.get(&function) {
            Some(Ok(index)) => *index,
            Some(Err(why)) => return Err(Box::new(why.clone())),
            None => return error(e.span, format!("there is no function {function} here")),
        };
        let functions: &'g [UserFunction] = self.functions;
        let (Some(f), Some(code)) =
            (functions.get(function as usize), self.program.functions.get(index as usize).copied())
        else {
            return error(e.span, format!("there is no function {function}"));
        };
        if e.args.len() != f.parameters.len() {
            return error(e.span, format!("`{}` takes {} arguments", f.name, f.parameters.len()));
        }
        gives(e, &f.body.ty)?;
        Ok((f, index, code))
    }

    #[inline(never)]
    pub(super) fn gen_call(&mut self, e: &Expr, function: u32, dest: Option<u32>) -> Compiled<Place> {
        let (f, index, code) = self.callee(e, function)?;
        if self.may_write_out(code) {
            return self.written_out(e, f, code, |c| c.generate(&f.body, dest));
        }
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

    /// Code that jumps when a function that is written out gives `when`; false when it is to be called.
    #[inline(never)]
    pub(super) fn branch_call(
        &mut self,
        e: &Expr,
        function: u32,
        when: bool,
        jumps: &mut Vec<u32>,
    ) -> Compiled<bool> {
        let (f, _, code) = self.callee(e, function)?;
        let short = self.may_write_out(code);
        if short {
            self.written_out(e, f, code, |c| c.branch(&f.body, when, jumps))?;
        }
        Ok(short)
    }

    /// Whether a function is written out here.
    fn may_write_out(&self, code: FunctionCode) -> bool {
        code.short && self.body.depth < MAX_DEPTH / 2
    }

    /// Compiles `body` with the parameters of a function standing for its arguments, wherever these lie.
    fn written_out<T>(
        &mut self,
        e: &Expr,
        f: &UserFunction,
        code: FunctionCode,
        body: impl FnOnce(&mut Self) -> Compiled<T>,
    ) -> Compiled<T> {
        let (mut locals, width) = self.lay_out(&f.locals, e.span)?;
        let base = self.alloc(width, e.span)?;
        locals.iter_mut().for_each(|l| l.0 += base);
        let mut bound = vec![None; locals.len()];
        for ((arg, (_, t)), bound) in e.args.iter().zip(&f.parameters).zip(&mut bound) {
            *bound = Some(self.gen_as(arg, t, None)?);
        }
        self.body.calls = self.body.calls.max(code.depth);
        let locals = std::mem::replace(&mut self.body.locals, locals);
        let bound = std::mem::replace(&mut self.body.bound, bound);
        let agent = self.agent.take();
        let made = body(self);
        (self.body.locals, self.body.bound, self.agent) = (locals, bound, agent);
        made
    }
}

/// Most instructions of a function that is written out where it is called, and most operators of the text it
/// is made from: so functions of functions do not grow without end.
const SHORT: usize = 24;
const SHORT_TEXT: usize = 48;

fn operators(e: &Expr) -> usize {
    let mut n = 0;
    e.walk(&mut |_| n += 1);
    n
}

/// How deep functions may call each other.
const MAX_CALLS: u32 = 64;
