//! Items: everything that stands at the top level of a file, and the members of missions.

use super::{Builder, Cursor, Rule, unquote};
use crate::{ast::*, code};
use pest::iterators::Pair;
use soifra_graph::{Diagnostic, Keep, pattern::parse_type};

type P<'i> = Pair<'i, Rule>;

impl Builder {
    pub fn import(&mut self, pair: P<'_>) -> Import {
        let span = self.span(&pair);
        let mut c = Cursor::new(pair);
        match c.any() {
            Some(p) if p.as_rule() == Rule::string => {
                Import { path: unquote(p.as_str()), is_file: true, span }
            }
            p => Import { path: p.map(|p| p.as_str().to_string()).unwrap_or_default(), is_file: false, span },
        }
    }

    pub fn item(&mut self, p: P<'_>) -> Option<Item> {
        Some(match p.as_rule() {
            Rule::mission => Item::Mission(self.mission(p)),
            Rule::agent => Item::Agent(self.agent(p)),
            Rule::platform => Item::Platform(self.profile(p)),
            Rule::world => Item::World(self.profile(p)),
            Rule::record => {
                let mut c = Cursor::new(p);
                let name = self.ident(&mut c);
                let mut fields = Vec::new();
                for f in c.all(Rule::field) {
                    let mut c = Cursor::new(f);
                    fields.push((self.ident(&mut c), self.type_in(&mut c)));
                }
                Item::Record(Record { name, fields })
            }
            Rule::enumeration => {
                let mut c = Cursor::new(p);
                let name = self.ident(&mut c);
                let variants = c.all(Rule::ident).iter().map(|p| self.name(p)).collect();
                Item::Enum(Enum { name, variants })
            }
            Rule::interface => {
                let mut c = Cursor::new(p);
                Item::Interface(Interface {
                    name: self.ident(&mut c),
                    params: self.params(&mut c),
                    result: self.type_in(&mut c),
                })
            }
            Rule::function => Item::Function(self.function(p)),
            Rule::constant => Item::Constant(self.constant(p)),
            Rule::topic => {
                let mut c = Cursor::new(p);
                let (name, ty) = (self.ident(&mut c), self.type_in(&mut c));
                let channel = c.take(Rule::ident).map(|m| {
                    let model = self.name(&m);
                    (model, c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default())
                });
                Item::Topic(Topic { name, ty, channel })
            }
            Rule::protocol => Item::Protocol(self.protocol(p)),
            Rule::conversation => Item::Conversation(self.conversation(p)),
            Rule::param => Item::Param(self.param(p)),
            Rule::library_plan => Item::Plan(self.library_plan(p)),
            Rule::test => Item::Test(self.test(p)),
            _ => return None,
        })
    }

    fn function(&mut self, p: P<'_>) -> Function {
        let mut c = Cursor::new(p);
        let (name, params) = (self.ident(&mut c), self.params(&mut c));
        let result = c.take(Rule::type_ref).map(|t| self.type_ref(t));
        let implements = c.take(Rule::ident).map(|p| self.name(&p));
        let mut lets = Vec::new();
        let body = match c.take(Rule::function_body) {
            Some(b) => {
                let mut c = Cursor::new(b);
                for l in c.all(Rule::let_stmt) {
                    lets.push(self.constant(l));
                }
                self.expr_in(&mut c)
            }
            None => self.expr_in(&mut c),
        };
        Function { name, params, result, implements, lets, body }
    }

    fn metric(&mut self, p: P<'_>) -> Metric {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let Some(p) = c.take(Rule::sampled) else {
            return Metric { name, value: Some(self.expr_in(&mut c)), samples: None };
        };
        let mut c = Cursor::new(p);
        let words = [
            (Rule::K_SUM, Keep::Sum),
            (Rule::K_MEAN, Keep::Mean),
            (Rule::K_LEAST, Keep::Least),
            (Rule::K_MOST, Keep::Most),
        ];
        let keep = words.iter().find(|(w, _)| c.word(*w)).map(|(_, k)| *k);
        let value = keep.is_some().then(|| self.expr_in(&mut c));
        let upon = self.expr_in(&mut c);
        let when = c.take(Rule::sampled_when).map(|p| self.expr_in(&mut Cursor::new(p)));
        Metric { name, value, samples: Some(Samples { keep: keep.unwrap_or(Keep::Sum), upon, when }) }
    }

    /// `let name = value`, `set name = value`: a name and an expression.
    pub fn constant(&mut self, p: P<'_>) -> Constant {
        let mut c = Cursor::new(p);
        Constant { name: self.ident(&mut c), value: self.expr_in(&mut c) }
    }

    fn param(&mut self, p: P<'_>) -> Param {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let ty = c.take(Rule::type_ref).map(|t| self.type_ref(t));
        Param { name, ty, value: self.expr_in(&mut c) }
    }

    /// The parameter list that comes next, empty when there is none.
    pub fn params(&mut self, c: &mut Cursor<'_>) -> Vec<(Ident, TypeRef)> {
        let Some(p) = c.take(Rule::params) else { return Vec::new() };
        let mut out = Vec::new();
        for p in Cursor::new(p).all(Rule::param_decl) {
            let mut c = Cursor::new(p);
            out.push((self.ident(&mut c), self.type_in(&mut c)));
        }
        out
    }

    pub fn type_in(&mut self, c: &mut Cursor<'_>) -> TypeRef {
        match c.take(Rule::type_ref) {
            Some(p) => self.type_ref(p),
            None => TypeRef {
                kind: TypeKind::Bad("no type".into()),
                span: soifra_graph::Span::new(self.file, 0, 0),
            },
        }
    }

    pub fn type_ref(&mut self, p: P<'_>) -> TypeRef {
        let span = self.span(&p);
        let mut c = Cursor::new(p);
        let kind = match c.any() {
            Some(p) if p.as_rule() == Rule::inline_enum => {
                TypeKind::InlineEnum(Cursor::new(p).all(Rule::ident).iter().map(|p| self.name(p)).collect())
            }
            Some(p) if p.as_rule() == Rule::service_type => {
                TypeKind::Service(self.ident(&mut Cursor::new(p)))
            }
            Some(p) => {
                let text: String = type_text(p);
                match parse_type(&text.replace(',', ", ")) {
                    Ok(t) => TypeKind::Named(t),
                    Err(_) if text.len() > 60 => TypeKind::Bad("this is no type".into()),
                    Err(why) => TypeKind::Bad(why),
                }
            }
            None => TypeKind::Bad("no type".into()),
        };
        TypeRef { kind, span }
    }

    fn profile(&mut self, p: P<'_>) -> Profile {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let extends = c.take(Rule::ident).map(|p| self.name(&p));
        let entries = c.all(Rule::entry).into_iter().map(|p| self.entry(p)).collect();
        Profile { name, extends, entries }
    }

    fn entry(&mut self, p: P<'_>) -> Entry {
        let span = self.span(&p);
        let mut c = Cursor::new(p);
        let mut names: Vec<Ident> = c.all(Rule::ident).iter().map(|p| self.name(p)).collect();
        let count = c.take(Rule::count).map(|p| self.expr_in(&mut Cursor::new(p)));
        names.extend(c.all(Rule::ident).iter().map(|p| self.name(p)));
        let args = c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default();
        let missing = || Ident { name: "?".into(), span };
        let model = if names.len() > 1 { names.pop().unwrap_or_else(missing) } else { missing() };
        let mut names = names.into_iter();
        let role = names.next().unwrap_or_else(missing);
        Entry { role, name: names.next(), count, model, args, span }
    }

    fn mission(&mut self, p: P<'_>) -> Mission {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let extends = c.take(Rule::ident).map(|p| self.name(&p));
        let title = c.take(Rule::string).map(|p| unquote(p.as_str()));
        let mut members = Vec::new();
        while let Some(p) = c.any() {
            let span = self.span(&p);
            members.push(match p.as_rule() {
                Rule::param => MissionMember::Param(self.param(p)),
                Rule::clock => MissionMember::Clock(self.expr_in(&mut Cursor::new(p))),
                Rule::robot => MissionMember::Robot(self.robot(p)),
                Rule::host => MissionMember::Host(self.host(p)),
                Rule::goal => MissionMember::Goal(self.goal(p)),
                Rule::done => MissionMember::Done(self.expr_in(&mut Cursor::new(p)), span),
                Rule::within => MissionMember::Within(self.expr_in(&mut Cursor::new(p)), span),
                Rule::expect => MissionMember::Expect(self.expect(p)),
                Rule::metric => MissionMember::Metric(self.metric(p)),
                Rule::constant => MissionMember::Constant(self.constant(p)),
                Rule::world_use => MissionMember::World(self.ident(&mut Cursor::new(p))),
                Rule::entry => MissionMember::Entry(self.entry(p)),
                _ => continue,
            });
        }
        Mission { name, extends, title, members }
    }

    fn robot(&mut self, p: P<'_>) -> Robot {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let count = c.take(Rule::count).map(|p| self.expr_in(&mut Cursor::new(p)));
        let platforms =
            c.take(Rule::platform_choice).map(|p| Cursor::new(p).all(Rule::ident)).unwrap_or_default();
        let platforms = platforms.iter().map(|p| self.name(p)).collect();
        let at = self.expr_in(&mut c);
        let target = c.take(Rule::robot_target).map(|p| self.expr_in(&mut Cursor::new(p)));
        let scatter = c.take(Rule::robot_scatter).map(|p| self.expr_in(&mut Cursor::new(p)));
        let runs = self.runs(&mut c);
        Robot { name, count, platforms, at, target, scatter, runs }
    }

    fn host(&mut self, p: P<'_>) -> Host {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let count = c.take(Rule::count).map(|p| self.expr_in(&mut Cursor::new(p)));
        Host { name, count, runs: self.runs(&mut c) }
    }

    /// Agents with their arguments.
    fn runs(&mut self, c: &mut Cursor<'_>) -> Vec<(Ident, Vec<Arg>)> {
        let mut runs = Vec::new();
        if let Some(p) = c.take(Rule::robot_runs) {
            for b in Cursor::new(p).all(Rule::binding) {
                let mut c = Cursor::new(b);
                let agent = self.ident(&mut c);
                runs.push((agent, c.take(Rule::args).map(|a| self.args(a)).unwrap_or_default()));
            }
        }
        runs
    }

    fn goal(&mut self, p: P<'_>) -> Goal {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let on_request = c.take(Rule::goal_request).is_some();
        let subgoals = c.all(Rule::subgoal).into_iter().map(|p| self.subgoal(p)).collect();
        Goal { name, on_request, subgoals }
    }

    fn subgoal(&mut self, p: P<'_>) -> SubGoal {
        let mut c = Cursor::new(p);
        let each_robot = c.take(Rule::expect_each).is_some();
        let name = self.ident(&mut c);
        let agent = c.take(Rule::subgoal_by).map(|p| self.ident(&mut Cursor::new(p)));
        let achieved = c.take(Rule::expr).map(|e| self.expr(e));
        SubGoal { name, each_robot, agent, achieved }
    }

    fn library_plan(&mut self, p: P<'_>) -> LibraryPlan {
        let mut c = Cursor::new(p);
        let (name, target) = (self.ident(&mut c), self.ident(&mut c));
        let when = c.take(Rule::plan_when).map(|p| self.expr_in(&mut Cursor::new(p)));
        let (mut needs, mut subgoals) = (Vec::new(), Vec::new());
        while let Some(p) = c.any() {
            match p.as_rule() {
                Rule::needs => {
                    needs.extend(Cursor::new(p).all(Rule::ident).iter().map(|p| self.name(p)));
                }
                Rule::subgoal => subgoals.push(self.subgoal(p)),
                _ => {}
            }
        }
        LibraryPlan { name, target, when, needs, subgoals }
    }

    fn expect(&mut self, p: P<'_>) -> Expect {
        let span = self.span(&p);
        let mut c = Cursor::new(p);
        let each_robot = c.take(Rule::expect_each).is_some();
        let kind = match c.any() {
            None => ExpectKind::Finally(self.expr_in(&mut c)),
            Some(p) => {
                let rule = p.as_rule();
                let mut c = Cursor::new(p);
                let a = self.expr_in(&mut c);
                match rule {
                    Rule::expect_always => ExpectKind::Always(a),
                    Rule::expect_never => ExpectKind::Never(a),
                    Rule::expect_eventually => ExpectKind::Eventually(a, self.within(&mut c)),
                    Rule::expect_until => ExpectKind::Until(a, self.expr_in(&mut c)),
                    Rule::expect_leads => {
                        let b = self.expr_in(&mut c);
                        ExpectKind::LeadsTo(a, b, self.within(&mut c))
                    }
                    _ => ExpectKind::Finally(a),
                }
            }
        };
        Expect { each_robot, kind, span }
    }

    fn within(&mut self, c: &mut Cursor<'_>) -> Option<Expr> {
        c.take(Rule::within).map(|p| self.expr_in(&mut Cursor::new(p)))
    }

    fn test(&mut self, p: P<'_>) -> Test {
        let mut c = Cursor::new(p);
        let name = self.ident(&mut c);
        let mut t = Test {
            name,
            run: Vec::new(),
            seeds: None,
            sets: Vec::new(),
            outcome: None,
            expects: Vec::new(),
            faults: Vec::new(),
        };
        while let Some(p) = c.any() {
            let (rule, span) = (p.as_rule(), self.span(&p));
            match rule {
                Rule::test_run => t.run.push(self.ident(&mut Cursor::new(p))),
                Rule::test_seeds if t.seeds.is_some() => self.errors.push(
                    Diagnostic::error(code::DUPLICATE, "a test has one `seeds`")
                        .at(span, "the second")
                        .hint("remove one of them"),
                ),
                Rule::test_seeds => t.seeds = Some(self.expr_in(&mut Cursor::new(p))),
                Rule::test_set => t.sets.push(self.constant(p)),
                Rule::entry => t.faults.push(self.entry(p)),
                Rule::test_outcome => t.outcome = Some(self.ident(&mut Cursor::new(p))),
                Rule::test_expect => t.expects.push(self.expr_in(&mut Cursor::new(p))),
                _ => {}
            }
        }
        t
    }
}

/// A type as it is written, without blanks and comments.
fn type_text(p: P<'_>) -> String {
    let (mut out, from, text) = (String::new(), p.as_span().start(), p.as_str());
    let mut at = 0;
    for c in p.into_inner().flatten().filter(|p| p.as_rule() == Rule::COMMENT) {
        let span = c.as_span();
        out.push_str(&text[at..span.start() - from]);
        at = span.end() - from;
    }
    out.push_str(&text[at..]);
    out.retain(|c| !c.is_whitespace());
    out
}
