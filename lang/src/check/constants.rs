//! Values that are known before a run, for checks that need them.

use crate::code;
use soifra_graph::{
    Diagnostic, Expr, Graph, Texts, Type, Value,
    eval::{self, Fault, FaultKind, Parameters},
};

/// The error for a constant that has no value.
pub fn not_computable(fault: &Fault) -> Diagnostic {
    Diagnostic::error(code::NOT_FINITE, format!("this constant cannot be computed: {fault}"))
        .at(fault.at, "here")
        .hint("change the operands so that the result is a finite number")
}

/// Evaluates expressions with parameters at their defaults.
pub struct Constants<'a> {
    g: &'a Graph,
    params: Parameters,
    texts: Texts,
}

impl<'a> Constants<'a> {
    /// For the expressions of a graph.
    pub fn new(g: &'a Graph) -> Self {
        let mut texts = g.texts.clone();
        let params = g.params.iter().map(|p| (&p.ty, &p.default));
        // Types have been checked before: there are values for all, or none is looked at.
        let params = Parameters::new(&g.types, &mut texts, params).unwrap_or_default();
        Constants { g, params, texts }
    }

    /// The value of a scene expression for the `index`-th of an array; `None` when it is drawn.
    pub fn value(&mut self, e: &Expr, index: i64) -> Option<Value> {
        self.evaluate(e, index).ok()?
    }

    /// The same, with the fault of an evaluation that can have no value.
    ///
    /// # Errors
    /// A division by zero and the like.
    pub fn evaluate(&mut self, e: &Expr, index: i64) -> Result<Option<Value>, Fault> {
        if let Some(v) = e.as_const() {
            return Ok(Some(v.clone()));
        }
        let types = e.local_types(&[Type::Int]);
        let mut locals: Vec<(Type, Option<Value>)> = types.into_iter().map(|t| (t, None)).collect();
        if let Some(first) = locals.first_mut() {
            first.1 = Some(Value::Int(index));
        }
        let (g, params) = (self.g, &self.params);
        let known = eval::Known { types: &g.types, functions: &g.functions, params, locals: &locals };
        match eval::constant(e, &known, &mut self.texts) {
            Ok(v) => Ok(Some(v)),
            Err(f) if matches!(f.kind, FaultKind::Unavailable(_) | FaultKind::Refused(_)) => Ok(None),
            Err(f) => Err(f),
        }
    }

    /// The number that it is.
    pub fn number(&mut self, e: &Expr, index: i64) -> Option<f64> {
        self.value(e, index)?.number()
    }

    /// How many a declaration stands for; `None` when that is not known.
    pub fn count(&mut self, count: Option<&Expr>) -> Option<usize> {
        match count {
            None => Some(1),
            Some(e) => match self.value(e, 0)? {
                Value::Int(n) => usize::try_from(n).ok(),
                _ => None,
            },
        }
    }
}
