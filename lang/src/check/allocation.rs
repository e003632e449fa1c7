//! Can every sub-goal be served by agents? The four questions of the planner-matcher, before a run: is there a
//! plan, is anybody capable, are the capable ones free, and if not, do they serve several at a time?

use super::{Constants, walk};
use crate::code;
use soifra_graph::{
    Diagnostic, Govern, Graph, LibraryPlan, Name, Span, StmtKind, SubGoal, Value,
    allocation::{Agent, Matcher, Outcome, Problem, Refusal},
    planning::{Means, Pool, Wanted},
};
use std::collections::BTreeSet;

/// The most robots that are looked at.
const MOST: usize = 10_000;

/// Checks all sub-goals that are wanted from the start together, and each on request by itself.
pub fn check(g: &Graph) -> Vec<Diagnostic> {
    let mut out = idle(g);
    if g.goals.iter().flat_map(|x| &x.subgoals).all(|s| s.agent.is_some()) {
        return out;
    }
    let Some((hall, holds, bodies)) = Hall::new(g) else { return out };
    let at_start = |p: u32| holds.get(p as usize).copied().unwrap_or(false);
    let goals = |on_request: bool| {
        (0..).zip(&g.goals).filter(move |(_, x)| x.on_request == on_request).map(|(i, _)| i)
    };
    let mut first = Vec::new();
    for goal in goals(false) {
        let wanted = g.wanted(goal, bodies, &at_start);
        if wanted.is_empty()
            && let Some(x) =
                g.goals.get(goal as usize).filter(|x| x.subgoals.iter().any(|s| s.plan.is_some()))
        {
            out.push(no_plan(g, &x.name, x.at));
        }
        first.extend(wanted);
    }
    out.extend(hall.refusals(&first, &at_start));
    // Later other plans may hold, and the agents of now may be free.
    for goal in goals(true) {
        let subgoals = g.goals.get(goal as usize).map_or(0, |x| x.subgoals.len() as u32);
        let wanted = (0..subgoals).flat_map(|subgoal| {
            let one = Wanted { goal, subgoal, robot: None };
            match hall.subgoal(&one) {
                s if s.agent.is_some() => Vec::new(),
                s if s.each_robot => (0..bodies).map(|r| Wanted { robot: Some(r), ..one }).collect(),
                _ => vec![one],
            }
        });
        for w in wanted {
            out.extend(hall.refusals(&[w], &|_| true));
        }
    }
    // What is wrong on every robot of an array is one mistake.
    let mut seen = BTreeSet::new();
    out.retain(|d| seen.insert((d.code, d.position())));
    out
}

/// A sub-goal as it is allocated at the start of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Allotted {
    /// Goal and sub-goal, by index.
    pub goal: (u32, u32),
    /// The robot that it is for, when each has one.
    pub robot: Option<String>,
    /// Plan of the library, by index.
    pub plan: u32,
    /// Services with the agents that give them, `agent@robot`.
    pub agents: Vec<(Name, String)>,
}

/// The allocation at the start of a run with parameters at their defaults: sub-goals that are served.
pub fn allocation(g: &Graph) -> Vec<Allotted> {
    let Some((hall, holds, bodies)) = Hall::new(g) else { return Vec::new() };
    let holds = |p: u32| holds.get(p as usize).copied().unwrap_or(false);
    let goals = (0..).zip(&g.goals).filter(|(_, x)| !x.on_request).map(|(i, _)| i);
    let wanted: Vec<Wanted> = goals.flat_map(|goal| g.wanted(goal, bodies, &holds)).collect();
    let (matcher, means) = hall.solve(&wanted, &holds);
    let mut out = Vec::new();
    for ((w, means), outcome) in wanted.iter().zip(&means).zip(matcher.outcomes()) {
        let Some(choice) = outcome.choice() else { continue };
        let Some(plan) = means.get(choice.label as usize).map(|m| m.plan) else { continue };
        let needs = g.plans.get(plan as usize).map(|p| p.needs.as_slice()).unwrap_or_default();
        let agents = needs.iter().zip(&choice.agents).map(|((s, _), a)| (s.clone(), hall.name(*a)));
        let robot = w.robot.and_then(|r| hall.names.get(r as usize).cloned());
        out.push(Allotted { goal: (w.goal, w.subgoal), robot, plan, agents: agents.collect() });
    }
    out
}

/// Offers and words that mean nothing without plans.
fn idle(g: &Graph) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    let needed = |name: &Name| g.plans.iter().flat_map(|p| &p.needs).any(|(n, _)| n == name);
    for (a, used) in g.agents.iter().zip(super::used_agents(g)) {
        for o in a.offers.iter().filter(|o| used && o.unit.is_some() && !needed(&o.name)) {
            out.push(
                Diagnostic::warning(code::NO_EFFECT, format!("no plan needs `{}`", o.name))
                    .at(o.span, "runs only while it is needed, so never")
                    .hint(format!(
                        "write a plan: `plan NAME for SUBGOAL {{ needs {} }}`, or do not offer it",
                        o.name
                    )),
            );
        }
        if a.offers.iter().any(|o| o.unit.is_some()) {
            continue;
        }
        for s in a.units.iter().flat_map(walk::statements) {
            if let StmtKind::Govern(what @ (Govern::Achieve | Govern::Fail(_))) = &s.kind {
                let word = if *what == Govern::Achieve { "achieve" } else { "fail" };
                out.push(
                    Diagnostic::warning(
                        code::NO_EFFECT,
                        format!("`{word}` is for agents that are allocated"),
                    )
                    .at(s.at, "of which sub-goal?")
                    .at(a.span, "offers no service that a plan could need")
                    .hint("offer a service: `offers UNIT`; of a sub-goal `by` an agent say `achieved when`"),
                );
            }
        }
    }
    out
}

fn no_plan(g: &Graph, name: &Name, at: Span) -> Diagnostic {
    let title = format!("no plan for `{name}`");
    let mut d = Diagnostic::error(code::NO_PLAN, title).at(at, "how is it to be achieved?");
    let plans: Vec<_> = g.plans.iter().filter(|p| p.target == *name).collect();
    for p in &plans {
        let at = p.when.as_ref().map_or(p.at, |w| w.span);
        d = d.at(at, format!("does not hold at the start, so `{}` is none", p.name));
    }
    d.hint(match plans.as_slice() {
        [] => format!("write `plan NAME for {name} {{ needs SERVICE }}`, or say who does it: `by AGENT`"),
        _ => "add a plan for this state of the parameters, or one without `when` as the last".into(),
    })
}

/// Who could serve what.
struct Hall<'g> {
    g: &'g Graph,
    pool: Pool,
    names: Vec<String>,
}

impl<'g> Hall<'g> {
    /// Everybody, which plans hold at the start, and the number of robots with a body; none when the number of
    /// robots is not known, or too large.
    fn new(g: &'g Graph) -> Option<(Hall<'g>, Vec<bool>, u32)> {
        let mut known = Constants::new(g);
        let (mut groups, mut names) = (Vec::new(), Vec::new());
        for (i, r) in (0..).zip(&g.robots) {
            let count = known.count(r.count.as_ref()).filter(|c| groups.len() + c <= MOST)?;
            groups.extend((0..count).map(|_| i));
            let name =
                |k: usize| if r.count.is_some() { format!("{}[{k}]", r.name) } else { r.name.to_string() };
            names.extend((0..count).map(name));
        }
        let holds =
            |p: &LibraryPlan| p.when.as_ref().is_none_or(|e| known.value(e, 0) != Some(Value::Bool(false)));
        let holds: Vec<bool> = g.plans.iter().map(holds).collect();
        let has_body = |i: &&u32| g.robots.get(**i as usize).is_some_and(|r| !r.host);
        let bodies = groups.iter().filter(has_body).count() as u32;
        Some((Hall { g, pool: Pool::new(g, &groups), names }, holds, bodies))
    }

    /// The allocation of what is wanted.
    fn solve(&self, wanted: &[Wanted], holds: &dyn Fn(u32) -> bool) -> (Matcher, Vec<Vec<Means>>) {
        let agents = self.pool.members().iter().map(|m| {
            let a = &self.g.agents[m.agent as usize];
            // An exclusive agent that a sub-goal names serves that one.
            Agent { collaborative: a.collaborative, available: a.collaborative || !self.g.is_bound(m.agent) }
        });
        let (tasks, means): (Vec<_>, Vec<_>) =
            wanted.iter().map(|w| self.pool.task(self.g, *w, holds)).unzip();
        let mut matcher = Matcher::new(Problem { agents: agents.collect(), tasks });
        matcher.solve();
        (matcher, means)
    }

    fn subgoal(&self, w: &Wanted) -> &SubGoal {
        &self.g.goals[w.goal as usize].subgoals[w.subgoal as usize]
    }

    /// `agent@robot`
    fn name(&self, number: u32) -> String {
        let Some(m) = self.pool.members().get(number as usize) else { return String::new() };
        let robot = self.names.get(m.robot as usize).map_or("?", String::as_str);
        format!("{}@{robot}", self.g.agents[m.agent as usize].name)
    }

    /// What cannot be served, and why.
    fn refusals(&self, wanted: &[Wanted], holds: &dyn Fn(u32) -> bool) -> Vec<Diagnostic> {
        let (matcher, means) = self.solve(wanted, holds);
        let mut out = Vec::new();
        for ((w, means), outcome) in wanted.iter().zip(&means).zip(matcher.outcomes()) {
            match outcome {
                Outcome::Refused(Refusal::NoPlan) => {
                    let s = self.subgoal(w);
                    out.push(no_plan(self.g, &s.name, s.at));
                }
                Outcome::Refused(Refusal::NoCapable { needs }) => out.push(self.no_capable(w, means, needs)),
                Outcome::Refused(Refusal::NotAvailable { tasks, agents, unavailable }) => {
                    let rivals: Vec<&Wanted> = tasks.iter().filter_map(|t| wanted.get(*t as usize)).collect();
                    out.push(self.not_available(w, &rivals, agents, unavailable));
                }
                Outcome::Undecided => {
                    let s = self.subgoal(w);
                    out.push(
                        Diagnostic::warning(
                            code::NOT_AVAILABLE,
                            format!("not proven that agents for `{}` are available", s.name),
                        )
                        .at(s.at, "too many ways to share the agents")
                        .hint("fewer exclusive agents in plans with several needs make it easier to decide"),
                    );
                }
                Outcome::Served(_) | Outcome::Removed => {}
            }
        }
        out
    }

    fn no_capable(&self, w: &Wanted, means: &[Means], needs: &[u32]) -> Diagnostic {
        let s = self.subgoal(w);
        let of = w.robot.and_then(|r| self.names.get(r as usize));
        let of = of.map_or(String::new(), |r| format!(" of `{r}`"));
        let title = format!("no agent is capable of `{}`{of}", s.name);
        let mut d = Diagnostic::error(code::NO_CAPABLE, title).at(s.at, "nobody can serve it");
        let mut told = BTreeSet::new();
        let mut unfit = false;
        for (means, need) in means.iter().zip(needs) {
            let Some(plan) = self.g.plans.get(means.plan as usize) else { continue };
            let Some((service, at)) = plan.needs.get(*need as usize) else { continue };
            if !told.insert((means.plan, service)) {
                continue;
            }
            let elsewhere = self.pool.offering(service).next();
            d = d.at(
                *at,
                match elsewhere {
                    None => format!("nobody offers `{service}`"),
                    Some(a) => {
                        format!("on the robot of the others nobody offers `{service}`, only {}", self.name(a))
                    }
                },
            );
            for (r, u) in self.g.robots.iter().flat_map(|r| r.unfit.iter().map(move |u| (r, u))) {
                let a = &self.g.agents[u.agent as usize];
                if a.offers.iter().any(|o| o.name == *service) {
                    let platform = self.g.platforms.get(r.platform as usize).map_or("?", |p| &*p.name);
                    let text =
                        format!("`{}` would, but `{platform}` has no such {} `{}`", a.name, u.role, u.port);
                    d = d.at(u.at, text);
                    unfit = true;
                }
            }
            let used = super::used_agents(self.g);
            let idle = self.g.agents.iter().zip(used).filter(|(_, used)| !used).map(|(a, _)| a);
            let listed = |a: u32| self.g.robots.iter().any(|r| r.unfit.iter().any(|u| u.agent == a));
            for (i, a) in (0..).zip(&self.g.agents) {
                let offers = a.offers.iter().any(|o| o.name == *service);
                if offers && !listed(i) && idle.clone().any(|x| std::ptr::eq(x, a)) {
                    d = d.at(a.span, format!("`{}` offers it, but no robot runs it", a.name));
                }
            }
        }
        d.hint(match unfit {
            true => "choose a platform that has it, or add a plan that does without",
            false => "let a robot run an agent that offers it, or add a plan that does without",
        })
    }

    fn not_available(&self, w: &Wanted, rivals: &[&Wanted], agents: &[u32], gone: &[u32]) -> Diagnostic {
        let s = self.subgoal(w);
        let title = format!("capable agents for `{}` are not available", s.name);
        let mut d = Diagnostic::error(code::NOT_AVAILABLE, title).at(s.at, "cannot be served together");
        let mut told = BTreeSet::from([s.at]);
        for r in rivals.iter().map(|w| self.subgoal(w)) {
            if told.insert(r.at) {
                d = d.at(r.at, format!("with `{}`, which needs them too", r.name));
            }
        }
        let mut kinds = BTreeSet::new();
        for number in agents.iter().chain(gone) {
            let Some(m) = self.pool.members().get(*number as usize) else { continue };
            if !kinds.insert(m.agent) {
                continue;
            }
            let a = &self.g.agents[m.agent as usize];
            let bound = self.g.goals.iter().flat_map(|x| &x.subgoals).find(|s| s.agent == Some(m.agent));
            d = match bound {
                Some(b) => d.at(b.at, format!("`{}` is exclusive and serves this", a.name)),
                None => d.at(a.span, format!("{} is exclusive", self.name(*number))),
            };
        }
        d.hint("let another robot run such an agent, declare it `collaborative`, or want less at a time")
    }
}
