//! Compiles what decides over a run: done condition, time limit, expectations, metrics.

use super::{
    code::*,
    compile::{Compiled, alone, damaged},
    margin,
    uses::Uses,
};
use soifra_graph::{
    Dim, ExpectKind, Expectation, Expr, Graph, Type,
    eval::{Block, Compiler},
};

/// The judge of a mission. What does not compile is an error of its own.
pub(super) fn judge(c: &mut Compiler<'_>, graph: &Graph) -> Compiled<JudgeCode> {
    let done = condition(c, &graph.done)?;
    let within = graph.within.as_ref().map(|e| limit(c, graph, e)).transpose()?;
    let mut expects = Vec::new();
    for e in &graph.expects {
        expects.push(expect(c, graph, e)?);
    }
    let mut metrics = Vec::new();
    for m in &graph.metrics {
        let block = alone(c, &m.value, &[])?;
        if block.width != 1 {
            return damaged(m.at, "a metric must be a number");
        }
        let samples = match &m.samples {
            None => None,
            Some(s) => {
                let upon = alone(c, &s.upon, &[])?;
                if upon.width != 1 {
                    return damaged(s.upon.span, "a number or a Bool is wanted here");
                }
                let when = s.when.as_ref().map(|w| condition(c, w)).transpose()?;
                Some(SamplesCode { keep: s.keep, upon, when })
            }
        };
        metrics.push(MetricCode { name: m.name.clone(), value: block, samples });
    }
    let mut code = JudgeCode { done, within, expects, metrics, frame: 0 };
    code.frame = code.blocks().map(|b| b.frame as usize).max().unwrap_or(0);
    Ok(code)
}

fn condition(c: &mut Compiler<'_>, e: &Expr) -> Compiled<Block> {
    if e.ty != Type::Bool {
        return damaged(e.span, "a condition is wanted here");
    }
    alone(c, e, &[])
}

/// A duration or a number of steps.
fn limit(c: &mut Compiler<'_>, graph: &Graph, e: &Expr) -> Compiled<(Block, bool)> {
    let in_steps = match e.ty {
        Type::Quantity(Dim::TIME) => false,
        Type::Quantity(Dim::STEP) if graph.step.is_some() => true,
        _ => return damaged(e.span, "a duration is wanted here, or steps where there is a step clock"),
    };
    Ok((alone(c, e, &[])?, in_steps))
}

fn expect(c: &mut Compiler<'_>, graph: &Graph, e: &Expectation) -> Compiled<ExpectCode> {
    let mut uses = Uses::default();
    let mut both = |c: &mut Compiler<'_>, e: &Expr| -> Compiled<Condition> {
        uses.expr(e);
        let holds = condition(c, e)?;
        let margin = match margin::of(e) {
            Some(m) => {
                let mut scope = c.scope(&m.local_types(&[]))?;
                Some(c.expr(&mut scope, &m)?)
            }
            None => None,
        };
        Ok(Condition { holds, margin })
    };
    let kind = match &e.kind {
        ExpectKind::Always(a) => ExpectKindCode::Always(both(c, a)?),
        ExpectKind::Never(a) => ExpectKindCode::Never(both(c, a)?),
        ExpectKind::Finally(a) => ExpectKindCode::Finally(both(c, a)?),
        ExpectKind::Until(a, b) => ExpectKindCode::Until(both(c, a)?, both(c, b)?),
        ExpectKind::Eventually(a, t) => {
            let a = both(c, a)?;
            ExpectKindCode::Eventually(a, t.as_ref().map(|t| limit(c, graph, t)).transpose()?)
        }
        ExpectKind::LeadsTo(a, b, t) => {
            let (a, b) = (both(c, a)?, both(c, b)?);
            ExpectKindCode::LeadsTo(a, b, t.as_ref().map(|t| limit(c, graph, t)).transpose()?)
        }
    };
    Ok(ExpectCode { each_robot: e.each_robot, kind, contacts: uses.contacts, truth: uses.truth })
}

impl JudgeCode {
    fn blocks(&self) -> impl Iterator<Item = &Block> {
        let limits = self.within.iter().map(|w| &w.0);
        let expects = self.expects.iter().flat_map(|e| e.kind.blocks());
        let metrics = self.metrics.iter().flat_map(|m| {
            let samples = m.samples.iter().flat_map(|s| std::iter::once(&s.upon).chain(&s.when));
            std::iter::once(&m.value).chain(samples)
        });
        std::iter::once(&self.done).chain(limits).chain(expects).chain(metrics)
    }
}

impl ExpectKindCode {
    fn blocks(&self) -> Vec<&Block> {
        let (conditions, limit) = match self {
            ExpectKindCode::Always(a) | ExpectKindCode::Never(a) | ExpectKindCode::Finally(a) => {
                (vec![a], None)
            }
            ExpectKindCode::Until(a, b) => (vec![a, b], None),
            ExpectKindCode::Eventually(a, t) => (vec![a], t.as_ref()),
            ExpectKindCode::LeadsTo(a, b, t) => (vec![a, b], t.as_ref()),
        };
        let margins = |c: &&'_ Condition| c.margin.is_some();
        let mut out: Vec<&Block> = conditions.iter().map(|c| &c.holds).collect();
        out.extend(conditions.iter().filter(|c| margins(c)).filter_map(|c| c.margin.as_ref()));
        out.extend(limit.map(|t| &t.0));
        out
    }
}
