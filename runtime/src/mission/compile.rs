//! Compiles agents: their units, arbiters and sub-goals.

use super::{code::*, uses::Uses};
use crate::nodes::{Act, Kind, MAX_DEPTH, Part, Tree};
use soifra_graph::{
    Agent, Arbiter, Expr, Graph, OPAQUE, Op, PlanKind, PlanNode, Refine, Span, Stmt, StmtKind, Strategy,
    Talk, Timing, Trigger, Type, TypeTable, Unit, UnitKind,
    eval::{Block, CompileError, Compiler, Layout, Scope},
};

pub(super) type Compiled<T> = Result<T, CompileError>;

/// An error of the graph that is none of a single expression.
pub(super) fn damaged<T>(at: Span, text: impl Into<String>) -> Compiled<T> {
    Err(CompileError { text: text.into(), at })
}

/// An expression in a scope of its own.
pub(super) fn alone(c: &mut Compiler<'_>, e: &Expr, known: &[Type]) -> Compiled<Block> {
    let mut scope = scope_of(c, e, known)?;
    c.expr(&mut scope, e)
}

/// A scope for one expression; what is known from outside lies at its beginning.
fn scope_of(c: &mut Compiler<'_>, e: &Expr, known: &[Type]) -> Compiled<Scope> {
    let scope = c.scope(&e.local_types(known))?;
    match (known.is_empty(), scope.local(0)) {
        (true, _) | (false, Some(0)) => Ok(scope),
        _ => damaged(e.span, "the index of an array has no place"),
    }
}

/// As [`alone`], for a value of a given type.
pub(super) fn alone_as(c: &mut Compiler<'_>, e: &Expr, known: &[Type], ty: &Type) -> Compiled<Block> {
    let mut scope = scope_of(c, e, known)?;
    c.expr_as(&mut scope, e, ty)
}

/// An optional number in a scope of its own.
pub(super) fn perhaps(c: &mut Compiler<'_>, e: Option<&Expr>) -> Compiled<Option<Block>> {
    e.map(|e| number(c, e)).transpose()
}

fn number(c: &mut Compiler<'_>, e: &Expr) -> Compiled<Block> {
    let block = alone(c, e, &[])?;
    if block.width == 1 { Ok(block) } else { damaged(e.span, "a number is wanted here") }
}

fn condition(c: &mut Compiler<'_>, scope: &mut Scope, e: &Expr) -> Compiled<Block> {
    match e.ty {
        Type::Bool => c.expr(scope, e),
        _ => damaged(e.span, "a condition is wanted here"),
    }
}

fn some_stmts(c: &mut Compiler<'_>, scope: &mut Scope, stmts: &[Stmt]) -> Compiled<Option<Block>> {
    if stmts.is_empty() { Ok(None) } else { c.stmts(scope, stmts).map(Some) }
}

/// Agent type `index`. What does not compile goes into `errors`.
pub(super) fn agent(
    c: &mut Compiler<'_>,
    graph: &Graph,
    index: u32,
    errors: &mut Vec<CompileError>,
) -> Option<AgentCode> {
    let agent = graph.agents.get(index as usize)?;
    let before = errors.len();
    if let Err(e) = c.agent(Some(index)) {
        errors.push(e);
        return None;
    }
    let mut code = AgentCode {
        states: Layout::states(&graph.types, agent),
        opaque: opaque(graph, agent),
        initial: Vec::new(),
        units: Vec::new(),
        offers: Vec::new(),
        restart: None,
        arbiters: Vec::new(),
        subgoals: Vec::new(),
        nodes: 0,
        frame: 0,
    };
    let mut keep = |e| errors.push(e);
    for s in &agent.states {
        match alone_as(c, &s.initial, &[], &s.ty) {
            Ok(b) => code.initial.push(b),
            Err(e) => keep(e),
        }
    }
    for (g, goal) in graph.goals.iter().enumerate() {
        for s in goal.subgoals.iter().filter(|s| s.agent == Some(index)) {
            let register = |e: &Expr| match e.op {
                Op::State(i) => code.states.range(i as usize).map(|r| r.start),
                _ => None,
            };
            let belief = |e: &Expr| match register(e) {
                Some(at) => Ok(BeliefCode::State(at)),
                None => number(c, e).map(BeliefCode::Condition),
            };
            let achieved = match s.achieved.as_ref().map(belief).transpose() {
                Ok(a) => a,
                Err(e) => {
                    keep(e);
                    None
                }
            };
            if let Some(BeliefCode::Condition(b)) = &achieved {
                code.frame = code.frame.max(b.frame as usize);
            }
            let is_plan =
                |u: &Unit| matches!(&u.kind, UnitKind::Plan { subgoal: Some(n), .. } if *n == s.name);
            let plan = agent.units.iter().position(is_plan).map(|u| u as u32);
            code.subgoals.push(SubgoalCode { goal: g as u32, name: s.name.clone(), achieved, plan });
        }
    }
    for o in &agent.offers {
        match o.when.as_ref().map(|e| alone_as(c, e, &[], &Type::Bool)).transpose() {
            Ok(when) => code.offers.push(OfferCode { when }),
            Err(e) => keep(e),
        }
    }
    if let Some(r) = &agent.restart {
        match alone(c, &r.within, &[]) {
            Ok(within) => code.restart = Some((r.times, within)),
            Err(e) => keep(e),
        }
    }
    for (u, unit_) in agent.units.iter().enumerate() {
        let subgoal = code.subgoals.iter().position(|s| s.plan == Some(u as u32)).map(|i| i as u32);
        match unit(c, graph, agent, unit_, &mut code.nodes, subgoal) {
            Ok((u, frame)) => {
                code.frame = code.frame.max(frame);
                code.units.push(u);
            }
            Err(e) => keep(e),
        }
    }
    for a in &agent.arbiters {
        match arbiter(c, graph, agent, a) {
            Ok((a, frame)) => {
                code.frame = code.frame.max(frame);
                code.arbiters.push(a);
            }
            Err(e) => keep(e),
        }
    }
    let _ = c.agent(None);
    (errors.len() == before).then_some(code)
}

fn unit(
    c: &mut Compiler<'_>,
    graph: &Graph,
    agent: &Agent,
    unit: &Unit,
    nodes_at: &mut usize,
    subgoal: Option<u32>,
) -> Compiled<(UnitCode, usize)> {
    let mut scope = c.scope(&unit.locals)?;
    let uses = Uses::of_unit(unit);
    let mut requires = Vec::new();
    for &p in &uses.readings {
        match agent.sensors.get(p as usize) {
            Some(port) if !port.optional => requires.push(p),
            Some(_) => {}
            None => return damaged(unit.span, "it reads a sensor port that the agent does not have"),
        }
    }
    let (trigger, letter) = trigger(c, graph, agent, unit, &scope)?;
    let envelope = match &unit.trigger {
        Trigger::Talk { sender, thread, .. } => match (scope.local(*sender), scope.local(*thread)) {
            (Some(a), Some(b)) => Some([a as usize, b as usize]),
            _ => return damaged(unit.span, "there is no place for who is talking"),
        },
        _ => None,
    };
    let timing = timing(c, &unit.timing)?;
    let kind = match &unit.kind {
        UnitKind::Service(body) if body.iter().any(|s| matches!(s.kind, StmtKind::Refine(_))) => {
            KindCode::Anytime(anytime(c, &mut scope, unit, body)?)
        }
        UnitKind::Service(body) => {
            let all: Vec<Stmt> = unit.prelude.iter().chain(body).cloned().collect();
            KindCode::Service(some_stmts(c, &mut scope, &all)?)
        }
        UnitKind::Machine(states) => {
            let prelude = some_stmts(c, &mut scope, &unit.prelude)?;
            if states.is_empty() {
                return damaged(unit.span, "a machine needs a state");
            }
            let mut out = Vec::new();
            for s in states {
                let mut transitions = Vec::new();
                for t in &s.transitions {
                    let Some(target) = states.get(t.target as usize) else {
                        return damaged(t.at, "a transition leads to a state that does not exist");
                    };
                    if t.arguments.len() != target.data.len() {
                        return damaged(t.at, "a transition gives its target the wrong number of values");
                    }
                    let guard = c.guard(&mut scope, &t.guard)?;
                    let mut arguments = Vec::new();
                    for (e, &slot) in t.arguments.iter().zip(&target.data) {
                        let Some(state) = agent.states.get(slot as usize) else {
                            return damaged(t.at, "a state carries data in a slot that does not exist");
                        };
                        arguments.push((c.expr_as(&mut scope, e, &state.ty)?, slot));
                    }
                    let body = some_stmts(c, &mut scope, &t.body)?;
                    transitions.push(TransitionCode { guard, target: t.target, arguments, body });
                }
                out.push(StateCode {
                    entry: some_stmts(c, &mut scope, &s.entry)?,
                    body: some_stmts(c, &mut scope, &s.body)?,
                    exit: some_stmts(c, &mut scope, &s.exit)?,
                    transitions,
                });
            }
            KindCode::Machine { prelude, states: out }
        }
        UnitKind::Plan { nodes, .. } => {
            let prelude = some_stmts(c, &mut scope, &unit.prelude)?;
            let mut plan = plan(c, &mut scope, nodes, unit.span)?;
            plan.prelude = prelude;
            plan.subgoal = subgoal;
            plan.nodes_at = *nodes_at;
            *nodes_at += nodes.len();
            KindCode::Plan(plan)
        }
    };
    let locals = unit.locals.iter().map(|t| graph.types.width(t)).sum();
    let code = UnitCode {
        trigger,
        timing,
        locals,
        letter,
        envelope,
        reads: uses.readings,
        requires,
        hears: uses.heard,
        kind,
        span: unit.span,
    };
    Ok((code, scope.frame().max(locals)))
}

type Letter = Option<(usize, usize)>;

fn trigger(
    c: &mut Compiler<'_>,
    graph: &Graph,
    agent: &Agent,
    unit: &Unit,
    scope: &Scope,
) -> Compiled<(TriggerCode, Letter)> {
    let letter = |local: u32, ty: &Type| match (scope.local(local), unit.locals.get(local as usize)) {
        (Some(register), Some(t)) if t == ty => Ok(Some((register as usize, graph.types.width(ty)))),
        _ => damaged(unit.span, "the local for the message has another type"),
    };
    Ok(match &unit.trigger {
        Trigger::Every { period, offset } => {
            let (period, offset) = (number(c, period)?, perhaps(c, offset.as_ref())?);
            (TriggerCode::Every { period, offset }, None)
        }
        Trigger::Step { offset } => {
            if graph.step.is_none() {
                return damaged(unit.span, "there is no step clock");
            }
            (TriggerCode::Step { offset: perhaps(c, offset.as_ref())? }, None)
        }
        Trigger::Message { topic, local } => {
            let Some(t) = graph.topics.get(*topic as usize) else {
                return damaged(unit.span, "a topic does not exist");
            };
            (TriggerCode::Message { topic: *topic }, letter(*local, &t.ty)?)
        }
        Trigger::Told { performative, content, from, local } => {
            let (performative, from) = (performative.clone(), from.clone());
            let letter = letter(*local, &Type::Record(content.clone()))?;
            (TriggerCode::Told { performative, content: content.clone(), from }, letter)
        }
        Trigger::Talk { conversation, what, .. } => {
            let Some(of) = graph.conversations.get(*conversation as usize) else {
                return damaged(unit.span, "a conversation does not exist");
            };
            let conversation = *conversation;
            match what {
                Talk::Timeout => (TriggerCode::Talk { conversation, what: TalkCode::Timeout }, None),
                Talk::Settled => (TriggerCode::Talk { conversation, what: TalkCode::Settled }, None),
                Talk::Message { performative, content } => {
                    let mut moves = of.states.iter().flat_map(|s| &s.moves);
                    let carried =
                        moves.find(|m| m.performative == *performative).and_then(|m| m.content.clone());
                    let letter = match (content, carried) {
                        (Some(local), Some(record)) => letter(*local, &Type::Record(record))?,
                        (None, _) => None,
                        _ => return damaged(unit.span, "a message that carries nothing is named"),
                    };
                    (
                        TriggerCode::Talk { conversation, what: TalkCode::Message(performative.clone()) },
                        letter,
                    )
                }
            }
        }
        Trigger::Reading(p) if (*p as usize) < agent.sensors.len() => (TriggerCode::Reading(*p), None),
        Trigger::Event(e) if (*e as usize) < agent.events.len() => (TriggerCode::Event(*e), None),
        Trigger::Param(p) if (*p as usize) < graph.params.len() => (TriggerCode::Param(*p), None),
        Trigger::Reading(_) | Trigger::Event(_) | Trigger::Param(_) => {
            return damaged(unit.span, "a trigger does not exist");
        }
    })
}

fn timing(c: &mut Compiler<'_>, t: &Timing) -> Compiled<TimingCode> {
    Ok(TimingCode {
        deadline: perhaps(c, t.deadline.as_ref())?,
        worst_case: perhaps(c, t.worst_case.as_ref())?,
        at_most_every: perhaps(c, t.at_most_every.as_ref())?,
        priority: t.priority.unwrap_or(0),
        misses: t.misses,
        takes: match &t.takes {
            Some(e) if matches!(e.ty, Type::Distribution(_)) => Some(alone(c, e, &[])?),
            Some(e) => return damaged(e.span, "a distribution is wanted here"),
            None => None,
        },
        jitter: perhaps(c, t.jitter.as_ref())?,
        budget: perhaps(c, t.budget.as_ref())?,
        core: t.core,
        shares: t
            .shares
            .iter()
            .map(|s| Ok((s.resource.clone(), number(c, &s.time)?)))
            .collect::<Compiled<_>>()?,
    })
}

/// A service with a `refine` among its statements.
fn anytime(c: &mut Compiler<'_>, scope: &mut Scope, unit: &Unit, body: &[Stmt]) -> Compiled<AnytimeCode> {
    let at = body.iter().position(|s| matches!(s.kind, StmtKind::Refine(_)));
    let Some((before, [refine, after @ ..])) = at.map(|i| body.split_at(i)) else {
        return damaged(unit.span, "nothing is refined");
    };
    let StmtKind::Refine(r) = &refine.kind else {
        return damaged(unit.span, "nothing is refined");
    };
    let Refine { local, first, step, cost, until } = &**r;
    let (Some(ty), Some(register)) = (unit.locals.get(*local as usize), scope.local(*local)) else {
        return damaged(refine.at, "there is no place for what is refined");
    };
    let before: Vec<Stmt> = unit.prelude.iter().chain(before).cloned().collect();
    Ok(AnytimeCode {
        before: some_stmts(c, scope, &before)?,
        first: c.expr_as(scope, first, ty)?,
        step: c.expr_as(scope, step, ty)?,
        until: until.as_ref().map(|u| condition(c, scope, u)).transpose()?,
        cost: number(c, cost)?,
        local: register as usize,
        after: some_stmts(c, scope, after)?,
    })
}

fn plan(c: &mut Compiler<'_>, scope: &mut Scope, nodes: &[PlanNode], at: Span) -> Compiled<PlanCode> {
    let mut code: Vec<Block> = Vec::new();
    let mut keep = |b: Block| {
        code.push(b);
        code.len() as u32 - 1
    };
    let mut parts: Vec<(Part, &[u32])> = Vec::new();
    for n in nodes {
        let kind = match &n.kind {
            PlanKind::Sequence { memory } => Kind::Sequence { memory: *memory },
            PlanKind::Fallback { memory } => Kind::Fallback { memory: *memory },
            PlanKind::Parallel { successes } => {
                let all = n.children.len() as u32;
                let successes = successes.unwrap_or(all);
                if successes > all || successes == 0 {
                    return damaged(n.at, "more children must succeed than there are, or none");
                }
                Kind::Parallel { successes }
            }
            PlanKind::Retry(times) => Kind::Retry(*times),
            PlanKind::Timeout(e) => Kind::Timeout(keep(duration(c, scope, e)?)),
            PlanKind::Repeat { times, condition: e } => {
                let condition = match e {
                    Some(e) => Some(keep(condition(c, scope, e)?)),
                    None => None,
                };
                Kind::Repeat { times: *times, condition }
            }
            PlanKind::Invert => Kind::Invert,
            PlanKind::Succeed => Kind::Succeed,
            PlanKind::Check(e) => Kind::Check(keep(condition(c, scope, e)?)),
            PlanKind::Wait(e) => Kind::Wait(keep(duration(c, scope, e)?)),
            PlanKind::WaitUntil(e) => Kind::WaitUntil(keep(condition(c, scope, e)?)),
            PlanKind::Act { prelude, body, until, fails, halt } => {
                let mut act =
                    Act { prelude: some_stmts(c, scope, prelude)?.map(&mut keep), ..Act::default() };
                if let Some(e) = until {
                    act.until = Some(keep(condition(c, scope, e)?));
                }
                if let Some(e) = fails {
                    act.fails = Some(keep(condition(c, scope, e)?));
                }
                act.body = some_stmts(c, scope, body)?.map(&mut keep);
                act.halt = some_stmts(c, scope, halt)?.map(&mut keep);
                parts.push((Part::Act(act), &n.children));
                continue;
            }
        };
        parts.push((Part::Kind(kind), &n.children));
    }
    let tree = match Tree::new(&parts) {
        Ok(tree) => tree,
        Err(e) => {
            return damaged(
                nodes.get(e.node).map_or(at, |n| n.at),
                format!("{e} (at most {MAX_DEPTH} deep)"),
            );
        }
    };
    Ok(PlanCode { prelude: None, tree, code, nodes_at: 0, subgoal: None })
}

fn duration(c: &mut Compiler<'_>, scope: &mut Scope, e: &Expr) -> Compiled<Block> {
    let block = c.expr(scope, e)?;
    if block.width == 1 { Ok(block) } else { damaged(e.span, "a duration is wanted here") }
}

fn arbiter(
    c: &mut Compiler<'_>,
    graph: &Graph,
    agent: &Agent,
    a: &Arbiter,
) -> Compiled<(ArbiterCode, usize)> {
    let Some(port) = agent.actuators.get(a.actuator as usize) else {
        return damaged(a.at, "an arbiter is for an actuator port that the agent does not have");
    };
    let mut scope = c.scope(&a.locals)?;
    let mut uses = Uses::default();
    uses.stmts(&a.prelude);
    let prelude = some_stmts(c, &mut scope, &a.prelude)?;
    let mut numbers = |c: &mut Compiler<'_>, list: &[Expr]| -> Compiled<Vec<Block>> {
        if list.len() != a.sources.len() {
            return damaged(a.at, "an arbiter needs one value for each source");
        }
        list.iter()
            .map(|e| {
                uses.expr(e);
                let block = c.expr(&mut scope, e)?;
                if block.width == 1 { Ok(block) } else { damaged(e.span, "a number is wanted here") }
            })
            .collect()
    };
    let strategy = match &a.strategy {
        Strategy::Switch => StrategyCode::Switch,
        Strategy::Priority(list) => StrategyCode::Priority(numbers(c, list)?),
        Strategy::Blend(list) => {
            if !matches!(port.ty, Type::Twist | Type::Vector(..)) {
                return damaged(a.at, "only twists and vectors can be blended");
            }
            StrategyCode::Blend(numbers(c, list)?)
        }
        Strategy::Layers(layers) => {
            if layers.len() != a.sources.len() {
                return damaged(a.at, "an arbiter needs one layer for each source");
            }
            let mut out = Vec::new();
            for l in layers {
                if l.suppresses.iter().any(|s| *s as usize >= a.sources.len()) {
                    return damaged(a.at, "a layer suppresses a source that does not exist");
                }
                let inhibited = match &l.inhibited {
                    Some(e) => {
                        uses.expr(e);
                        Some(condition(c, &mut scope, e)?)
                    }
                    None => None,
                };
                out.push(LayerCode {
                    suppresses: l.suppresses.clone(),
                    hold: perhaps(c, l.hold.as_ref())?,
                    inhibited,
                });
            }
            StrategyCode::Layers(out)
        }
    };
    let optional = |p: &u32| agent.sensors.get(*p as usize).is_some_and(|s| s.optional);
    let locals = a.locals.iter().map(|t| graph.types.width(t)).sum();
    let code = ArbiterCode {
        prelude,
        locals,
        strategy,
        requires: uses.readings.iter().copied().filter(|p| !optional(p)).collect(),
        hears: uses.heard,
    };
    Ok((code, scope.frame().max(locals)))
}

/// Registers of an agent's states that are numbers of objects.
fn opaque(graph: &Graph, agent: &Agent) -> Vec<usize> {
    fn of(ty: &Type, types: &TypeTable, at: usize, out: &mut Vec<usize>) {
        match ty {
            Type::Handle(name) if OPAQUE.contains(&&**name) => out.push(at),
            Type::Option(inner) => of(inner, types, at + 1, out),
            Type::List(item, n) => {
                let (width, before) = (types.width(item), out.len());
                of(item, types, at + 1, out);
                let first: Vec<usize> = out.drain(before..).collect();
                let items = if first.is_empty() { 0 } else { *n as usize };
                out.extend((0..items).flat_map(|i| first.iter().map(move |a| a + i * width)));
            }
            Type::Record(name) => {
                let mut at = at;
                for (_, field) in types.records.get(name).into_iter().flat_map(|r| &r.fields) {
                    of(field, types, at, out);
                    at += types.width(field);
                }
            }
            _ => {}
        }
    }
    let (mut out, mut at) = (Vec::new(), 0);
    for s in &agent.states {
        of(&s.ty, &graph.types, at, &mut out);
        at += graph.types.width(&s.ty);
    }
    out
}
