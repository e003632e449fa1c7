//! Types of the locals that an expression binds by itself, where the graph lists none.

use soifra_graph::{Expr, Op, Type};

/// More locals than this are not looked for; an expression that uses them is refused when compiled.
const MOST: u32 = 1 << 16;

/// The types of all locals of `e`, numbered from 0; `known` are given from outside.
pub(crate) fn of(e: &Expr, known: &[Type]) -> Vec<Type> {
    let mut types = known.to_vec();
    let mut bind = |local: u32, ty: &Type| {
        if local < MOST && local as usize >= known.len() {
            let l = local as usize;
            if types.len() <= l {
                types.resize(l + 1, Type::Bool);
            }
            types[l] = ty.clone();
        }
    };
    let item = |list: Option<&Expr>| match list.map(|e| &e.ty) {
        Some(Type::List(t, _)) => Some((**t).clone()),
        _ => None,
    };
    e.walk(&mut |e| match &e.op {
        Op::Let(l) => {
            if let Some(value) = e.args.first() {
                bind(*l, &value.ty);
            }
        }
        Op::IfSome { local, reason } => {
            if let Some(Type::Option(t)) = e.args.first().map(|a| &a.ty) {
                bind(*local, t);
            }
            if let Some(r) = reason {
                bind(*r, &Type::Text);
            }
        }
        Op::List(_, l) => {
            if let Some(t) = item(e.args.first()) {
                bind(*l, &t);
            }
        }
        Op::Fold(accumulator, l) => {
            if let Some(t) = item(e.args.first()) {
                bind(*l, &t);
            }
            bind(*accumulator, &e.ty);
        }
        _ => {}
    });
    types
}
