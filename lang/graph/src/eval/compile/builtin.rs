//! Code for calls of built-in functions.

use super::emit::error;
use super::expr::{Operand, arguments, gives};
use super::{Compiled, Compiler, Place};
use crate::eval::{code::Instr, geometry};
use crate::{Expr, Function, Type, pattern::Bindings};

impl Compiler<'_> {
    #[inline(never)]
    pub(super) fn gen_builtin(&mut self, e: &Expr, f: Function, dest: Option<u32>) -> Compiled<Place> {
        use Function as F;
        match f {
            F::Length | F::At | F::First | F::Last | F::Push | F::Sum | F::Smallest | F::Largest => {
                self.gen_list_function(e, f, dest)
            }
            F::Low | F::High => {
                let [range] = arguments(e)?;
                let (Type::Range(_), Ok(())) = (&range.ty, gives(e, &Type::NUMBER)) else {
                    return error(e.span, format!("a range is wanted here, not {}", range.ty));
                };
                let place = self.generate(range, None)?;
                Ok(self.settle(place.plus(u32::from(f == F::High)), dest, 1, e.span))
            }
            F::Brightness
            | F::Look
            | F::Viewpoint
            | F::Obstacles
            | F::ContactByExpansion
            | F::ContactByFlow
            | F::ContactByRobustFlow
            | F::Diverging
            | F::CourseAhead
            | F::NearestPairAhead
            | F::WatchPeople
            | F::PeopleSeen
            | F::KnownMap
            | F::TrueMap
            | F::TruePlace
            | F::EmptyMap
            | F::Observe
            | F::Localise
            | F::Located
            | F::MatchScan
            | F::PlanPath
            | F::Track
            | F::FreeWay
            | F::MapOverlap => self.gen_service(e, f, dest),
            F::Draw | F::Inside => self.gen_env_function(e, f, dest),
            F::Norm | F::Distance => {
                self.check_call(e, f)?;
                let d = self.dest(dest, 1, e.span)?;
                let top = self.body.top;
                let instr = match e.args.as_slice() {
                    [a, b] => Instr::Distance { d, a: self.registers(a)?, b: self.registers(b)? },
                    [a] => Instr::Norm { d, a: self.registers(a)? },
                    _ => return error(e.span, "wrong number of arguments"),
                };
                self.body.top = top;
                self.emit(instr, e.span);
                Ok(Place::frame(d))
            }
            F::Abs
            | F::Sign
            | F::Floor
            | F::Ceil
            | F::Round
            | F::Sin
            | F::Cos
            | F::Tan
            | F::Asin
            | F::Acos
            | F::Exp
            | F::Log
            | F::Wrap
            | F::Towards
            | F::AngleOf => {
                let [x] = arguments(e)?;
                self.check_call(e, f)?;
                let top = self.body.top;
                let a = self.scalar(x)?;
                self.body.top = top;
                let d = self.dest(dest, 1, e.span)?;
                let instr = if f == F::Abs { Instr::Abs { d, a } } else { Instr::Function1 { f, d, a } };
                self.emit(instr, e.span);
                Ok(Place::frame(d))
            }
            F::Min | F::Max => {
                let [x, y] = arguments(e)?;
                self.check_call(e, f)?;
                let top = self.body.top;
                let (a, b) = (self.scalar(x)?, self.operand(y)?);
                self.body.top = top;
                let d = self.dest(dest, 1, e.span)?;
                let instr = match (f, b) {
                    (F::Min, Operand::Register(b)) => Instr::Min { d, a, b },
                    (F::Min, Operand::Constant(k)) => Instr::MinK { d, a, k },
                    (_, Operand::Register(b)) => Instr::Max { d, a, b },
                    (_, Operand::Constant(k)) => Instr::MaxK { d, a, k },
                };
                self.emit(instr, e.span);
                Ok(Place::frame(d))
            }
            F::Atan2 | F::Hypot | F::Modulo => {
                let [x, y] = arguments(e)?;
                self.check_call(e, f)?;
                let top = self.body.top;
                let (a, b) = (self.scalar(x)?, self.scalar(y)?);
                self.body.top = top;
                let d = self.dest(dest, 1, e.span)?;
                self.emit(Instr::Function2 { f, d, a, b }, e.span);
                Ok(Place::frame(d))
            }
            F::Rotate => {
                let [v, by] = arguments(e)?;
                self.check_call(e, f)?;
                let d = self.dest(dest, 3, e.span)?;
                let top = self.body.top;
                let v = self.registers(v)?;
                let instr = match self.operand(by)? {
                    Operand::Constant(k) => {
                        let angle = self.program.constants.get(k as usize).copied().unwrap_or_default();
                        let k = self.program.constants.len() as u32;
                        self.program.constants.extend(geometry::turn_of(angle));
                        Instr::TurnK { d, a: v, k }
                    }
                    Operand::Register(b) => {
                        let a = self.alloc(4, e.span)?;
                        self.copy(Place::frame(v), a, 3, e.span);
                        self.copy(Place::frame(b), a + 3, 1, e.span);
                        Instr::FunctionN { f, d, a }
                    }
                };
                self.body.top = top;
                self.emit(instr, e.span);
                Ok(Place::frame(d))
            }
            F::Twist => {
                let [forward, turn, left, up] = arguments(e)?;
                self.check_call(e, f)?;
                let d = self.dest(dest, 6, e.span)?;
                let top = self.body.top;
                for (arg, at) in [(forward, 0), (left, 1), (up, 2), (turn, 5)] {
                    self.generate(arg, Some(d + at))?;
                    self.body.top = top;
                }
                self.constant_into(d + 3, 0.0, e.span);
                self.constant_into(d + 4, 0.0, e.span);
                Ok(Place::frame(d))
            }
            F::Clamp
            | F::HeadingOf
            | F::Polar
            | F::Unit
            | F::PoseAt
            | F::Bearing
            | F::Place
            | F::FromBody
            | F::ToBody
            | F::PointFromBody
            | F::PointToBody
            | F::CircleIntersections
            | F::FirstContact
            | F::Exactly
            | F::Normal
            | F::Uniform
            | F::Skewed
            | F::Within => {
                let t = self.check_call(e, f)?;
                let n = self.width(&t, e.span)?;
                let d = self.dest(dest, n, e.span)?;
                let top = self.body.top;
                let a = self.in_a_row(&e.args)?;
                self.body.top = top;
                self.emit(Instr::FunctionN { f, d, a }, e.span);
                Ok(Place::frame(d))
            }
        }
    }

    /// Values one after the other in the frame; the first register.
    fn in_a_row(&mut self, args: &[Expr]) -> Compiled<u32> {
        let mut widths = Vec::new();
        for arg in args {
            widths.push(self.width(&arg.ty, arg.span)?);
        }
        let at = args.first().map(|a| a.span).unwrap_or_default();
        let a = self.alloc(widths.iter().sum(), at)?;
        let (top, mut to) = (self.body.top, a);
        for (arg, width) in args.iter().zip(widths) {
            self.generate(arg, Some(to))?;
            self.body.top = top;
            to += width;
        }
        Ok(a)
    }

    /// Functions that ask the surroundings.
    #[inline(never)]
    pub(super) fn gen_env_function(&mut self, e: &Expr, f: Function, dest: Option<u32>) -> Compiled<Place> {
        self.check_call(e, f)?;
        self.body.variable += 1;
        let d = self.dest(dest, 1, e.span)?;
        let top = self.body.top;
        let instr = match e.args.as_slice() {
            [from] => Instr::Draw { d, a: self.registers(from)? },
            [point, region] => Instr::Inside { d, a: self.registers(point)?, b: self.scalar(region)? },
            _ => return error(e.span, "wrong number of arguments"),
        };
        self.body.top = top;
        self.emit(instr, e.span);
        Ok(Place::frame(d))
    }

    /// Services of the surroundings.
    #[inline(never)]
    fn gen_service(&mut self, e: &Expr, f: Function, dest: Option<u32>) -> Compiled<Place> {
        let ty = self.check_call(e, f)?;
        self.body.variable += 1;
        let n = self.width(&ty, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let a = self.in_a_row(&e.args)?;
        let args = self.body.top - a;
        self.body.top = top;
        self.program.sizes.push((args, n));
        let sizes = (self.program.sizes.len() - 1) as u32;
        self.emit(Instr::Service { f, d, a, sizes }, e.span);
        Ok(Place::frame(d))
    }

    /// Checks arguments and type of a call against the function's signature; returns the type.
    #[inline(never)]
    fn check_call(&mut self, e: &Expr, f: Function) -> Compiled<Type> {
        let signature = f.signature();
        if signature.parameters.len() != e.args.len() {
            return error(
                e.span,
                format!("`{}` takes {} arguments", signature.name, signature.parameters.len()),
            );
        }
        let mut vars = Bindings::default();
        for (arg, parameter) in e.args.iter().zip(&signature.parameters) {
            if !parameter.pattern.matches(&arg.ty, &mut vars) {
                return error(arg.span, format!("`{}` does not take {} here", signature.name, arg.ty));
            }
        }
        match signature.result.instantiate(&vars) {
            Some(t) => {
                gives(e, &t)?;
                Ok(t)
            }
            None => error(e.span, format!("the type of `{}` is not determined", signature.name)),
        }
    }
}
