//! Arguments of calls: which belongs to which parameter, and whether it fits.

use super::Checker;
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{
    Diagnostic, Expr as GExpr, Function as Builtin, Name, Op, Signature, Span, Type, Value,
    pattern::{Bindings, DimPattern, Pattern},
    typing,
};

/// An argument as the callee sees it: an untyped one, or the receiver of a method call.
pub(super) enum Given<'e> {
    Typed(GExpr),
    Written(&'e Arg),
}

/// Arguments of a component model by name, and the type that the model delivers.
type ModelArguments = (Vec<(Name, GExpr)>, Option<Type>);

impl Checker<'_> {
    pub(super) fn value(&mut self, g: Given<'_>, want: Option<&Type>) -> Option<GExpr> {
        match g {
            Given::Typed(e) => Some(e),
            Given::Written(a) => {
                if a.lambda.is_some() {
                    self.report(
                        Diagnostic::error(code::ARGUMENTS, "a value is wanted, not a function")
                            .at(a.value.span, "part of `=>`")
                            .hint("only list operations such as `map` take `x => …`"),
                    );
                    return None;
                }
                self.expr(&a.value, want)
            }
        }
    }

    /// Orders arguments by parameter: names first, then positions. Missing ones stay `None`.
    pub(super) fn arrange<'e>(
        &mut self,
        f: &Ident,
        names: &[Name],
        given: Vec<Given<'e>>,
        form: &str,
        span: Span,
    ) -> Option<Vec<Option<Given<'e>>>> {
        let mut slots: Vec<Option<Given<'e>>> = names.iter().map(|_| None).collect();
        let mut position = 0;
        for g in given {
            let named = match &g {
                Given::Written(Arg { name: Some(n), .. }) => Some(n.clone()),
                _ => None,
            };
            let at = match &named {
                Some(n) => match names.iter().position(|p| *p == n.name) {
                    Some(i) => i,
                    None => {
                        let d = unknown(
                            code::ARGUMENTS,
                            &format!("argument of `{}`", f.name),
                            &n.name,
                            n.span,
                            names.iter().map(|n| &**n),
                        );
                        self.report(d);
                        return None;
                    }
                },
                None => {
                    position += 1;
                    position - 1
                }
            };
            match slots.get_mut(at) {
                Some(slot @ None) => *slot = Some(g),
                Some(_) => {
                    self.report(
                        Diagnostic::error(code::ARGUMENTS, format!("`{}` is given twice", names[at]))
                            .at(span, "in this call")
                            .hint(form.to_string()),
                    );
                    return None;
                }
                None => {
                    self.report(
                        Diagnostic::error(
                            code::ARGUMENTS,
                            format!("`{}` takes {} arguments", f.name, names.len()),
                        )
                        .at(span, "too many")
                        .hint(form.to_string()),
                    );
                    return None;
                }
            }
        }
        Some(slots)
    }

    /// Types the arguments of a signature; defaults are filled in. Also used for component models.
    pub(super) fn bind_arguments(
        &mut self,
        s: &Signature,
        f: &Ident,
        given: Vec<Given<'_>>,
        span: Span,
        want: Option<&Type>,
    ) -> Option<(Vec<(Name, GExpr)>, Bindings)> {
        let names: Vec<Name> = s.parameters.iter().map(|p| p.name.clone()).collect();
        let form = format!("it is declared `{}`", s.text);
        let slots = self.arrange(f, &names, given, &form, span)?;
        let mut bindings = Bindings::default();
        // What is wanted of the result tells frames and dimensions to literals; a wrong guess is undone.
        if let Some(w) = want {
            let mut guess = Bindings::default();
            if s.result.matches(w, &mut guess) {
                bindings.frames = guess.frames;
            }
        }
        let mut out = Vec::new();
        for (p, slot) in s.parameters.iter().zip(slots) {
            let value = match slot {
                Some(g) => {
                    let want = p.pattern.instantiate(&bindings).or_else(|| open(&p.pattern, &bindings));
                    let is_tuple =
                        matches!(&g, Given::Written(a) if matches!(&*a.value.kind, ExprKind::Tuple(_)));
                    let mut e = self.value(g, want.as_ref())?;
                    if is_tuple && want.is_none() {
                        e.ty = written_vector(&e, &p.pattern, &bindings).unwrap_or(e.ty);
                    }
                    self.fit_pattern(e, &p.pattern, &mut bindings, f, &p.name, &form)?
                }
                None => match &p.default {
                    Some(v) => {
                        let ty = p.pattern.instantiate(&bindings);
                        let Some(ty) = ty else {
                            self.report(
                                Diagnostic::error(
                                    code::CANNOT_INFER,
                                    format!("`{}` of `{}` must be given", p.name, f.name),
                                )
                                .at(span, "here")
                                .hint(form),
                            );
                            return None;
                        };
                        if let Value::Text(t) = v {
                            self.texts.intern(t);
                        }
                        GExpr::constant(v.clone(), ty, span)
                    }
                    None => {
                        self.report(
                            Diagnostic::error(code::ARGUMENTS, format!("`{}` needs `{}`", f.name, p.name))
                                .at(span, "missing here")
                                .hint(form),
                        );
                        return None;
                    }
                },
            };
            out.push((p.name.clone(), value));
        }
        Some((out, bindings))
    }

    fn fit_pattern(
        &mut self,
        e: GExpr,
        pattern: &Pattern,
        bindings: &mut Bindings,
        f: &Ident,
        name: &Name,
        form: &str,
    ) -> Option<GExpr> {
        if let Pattern::Exact(t) = pattern {
            return self.coerce(e, t);
        }
        if pattern.matches(&e.ty, bindings) {
            if let Some(t) = pattern.instantiate(bindings)
                && t != e.ty
                && !matches!(t, Type::List(..))
            {
                return self.coerce(e, &t);
            }
            return Some(e);
        }
        if let Some(t) = pattern.instantiate(bindings)
            && t != e.ty
        {
            return self.coerce(e, &t);
        }
        let d = match &e.ty {
            Type::Option(_) if !matches!(pattern, Pattern::Option(_) | Pattern::Var(_)) => Diagnostic::error(code::ABSENCE, "this value may be absent")
                .at(e.span, format!("{}, `{name}` of `{}`", e.ty, f.name))
                .hint("give a value for absence with `or`, or take both ways with `match … { some(x) => … none(why) => … }`"),
            t if frames(t).into_iter().any(|t| pattern.matches(&t, &mut bindings.clone())) => {
                Diagnostic::error(code::FRAMES, format!("`{name}` of `{}` is in another frame", f.name))
                    .at(e.span, e.ty.to_string())
                    .hint(format!("change frames with `place`, `from_body` or `to_body`; {form}"))
            }
            _ => Diagnostic::error(code::MISMATCH, format!("`{name}` of `{}` cannot be {}", f.name, e.ty)).at(e.span, e.ty.to_string()).hint(form.to_string()),
        };
        self.report(d);
        None
    }

    /// Arguments of a component model: name and value, defaults filled in, and the result type.
    pub fn model_arguments(
        &mut self,
        s: &Signature,
        model: &Ident,
        args: &[Arg],
        span: Span,
    ) -> Option<ModelArguments> {
        let given = args.iter().map(Given::Written).collect();
        let (args, mut bindings) = self.bind_arguments(s, model, given, span, None)?;
        if let Pattern::List(_, n) = &s.result
            && let Some((_, e)) = args.iter().find(|(name, _)| **name == **n)
        {
            let capacity = match &e.ty {
                Type::List(_, n) => Some(*n),
                _ => match self.fold_constant(e, "the number of items")? {
                    Value::Int(n) if (1..=4096).contains(&n) => Some(n as u32),
                    _ => {
                        self.report(
                            Diagnostic::error(code::RANGE, "a list of that many items")
                                .at(e.span, "1 to 4096 are possible")
                                .hint("choose a number in that range"),
                        );
                        return None;
                    }
                },
            };
            bindings.capacities.extend(capacity.map(|c| (n.clone(), c)));
        }
        let ty = s.result.instantiate(&bindings);
        Some((args, ty))
    }

    /// A typed expression that must not depend on parameters or draws.
    pub fn fold_constant(&mut self, e: &GExpr, what: &str) -> Option<Value> {
        let mut varies = None;
        e.walk(&mut |x| {
            if matches!(x.op, Op::Param(_) | Op::Argument(_) | Op::Builtin(Builtin::Draw)) {
                varies = Some(x.span);
            }
        });
        if let Some(at) = varies {
            self.report(
                Diagnostic::error(code::NOT_CONSTANT, format!("{what} must be a constant"))
                    .at(at, "may differ from run to run")
                    .hint("write the value itself, or use a `let`"),
            );
            return None;
        }
        self.fold(e)
    }

    /// Types one argument for each of a list of parameters; none may be missing.
    pub(super) fn fill(
        &mut self,
        f: &Ident,
        params: &[(Name, Type)],
        slots: Vec<Option<Given<'_>>>,
        form: &str,
        span: Span,
    ) -> Option<Vec<GExpr>> {
        let mut out = Vec::new();
        let mut ok = true;
        for ((name, ty), slot) in params.iter().zip(slots) {
            match slot {
                Some(g) => match self.value(g, Some(ty)).and_then(|e| self.coerce(e, ty)) {
                    Some(e) => out.push(e),
                    None => ok = false,
                },
                None => {
                    self.report(
                        Diagnostic::error(code::ARGUMENTS, format!("`{}` needs `{name}`", f.name))
                            .at(span, "missing here")
                            .hint(form.to_string()),
                    );
                    ok = false;
                }
            }
        }
        ok.then_some(out)
    }

    /// Arguments for named parameters of an agent, action, machine state or function.
    pub fn arguments(
        &mut self,
        f: &Ident,
        params: &[(Name, Type)],
        args: &[Arg],
        span: Span,
    ) -> Option<Vec<GExpr>> {
        let names: Vec<Name> = params.iter().map(|(n, _)| n.clone()).collect();
        let form = if params.is_empty() {
            format!("`{}` takes no arguments", f.name)
        } else {
            format!(
                "its parameters are {}",
                params.iter().map(|(n, t)| format!("`{n}: {t}`")).collect::<Vec<_>>().join(", ")
            )
        };
        let slots = self.arrange(f, &names, args.iter().map(Given::Written).collect(), &form, span)?;
        self.fill(f, params, slots, &form, span)
    }
}

/// A type in every frame there is a name for; nothing for a type without a frame.
fn frames(t: &Type) -> Vec<Type> {
    let named = ["map", "odom", "base_link"].map(|f| soifra_graph::Frame(f.into()));
    let make = |f: soifra_graph::Frame| {
        Some(match t {
            Type::Point(_) => Type::Point(f),
            Type::Vector(_, d) => Type::Vector(f, *d),
            Type::Heading(_) => Type::Heading(f),
            Type::Pose(_) => Type::Pose(f),
            _ => return None,
        })
    };
    named.into_iter().filter_map(make).collect()
}

/// A type to guide a literal when part of the pattern is still open: quantities of an open dimension
/// say nothing, points and vectors of an open frame are taken in map.
fn open(pattern: &Pattern, bindings: &Bindings) -> Option<Type> {
    match pattern {
        Pattern::Point(_) | Pattern::Pose(_) | Pattern::Heading(_) | Pattern::Vector(..) => {
            pattern.instantiate(&any_frame(bindings))
        }
        _ => None,
    }
}

/// What is bound, and frames that are not as map.
fn any_frame(bindings: &Bindings) -> Bindings {
    let mut b = bindings.clone();
    for v in ["F", "G"] {
        b.frames.entry(v.into()).or_insert_with(soifra_graph::Frame::map);
    }
    b
}

/// The type that a tuple, which is of no frame, has as a vector of any dimension.
fn written_vector(e: &GExpr, pattern: &Pattern, bindings: &Bindings) -> Option<Type> {
    let (Pattern::Vector(_, DimPattern::Var(dim)), Op::MakeVector) = (pattern, &e.op) else { return None };
    let mut b = any_frame(bindings);
    b.dims.insert(dim.clone(), typing::number(&e.args.first()?.ty)?);
    pattern.instantiate(&b)
}
