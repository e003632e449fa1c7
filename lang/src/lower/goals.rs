//! Goals, their sub-goals, and the plans of the library for them.

use crate::{
    ast::{self, MissionMember as M},
    code,
    decls::unknown,
    typed::{Body, Checker, Place},
};
use soifra_graph::{Diagnostic, Goal, LibraryPlan, Name, Severity, SubGoal, Type};
use std::collections::{BTreeMap, BTreeSet};

impl<'a> Checker<'a> {
    /// The goals of a mission and the plans for them.
    pub(super) fn goals(
        &mut self,
        m: &'a ast::Mission,
        agents: &BTreeMap<Name, u32>,
    ) -> (Vec<Goal>, Vec<LibraryPlan>) {
        let goals: Vec<&'a ast::Goal> =
            m.members.iter().filter_map(|x| if let M::Goal(g) = x { Some(g) } else { None }).collect();
        self.distinct(goals.iter().map(|g| &g.name));
        let library = self.library(&goals);
        let mut out = Vec::new();
        for g in &goals {
            self.goals.push(g.name.name.clone());
            self.distinct(g.subgoals.iter().map(|s| &s.name));
            let mut subgoals: Vec<SubGoal> =
                g.subgoals.iter().filter_map(|s| self.subgoal(s, agents)).collect();
            for s in g.subgoals.iter().filter(|_| g.on_request) {
                if let Some(by) = &s.agent {
                    self.report(
                        Diagnostic::error(
                            code::NO_PLAN,
                            format!("`{}` is pursued from the start", s.name.name),
                        )
                        .at(by.span, "an agent that is named pursues it always")
                        .at(g.name.span, "on request only")
                        .hint("leave out `by` and write a plan for it, or leave out `on request`"),
                    );
                }
            }
            for (i, plan) in (0..).zip(&library) {
                if plan.target.name != g.name.name || plan.subgoals.is_empty() {
                    continue;
                }
                if !g.subgoals.is_empty() {
                    self.report(
                        Diagnostic::error(code::NO_PLAN, format!("`{}` has its sub-goals", g.name.name))
                            .at(plan.target.span, "a plan that is never chosen")
                            .at(g.name.span, "says itself what it is made of")
                            .hint("leave out the braces of the goal, or the plan"),
                    );
                }
                subgoals.extend(plan.subgoals.iter().map(|s| SubGoal {
                    name: s.name.name.clone(),
                    agent: None,
                    achieved: None,
                    each_robot: s.each_robot,
                    plan: Some(i),
                    at: s.name.span,
                }));
            }
            out.push(Goal { name: g.name.name.clone(), on_request: g.on_request, subgoals, at: g.name.span });
        }
        let plans = library.into_iter().filter_map(|p| self.library_plan(p)).collect();
        (out, plans)
    }

    /// The plans of the library that are for these goals or what they are made of.
    fn library(&mut self, goals: &[&'a ast::Goal]) -> Vec<&'a ast::LibraryPlan> {
        let plans = self.decls.plans.clone();
        let of_goals = |name: &Name| goals.iter().any(|g| g.name.name == *name);
        let mut wanted: BTreeSet<&Name> =
            goals.iter().flat_map(|g| &g.subgoals).map(|s| &s.name.name).collect();
        for (_, p) in &plans {
            if of_goals(&p.target.name) {
                wanted.extend(p.subgoals.iter().map(|s| &s.name.name));
            }
        }
        let mut out = Vec::new();
        for (file, p) in plans {
            let fits = match p.subgoals.is_empty() {
                true => wanted.contains(&p.target.name),
                false => of_goals(&p.target.name),
            };
            match fits {
                true => out.push(p),
                // A library may have plans for what this mission does not want.
                false if file == 0 && !self.is_goal_of_any(&p.target.name) => {
                    let what = if p.subgoals.is_empty() { "sub-goal" } else { "goal" };
                    let known = wanted.iter().map(|n| &***n).chain(goals.iter().map(|g| &*g.name.name));
                    let d = unknown(code::UNKNOWN_NAME, what, &p.target.name, p.target.span, known);
                    self.report(d);
                }
                false => {}
            }
        }
        out
    }

    /// Whether some mission, perhaps another one, has a goal or sub-goal of that name.
    fn is_goal_of_any(&self, name: &Name) -> bool {
        let members = self.decls.missions.iter().flat_map(|(_, m)| &m.members);
        let mut goals = members.filter_map(|x| if let M::Goal(g) = x { Some(g) } else { None });
        let in_plans = self.decls.plans.iter().flat_map(|(_, p)| &p.subgoals).any(|s| s.name.name == *name);
        in_plans || goals.any(|g| g.name.name == *name || g.subgoals.iter().any(|s| s.name.name == *name))
    }

    fn subgoal(&mut self, s: &'a ast::SubGoal, agents: &BTreeMap<Name, u32>) -> Option<SubGoal> {
        let Some(by) = &s.agent else {
            if let Some(e) = &s.achieved {
                self.report(
                    Diagnostic::error(code::NO_AGENT, "nobody in particular believes this")
                        .at(e.span, "whose states?")
                        .at(s.name.span, "whoever is allocated pursues it")
                        .hint("leave it out and let the agent say `achieve`, or name the agent: `by AGENT`"),
                );
            }
            return Some(SubGoal {
                name: s.name.name.clone(),
                agent: None,
                achieved: None,
                each_robot: s.each_robot,
                plan: None,
                at: s.name.span,
            });
        };
        if s.each_robot {
            self.report(
                Diagnostic::error(code::SYNTAX, "every robot that runs the agent pursues it anyway")
                    .at(s.name.span, "said for each robot")
                    .at(by.span, "and by whom")
                    .hint("leave out `each robot:`, or leave out `by` and let agents be allocated"),
            );
        }
        let Some(i) = agents.get(&by.name) else {
            let d = unknown(code::UNKNOWN_NAME, "agent", &by.name, by.span, agents.keys().map(|k| &**k));
            self.report(d);
            return None;
        };
        let achieved = match &s.achieved {
            Some(e) => {
                self.enter_agent(*i);
                Some(self.in_body(Body::new(Place::Belief), |c| c.typed(e, &Type::Bool)).0?)
            }
            None => None,
        };
        Some(SubGoal {
            name: s.name.name.clone(),
            agent: Some(*i),
            achieved,
            each_robot: false,
            plan: None,
            at: s.name.span,
        })
    }

    fn library_plan(&mut self, p: &'a ast::LibraryPlan) -> Option<LibraryPlan> {
        self.distinct(p.needs.iter());
        self.distinct(p.subgoals.iter().map(|s| &s.name));
        if p.needs.is_empty() == p.subgoals.is_empty() {
            let (title, hint) = match p.needs.is_empty() {
                true => ("a plan without anything in it", "write what services it needs: `needs SERVICE`"),
                false => (
                    "a plan is for a goal or for a sub-goal",
                    "a plan for a goal has sub-goals, and each of them a plan with the services it needs",
                ),
            };
            self.report(Diagnostic::error(code::NO_PLAN, title).at(p.name.span, "this plan").hint(hint));
        }
        for s in p.subgoals.iter().filter(|s| s.agent.is_some() || s.achieved.is_some()) {
            self.report(
                Diagnostic::error(code::SYNTAX, "sub-goals of a plan are allocated")
                    .at(s.name.span, "says more than its name")
                    .hint("write `subgoal NAME`, and a plan for it"),
            );
        }
        let members = self.decls.agents.iter().flat_map(|a| &a.members);
        let offers = members.filter_map(|m| match m {
            ast::AgentMember::Offers(o, _) => Some(&*o.name),
            _ => None,
        });
        let known: BTreeSet<&str> = offers.collect();
        let is_served = |o: &ast::LibraryPlan| {
            o.target.name == p.target.name
                && !o.needs.is_empty()
                && o.needs.iter().all(|n| known.contains(&*n.name))
        };
        let another = self.decls.plans.iter().any(|(_, o)| is_served(o));
        for n in &p.needs {
            if !known.contains(&*n.name) {
                let mut d = unknown(code::NO_CAPABLE, "service", &n.name, n.span, known.iter().copied());
                d.title = format!("no agent offers `{}`", n.name);
                d.labels[0].text = format!("`{}` needs it", p.name.name);
                if known.is_empty() {
                    d.hint =
                        Some(format!("write `offers {}` in an agent with a service of that name", n.name));
                }
                if another {
                    // The plan cannot be followed, but its sub-goal can be achieved without it.
                    d.severity = Severity::Warning;
                }
                self.report(d);
            }
        }
        let when = match &p.when {
            Some(e) => {
                self.agent = Default::default();
                Some(self.in_body(Body::new(Place::Start), |c| c.typed(e, &Type::Bool)).0?)
            }
            None => None,
        };
        Some(LibraryPlan {
            name: p.name.name.clone(),
            target: p.target.name.clone(),
            when,
            needs: p.needs.iter().map(|n| (n.name.clone(), n.span)).collect(),
            at: p.name.span,
        })
    }
}
