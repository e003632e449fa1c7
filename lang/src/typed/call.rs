//! Calls: built-in functions, functions of the sources, records, services.

use super::{Checker, Place, arguments::Given, lists};
use crate::{ast::*, code, decls::unknown};
use soifra_graph::{Diagnostic, Expr as GExpr, FUNCTIONS, Function as Builtin, Name, Op, Span, Type};

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
            "offering" => return self.offering(given, span),
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
            .chain(
                ["heard", "offering", "sqrt", "dot", "transpose", "inverse", "matrix", "item"]
                    .map(String::from),
            )
            .collect();
        let d = unknown(code::UNKNOWN_NAME, "function", &f.name, f.span, known.iter().map(String::as_str));
        self.report(d);
        None
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
        if b.is_truth() && self.body.place != Place::Truth {
            self.truth_refused(span);
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
