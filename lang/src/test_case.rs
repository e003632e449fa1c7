//! `test` blocks: runs of a mission and what is expected of them.

use crate::{
    ast::{ExprKind, Test},
    code,
    decls::{Decls, unknown},
};
use soifra_graph::{Binary, Diagnostic, Name, Span};

/// A test: every seed must give the outcome, and every comparison of a metric must hold.
#[derive(Debug, Clone, PartialEq)]
pub struct TestCase {
    /// Its name.
    pub name: Name,
    /// The mission it runs.
    pub mission: Name,
    /// First and last seed.
    pub seeds: (u64, u64),
    /// Parameters, as `--set` takes them.
    pub sets: Vec<(Name, String)>,
    /// Outcome every run must have (`success` unless said otherwise).
    pub outcome: Name,
    /// Metric, comparison, bound in SI units; for every run.
    pub expects: Vec<(Name, Binary, f64)>,
    /// Where it is.
    pub at: Span,
}

const OUTCOMES: &[&str] = &["success", "failed", "timeout", "aborted"];

/// The tests of all files.
pub fn collect(decls: &Decls<'_>, errors: &mut Vec<Diagnostic>) -> Vec<TestCase> {
    decls.tests.iter().filter_map(|t| one(t, decls, errors)).collect()
}

fn one(t: &Test, decls: &Decls<'_>, errors: &mut Vec<Diagnostic>) -> Option<TestCase> {
    let [run] = t.run.as_slice() else {
        let d = Diagnostic::error(code::TEST, "a test runs one mission")
            .at(t.name.span, format!("{} `run` here", t.run.len()));
        errors.push(d.hint("write `run MISSION` once"));
        return None;
    };
    if !decls.missions.iter().any(|(_, m)| m.name.name == run.name) {
        errors.push(unknown(
            code::UNKNOWN_NAME,
            "mission",
            &run.name,
            run.span,
            decls.missions.iter().map(|(_, m)| &*m.name.name),
        ));
        return None;
    }
    let seeds = match &t.seeds {
        None => (1, 1),
        Some(e) => {
            let int = |e: &crate::ast::Expr| match &*e.kind {
                ExprKind::Quantity(_, _, Some(i)) => u64::try_from(*i).ok(),
                _ => None,
            };
            let range = match &*e.kind {
                ExprKind::Range(a, b) => int(a).zip(int(b)),
                _ => int(e).map(|i| (i, i)),
            };
            match range.filter(|(a, b)| a <= b) {
                Some(r) => r,
                None => {
                    errors.push(
                        Diagnostic::error(code::TEST, "seeds are whole numbers")
                            .at(e.span, "not a range of them")
                            .hint("write `seeds 1 .. 20` or `seeds 7`"),
                    );
                    return None;
                }
            }
        }
    };
    let mut sets = Vec::new();
    for s in &t.sets {
        let text = match &*s.value.kind {
            ExprKind::Name(n) => n.to_string(),
            ExprKind::Bool(b) => b.to_string(),
            ExprKind::Quantity(v, dim, _) => format!("{v} {}", dim.si_unit()).trim().to_string(),
            ExprKind::Text(t) => format!("\"{t}\""),
            _ => {
                errors.push(
                    Diagnostic::error(code::TEST, "a test sets a parameter to a value written out")
                        .at(s.value.span, "not one")
                        .hint("write a quantity, a variant, true or false"),
                );
                return None;
            }
        };
        sets.push((s.name.name.clone(), text));
    }
    let outcome = match &t.outcome {
        None => "success".into(),
        Some(o) if OUTCOMES.contains(&&*o.name) => o.name.clone(),
        Some(o) => {
            errors.push(unknown(code::TEST, "outcome", &o.name, o.span, OUTCOMES.iter().copied()));
            return None;
        }
    };
    let mut expects = Vec::new();
    for e in &t.expects {
        let parts = match &*e.kind {
            ExprKind::Binary(op, a, b) => match (&*a.kind, &*b.kind) {
                (ExprKind::Name(n), ExprKind::Quantity(v, _, _)) => Some((n.clone(), *op, *v)),
                _ => None,
            },
            _ => None,
        };
        match parts {
            Some(p) => expects.push(p),
            None => {
                errors.push(
                    Diagnostic::error(code::TEST, "a test compares a metric with a value")
                        .at(e.span, "not such a comparison")
                        .hint("write `expect METRIC <= VALUE`; the mission declares the metric"),
                );
                return None;
            }
        }
    }
    Some(TestCase {
        name: t.name.name.clone(),
        mission: run.name.clone(),
        seeds,
        sets,
        outcome,
        expects,
        at: t.name.span,
    })
}
