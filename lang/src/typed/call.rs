//! Calls: built-in functions, functions of the sources, records, services.

use super::{Checker, Place, lists};
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{
    Diagnostic, Expr as GExpr, FUNCTIONS, Function as Builtin, Name, Op, Signature, Span, Type, Value,
    pattern::{Bindings, DimPattern, Pattern},
    typing,
};

/// An argument as the callee sees it: an untyped one, or the receiver of a method call.
enum Given<'e> {
    Typed(GExpr),
    Written(&'e Arg),
}

/// Arguments of a component model by name, and the type that the model delivers.
type ModelArguments = (Vec<(Name, GExpr)>, Option<Type>);

impl Checker<'_> {
    /// `f(args)`.
    pub(super) fn call(&mut self, f: &Ident, args: &[Arg], span: Span, want: Option<&Type>) -> Option<GExpr> {
        if (lists::list_op(&f.name).is_some() || &*f.name == "fold") && args.len() > 1 {
            let on = self.expr(&args[0].value, None)?;
            return self.call_on(on, f, &args[1..], span, want);
        }
        self.dispatch(None, f, args, span, want)
    }

    /// `x.f(args)`.
    pub(super) fn method(
        &mut self,
        on: &Expr,
        f: &Ident,
        args: &[Arg],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let on = self.expr(on, None)?;
        self.call_on(on, f, args, span, want)
    }

    fn call_on(
        &mut self,
        on: GExpr,
        f: &Ident,
        args: &[Arg],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        if let Some(op) = lists::list_op(&f.name) {
            return self.list_call(on, op, f, args, span, want);
        }
        if &*f.name == "fold" {
            return self.fold_call(on, f, args, span, want);
        }
        self.dispatch(Some(on), f, args, span, want)
    }

    fn dispatch(
        &mut self,
        on: Option<GExpr>,
        f: &Ident,
        args: &[Arg],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let given: Vec<Given<'_>> =
            on.into_iter().map(Given::Typed).chain(args.iter().map(Given::Written)).collect();
        match &*f.name {
            "heard" => return self.heard(given, span),
            "achieved" => return self.achieved(given, span),
            "sqrt" | "dot" | "transpose" | "inverse" | "matrix" | "item" => {
                return self.special(f, given, span);
            }
            _ => {}
        }
        if let Some(i) = self.params.position(&f.name)
            && let Some(interface) = self.services.get(&(i as u32)).cloned()
        {
            return self.service(i as u32, &interface, f, given, span);
        }
        if self.decls.functions.contains_key(&f.name) {
            return self.user_function(f, given, span);
        }
        if self.types.records.contains_key(&f.name) {
            return self.record(f, given, span);
        }
        if let Some(b) = Builtin::named(&f.name) {
            return self.builtin(b, f, given, span, want);
        }
        let known: Vec<String> = FUNCTIONS
            .iter()
            .map(|(b, _, _)| b.signature().name.to_string())
            .chain(self.decls.functions.keys().map(|k| k.to_string()))
            .chain(self.types.records.keys().map(|k| k.to_string()))
            .chain(lists::LIST_OPS.iter().map(|s| (*s).to_string()))
            .chain(["heard", "sqrt", "dot", "transpose", "inverse", "matrix", "item"].map(String::from))
            .collect();
        let d = unknown(code::UNKNOWN_NAME, "function", &f.name, f.span, known.iter().map(String::as_str));
        self.report(d);
        None
    }

    fn value(&mut self, g: Given<'_>, want: Option<&Type>) -> Option<GExpr> {
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
    fn arrange<'e>(
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

    fn builtin(
        &mut self,
        b: Builtin,
        f: &Ident,
        given: Vec<Given<'_>>,
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        if b == Builtin::Draw && !matches!(self.body.place, Place::Scene | Place::Behaviour) {
            self.report(
                Diagnostic::error(code::RANDOM, "nothing can be drawn here")
                    .at(span, "would differ from evaluation to evaluation")
                    .hint("draws belong to worlds, robots and behaviours"),
            );
            return None;
        }
        let s = b.signature();
        let (args, bindings) = self.bind_arguments(s, f, given, span, want)?;
        let args = args.into_iter().map(|(_, e)| e).collect();
        let Some(ty) = s.result.instantiate(&bindings) else {
            self.report(
                Diagnostic::error(code::CANNOT_INFER, format!("the result of `{}` cannot be told", f.name))
                    .at(span, "here")
                    .hint(format!("it is declared `{}`", s.text)),
            );
            return None;
        };
        Some(GExpr::new(Op::Builtin(b), args, ty, span))
    }

    /// Types the arguments of a signature; defaults are filled in. Also used for component models.
    fn bind_arguments(
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
                    let want = want.or_else(|| self.written_vector(&p.pattern, &bindings, &g));
                    let e = self.value(g, want.as_ref())?;
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

    /// The type a tuple has as a vector of any dimension: that of its first part.
    fn written_vector(&mut self, pattern: &Pattern, bindings: &Bindings, g: &Given<'_>) -> Option<Type> {
        let (Pattern::Vector(_, DimPattern::Var(dim)), Given::Written(a)) = (pattern, g) else { return None };
        let ExprKind::Tuple(items) = &*a.value.kind else { return None };
        let first = self.expr(items.first()?, None)?;
        let mut b = any_frame(bindings);
        b.dims.insert(dim.clone(), typing::number(&first.ty)?);
        pattern.instantiate(&b)
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

    fn heard(&mut self, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let topic = match given.as_slice() {
            [Given::Written(Arg { name: None, lambda: None, value })] => match &*value.kind {
                ExprKind::Name(n) => Some((n.clone(), value.span)),
                _ => None,
            },
            _ => None,
        };
        let Some((name, at)) = topic else {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "`heard` takes a topic")
                    .at(span, "here")
                    .hint("write `heard(TOPIC)`"),
            );
            return None;
        };
        let Some(i) = self.topics.position(&name) else {
            let names: Vec<String> = self.topics.iter().map(|t| t.channel.name.to_string()).collect();
            let d = unknown(code::UNKNOWN_NAME, "topic", &name, at, names.iter().map(String::as_str));
            self.report(d);
            return None;
        };
        if self.body.place != Place::Behaviour {
            self.report(
                Diagnostic::error(code::BELIEF, "only a behaviour hears messages")
                    .at(span, "nobody listens here")
                    .hint("use it in a service, machine, plan or agent-level `let`"),
            );
            return None;
        }
        let ty = Type::List(Box::new(self.topics[i].ty.clone()), self.topic_capacity[i]);
        Some(GExpr::new(Op::Heard(i as u32), Vec::new(), ty, span))
    }

    fn achieved(&mut self, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let [Given::Written(Arg { name: None, lambda: None, value })] = given.as_slice() else {
            self.report(
                Diagnostic::error(code::ARGUMENTS, "`achieved` takes a goal")
                    .at(span, "here")
                    .hint("write `achieved(GOAL)`"),
            );
            return None;
        };
        let name = match &*value.kind {
            ExprKind::Name(n) => n.clone(),
            _ => "?".into(),
        };
        if self.body.place != Place::Truth {
            self.report(
                Diagnostic::error(code::BELIEF, "only the mission judges goals")
                    .at(span, "an agent knows its own states")
                    .hint("keep what the agent knows in a `state`"),
            );
            return None;
        }
        let Some(i) = self.goals.position(&name) else {
            let names = self.goals.to_vec();
            let d = unknown(code::UNKNOWN_NAME, "goal", &name, value.span, names.iter().map(|n| &**n));
            self.report(d);
            return None;
        };
        Some(GExpr::new(Op::Achieved(i as u32), Vec::new(), Type::Bool, span))
    }

    fn special(&mut self, f: &Ident, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let mut args = Vec::new();
        for g in given {
            args.push(self.value(g, None)?);
        }
        let matrix = |t: &Type| match t {
            Type::Matrix(r, c) => Some((*r, *c)),
            _ => None,
        };
        let (op, ty, form) = match (&*f.name, args.as_slice()) {
            ("sqrt", [x]) => {
                (Op::Sqrt, typing::sqrt(&x.ty), "`sqrt(x)`: the dimension of x must be a square, such as m2")
            }
            ("dot", [a, b]) => (Op::Dot, typing::dot(&a.ty, &b.ty), "`dot(a, b)`: two vectors of one frame"),
            ("transpose", [m]) => {
                (Op::Transpose, matrix(&m.ty).map(|(r, c)| Type::Matrix(c, r)), "`transpose(m)`: a matrix")
            }
            ("inverse", [m]) => (
                Op::Inverse,
                matrix(&m.ty).filter(|(r, c)| r == c).map(|(r, c)| Type::Matrix(r, c).optional()),
                "`inverse(m)`: a square matrix",
            ),
            ("item", [m, r, c]) => {
                let index = |e: &GExpr, n: u8| match e.as_const() {
                    Some(Value::Int(i)) if (0..i64::from(n)).contains(i) => Some(*i as u8),
                    _ => None,
                };
                let at =
                    matrix(&m.ty).and_then(|(rows, columns)| Some((index(r, rows)?, index(c, columns)?)));
                match at {
                    Some((r, c)) => {
                        let m = args.swap_remove(0);
                        return Some(GExpr::new(Op::Item(r, c), vec![m], Type::NUMBER, span));
                    }
                    None => (
                        Op::Transpose,
                        None,
                        "`item(m, row, column)`: a matrix and two constants, counted from 0",
                    ),
                }
            }
            ("matrix", [rows]) if matches!(rows.op, Op::MakeList) => {
                let width = rows.args.first().map_or(0, |r| r.args.len());
                let square = rows.args.iter().all(|r| r.op == Op::MakeList && r.args.len() == width);
                let (r, c) = (rows.args.len(), width);
                if square && (1..=8).contains(&r) && (1..=8).contains(&c) {
                    let mut items = Vec::new();
                    for row in args.swap_remove(0).args {
                        for e in row.args {
                            items.push(self.coerce(e, &Type::NUMBER)?);
                        }
                    }
                    return Some(GExpr::new(Op::MakeMatrix, items, Type::Matrix(r as u8, c as u8), span));
                }
                (Op::Transpose, None, "`matrix([[a, b], [c, d]])`: rows of equal length, at most 8 × 8")
            }
            (name, _) => {
                let form = match name {
                    "sqrt" => "sqrt(x)",
                    "dot" => "dot(a, b)",
                    "item" => "item(m, row, column)",
                    "matrix" => "matrix([[a, b], [c, d]])",
                    other => &format!("{other}(m)"),
                };
                self.report(
                    Diagnostic::error(code::ARGUMENTS, format!("wrong arguments for `{name}`"))
                        .at(span, "in this call")
                        .hint(format!("write `{form}`")),
                );
                return None;
            }
        };
        match ty {
            Some(ty) => Some(GExpr::new(op, args, ty, span)),
            None => {
                let mut d = Diagnostic::error(code::OPERANDS, format!("`{}` does not work on this", f.name));
                for a in &args {
                    d = d.at(a.span, a.ty.to_string());
                }
                self.report(d.hint(format!("write {form}")));
                None
            }
        }
    }

    fn record(&mut self, f: &Ident, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let fields = self.types.records.get(&f.name).map(|r| r.fields.clone()).unwrap_or_default();
        let names: Vec<Name> = fields.iter().map(|(n, _)| n.clone()).collect();
        let form = format!(
            "its fields are {}",
            names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
        );
        let slots = self.arrange(f, &names, given, &form, span)?;
        let args = self.fill(f, &fields, slots, &form, span)?;
        Some(GExpr::new(Op::MakeRecord, args, Type::Record(f.name.clone()), span))
    }

    /// Types one argument for each of a list of parameters; none may be missing.
    fn fill(
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

    fn user_function(&mut self, f: &Ident, given: Vec<Given<'_>>, span: Span) -> Option<GExpr> {
        let index = self.function(&f.name, f.span)?;
        let (params, ty) = {
            let u = &self.functions[index as usize];
            (u.parameters.clone(), u.body.ty.clone())
        };
        let names: Vec<Name> = params.iter().map(|(n, _)| n.clone()).collect();
        let form = format!(
            "its parameters are {}",
            params.iter().map(|(n, t)| format!("`{n}: {t}`")).collect::<Vec<_>>().join(", ")
        );
        let slots = self.arrange(f, &names, given, &form, span)?;
        let args = self.fill(f, &params, slots, &form, span)?;
        Some(GExpr::new(Op::Call(index), args, ty, span))
    }

    /// A call through a parameter that selects a service: every implementation, by the parameter's value.
    fn service(
        &mut self,
        param: u32,
        interface: &Name,
        f: &Ident,
        given: Vec<Given<'_>>,
        span: Span,
    ) -> Option<GExpr> {
        let variants = self.types.enums.get(interface).map(|e| e.variants.clone()).unwrap_or_default();
        let mut indices = Vec::new();
        for v in &variants {
            indices.push(self.function(v, f.span)?);
        }
        let first = *indices.first()?;
        let (params, ty) = {
            let u = &self.functions[first as usize];
            (u.parameters.clone(), u.body.ty.clone())
        };
        let names: Vec<Name> = params.iter().map(|(n, _)| n.clone()).collect();
        let form = format!(
            "the parameters of {interface} are {}",
            params.iter().map(|(n, t)| format!("`{n}: {t}`")).collect::<Vec<_>>().join(", ")
        );
        let slots = self.arrange(f, &names, given, &form, span)?;
        let args = self.fill(f, &params, slots, &form, span)?;
        // Arguments are evaluated once, whatever is selected.
        let locals: Vec<u32> = args.iter().map(|a| self.body.local(&a.ty)).collect();
        let passed: Vec<GExpr> = args
            .iter()
            .zip(&locals)
            .map(|(a, l)| GExpr::new(Op::Local(*l), Vec::new(), a.ty.clone(), a.span))
            .collect();
        let mut bodies =
            vec![GExpr::new(Op::Param(param), Vec::new(), Type::Enum(interface.clone()), f.span)];
        bodies.extend(indices.iter().map(|i| GExpr::new(Op::Call(*i), passed.clone(), ty.clone(), span)));
        let choice = GExpr::new(
            Op::Switch { variants: (0..indices.len() as u32).collect(), rest: false },
            bodies,
            ty.clone(),
            span,
        );
        Some(
            args.into_iter()
                .zip(locals)
                .rev()
                .fold(choice, |body, (a, l)| GExpr::new(Op::Let(l), vec![a, body], ty.clone(), span)),
        )
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
