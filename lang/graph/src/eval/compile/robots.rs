//! Code for expressions about other robots, one or all.

use super::emit::error;
use super::expr::{arguments, gives};
use super::{Compiled, Compiler, Place};
use crate::{
    Expr, Quantifier, Type,
    eval::{MAX_ROBOTS, code::Instr},
};

impl Compiler<'_> {
    #[inline(never)]
    pub(super) fn gen_quantified(&mut self, e: &Expr, q: Quantifier, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        gives(e, &Type::NUMBER)?;
        gives(of, &Type::NUMBER)?;
        self.body.variable += 1;
        let at = e.span;
        let d = self.dest(dest, 1, at)?;
        let top = self.body.top;
        let state = self.alloc(3, at)?;
        let start = match q {
            Quantifier::Each => 1.0,
            Quantifier::Least => f64::MAX,
            Quantifier::Most => f64::MIN,
            _ => 0.0,
        };
        self.begin_loop(of)?;
        self.constant_into(d, start, at);
        let (mut out, mut end) = (Vec::new(), Vec::new());
        self.jump(Instr::RobotFirst { q: state, to: 0 }, &mut out, at);
        let (body, before) = (self.here(), self.body.cost);
        let nested = std::mem::replace(&mut self.body.in_loop, true);
        let mut next = Vec::new();
        match q {
            Quantifier::Each => self.branch(of, false, &mut end)?,
            Quantifier::Some => self.branch(of, true, &mut end)?,
            Quantifier::Count => {
                self.branch(of, false, &mut next)?;
                let k = self.pooled(1.0);
                self.emit(Instr::AddK { d, a: d, k }, at);
            }
            _ => {
                let b = self.scalar(of)?;
                self.emit(
                    match q {
                        Quantifier::Least => Instr::Min { d, a: d, b },
                        Quantifier::Most => Instr::Max { d, a: d, b },
                        _ => Instr::Add { d, a: d, b },
                    },
                    at,
                );
            }
        }
        self.body.in_loop = nested;
        self.end_loop();
        self.land(&next);
        self.emit(Instr::RobotNext { q: state, to: body }, at);
        self.repeat(before, u64::from(MAX_ROBOTS));
        if matches!(q, Quantifier::Each | Quantifier::Some) {
            self.jump(Instr::Jump { to: 0 }, &mut out, at);
            self.land(&end);
            self.constant_into(d, 1.0 - start, at);
            self.emit(Instr::RobotRestore { q: state }, at);
        }
        self.land(&out);
        if q == Quantifier::Mean {
            self.emit(Instr::RobotCount { d: state, q: state }, at);
            self.emit(Instr::Div { d, a: d, b: state }, at);
        }
        self.body.top = top;
        Ok(Place::frame(d))
    }

    /// Counts what was compiled since `before` so many times.
    pub(super) fn repeat(&mut self, before: u64, times: u64) {
        let once = self.body.cost - before;
        self.body.cost = before.saturating_add(once.saturating_mul(times));
    }

    #[inline(never)]
    pub(super) fn gen_of_robot(&mut self, e: &Expr, group: u32, dest: Option<u32>) -> Compiled<Place> {
        let [of] = arguments(e)?;
        if group as usize >= self.robots.len() {
            return error(e.span, format!("there is no robot {group} here"));
        }
        gives(e, &of.ty)?;
        self.body.variable += 1;
        let n = self.width(&e.ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let q = self.alloc(1, e.span)?;
        self.emit(Instr::RobotSet { q, group }, e.span);
        self.generate(of, Some(d))?;
        self.emit(Instr::RobotRestore { q }, e.span);
        self.body.top = top;
        Ok(Place::frame(d))
    }
}
