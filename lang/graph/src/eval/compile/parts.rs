//! Code for making values of parts, and for taking parts of values.

use super::emit::error;
use super::expr::{arguments, gives};
use super::{Compiled, Compiler, Place};
use crate::{Expr, Op, Part, Type, eval::code::Instr, reason};

impl Compiler<'_> {
    #[inline(never)]
    pub(super) fn gen_make(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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
                    self.one_register(arg)?;
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
    pub(super) fn gen_field(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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
    pub(super) fn gen_part(&mut self, e: &Expr, part: Part, dest: Option<u32>) -> Compiled<Place> {
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
    pub(super) fn gen_matrix(&mut self, e: &Expr, dest: Option<u32>) -> Compiled<Place> {
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
