//! Is an item put into a list that has no room for it?

use super::walk;
use crate::code;
use soifra_graph::{Diagnostic, Expr, Function, Graph, ListOp, Op, StmtKind, Type};
use std::collections::BTreeMap;

/// Checks every `push`. A list that a behaviour fills little by little is meant to lose its oldest item; one
/// that is written out in full and pushed to is not.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    for f in &g.functions {
        f.body.walk(&mut |e| report(e, &BTreeMap::new(), &mut out));
    }
    for u in g.agents.iter().flat_map(|a| &a.units) {
        let lets: BTreeMap<u32, &Expr> = walk::statements(u)
            .into_iter()
            .filter_map(|s| if let StmtKind::Let(local, e) = &s.kind { Some((*local, e)) } else { None })
            .collect();
        walk::unit(u, &mut |e| report(e, &lets, &mut out));
    }
    out
}

fn report<'g>(e: &'g Expr, lets: &BTreeMap<u32, &'g Expr>, out: &mut Vec<Diagnostic>) {
    let (Op::Builtin(Function::Push), [list, _]) = (&e.op, e.args.as_slice()) else { return };
    if let (true, Type::List(_, n)) = (is_full(list, lets), &list.ty) {
        out.push(
            Diagnostic::warning(code::FULL_LIST, "this list is full: its first item is lost")
                .at(list.span, format!("always holds {n}, and has room for {n}"))
                .hint("write the item among the others, between the brackets"),
        );
    }
}

/// Whether a list holds as many items as it can, whatever happens. Looked at through this many steps: a graph
/// file may hold a ring of `let`s.
fn is_full<'g>(mut e: &'g Expr, lets: &BTreeMap<u32, &'g Expr>) -> bool {
    for _ in 0..64 {
        e = match (&e.op, e.args.first(), &e.ty) {
            (Op::MakeList, _, Type::List(_, n)) => return e.args.len() == *n as usize,
            (Op::List(ListOp::Map, _) | Op::Builtin(Function::Push), Some(list), _) => list,
            (Op::Local(l), ..) if lets.contains_key(l) => lets[l],
            _ => return false,
        };
    }
    false
}
