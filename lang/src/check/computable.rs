//! Can every constant of behaviours and conditions be computed? `1 / 0` would fail at the first
//! activation; it can be told before.

use super::{
    constants::{Constants, not_computable},
    walk,
};
use soifra_graph::{Binary, Diagnostic, Expr, Graph, Op};

/// Evaluates the largest parts of expressions that depend on nothing.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut found = Search { known: Constants::new(g), skip: 0, out: Vec::new() };
    let mut visit = |e: &Expr| found.visit(e);
    g.agents.iter().for_each(|a| walk::agent(a, &mut visit));
    g.functions.iter().for_each(|f| f.body.walk(&mut visit));
    let conditions = g.expects.iter().flat_map(|x| walk::conditions(&x.kind));
    let metrics = g.metrics.iter().flat_map(|m| m.exprs());
    std::iter::once(&g.done).chain(conditions).chain(metrics).for_each(|e| e.walk(&mut visit));
    found.out
}

struct Search<'g> {
    known: Constants<'g>,
    /// So many of the next expressions are parts of one that was evaluated.
    skip: usize,
    out: Vec<Diagnostic>,
}

impl Search<'_> {
    /// Looks at an expression; its parts come next, in order.
    fn visit(&mut self, e: &Expr) {
        if self.skip > 0 {
            self.skip -= 1;
            return;
        }
        // What cannot fail need not be evaluated.
        if e.args.is_empty() || !is_written_out(e) || !can_fail(e) {
            return;
        }
        e.walk(&mut |_| self.skip += 1);
        self.skip -= 1;
        if let Err(fault) = self.known.evaluate(e, 0) {
            self.out.push(not_computable(&fault));
        }
    }
}

/// Sums and products of smaller constants stay in the range of whole numbers and of numbers.
const LARGE: f64 = 1e15;

/// Whether its value depends on nothing.
fn is_written_out(e: &Expr) -> bool {
    let pure = matches!(
        e.op,
        Op::Const(_)
            | Op::Binary(_)
            | Op::Builtin(_)
            | Op::Power(_)
            | Op::Sqrt
            | Op::Neg
            | Op::Not
            | Op::Dot
            | Op::MakeVector
            | Op::Part(_)
    );
    pure && e.args.iter().all(is_written_out)
}

/// Whether some operator in it has no value for some operands of a usual size.
fn can_fail(e: &Expr) -> bool {
    let here = match &e.op {
        Op::Binary(Binary::Div) | Op::Builtin(_) | Op::Power(_) | Op::Sqrt => true,
        Op::Const(v) => v.number().is_some_and(|x| x.abs() >= LARGE),
        _ => false,
    };
    here || e.args.iter().any(can_fail)
}
