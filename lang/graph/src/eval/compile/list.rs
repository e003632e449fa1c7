//! Code for lists: loops that go through a list where it lies, and functions of lists.

use super::emit::error;
use super::expr::{arguments, gives, writes_last};
use super::{Compiled, Compiler, Place};
use crate::eval::code::{Instr, ListRef, Space};
use crate::eval::widths::same_layout;
use crate::{Expr, Function, ListOp, Span, Stmt, Type, reason};

impl Compiler<'_> {
    /// Code for a list, and a description of it for an instruction.
    fn list(&mut self, e: &Expr) -> Compiled<ListRef> {
        let Type::List(item, capacity) = &e.ty else {
            return error(e.span, format!("a list is wanted here, not {}", e.ty));
        };
        let width = if *capacity == 0 { 0 } else { self.width(item, e.span)? };
        let place = self.generate(e, None)?;
        Ok(ListRef {
            space: place.space,
            at: place.at,
            capacity: *capacity,
            width,
            state: 0,
            item: 0,
            part: (0, 0),
            out_width: 0,
            out_capacity: 0,
        })
    }

    fn add_list(&mut self, list: ListRef) -> u32 {
        self.program.lists.push(list);
        (self.program.lists.len() - 1) as u32
    }

    /// A list that a loop goes through with its items in `local`.
    #[inline(never)]
    fn looped(&mut self, e: &Expr, local: u32, body: &Expr) -> Compiled<ListRef> {
        let mut list = self.list(e)?;
        let (item, t) = self.local(local, e.span)?;
        match &e.ty {
            Type::List(_, 0) => {}
            Type::List(of, _) if same_layout(of, &t) => list.part = self.part_read(body, local)?,
            _ => return error(e.span, format!("the items of {} are put into {t}", e.ty)),
        }
        list.item = item;
        list.state = self.alloc(3, e.span)?;
        self.begin_loop(body)?;
        self.body.variable += 1;
        Ok(list)
    }

    /// Code of a loop: `body` is compiled once and counted for every item. Jumps to the next item come
    /// from `next`, jumps behind the loop are added to `out`.
    fn each_item(
        &mut self,
        list: ListRef,
        local: u32,
        at: Span,
        out: &mut Vec<u32>,
        body: impl FnOnce(&mut Self, u32, &mut Vec<u32>) -> Compiled<()>,
    ) -> Compiled<()> {
        let index = self.add_list(list);
        let (go_in, go_on) = loop_instructions(&list, index);
        self.jump(go_in, out, at);
        let (first, before) = (self.here(), self.body.cost);
        let nested = std::mem::replace(&mut self.body.in_loop, true);
        let mut next = Vec::new();
        self.perhaps(|c| c.with_bound(local, None, |c| body(c, index, &mut next)))?;
        self.body.in_loop = nested;
        self.end_loop();
        self.land(&next);
        self.emit(go_on(first), at);
        self.repeat(before, u64::from(list.capacity));
        Ok(())
    }

    /// Code of statements for each item. They may change the state that the list comes from, so it is copied.
    pub(super) fn gen_each(&mut self, e: &Expr, local: u32, body: &[Stmt]) -> Compiled<()> {
        let (Type::List(of, capacity), (item, t)) = (&e.ty, self.local(local, e.span)?) else {
            return error(e.span, format!("a list is wanted here, not {}", e.ty));
        };
        if *capacity > 0 && !same_layout(of, &t) {
            return error(e.span, format!("the items of {} are put into {t}", e.ty));
        }
        let n = self.width(&e.ty, e.span)?;
        let copy = self.alloc(n, e.span)?;
        let place = self.generate(e, None)?;
        if place != Place::frame(copy) {
            self.copy(place, copy, n, e.span);
        }
        let width = if *capacity == 0 { 0 } else { self.width(of, e.span)? };
        let list = ListRef {
            space: Space::Frame,
            at: copy,
            capacity: *capacity,
            width,
            state: self.alloc(3, e.span)?,
            item,
            part: (0, width),
            out_width: 0,
            out_capacity: 0,
        };
        let index = self.add_list(list);
        let (go_in, go_on) = loop_instructions(&list, index);
        let mut out = Vec::new();
        self.jump(go_in, &mut out, e.span);
        let (first, before) = (self.here(), self.body.cost);
        self.perhaps(|c| c.with_bound(local, None, |c| c.gen_stmts(body)))?;
        self.emit(go_on(first), e.span);
        self.repeat(before, u64::from(*capacity));
        self.land(&out);
        Ok(())
    }

    #[inline(never)]
    pub(super) fn gen_list(
        &mut self,
        e: &Expr,
        op: ListOp,
        local: u32,
        dest: Option<u32>,
    ) -> Compiled<Place> {
        let [of, body] = arguments(e)?;
        let at = e.span;
        let n = self.width(&e.ty, at)?;
        let Type::List(item, capacity) = &of.ty else {
            return error(at, format!("a list is wanted here, not {}", of.ty));
        };
        match (op, &e.ty) {
            (ListOp::Map, Type::List(_, m)) if m >= capacity => {}
            (ListOp::Filter, Type::List(t, m)) if m >= capacity && (*m == 0 || same_layout(t, item)) => {}
            (ListOp::Any | ListOp::All | ListOp::Count, _) => gives(e, &Type::NUMBER)?,
            (ListOp::Find | ListOp::MinBy | ListOp::MaxBy, Type::Option(t)) if same_layout(t, item) => {}
            _ => return error(at, format!("this is no {}", e.ty)),
        }
        if op != ListOp::Map {
            gives(body, &Type::NUMBER)?;
        }
        let d = self.dest(dest, n, at)?;
        let top = self.body.top;
        let mut list = self.looped(of, local, body)?;
        if let Type::List(t, m) = &e.ty {
            list.out_width = if *m == 0 { 0 } else { self.width(t, at)? };
            list.out_capacity = *m;
        }
        let start = match op {
            ListOp::All => 1.0,
            ListOp::Find | ListOp::MinBy | ListOp::MaxBy => reason::tag(reason::NONE_FOUND),
            _ => 0.0,
        };
        self.constant_into(d, start, at);
        let (mut out, mut decided) = (Vec::new(), Vec::new());
        let mut found = Vec::new();
        self.each_item(list, local, at, &mut out, |c, list, next| {
            match op {
                ListOp::Filter => {
                    c.branch(body, false, next)?;
                    c.emit(Instr::Keep { list, d }, at);
                }
                ListOp::Count => {
                    c.branch(body, false, next)?;
                    let k = c.pooled(1.0);
                    c.emit(Instr::AddK { d, a: d, k }, at);
                }
                ListOp::Any => c.branch(body, true, &mut decided)?,
                ListOp::All => c.branch(body, false, &mut decided)?,
                ListOp::Find => {
                    c.branch(body, false, next)?;
                    c.emit(Instr::Found { list, d }, at);
                    c.jump(Instr::Jump { to: 0 }, &mut found, at);
                }
                ListOp::Map => {
                    let Type::List(t, _) = &e.ty else { return error(at, "no list") };
                    let n = c.width(t, at)?;
                    let place = c.gen_as(body, t, None)?;
                    let a = c.in_frame(place, n, at)?;
                    let instr = match (n, u16::try_from(c.program.lists[list as usize].out_capacity)) {
                        (3, Ok(most)) => Instr::Append3 { most, d, a },
                        _ => Instr::Append { list, d, a },
                    };
                    c.emit(instr, at);
                }
                ListOp::MinBy | ListOp::MaxBy => {
                    let a = c.scalar(body)?;
                    c.emit(
                        match op {
                            ListOp::MinBy => Instr::Least { list, d, a },
                            _ => Instr::Greatest { list, d, a },
                        },
                        at,
                    );
                }
            }
            Ok(())
        })?;
        if !decided.is_empty() {
            self.jump(Instr::Jump { to: 0 }, &mut out, at);
            self.land(&decided);
            self.constant_into(d, 1.0 - start, at);
        }
        self.land(&out);
        self.land(&found);
        self.body.top = top;
        Ok(Place::frame(d))
    }

    #[inline(never)]
    pub(super) fn gen_fold(&mut self, e: &Expr, acc: u32, item: u32, dest: Option<u32>) -> Compiled<Place> {
        let [of, initial, body] = arguments(e)?;
        let (register, t) = self.local(acc, e.span)?;
        gives(e, &t)?;
        let n = self.width(&t, e.span)?;
        let d = self.dest(dest, n, e.span)?;
        let top = self.body.top;
        let list = self.looped(of, item, body)?;
        self.gen_as(initial, &t, Some(register))?;
        let mut out = Vec::new();
        self.with_bound(acc, None, |c| {
            c.each_item(list, item, e.span, &mut out, |c, _, _| {
                if writes_last(body) && same_layout(&body.ty, &t) {
                    c.generate(body, Some(register))?;
                } else {
                    let place = c.gen_as(body, &t, None)?;
                    // The value may share registers with the accumulator it was made of.
                    c.copy(place, register, n, e.span);
                }
                Ok(())
            })
        })?;
        self.land(&out);
        self.body.top = top;
        self.copy(Place::frame(register), d, n, e.span);
        Ok(Place::frame(d))
    }

    /// Functions whose first argument is a list.
    #[inline(never)]
    pub(super) fn gen_list_function(&mut self, e: &Expr, f: Function, dest: Option<u32>) -> Compiled<Place> {
        let Some((of, args)) = e.args.split_first() else {
            return error(e.span, "a list is wanted here");
        };
        let Type::List(item, _) = &of.ty else {
            return error(e.span, format!("a list is wanted here, not {}", of.ty));
        };
        let at = e.span;
        let n = self.width(&e.ty, at)?;
        let d = self.dest(dest, n, at)?;
        let top = self.body.top;
        let list = self.list(of)?;
        let wanted = match f {
            Function::At | Function::First | Function::Last => item.as_ref().clone().optional(),
            Function::Smallest | Function::Largest => Type::NUMBER.optional(),
            Function::Push => of.ty.clone(),
            _ => Type::NUMBER,
        };
        gives(e, &wanted)?;
        if matches!(f, Function::Sum | Function::Smallest | Function::Largest) && list.width > 1 {
            return error(at, format!("a list of numbers is wanted here, not {}", of.ty));
        }
        let argument = match (f, args) {
            (Function::Push, [value]) => {
                let place = self.gen_as(value, item, None)?;
                let width = self.width(item, at)?;
                self.in_frame(place, width, at)?
            }
            (Function::At, [index]) => self.scalar(index)?,
            (Function::First, []) => {
                let zero = self.alloc(1, at)?;
                self.constant_into(zero, 0.0, at);
                zero
            }
            (Function::Push | Function::At, _) | (_, [_, ..]) => {
                return error(at, "wrong number of arguments");
            }
            _ => 0,
        };
        let (list, a) = (self.add_list(list), argument);
        self.emit(
            match f {
                Function::Length => Instr::ListLength { list, d },
                Function::At | Function::First => Instr::ListAt { list, d, a },
                Function::Last => Instr::ListLast { list, d },
                Function::Push => Instr::ListPush { list, d, a },
                Function::Sum => Instr::ListSum { list, d },
                Function::Smallest => Instr::ListSmallest { list, d },
                Function::Largest => Instr::ListLargest { list, d },
                _ => return error(at, "no function of a list"),
            },
            at,
        );
        self.body.top = top;
        Ok(Place::frame(d))
    }
}

/// The instructions that make the first item of a list current and the next: the latter jumps to where it is
/// told.
fn loop_instructions(list: &ListRef, index: u32) -> (Instr, impl FnOnce(u32) -> Instr + use<>) {
    let ListRef { state: q, item, width, .. } = *list;
    let three = match (list.space, list.part, u16::try_from(width)) {
        (Space::Frame, (from, 3), Ok(stride)) => Some((item + from, stride)),
        _ => None,
    };
    let first = match three {
        Some(_) => Instr::ListFirst3 { list: index, to: 0 },
        None => Instr::ListFirst { list: index, to: 0 },
    };
    (first, move |to| match three {
        Some((item, stride)) => Instr::ListNext3 { stride, q, item, to },
        None => Instr::ListNext { list: index, to },
    })
}
