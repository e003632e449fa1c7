//! Agents: their members, units and statements.

use super::{Builder, Cursor, Rule, unquote};
use crate::ast::*;
use pest::iterators::Pair;
use soifra_graph::Misses;

type P<'i> = Pair<'i, Rule>;

impl Builder {
    pub fn agent(&mut self, p: P<'_>) -> Agent {
        let mut c = Cursor::new(p);
        c.word(Rule::K_AGENT);
        let name = self.ident(&mut c);
        let params = self.params(&mut c);
        let collaborative = c.take(Rule::collaborative).is_some();
        let restart = c.take(Rule::agent_restart).map(|p| {
            let mut c = Cursor::new(p);
            (self.int(&mut c), self.expr_in(&mut c))
        });
        let mut members = Vec::new();
        while let Some(p) = c.any() {
            members.push(match p.as_rule() {
                Rule::offers => {
                    let mut c = Cursor::new(p);
                    let name = self.ident(&mut c);
                    let when = c.take(Rule::offer_when).map(|p| self.expr_in(&mut Cursor::new(p)));
                    AgentMember::Offers(name, when)
                }
                Rule::sensor_port => {
                    let mut c = Cursor::new(p);
                    AgentMember::Sensor(self.ident(&mut c), self.type_in(&mut c))
                }
                Rule::actuator_port => {
                    let mut c = Cursor::new(p);
                    AgentMember::Actuator(self.ident(&mut c), self.type_in(&mut c))
                }
                Rule::slot => {
                    let mut c = Cursor::new(p);
                    let name = self.ident(&mut c);
                    let ty = c.take(Rule::type_ref).map(|t| self.type_ref(t));
                    AgentMember::State(name, ty, self.expr_in(&mut c))
                }
                Rule::device => {
                    let mut c = Cursor::new(p);
                    let name = self.ident(&mut c);
                    let capacity = if c.peek() == Some(Rule::int) { self.int(&mut c) } else { 1 };
                    AgentMember::Device(name, capacity)
                }
                Rule::event => AgentMember::Event(self.ident(&mut Cursor::new(p))),
                Rule::constant => AgentMember::Constant(self.constant(p)),
                Rule::action => AgentMember::Action(self.action(p)),
                Rule::service => {
                    let mut c = Cursor::new(p);
                    let (name, trigger, timing) = self.unit_head(&mut c);
                    AgentMember::Unit(Box::new(Unit {
                        name,
                        trigger,
                        timing,
                        kind: UnitKind::Service(self.block_in(&mut c)),
                    }))
                }
                Rule::machine => {
                    let mut c = Cursor::new(p);
                    let (name, trigger, timing) = self.unit_head(&mut c);
                    let states =
                        c.all(Rule::machine_state).into_iter().map(|p| self.machine_state(p)).collect();
                    AgentMember::Unit(Box::new(Unit {
                        name,
                        trigger,
                        timing,
                        kind: UnitKind::Machine(states),
                    }))
                }
                Rule::plan => {
                    let mut c = Cursor::new(p);
                    let name = self.ident(&mut c);
                    let subgoal = c.take(Rule::ident).map(|p| self.name(&p));
                    let (trigger, timing) = self.trigger_and_timing(&mut c);
                    let Some(root) = c.take(Rule::plan_node) else { continue };
                    let root = self.plan_node(root);
                    AgentMember::Unit(Box::new(Unit {
                        name,
                        trigger,
                        timing,
                        kind: UnitKind::Plan(subgoal, Box::new(root)),
                    }))
                }
                Rule::arbiter => AgentMember::Arbiter(self.arbiter(p)),
                _ => continue,
            });
        }
        Agent { name, params, collaborative, restart, members }
    }

    fn action(&mut self, p: P<'_>) -> Action {
        let mut c = Cursor::new(p);
        let (name, params) = (self.ident(&mut c), self.params(&mut c));
        let until = c.take(Rule::action_until).map(|p| self.expr_in(&mut Cursor::new(p)));
        let fails = c.take(Rule::action_fails).map(|p| self.expr_in(&mut Cursor::new(p)));
        let body = self.block_in(&mut c);
        let halt = c.take(Rule::action_halt).map(|p| self.block_in(&mut Cursor::new(p))).unwrap_or_default();
        Action { name, params, until, fails, body, halt }
    }

    fn unit_head(&mut self, c: &mut Cursor<'_>) -> (Ident, Trigger, Vec<Timing>) {
        let name = self.ident(c);
        let (trigger, timing) = self.trigger_and_timing(c);
        (name, trigger, timing)
    }

    fn trigger_and_timing(&mut self, c: &mut Cursor<'_>) -> (Trigger, Vec<Timing>) {
        let trigger = match c.take(Rule::trigger) {
            Some(p) => self.trigger(p),
            None => Trigger { kind: TriggerKind::Step(None), span: soifra_graph::Span::new(self.file, 0, 0) },
        };
        let mut timing = Vec::new();
        for p in c.all(Rule::timing) {
            let mut c = Cursor::new(p);
            timing.push(if c.word(Rule::K_WORST) {
                Timing::Worst(self.expr_in(&mut c))
            } else if c.word(Rule::K_TAKES) {
                Timing::Takes(self.expr_in(&mut c))
            } else if c.word(Rule::K_JITTER) {
                Timing::Jitter(self.expr_in(&mut c))
            } else if c.word(Rule::K_BUDGET) {
                Timing::Budget(self.expr_in(&mut c))
            } else if c.word(Rule::K_PRIORITY) {
                Timing::Priority(self.int(&mut c))
            } else if c.word(Rule::K_CORE) {
                Timing::Core(self.int(&mut c))
            } else {
                match c.peek() {
                    Some(Rule::timing_stopped) => Timing::Stopped,
                    Some(rule @ (Rule::timing_deadline | Rule::timing_shares)) => {
                        let Some(p) = c.any() else { continue };
                        let mut c = Cursor::new(p);
                        if rule == Rule::timing_shares {
                            Timing::Shares(self.ident(&mut c), self.expr_in(&mut c))
                        } else {
                            let deadline = self.expr_in(&mut c);
                            Timing::Deadline(deadline, self.misses(&mut c))
                        }
                    }
                    _ => Timing::AtMostEvery(self.expr_in(&mut c)),
                }
            });
        }
        (trigger, timing)
    }

    /// What a missed deadline means.
    fn misses(&mut self, c: &mut Cursor<'_>) -> Misses {
        match c.peek() {
            Some(Rule::soft) => Misses::Soft,
            Some(_) => Misses::AtMost(u32::try_from(self.int(c)).unwrap_or(u32::MAX)),
            None => Misses::Hard,
        }
    }

    fn trigger(&mut self, p: P<'_>) -> Trigger {
        let span = self.span(&p);
        let Some(p) = Cursor::new(p).any() else { return Trigger { kind: TriggerKind::Step(None), span } };
        let rule = p.as_rule();
        let mut c = Cursor::new(p);
        let kind = match rule {
            Rule::on_step => TriggerKind::Step(self.offset(&mut c)),
            Rule::on_period => {
                let period = self.expr_in(&mut c);
                TriggerKind::Every(period, self.offset(&mut c))
            }
            Rule::on_event => TriggerKind::Event(self.ident(&mut c)),
            Rule::on_sensor => TriggerKind::Sensor(self.ident(&mut c)),
            Rule::on_param => TriggerKind::Param(self.ident(&mut c)),
            Rule::on_told => {
                let (performative, content, local) =
                    (self.ident(&mut c), self.ident(&mut c), self.ident(&mut c));
                TriggerKind::Told(performative, content, local, c.take(Rule::ident).map(|p| self.name(&p)))
            }
            Rule::on_talk => TriggerKind::Talk(self.ident(&mut c), self.ident(&mut c)),
            _ => TriggerKind::Topic(self.ident(&mut c), self.ident(&mut c)),
        };
        Trigger { kind, span }
    }

    fn govern(&mut self, p: Option<P<'_>>) -> Govern {
        let Some(p) = p else { return Govern::Achieve };
        let rule = p.as_rule();
        let mut c = Cursor::new(p);
        match rule {
            Rule::govern_offer => Govern::Offer(self.ident(&mut c)),
            Rule::govern_withdraw => Govern::Withdraw(self.ident(&mut c)),
            Rule::govern_start => Govern::Start(self.ident(&mut c)),
            Rule::govern_stop => Govern::Stop(self.ident(&mut c)),
            Rule::govern_pursue => Govern::Pursue(self.ident(&mut c)),
            Rule::govern_fail => {
                Govern::Fail(c.take(Rule::string).map(|p| unquote(p.as_str())).unwrap_or_default())
            }
            _ => Govern::Achieve,
        }
    }

    fn offset(&mut self, c: &mut Cursor<'_>) -> Option<Expr> {
        c.take(Rule::offset).map(|p| self.expr_in(&mut Cursor::new(p)))
    }

    fn machine_state(&mut self, p: P<'_>) -> MachineState {
        let mut c = Cursor::new(p);
        let (name, data) = (self.ident(&mut c), self.params(&mut c));
        let mut s = MachineState {
            name,
            data,
            entry: Vec::new(),
            exit: Vec::new(),
            body: Vec::new(),
            transitions: Vec::new(),
        };
        while let Some(p) = c.any() {
            match p.as_rule() {
                Rule::on_enter => s.entry.extend(self.block_in(&mut Cursor::new(p))),
                Rule::on_exit => s.exit.extend(self.block_in(&mut Cursor::new(p))),
                Rule::transition => {
                    let mut c = Cursor::new(p);
                    let (guard, target) = (self.expr_in(&mut c), self.ident(&mut c));
                    let args = c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default();
                    s.transitions.push(Transition { guard, target, args, body: self.block_in(&mut c) });
                }
                Rule::stmt => s.body.push(self.stmt(p)),
                _ => {}
            }
        }
        s
    }

    fn plan_node(&mut self, p: P<'_>) -> PlanNode {
        let span = self.span(&p);
        let leaf = |kind| PlanNode { kind, children: Vec::new(), span };
        let Some(p) = Cursor::new(p).any() else { return leaf(PlanKind::Succeed) };
        match p.as_rule() {
            Rule::plan_check => leaf(PlanKind::Check(self.expr_in(&mut Cursor::new(p)))),
            Rule::plan_wait => leaf(PlanKind::Wait(self.expr_in(&mut Cursor::new(p)))),
            Rule::plan_wait_until => leaf(PlanKind::WaitUntil(self.expr_in(&mut Cursor::new(p)))),
            Rule::stmt => leaf(PlanKind::Stmt(self.stmt(p))),
            _ => {
                let mut c = Cursor::new(p);
                let control = c.take(Rule::control);
                // The head stands for the node in reports: its children have their own places.
                let span = control.as_ref().map_or(span, |p| self.span(p));
                let kind = control.map_or(PlanKind::Succeed, |p| self.control(p));
                let children = c.all(Rule::plan_node).into_iter().map(|p| self.plan_node(p)).collect();
                PlanNode { kind, children, span }
            }
        }
    }

    fn control(&mut self, p: P<'_>) -> PlanKind {
        let mut c = Cursor::new(p);
        // `reactive` is a rule of its own, so that the keyword after it is still there to be asked for.
        let reactive = c.reactive();
        if c.word(Rule::K_SEQUENCE) {
            PlanKind::Sequence(reactive)
        } else if c.word(Rule::K_FALLBACK) {
            PlanKind::Fallback(reactive)
        } else if c.word(Rule::K_PARALLEL) {
            PlanKind::Parallel((c.peek() == Some(Rule::int)).then(|| self.int(&mut c)))
        } else if c.word(Rule::K_RETRY) {
            PlanKind::Retry(self.int(&mut c))
        } else if c.word(Rule::K_TIMEOUT) {
            PlanKind::Timeout(self.expr_in(&mut c))
        } else if c.word(Rule::K_REPEAT) {
            match c.peek() {
                Some(Rule::int) => PlanKind::Repeat(self.int(&mut c)),
                _ => PlanKind::RepeatWhile(self.expr_in(&mut c)),
            }
        } else if c.word(Rule::K_INVERT) {
            PlanKind::Invert
        } else {
            PlanKind::Succeed
        }
    }

    fn arbiter(&mut self, p: P<'_>) -> Arbiter {
        let span = self.span(&p);
        let mut c = Cursor::new(p);
        let actuator = self.ident(&mut c);
        let strategy = match c.any() {
            Some(p) => {
                let rule = p.as_rule();
                let mut c = Cursor::new(p);
                match rule {
                    Rule::by_switch => Strategy::Switch(self.sources(&mut c)),
                    Rule::by_layers => {
                        Strategy::Layers(c.all(Rule::layer).into_iter().map(|p| self.layer(p)).collect())
                    }
                    _ => {
                        let mut list = Vec::new();
                        for w in c.all(Rule::weighted) {
                            let mut c = Cursor::new(w);
                            if let Some(s) = c.take(Rule::source) {
                                list.push((self.source(s), self.expr_in(&mut c)));
                            }
                        }
                        if rule == Rule::by_blend { Strategy::Blend(list) } else { Strategy::Priority(list) }
                    }
                }
            }
            None => Strategy::Switch(Vec::new()),
        };
        Arbiter { actuator, strategy, span }
    }

    fn layer(&mut self, p: P<'_>) -> Layer {
        let mut c = Cursor::new(p);
        let source = match c.take(Rule::source) {
            Some(p) => self.source(p),
            None => Source { agent: None, unit: self.ident(&mut c) },
        };
        let suppresses = c.take(Rule::layer_suppresses).map(|p| self.sources(&mut Cursor::new(p)));
        let hold = c.take(Rule::layer_for).map(|p| self.expr_in(&mut Cursor::new(p)));
        let inhibited = c.take(Rule::layer_inhibited).map(|p| self.expr_in(&mut Cursor::new(p)));
        Layer { source, suppresses, hold, inhibited }
    }

    fn sources(&mut self, c: &mut Cursor<'_>) -> Vec<Source> {
        c.all(Rule::source).into_iter().map(|p| self.source(p)).collect()
    }

    fn source(&mut self, p: P<'_>) -> Source {
        let mut c = Cursor::new(p);
        let first = self.ident(&mut c);
        match c.take(Rule::ident) {
            Some(p) => Source { agent: Some(first), unit: self.name(&p) },
            None => Source { agent: None, unit: first },
        }
    }

    /// The block that comes next, empty when there is none.
    pub fn block_in(&mut self, c: &mut Cursor<'_>) -> Vec<Stmt> {
        c.take(Rule::block).map(|p| self.block(p)).unwrap_or_default()
    }

    fn block(&mut self, p: P<'_>) -> Vec<Stmt> {
        Cursor::new(p).all(Rule::stmt).into_iter().map(|p| self.stmt(p)).collect()
    }

    fn body_in(&mut self, c: &mut Cursor<'_>) -> Vec<Stmt> {
        let Some(p) = c.take(Rule::body) else { return Vec::new() };
        match Cursor::new(p).any() {
            Some(p) if p.as_rule() == Rule::block => self.block(p),
            Some(p) => vec![self.stmt(p)],
            None => Vec::new(),
        }
    }

    fn stmt(&mut self, p: P<'_>) -> Stmt {
        let span = self.span(&p);
        let Some(p) = Cursor::new(p).any() else {
            return Stmt { kind: StmtKind::If(Vec::new(), Vec::new()), span };
        };
        let rule = p.as_rule();
        let mut c = Cursor::new(p);
        let kind = match rule {
            Rule::let_stmt => StmtKind::Let(self.ident(&mut c), self.expr_in(&mut c)),
            Rule::open_stmt => {
                let (conversation, performative) = (self.ident(&mut c), self.ident(&mut c));
                let content = c.take(Rule::expr).map(|e| self.expr(e));
                let to = match c.take(Rule::open_to) {
                    Some(p) => self.expr_in(&mut Cursor::new(p)),
                    None => self.expr_in(&mut c),
                };
                let within = c.take(Rule::open_within).map(|p| self.expr_in(&mut Cursor::new(p)));
                StmtKind::Open { conversation, performative, content, to, within }
            }
            Rule::reply_stmt => {
                let performative = self.ident(&mut c);
                let reason = c.take(Rule::string).map(|p| unquote(p.as_str()));
                let content = c.take(Rule::expr).map(|e| self.expr(e));
                let thread = c.take(Rule::reply_in).map(|p| self.expr_in(&mut Cursor::new(p)));
                StmtKind::Reply { performative, content, reason, thread }
            }
            Rule::use_stmt => StmtKind::Use(self.ident(&mut c), self.expr_in(&mut c)),
            Rule::for_stmt => {
                let (item, list) = (self.ident(&mut c), self.expr_in(&mut c));
                StmtKind::For(item, list, self.block_in(&mut c))
            }
            Rule::refine_stmt => StmtKind::Refine {
                name: self.ident(&mut c),
                first: self.expr_in(&mut c),
                step: self.expr_in(&mut c),
                cost: self.expr_in(&mut c),
                until: c.take(Rule::refine_until).map(|p| self.expr_in(&mut Cursor::new(p))),
            },
            Rule::set_stmt => StmtKind::Set(self.ident(&mut c), self.expr_in(&mut c)),
            Rule::command_stmt => StmtKind::Command(self.ident(&mut c), self.expr_in(&mut c)),
            Rule::publish_stmt => StmtKind::Publish(self.ident(&mut c), self.expr_in(&mut c)),
            Rule::tell_stmt => StmtKind::Tell(self.ident(&mut c), self.ident(&mut c), self.expr_in(&mut c)),
            Rule::note_stmt => {
                let text = c.take(Rule::string).map(|p| unquote(p.as_str())).unwrap_or_default();
                StmtKind::Note(text, c.take(Rule::expr).map(|e| self.expr(e)))
            }
            Rule::raise_stmt => StmtKind::Raise(self.ident(&mut c)),
            Rule::govern_stmt => StmtKind::Govern(self.govern(c.any())),
            Rule::do_stmt => {
                StmtKind::Do(self.ident(&mut c), c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default())
            }
            Rule::when_stmt => StmtKind::When(self.expr_in(&mut c), self.body_in(&mut c)),
            Rule::rules_stmt => {
                let mut rules = Vec::new();
                for r in c.all(Rule::guarded) {
                    let at = self.span(&r);
                    let mut c = Cursor::new(r);
                    let guard = c.take(Rule::expr).map(|e| self.expr(e));
                    let at =
                        guard.as_ref().map_or(soifra_graph::Span { end: at.start + 9, ..at }, |g| g.span);
                    rules.push((guard, self.body_in(&mut c), at));
                }
                StmtKind::Rules(rules)
            }
            Rule::match_stmt => {
                let value = self.expr_in(&mut c);
                let mut arms = Vec::new();
                for a in c.all(Rule::match_stmt_arm) {
                    let mut c = Cursor::new(a);
                    let Some(pat) = c.take(Rule::pattern) else { continue };
                    let pat = self.pattern(pat);
                    arms.push((pat, self.body_in(&mut c)));
                }
                StmtKind::Match(value, arms)
            }
            _ => {
                let (mut arms, mut otherwise) = (Vec::new(), Vec::new());
                while let Some(p) = c.any() {
                    match p.as_rule() {
                        Rule::expr => {
                            let cond = self.expr(p);
                            arms.push((cond, self.block_in(&mut c)));
                        }
                        _ => otherwise = self.block(p),
                    }
                }
                StmtKind::If(arms, otherwise)
            }
        };
        Stmt { kind, span }
    }
}
