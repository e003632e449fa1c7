//! `test` blocks: runs of a mission and what is expected of them.

use crate::{
    ast::{Expr, ExprKind, Mission, MissionMember, Test},
    code,
    decls::{Decls, unknown},
    parse_value,
};
use soifra_graph::{Binary, Diagnostic, Dim, Graph, Name, Span, typing};

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

/// The tests of all files. `graph` is that of the mission that was checked, for the types of its members.
pub fn collect(decls: &Decls<'_>, graph: Option<&Graph>, errors: &mut Vec<Diagnostic>) -> Vec<TestCase> {
    decls.tests.iter().filter_map(|t| one(t, decls, graph, errors)).collect()
}

fn one(t: &Test, decls: &Decls<'_>, graph: Option<&Graph>, errors: &mut Vec<Diagnostic>) -> Option<TestCase> {
    let [run] = t.run.as_slice() else {
        let d = Diagnostic::error(code::TEST, "a test runs one mission")
            .at(t.name.span, if t.run.is_empty() { "no `run` here" } else { "more than one `run` here" });
        errors.push(d.hint("write `run MISSION` once"));
        return None;
    };
    let Some((_, mission)) = decls.missions.iter().find(|(_, m)| m.name.name == run.name) else {
        errors.push(unknown(
            code::UNKNOWN_NAME,
            "mission",
            &run.name,
            run.span,
            decls.missions.iter().map(|(_, m)| &*m.name.name),
        ));
        return None;
    };
    let graph = graph.filter(|g| g.name == run.name);
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
                        Diagnostic::error(code::TEST, "seeds are whole numbers, the smaller first")
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
        if !parameters(decls, mission).any(|p| *p == s.name.name) {
            let known: Vec<&str> = parameters(decls, mission).map(|p| &**p).collect();
            errors.push(unknown(code::UNKNOWN_NAME, "parameter", &s.name.name, s.name.span, known));
            return None;
        }
        let text = match &*s.value.kind {
            ExprKind::Neg(x) if matches!(&*x.kind, ExprKind::Quantity(..)) => {
                let (v, dim) = quantity(&s.value)?;
                format!("{v} {}", dim.si_unit()).trim().to_string()
            }
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
        if let Some(p) = graph.and_then(|g| g.params.iter().find(|p| p.name == s.name.name))
            && let Some(Err(why)) = graph.map(|g| parse_value(&text, &p.ty, &g.types))
        {
            errors.push(
                Diagnostic::error(code::MISMATCH, why)
                    .at(s.value.span, "set here")
                    .at(p.at, format!("declared as {}", p.ty))
                    .hint("write a value of the parameter's type, with its unit"),
            );
            return None;
        }
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
            ExprKind::Binary(op, a, b) if compares(*op) => match (&*a.kind, quantity(b)) {
                (ExprKind::Name(n), Some(bound)) => Some((n.clone(), *op, bound, a.span, b.span)),
                _ => None,
            },
            _ => None,
        };
        match parts {
            Some((name, op, (bound, dim), at, bound_at)) => {
                let metrics = || {
                    mission.members.iter().filter_map(|m| match m {
                        MissionMember::Metric(k) => Some(&k.name.name),
                        _ => None,
                    })
                };
                if !metrics().any(|m| *m == name) {
                    errors.push(unknown(code::UNKNOWN_NAME, "metric", &name, at, metrics().map(|m| &**m)));
                    return None;
                }
                let metric = graph.and_then(|g| g.metrics.iter().find(|m| m.name == name));
                let have = metric.and_then(|m| typing::number(&m.value.ty)).filter(|d| *d != dim);
                if let (Some(have), Some(m)) = (have, metric) {
                    errors.push(
                        Diagnostic::error(code::OPERANDS, format!("`{name}` is a {}", m.value.ty))
                            .at(bound_at, dim.to_string())
                            .at(m.at, format!("declared here, in {}", unit_of(have)))
                            .hint(format!("write the bound in {}", unit_of(have))),
                    );
                    return None;
                }
                expects.push((name, op, bound));
            }
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

/// The parameters of a mission: those of all files and its own.
fn parameters<'a>(decls: &'a Decls<'_>, mission: &'a Mission) -> impl Iterator<Item = &'a Name> {
    let own = mission.members.iter().filter_map(|m| match m {
        MissionMember::Param(p) => Some(&p.name.name),
        _ => None,
    });
    decls.params.iter().map(|p| &p.name.name).chain(own)
}

/// A quantity that is written out, with its sign.
fn quantity(e: &Expr) -> Option<(f64, Dim)> {
    match &*e.kind {
        ExprKind::Quantity(v, dim, _) => Some((*v, *dim)),
        ExprKind::Neg(x) => match &*x.kind {
            ExprKind::Quantity(v, dim, _) => Some((-*v, *dim)),
            _ => None,
        },
        _ => None,
    }
}

fn compares(op: Binary) -> bool {
    matches!(op, Binary::Lt | Binary::Le | Binary::Gt | Binary::Ge | Binary::Eq | Binary::Ne)
}

fn unit_of(dim: Dim) -> String {
    if dim == Dim::NONE { "plain numbers".into() } else { dim.si_unit() }
}
