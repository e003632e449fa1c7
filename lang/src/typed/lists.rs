//! Operations on lists with a lambda.

use super::Checker;
use crate::{ast::*, code};
use soifra_graph::{Diagnostic, Expr as GExpr, ListOp, Op, Span, Type, typing};

/// The list operation called `name`.
pub(super) fn list_op(name: &str) -> Option<ListOp> {
    Some(match name {
        "map" => ListOp::Map,
        "filter" => ListOp::Filter,
        "any" => ListOp::Any,
        "all" => ListOp::All,
        "count" => ListOp::Count,
        "find" => ListOp::Find,
        "min_by" => ListOp::MinBy,
        "max_by" => ListOp::MaxBy,
        _ => return None,
    })
}

/// Names of operations that take a lambda.
pub const LIST_OPS: &[&str] = &["map", "filter", "any", "all", "count", "find", "min_by", "max_by", "fold"];

impl Checker<'_> {
    /// `list.op(x => body)`.
    pub(super) fn list_call(
        &mut self,
        list: GExpr,
        op: ListOp,
        name: &Ident,
        args: &[Arg],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let Type::List(inner, n) = list.ty.clone() else {
            return self.no_list(&list, &name.name);
        };
        let [Arg { lambda: Some(params), value: body, .. }] = args else {
            return self.lambda_wanted(name, "x => …", span);
        };
        let [param] = params.as_slice() else {
            return self.lambda_wanted(name, "x => …", span);
        };
        let mark = self.body.scope.len();
        let local = self.body.bind(param, &inner);
        let inner_want = match (op, want) {
            (ListOp::Map, Some(Type::List(t, _))) => Some((**t).clone()),
            (ListOp::Filter | ListOp::Any | ListOp::All | ListOp::Count | ListOp::Find, _) => {
                Some(Type::Bool)
            }
            _ => None,
        };
        let value = match (&inner_want, op) {
            (Some(Type::Bool), o) if o != ListOp::Map => self.typed(body, &Type::Bool),
            (w, _) => self.expr(body, w.as_ref()),
        };
        self.body.scope.truncate(mark);
        let value = value?;
        if matches!(op, ListOp::MinBy | ListOp::MaxBy) && typing::number(&value.ty).is_none() {
            self.report(
                Diagnostic::error(
                    code::MISMATCH,
                    format!("items are compared by a quantity, this is {}", value.ty),
                )
                .at(value.span, value.ty.to_string())
                .hint("give a length, duration or number for each item"),
            );
            return None;
        }
        let ty = match op {
            ListOp::Map => Type::List(Box::new(value.ty.clone()), n),
            ListOp::Filter => list.ty.clone(),
            ListOp::Any | ListOp::All => Type::Bool,
            ListOp::Count => Type::Int,
            ListOp::Find | ListOp::MinBy | ListOp::MaxBy => Type::Option(inner),
        };
        Some(GExpr::new(Op::List(op, local), vec![list, value], ty, span))
    }

    /// `list.fold(initial, (sum, x) => body)`.
    pub(super) fn fold_call(
        &mut self,
        list: GExpr,
        name: &Ident,
        args: &[Arg],
        span: Span,
        want: Option<&Type>,
    ) -> Option<GExpr> {
        let Type::List(inner, _) = list.ty.clone() else {
            return self.no_list(&list, &name.name);
        };
        let [first, Arg { lambda: Some(params), value: body, .. }] = args else {
            return self.lambda_wanted(name, "start, (sum, x) => …", span);
        };
        let [acc, item] = params.as_slice() else {
            return self.lambda_wanted(name, "start, (sum, x) => …", span);
        };
        let mut start = self.expr(&first.value, want)?;
        // A whole number to start from may become a number on the way.
        if start.ty == Type::Int && want.is_none_or(|w| *w != Type::Int) {
            start = self.coerce(start, &Type::NUMBER)?;
        }
        let mark = self.body.scope.len();
        let acc_local = self.body.bind(acc, &start.ty);
        let item_local = self.body.bind(item, &inner);
        let ty = start.ty.clone();
        let body = self.typed(body, &ty);
        self.body.scope.truncate(mark);
        Some(GExpr::new(Op::Fold(acc_local, item_local), vec![list, start, body?], ty, span))
    }

    fn no_list<T>(&mut self, list: &GExpr, op: &str) -> Option<T> {
        let d = match &list.ty {
            Type::Option(inner) if matches!(**inner, Type::List(..)) => {
                Diagnostic::error(code::ABSENCE, format!("`{op}` on a list that may be absent"))
                    .at(list.span, list.ty.to_string())
                    .hint("give a list for absence with `or`, or take both ways with `match … { some(x) => … none(why) => … }`")
            }
            _ => Diagnostic::error(code::MISMATCH, format!("`{op}` works on lists, this is {}", list.ty))
                .at(list.span, list.ty.to_string())
                .hint("write it on a list, such as a reading of several beams or `heard(topic)`"),
        };
        self.report(d);
        None
    }

    fn lambda_wanted<T>(&mut self, name: &Ident, form: &str, span: Span) -> Option<T> {
        self.report(
            Diagnostic::error(
                code::ARGUMENTS,
                format!("`{}` must be told what to do with an item", name.name),
            )
            .at(span, "no such argument")
            .hint(format!("write `list.{}({form})`", name.name)),
        );
        None
    }
}
