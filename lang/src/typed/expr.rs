//! Expressions.

use super::{Checker, Place, same_but_frame};
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{
    Binary, Diagnostic, Dim, Expr as GExpr, Frame, Op, Quantifier, Span, Type, Value, typing,
};

impl Checker<'_> {
    /// Types an expression. `want` guides literals and names that could mean several things; the result
    /// need not have that type ([`Checker::typed`] makes sure).
    pub fn expr(&mut self, e: &Expr, want: Option<&Type>) -> Option<GExpr> {
        let ok = self.deeper(e.span);
        let result = if ok { self.expr_inner(e, want) } else { None };
        self.depth -= 1;
        result
    }

    fn expr_inner(&mut self, e: &Expr, want: Option<&Type>) -> Option<GExpr> {
        let span = e.span;
        match &*e.kind {
            ExprKind::Bad => None,
            ExprKind::Quantity(v, dim, whole) => Some(match (whole, want) {
                (Some(_), Some(Type::Quantity(Dim::NONE))) => {
                    GExpr::constant(Value::Number(*v), Type::NUMBER, span)
                }
                (Some(i), _) => GExpr::constant(Value::Int(*i), Type::Int, span),
                _ => GExpr::constant(Value::Number(*v), Type::Quantity(*dim), span),
            }),
            ExprKind::Bool(b) => Some(GExpr::constant(Value::Bool(*b), Type::Bool, span)),
            ExprKind::Text(s) => {
                self.texts.intern(s);
                Some(GExpr::constant(Value::Text(s.clone()), Type::Text, span))
            }
            ExprKind::Name(n) => self.name(n, span, want),
            ExprKind::Field(on, field) => self.field(on, field, span),
            ExprKind::Call(f, args) => self.call(f, args, span, want),
            ExprKind::Method(on, f, args) => self.method(on, f, args, span, want),
            ExprKind::Neg(x) => {
                let x = self.expr(x, want)?;
                match typing::negate(&x.ty) {
                    Some(ty) => Some(match &x.op {
                        Op::Const(Value::Int(i)) => GExpr::constant(Value::Int(-i), ty, span),
                        Op::Const(Value::Number(v)) => GExpr::constant(Value::Number(-v), ty, span),
                        _ => GExpr::new(Op::Neg, vec![x], ty, span),
                    }),
                    None => {
                        self.report(
                            Diagnostic::error(code::OPERANDS, format!("{} has no negative", x.ty))
                                .at(x.span, x.ty.to_string())
                                .hint("a minus stands before numbers, quantities and vectors"),
                        );
                        None
                    }
                }
            }
            ExprKind::Not(x) => {
                let x = self.typed(x, &Type::Bool)?;
                Some(GExpr::new(Op::Not, vec![x], Type::Bool, span))
            }
            ExprKind::Binary(op, a, b) => self.binary(*op, a, b, span, want),
            ExprKind::Range(a, b) => {
                let inner = match want {
                    Some(Type::Range(d)) => Some(Type::Quantity(*d)),
                    _ => None,
                };
                let (a, b) = (self.expr(a, inner.as_ref()), self.expr(b, inner.as_ref()));
                let (a, b) = (a?, b?);
                match (typing::number(&a.ty), typing::number(&b.ty)) {
                    (Some(x), Some(y)) if x == y => {
                        let q = Type::Quantity(x);
                        let (a, b) = (self.coerce(a, &q)?, self.coerce(b, &q)?);
                        Some(GExpr::new(Op::MakeRange, vec![a, b], Type::Range(x), span))
                    }
                    _ => self.operands("..", &a, &b),
                }
            }
            ExprKind::Power(a, n) => self.power(a, n, span),
            ExprKind::Is(x, some, name) => self.is_test(x, *some, name.as_ref(), span),
            ExprKind::If(arms, last) => self.if_expr(arms, last, span, want),
            ExprKind::Match(x, arms) => self.match_expr(x, arms, span, want),
            ExprKind::Some(x) => {
                let inner = match want {
                    Some(Type::Option(t)) => Some((**t).clone()),
                    _ => None,
                };
                let x = match &inner {
                    Some(t) => self.typed(x, t)?,
                    None => self.expr(x, None)?,
                };
                let ty = x.ty.clone().optional();
                Some(GExpr::new(Op::MakeSome, vec![x], ty, span))
            }
            ExprKind::None(why) => match want {
                Some(t @ Type::Option(_)) => {
                    let why = why.clone().unwrap_or_else(|| "not given".into());
                    self.texts.intern(&why);
                    Some(GExpr::new(Op::MakeNone(why), Vec::new(), t.clone(), span))
                }
                Some(t) => {
                    self.report(
                        Diagnostic::error(code::MISMATCH, format!("{t} is wanted, this is none"))
                            .at(span, "none")
                            .hint(format!("declare it as `{t}?` if it may be absent")),
                    );
                    None
                }
                None => {
                    self.report(
                        Diagnostic::error(code::CANNOT_INFER, "none of what?")
                            .at(span, "the type cannot be told")
                            .hint("declare the type where the value goes"),
                    );
                    None
                }
            },
            ExprKind::Quantified(q, x) => self.quantified(*q, x, span),
            ExprKind::List(items) => self.list_literal(items, span, want),
            ExprKind::Tuple(items) => self.tuple(items, span, want),
        }
    }

    fn field(&mut self, on: &Expr, field: &Ident, span: Span) -> Option<GExpr> {
        if let Some(e) = self.qualified(on, field, span) {
            return e;
        }
        let on = self.expr(on, None)?;
        if let Type::Record(r) = &on.ty {
            let fields = self.types.records.get(r).map(|r| r.fields.clone()).unwrap_or_default();
            if let Some(i) = fields.iter().position(|(n, _)| *n == field.name) {
                return Some(GExpr::new(Op::Field(i as u32), vec![on], fields[i].1.clone(), span));
            }
            let d = unknown(
                code::UNKNOWN_FIELD,
                &format!("field of {r}"),
                &field.name,
                field.span,
                fields.iter().map(|(n, _)| &**n),
            );
            self.report(d);
            return None;
        }
        if let Some((part, ty)) = typing::part(&on.ty, &field.name) {
            return Some(GExpr::new(Op::Part(part), vec![on], ty, span));
        }
        let d = match &on.ty {
            Type::Option(inner) => Diagnostic::error(code::ABSENCE, "this value may be absent")
                .at(on.span, format!("{}, a part of {inner} is wanted", on.ty))
                .hint("give a value for absence with `or`, or take both ways with `match … { some(x) => … none(why) => … }`"),
            ty => unknown(code::UNKNOWN_FIELD, &format!("part of {ty}"), &field.name, field.span, typing::parts_of(ty).iter().copied()),
        };
        self.report(d);
        None
    }

    fn binary(&mut self, op: Binary, a: &Expr, b: &Expr, span: Span, want: Option<&Type>) -> Option<GExpr> {
        use Binary::{And, Div, Mul, Or};
        if op == And {
            // What the left side binds (`x is some(y)`) is known on the right.
            let mark = self.body.scope.len();
            let e = self.and(a, b, span);
            self.body.scope.truncate(mark);
            return e;
        }
        // A literal takes its meaning from the other operand: variants, and numbers beside numbers.
        let hint = if matches!(op, Mul | Div) { None } else { want.filter(|_| !is_comparison(op)).cloned() };
        let (x, y) = if names_variant(a) && !names_variant(b) {
            let y = self.expr(b, hint.as_ref());
            let x = self.expr(a, y.as_ref().map(|y| &y.ty));
            (x, y)
        } else {
            let x = self.expr(a, hint.as_ref());
            let w = match &x {
                Some(x)
                    if matches!(
                        x.ty,
                        Type::Enum(_) | Type::Option(_) | Type::Vector(..) | Type::Point(_)
                    ) && !matches!(op, Mul | Div) =>
                {
                    self.partner(op, &x.ty)
                }
                _ => hint,
            };
            (x, self.expr(b, w.as_ref()))
        };
        let (x, y) = (x?, y?);
        if op == Or
            && let Type::Option(inner) = x.ty.clone()
        {
            let y = self.coerce(y, &inner)?;
            let local = self.body.local(&inner);
            let bound = GExpr::new(Op::Local(local), Vec::new(), (*inner).clone(), x.span);
            return Some(GExpr::new(Op::IfSome { local, reason: None }, vec![x, bound, y], *inner, span));
        }
        match typing::binary(op, &x.ty, &y.ty) {
            Some(ty) => Some(GExpr::new(Op::Binary(op), vec![x, y], ty, span)),
            None => self.operands(symbol(op), &x, &y),
        }
    }

    /// What would naturally stand on the other side of `op`.
    fn partner(&self, op: Binary, left: &Type) -> Option<Type> {
        match (op, left) {
            (Binary::Add, Type::Point(f)) => Some(Type::Vector(f.clone(), Dim::LENGTH)),
            (Binary::Or, Type::Option(t)) => Some((**t).clone()),
            (_, t) => Some(t.clone()),
        }
    }

    fn and(&mut self, a: &Expr, b: &Expr, span: Span) -> Option<GExpr> {
        let a = self.typed(a, &Type::Bool);
        let b = self.typed(b, &Type::Bool);
        Some(GExpr::new(Op::Binary(Binary::And), vec![a?, b?], Type::Bool, span))
    }

    /// The error for operands that do not go together, with both labelled.
    pub fn operands<T>(&mut self, op: &str, a: &GExpr, b: &GExpr) -> Option<T> {
        let d = if let (Type::Option(_), _) | (_, Type::Option(_)) = (&a.ty, &b.ty) {
            Diagnostic::error(code::ABSENCE, format!("`{op}` on a value that may be absent"))
                .hint("give a value for absence with `or`, or take both ways with `match … { some(x) => … none(why) => … }`")
        } else if same_but_frame(&a.ty, &b.ty) || frames_differ(&a.ty, &b.ty) {
            Diagnostic::error(code::FRAMES, format!("`{op}` mixes frames"))
                .hint("bring both into one frame first: `place`, `from_body`, `to_body`")
        } else {
            let d = Diagnostic::error(
                code::OPERANDS,
                format!("`{op}` does not go between {} and {}", a.ty, b.ty),
            );
            match (typing::number(&a.ty), typing::number(&b.ty)) {
                (Some(x), Some(y)) if x != y => match (x == Dim::NONE, y == Dim::NONE) {
                    (true, false) => d.hint(format!("give the first a unit, for example `{}`", y.si_unit())),
                    (false, true) => d.hint(format!("give the second a unit, for example `{}`", x.si_unit())),
                    _ => d.hint("only quantities of one dimension can be added, subtracted or compared"),
                },
                _ => match (&a.ty, &b.ty) {
                    (Type::Heading(_), Type::Heading(_)) => {
                        d.hint("headings wrap: subtract them and compare the angle between")
                    }
                    (Type::Point(_), Type::Point(_)) => {
                        d.hint("subtract points to get the vector between them")
                    }
                    _ => d.hint("see the operators in docs/language.md"),
                },
            }
        };
        let label = |t: &Type| match t {
            Type::Quantity(d) if *d != Dim::NONE => format!("{t}, in {}", d.si_unit()),
            t => t.to_string(),
        };
        let d = d.at(a.span, label(&a.ty)).at(b.span, label(&b.ty));
        self.report(d);
        None
    }

    fn power(&mut self, a: &Expr, n: &Expr, span: Span) -> Option<GExpr> {
        let a = self.expr(a, None)?;
        let n = self.typed(n, &Type::Int)?;
        let Some(Value::Int(k)) =
            n.as_const().cloned().filter(|v| matches!(v, Value::Int(k) if k.abs() <= 16))
        else {
            self.report(
                Diagnostic::error(code::NOT_CONSTANT, "a power needs a whole number written out")
                    .at(n.span, "from -16 to 16")
                    .hint("for other powers use `exp(y * log(x))`"),
            );
            return None;
        };
        match typing::power(&a.ty, k as i32) {
            Some(ty) => Some(GExpr::new(Op::Power(k as i32), vec![a], ty, span)),
            None => {
                self.report(
                    Diagnostic::error(code::OPERANDS, format!("{} has no powers", a.ty))
                        .at(a.span, a.ty.to_string())
                        .hint("powers are for numbers and quantities"),
                );
                None
            }
        }
    }

    fn quantified(&mut self, q: Quantifier, x: &Expr, span: Span) -> Option<GExpr> {
        if self.body.place != Place::Truth {
            self.report(
                Diagnostic::error(code::TRUTH, "only the mission can look at all robots")
                    .at(span, "a behaviour knows the others by their messages")
                    .hint("use `heard(topic)`"),
            );
            return None;
        }
        if self.body.of_robot {
            self.report(
                Diagnostic::error(code::OPERANDS, "a quantifier inside a quantifier")
                    .at(span, "already about one robot")
                    .hint("quantify once"),
            );
            return None;
        }
        self.body.of_robot = true;
        let wants_bool = matches!(q, Quantifier::Each | Quantifier::Some | Quantifier::Count);
        let x = if wants_bool { self.typed(x, &Type::Bool) } else { self.expr(x, None) };
        self.body.of_robot = false;
        let x = x?;
        let ty = match q {
            Quantifier::Each | Quantifier::Some => Type::Bool,
            Quantifier::Count => Type::Int,
            _ => match typing::number(&x.ty) {
                Some(d) => Type::Quantity(d),
                None => {
                    self.report(
                        Diagnostic::error(code::MISMATCH, format!("a quantity is wanted, this is {}", x.ty))
                            .at(x.span, x.ty.to_string())
                            .hint("`sum`, `least`, `most` and `mean` combine quantities"),
                    );
                    return None;
                }
            },
        };
        Some(GExpr::new(Op::Quantified(q), vec![x], ty, span))
    }

    /// `(x, y)` or `(x, y, z)`: a point or vector, in the frame that is wanted, else in map.
    fn tuple(&mut self, items: &[Expr], span: Span, want: Option<&Type>) -> Option<GExpr> {
        let want = match want {
            Some(Type::Option(t)) => Some(&**t),
            w => w,
        };
        let dim = match want {
            Some(Type::Point(_) | Type::Pose(_)) => Some(Dim::LENGTH),
            Some(Type::Vector(_, d)) => Some(*d),
            _ => None,
        };
        let mut parts = Vec::new();
        let mut found = dim;
        for item in items {
            let q = found.map(Type::Quantity);
            let e = match &q {
                Some(q) => self.typed(item, q)?,
                None => self.expr(item, None)?,
            };
            match typing::number(&e.ty) {
                Some(d) => found = Some(d),
                None => {
                    self.report(
                        Diagnostic::error(code::MISMATCH, format!("a quantity is wanted, this is {}", e.ty))
                            .at(e.span, e.ty.to_string())
                            .hint("points and vectors are made of two or three quantities"),
                    );
                    return None;
                }
            }
            parts.push(e);
        }
        let dim = found.unwrap_or(Dim::LENGTH);
        if parts.len() == 2 {
            parts.push(GExpr::constant(Value::Number(0.0), Type::Quantity(dim), span));
        }
        let ty = match want {
            Some(t @ (Type::Point(_) | Type::Vector(..))) => t.clone(),
            Some(Type::Pose(f)) => Type::Point(f.clone()),
            _ => self.default_vector(dim),
        };
        Some(GExpr::new(Op::MakeVector, parts, ty, span))
    }

    fn list_literal(&mut self, items: &[Expr], span: Span, want: Option<&Type>) -> Option<GExpr> {
        let (mut inner, capacity) = match want {
            Some(Type::List(t, n)) => (Some((**t).clone()), Some(*n)),
            _ => (None, None),
        };
        let mut out = Vec::new();
        for item in items {
            let e = match &inner {
                Some(t) => self.typed(item, t)?,
                None => self.expr(item, None)?,
            };
            inner.get_or_insert_with(|| e.ty.clone());
            out.push(e);
        }
        let Some(inner) = inner else {
            self.report(
                Diagnostic::error(code::CANNOT_INFER, "an empty list of what?")
                    .at(span, "the type cannot be told")
                    .hint("declare the type where the list goes"),
            );
            return None;
        };
        if capacity.is_some_and(|c| out.len() > c as usize) {
            self.report(
                Diagnostic::error(
                    code::RANGE,
                    format!("{} items in a list of at most {}", out.len(), capacity.unwrap_or(0)),
                )
                .at(span, "too many")
                .hint("declare a larger capacity, or leave some out"),
            );
            return None;
        }
        let n = capacity.unwrap_or(out.len() as u32);
        Some(GExpr::new(Op::MakeList, out, Type::List(Box::new(inner), n), span))
    }
}

fn is_comparison(op: Binary) -> bool {
    matches!(op, Binary::Lt | Binary::Le | Binary::Gt | Binary::Ge | Binary::Eq | Binary::Ne)
}

/// Whether an expression is a bare name, which might be a variant that needs its partner's type.
fn names_variant(e: &Expr) -> bool {
    matches!(&*e.kind, ExprKind::Name(_))
}

fn frames_differ(a: &Type, b: &Type) -> bool {
    fn frame(t: &Type) -> Option<&Frame> {
        match t {
            Type::Point(f) | Type::Vector(f, _) | Type::Heading(f) | Type::Pose(f) => Some(f),
            _ => None,
        }
    }
    matches!((frame(a), frame(b)), (Some(f), Some(g)) if f != g)
}

/// How an operator is written.
pub fn symbol(op: Binary) -> &'static str {
    match op {
        Binary::Add => "+",
        Binary::Sub => "-",
        Binary::Mul => "*",
        Binary::Div => "/",
        Binary::Lt => "<",
        Binary::Le => "<=",
        Binary::Gt => ">",
        Binary::Ge => ">=",
        Binary::Eq => "==",
        Binary::Ne => "!=",
        Binary::And => "and",
        Binary::Or => "or",
    }
}
