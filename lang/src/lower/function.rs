//! Functions of the sources, and the interfaces they implement.

use crate::{
    ast::Function,
    code,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Diagnostic, Expr, Name, Op, Span, Type, UserFunction};

impl Checker<'_> {
    /// Index of the function `name`, lowered when first asked for. `None` when it is broken (reported).
    pub fn function(&mut self, name: &Name, at: Span) -> Option<u32> {
        match self.function_index.get(name) {
            Some(Some(i)) => return Some(*i),
            Some(None) if self.broken.contains(name) => return None,
            Some(None) => {
                self.report(
                    Diagnostic::error(code::RECURSION, format!("`{name}` calls itself"))
                        .at(at, "directly or through others")
                        .hint(
                            "a tick must end: use a list operation, or a state that goes on at the next tick",
                        ),
                );
                return None;
            }
            None => {}
        }
        let f = self.decls.functions.get(name).copied()?;
        self.function_index.insert(name.clone(), None);
        let depth = std::mem::take(&mut self.depth);
        let expanding = std::mem::take(&mut self.expanding);
        let lowered = self.lower_function(f);
        self.expanding = expanding;
        self.depth = depth;
        match lowered {
            Some(u) => {
                let i = self.functions.len() as u32;
                self.functions.push(u);
                self.function_index.insert(name.clone(), Some(i));
                Some(i)
            }
            None => {
                self.broken.insert(name.clone());
                None
            }
        }
    }

    fn lower_function(&mut self, f: &Function) -> Option<UserFunction> {
        self.distinct(f.params.iter().map(|(n, _)| n));
        let mut parameters = Vec::new();
        for (n, t) in &f.params {
            parameters.push((n.name.clone(), self.resolve_type(t, None)?));
        }
        let result = match &f.result {
            Some(t) => Some(self.resolve_type(t, None)?),
            None => None,
        };
        let mut body = Body::new(Place::Function);
        for ((n, _), (_, ty)) in f.params.iter().zip(&parameters) {
            body.bind(n, ty);
        }
        let (value, body) = self.in_body(body, |c| {
            let mut lets = Vec::new();
            for l in &f.lets {
                let v = c.expr(&l.value, None)?;
                let ty = v.ty.clone();
                lets.push((c.body.bind(&l.name, &ty), v));
            }
            let value = match &result {
                Some(t) => c.typed(&f.body, t)?,
                None => c.expr(&f.body, None)?,
            };
            Some(lets.into_iter().rev().fold(value, |body, (local, v)| {
                let (ty, span) = (body.ty.clone(), body.span);
                Expr::new(Op::Let(local), vec![v, body], ty, span)
            }))
        });
        let body_expr = value?;
        Some(UserFunction {
            name: f.name.name.clone(),
            parameters,
            locals: body.locals,
            body: body_expr,
            span: f.name.span,
        })
    }

    /// Registers each interface as an enum of the functions that implement it, and checks each of them.
    pub fn interfaces(&mut self) {
        for (name, interface) in &self.decls.interfaces {
            let implementations: Vec<&Function> = self
                .decls
                .function_order
                .iter()
                .filter_map(|f| self.decls.functions.get(f).copied())
                .filter(|f| f.implements.as_ref().is_some_and(|i| i.name == *name))
                .collect();
            let variants: Vec<Name> = implementations.iter().map(|f| f.name.name.clone()).collect();
            self.add_enum(name, variants);
            let wanted: Option<Vec<Type>> =
                interface.params.iter().map(|(_, t)| self.resolve_type(t, None)).collect();
            let (Some(wanted), Some(result)) = (wanted, self.resolve_type(&interface.result, None)) else {
                continue;
            };
            for f in implementations {
                let Some(i) = self.function(&f.name.name, f.name.span) else { continue };
                let u = &self.functions[i as usize];
                let have: Vec<Type> = u.parameters.iter().map(|(_, t)| t.clone()).collect();
                let same_names =
                    u.parameters.iter().map(|(n, _)| n).eq(interface.params.iter().map(|(n, _)| &n.name));
                if have != wanted || u.body.ty != result || !same_names {
                    let form = |names: Vec<&Name>, types: &[Type], r: &Type| {
                        let list: Vec<String> =
                            names.iter().zip(types).map(|(n, t)| format!("{n}: {t}")).collect();
                        format!("({}) -> {r}", list.join(", "))
                    };
                    let is = form(u.parameters.iter().map(|(n, _)| n).collect(), &have, &u.body.ty);
                    let wants =
                        form(interface.params.iter().map(|(n, _)| &n.name).collect(), &wanted, &result);
                    self.report(
                        Diagnostic::error(
                            code::MISMATCH,
                            format!("`{}` does not have the form of {name}", f.name.name),
                        )
                        .at(f.name.span, is)
                        .at(interface.name.span, wants.clone())
                        .hint(format!("declare it `fn {}{wants}`", f.name.name)),
                    );
                }
            }
        }
        for f in self.decls.functions.values() {
            if let Some(i) = &f.implements
                && !self.decls.interfaces.contains_key(&i.name)
            {
                let d = crate::decls::unknown(
                    code::UNKNOWN_NAME,
                    "interface",
                    &i.name,
                    i.span,
                    self.decls.interfaces.keys().map(|k| &**k),
                );
                self.report(d);
            }
        }
    }
}
