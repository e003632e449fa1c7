//! Choices: guards, `if`, `match`, `is`.

use super::Checker;
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{Binary, Conjunct, Diagnostic, Expr as GExpr, Op, Span, Type, Value};

/// What the arms of a match cover.
pub(super) struct Cover {
    pub variants: Vec<(Ident, u32)>,
    pub open: Vec<String>,
    pub rest: bool,
}

/// Most nodes that may be written out more than once.
const MOST_REPEATED: usize = 20_000;

impl Checker<'_> {
    /// A guard as conjuncts; what it binds stays in scope: the caller cuts the scope back.
    pub fn guard(&mut self, e: &Expr) -> Option<Vec<Conjunct>> {
        match &*e.kind {
            ExprKind::Binary(Binary::And, a, b) => {
                // Both sides are looked at, so that what the right one binds is known or forgotten.
                let (left, right) = (self.guard(a), self.guard(b));
                let mut left = left?;
                left.extend(right?);
                Some(left)
            }
            ExprKind::Is(x, true, Some(name)) => {
                let Some(x) = self.optional(x) else {
                    self.poison(&name.name);
                    return None;
                };
                let Type::Option(inner) = x.ty.clone() else { return None };
                let local = self.body.bind(name, &inner);
                Some(vec![Conjunct::Binds(local, x)])
            }
            _ => Some(vec![Conjunct::Holds(self.typed(e, &Type::Bool)?)]),
        }
    }

    /// An expression that must be an optional.
    pub fn optional(&mut self, x: &Expr) -> Option<GExpr> {
        let x = self.expr(x, None)?;
        if !matches!(x.ty, Type::Option(_)) {
            self.report(
                Diagnostic::error(code::MISMATCH, format!("{} is never absent", x.ty))
                    .at(x.span, x.ty.to_string())
                    .hint("`is some`, `is none` and `some(…)` patterns are for optionals"),
            );
            return None;
        }
        Some(x)
    }

    pub(super) fn is_test(
        &mut self,
        x: &Expr,
        some: bool,
        name: Option<&Ident>,
        span: Span,
    ) -> Option<GExpr> {
        if let Some(name) = name {
            self.report(
                Diagnostic::error(code::SYNTAX, format!("`{}` would be bound where nothing can use it", name.name))
                    .at(name.span, "bound here")
                    .hint("`is some(x)` binds in guards: after `when` or `if`, joined with `and`; elsewhere write `is some`"),
            );
            return None;
        }
        let x = self.optional(x)?;
        let Type::Option(inner) = x.ty.clone() else { return None };
        let local = self.body.local(&inner);
        let yes = GExpr::constant(Value::Bool(some), Type::Bool, span);
        let no = GExpr::constant(Value::Bool(!some), Type::Bool, span);
        Some(GExpr::new(Op::IfSome { local, reason: None }, vec![x, yes, no], Type::Bool, span))
    }

    pub(super) fn if_expr(
        &mut self,
        arms: &[(Expr, Expr)],
        last: &Expr,
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let mut want = want.cloned();
        let mut done = Vec::new();
        for (cond, value) in arms {
            let mark = self.body.scope.len();
            let guard = self.guard(cond);
            let value = match &want {
                Some(t) => self.expr(value, Some(t)),
                None => self.expr(value, None),
            };
            self.body.scope.truncate(mark);
            let (guard, value) = (guard?, value?);
            want.get_or_insert_with(|| value.ty.clone());
            done.push((guard, value));
        }
        let last = self.expr(last, want.as_ref())?;
        // The widest of the arms' types: a number beside whole numbers, an optional beside values.
        let ty =
            done.iter().map(|(_, v)| &v.ty).chain([&last.ty]).fold(
                None,
                |acc: Option<Type>, t| match acc {
                    Some(a) if t.fits(&a) || Type::fits(t, &a) => Some(a),
                    Some(a) if a.fits(t) || matches!(t, Type::Option(i) if **i == a) => Some(t.clone()),
                    Some(a) => Some(a),
                    None => Some(t.clone()),
                },
            )?;
        let mut otherwise = self.arm(last, &ty)?;
        for (guard, value) in done.into_iter().rev() {
            let value = self.arm(value, &ty)?;
            otherwise = self.chain(guard, value, otherwise, &ty, span);
        }
        Some(otherwise)
    }

    /// One arm of an `if`. What comes otherwise is written out once: an arm with several conjuncts makes an
    /// optional first, else a chain of n such arms would grow like 2^n.
    fn chain(&mut self, guard: Vec<Conjunct>, then: GExpr, otherwise: GExpr, ty: &Type, span: Span) -> GExpr {
        let guard = merge(guard);
        if guard.len() < 2 {
            return nest(guard, then, &otherwise, ty, span);
        }
        if matches!(ty, Type::Option(_)) {
            let mut nodes = 0;
            otherwise.walk(&mut |_| nodes += 1);
            if nodes > MOST_REPEATED {
                self.report(
                    Diagnostic::error(code::UNBOUNDED, "too long a chain of `else if` with conditions that bind")
                        .at(span, "grows with every arm")
                        .hint("move the later arms into a function, or give `is some(x)` an arm of its own without `and`"),
                );
                return otherwise;
            }
            return nest(guard, then, &otherwise, ty, span);
        }
        let optional = ty.clone().optional();
        self.texts.intern("not given");
        let none = GExpr::new(Op::MakeNone("not given".into()), Vec::new(), optional.clone(), span);
        let some = GExpr::new(Op::MakeSome, vec![then], optional.clone(), span);
        let chosen = nest(guard, some, &none, &optional, span);
        let local = self.body.local(ty);
        let value = GExpr::new(Op::Local(local), Vec::new(), ty.clone(), span);
        GExpr::new(Op::IfSome { local, reason: None }, vec![chosen, value, otherwise], ty.clone(), span)
    }

    fn arm(&mut self, value: GExpr, ty: &Type) -> Option<GExpr> {
        self.coerce(value, ty)
    }

    pub(super) fn match_expr(
        &mut self,
        x: &Expr,
        arms: &[(Pattern, Expr)],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let x = self.expr(x, None)?;
        let mut ty = want.cloned();
        match x.ty.clone() {
            Type::Option(inner) => {
                let cover = self.cover_optional(arms.iter().map(|(p, _)| p), x.span)?;
                let (local, reason) = (self.body.local(&inner), self.body.local(&Type::Text));
                let (mut some, mut none) = (None, None);
                for (p, value) in arms {
                    let mark = self.body.scope.len();
                    self.bind_pattern(p, local, &inner, reason);
                    let v = self.expr(value, ty.as_ref());
                    self.body.scope.truncate(mark);
                    let v = v?;
                    let t = ty.get_or_insert_with(|| v.ty.clone()).clone();
                    let v = self.coerce(v, &t)?;
                    let (is_some, is_none) = sides(p);
                    if is_some && is_none && some.is_none() && none.is_none() {
                        // `otherwise` alone: the same whatever it is.
                        return Some(v);
                    }
                    if is_some && some.is_none() {
                        some = Some(v.clone());
                    }
                    if is_none && none.is_none() {
                        none = Some(v);
                    }
                }
                debug_assert!(cover);
                let ty = ty?;
                Some(GExpr::new(Op::IfSome { local, reason: Some(reason) }, vec![x, some?, none?], ty, span))
            }
            Type::Enum(name) => {
                let cover = self.cover_enum(&name, arms.iter().map(|(p, _)| p), x.span)?;
                let (mut variants, mut values, mut last) = (Vec::new(), vec![x], None);
                for (p, value) in arms {
                    let v = self.expr(value, ty.as_ref())?;
                    let t = ty.get_or_insert_with(|| v.ty.clone()).clone();
                    let v = self.coerce(v, &t)?;
                    match &p.kind {
                        PatternKind::Variants(list) => {
                            for i in list {
                                if let Some((_, index)) =
                                    cover.variants.iter().find(|(n, _)| n.span == i.span)
                                {
                                    variants.push(*index);
                                    values.push(v.clone());
                                }
                            }
                        }
                        _ => last = Some(v),
                    }
                }
                values.extend(last);
                Some(GExpr::new(Op::Switch { variants, rest: cover.rest }, values, ty?, span))
            }
            other => self.no_match(&other, x.span),
        }
    }

    /// Reports a match on something without cases.
    pub(super) fn no_match<T>(&mut self, ty: &Type, span: Span) -> Option<T> {
        self.report(
            Diagnostic::error(code::MISMATCH, format!("{ty} cannot be matched"))
                .at(span, ty.to_string())
                .hint("`match` takes apart optionals and enums; for other values use `if` or rules"),
        );
        None
    }

    /// Puts what a pattern binds into scope.
    pub(super) fn bind_pattern(&mut self, p: &Pattern, local: u32, inner: &Type, reason: u32) {
        match &p.kind {
            PatternKind::Some(name) => self.body.scope.push((name.name.clone(), local, inner.clone())),
            PatternKind::None(Some(name)) => self.body.scope.push((name.name.clone(), reason, Type::Text)),
            _ => {}
        }
    }

    /// Checks that patterns on an optional take both ways and no others.
    pub(super) fn cover_optional<'p>(
        &mut self,
        patterns: impl Iterator<Item = &'p Pattern>,
        span: Span,
    ) -> Option<bool> {
        let (mut some, mut none) = (false, false);
        for p in patterns {
            if let PatternKind::Variants(_) = p.kind {
                self.report(
                    Diagnostic::error(code::MISMATCH, "an optional is either some or none")
                        .at(p.span, "neither of them")
                        .at(span, "an optional")
                        .hint("write `some(x)`, `none(why)` or `otherwise`"),
                );
                return None;
            }
            let (s, n) = sides(p);
            if (some || !s) && (none || !n) {
                self.report(
                    Diagnostic::error(code::UNREACHABLE_RULE, "this case is already taken")
                        .at(p.span, "never reached")
                        .hint("remove it, or put it first"),
                );
                return None;
            }
            some |= s;
            none |= n;
        }
        let open = match (some, none) {
            (true, true) => return Some(true),
            (false, true) => "some(x)",
            (true, false) => "none(why)",
            _ => "some(x) and none(why)",
        };
        self.report(
            Diagnostic::error(
                code::NOT_EXHAUSTIVE,
                format!("this match does not say what to do with {open}"),
            )
            .at(span, "may also be that")
            .hint(format!("add `{open} => …` or `otherwise => …`")),
        );
        None
    }

    /// Checks that patterns on an enum take every variant once.
    pub(super) fn cover_enum<'p>(
        &mut self,
        name: &soifra_graph::Name,
        patterns: impl Iterator<Item = &'p Pattern>,
        span: Span,
    ) -> Option<Cover> {
        let all = self.types.enums.get(name).map(|e| e.variants.clone()).unwrap_or_default();
        let mut cover = Cover { variants: Vec::new(), open: Vec::new(), rest: false };
        for p in patterns {
            let list = match &p.kind {
                _ if cover.rest
                    || cover.variants.len() == all.len() && matches!(p.kind, PatternKind::Otherwise) =>
                {
                    self.report(
                        Diagnostic::error(code::UNREACHABLE_RULE, "this case is already taken")
                            .at(p.span, "never reached")
                            .hint("remove it; `otherwise` stands last"),
                    );
                    return None;
                }
                PatternKind::Otherwise => {
                    cover.rest = true;
                    continue;
                }
                PatternKind::Variants(list) => list,
                _ => {
                    self.report(
                        Diagnostic::error(code::MISMATCH, format!("`{name}` is an enum, never absent"))
                            .at(p.span, "not one of its variants")
                            .at(span, format!("enum {name}"))
                            .hint("list variants, or `otherwise`"),
                    );
                    return None;
                }
            };
            for v in list {
                let Some(i) = all.iter().position(|a| *a == v.name) else {
                    let d = unknown(
                        code::UNKNOWN_NAME,
                        &format!("variant of {name}"),
                        &v.name,
                        v.span,
                        all.iter().map(|a| &**a),
                    );
                    self.report(d);
                    return None;
                };
                if cover.variants.iter().any(|(_, k)| *k == i as u32) {
                    self.report(
                        Diagnostic::error(code::UNREACHABLE_RULE, format!("`{}` is already taken", v.name))
                            .at(v.span, "never reached")
                            .hint("remove it"),
                    );
                    return None;
                }
                cover.variants.push((v.clone(), i as u32));
            }
        }
        if !cover.rest {
            cover.open = all
                .iter()
                .enumerate()
                .filter(|(i, _)| !cover.variants.iter().any(|(_, k)| *k as usize == *i))
                .map(|(_, n)| n.to_string())
                .collect();
            if !cover.open.is_empty() {
                let open = cover.open.join(", ");
                self.report(
                    Diagnostic::error(
                        code::NOT_EXHAUSTIVE,
                        format!("this match does not say what to do with {open}"),
                    )
                    .at(span, "may also be that")
                    .hint(format!("add `{} => …` or `otherwise => …`", cover.open.join(" | "))),
                );
                return None;
            }
        }
        Some(cover)
    }
}

/// Whether a pattern takes the present side, the absent side.
pub(super) fn sides(p: &Pattern) -> (bool, bool) {
    match p.kind {
        PatternKind::Some(_) => (true, false),
        PatternKind::None(_) => (false, true),
        _ => (true, true),
    }
}

/// `if` on a guard: every conjunct must hold for `then`.
fn nest(guard: Vec<Conjunct>, then: GExpr, otherwise: &GExpr, ty: &Type, span: Span) -> GExpr {
    guard.into_iter().rev().fold(then, |then, c| match c {
        Conjunct::Holds(cond) => GExpr::new(Op::If, vec![cond, then, otherwise.clone()], ty.clone(), span),
        Conjunct::Binds(local, x) => {
            GExpr::new(Op::IfSome { local, reason: None }, vec![x, then, otherwise.clone()], ty.clone(), span)
        }
    })
}

/// Neighbouring conditions that bind nothing, as one.
fn merge(guard: Vec<Conjunct>) -> Vec<Conjunct> {
    let mut out: Vec<Conjunct> = Vec::new();
    for c in guard {
        match (out.pop(), c) {
            (Some(Conjunct::Holds(a)), Conjunct::Holds(b)) => {
                let span = a.span.to(b.span);
                out.push(Conjunct::Holds(GExpr::new(Op::Binary(Binary::And), vec![a, b], Type::Bool, span)));
            }
            (last, c) => out.extend(last.into_iter().chain([c])),
        }
    }
    out
}
