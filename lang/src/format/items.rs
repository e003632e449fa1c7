//! Layout of items, members and everything in brackets or braces.

use super::build::{Builder, Gap, Node, Part, children, only_child};
use crate::parse::Rule;

impl Builder<'_, '_> {
    /// Lays out any node. What no rule is given for stays on one line.
    pub fn node(&mut self, node: Node<'_>) {
        match node.as_rule() {
            Rule::record
            | Rule::platform
            | Rule::world
            | Rule::mission
            | Rule::test
            | Rule::agent
            | Rule::protocol
            | Rule::protocol_state
            | Rule::machine
            | Rule::machine_state
            | Rule::plan
            | Rule::library_plan
            | Rule::function_body
            | Rule::rules_stmt
            | Rule::match_stmt
            | Rule::match_expr
            | Rule::by_priority
            | Rule::by_blend
            | Rule::by_layers
            | Rule::block => self.braced(node, Gap::Hard),
            Rule::enumeration | Rule::inline_enum => self.braced(node, Gap::Line),
            Rule::goal => {
                let one = children(node.clone()).filter(|c| c.as_rule() == Rule::subgoal).count() == 1;
                self.braced(node, if one { Gap::Line } else { Gap::Hard });
            }
            Rule::plan_control => {
                let gap = if has_single_leaf(&node) { Gap::Line } else { Gap::Hard };
                self.braced(node, gap);
            }
            Rule::refine_stmt => self.refine(node),
            Rule::robot => self.robot(node),
            Rule::robot_runs | Rule::expect_leads | Rule::expect_until => self.clauses(node),
            Rule::subgoal | Rule::layer | Rule::expect_eventually => self.grouped_clauses(node),
            Rule::expect => self.expect(node),
            Rule::service | Rule::action => self.headed(node),
            Rule::type_name | Rule::protocol_contents => self.type_name(node),
            Rule::open_stmt | Rule::reply_stmt => self.talk(node),
            Rule::params | Rule::args | Rule::tuple | Rule::list => self.bracketed(node),
            Rule::by_switch | Rule::layer_suppresses | Rule::platform_choice => self.bracketed(node),
            Rule::count => {
                self.gap(Gap::Tight);
                self.parts(node, |b, p| b.plain(p));
            }
            Rule::entry | Rule::topic | Rule::conversation => self.parts(node, |b, p| b.plain(p)),
            Rule::constant
            | Rule::param
            | Rule::slot
            | Rule::metric
            | Rule::test_set
            | Rule::let_stmt
            | Rule::use_stmt
            | Rule::set_stmt
            | Rule::command_stmt
            | Rule::publish_stmt
            | Rule::tell_stmt
            | Rule::note_stmt
            | Rule::plan_when
            | Rule::offer_when
            | Rule::function
            | Rule::done
            | Rule::weighted
            | Rule::plan_check
            | Rule::plan_wait_until => self.valued(node),
            Rule::match_arm => self.valued(node),
            rule => self.behaviour(rule, node),
        }
    }

    /// A part as it comes.
    pub fn plain(&mut self, part: Part<'_, '_>) {
        match part {
            Part::Own(_) => self.token(),
            Part::Child(c) => self.node(c),
        }
    }

    /// A node whose expression moves to the next line as a whole when it is too long.
    fn valued(&mut self, node: Node<'_>) {
        self.parts(node, |b, p| match p {
            Part::Child(c) if c.as_rule() == Rule::expr => b.value(c),
            p => b.plain(p),
        });
    }

    /// A header and members in braces, with `gap` around the members.
    ///
    /// Timing clauses of the header go on lines of their own when it is too long.
    pub fn braced(&mut self, node: Node<'_>, gap: Gap) {
        let (mut inside, mut empty) = (false, true);
        let timed = children(node.clone()).any(|c| c.as_rule() == Rule::timing);
        if timed {
            self.open();
        }
        self.parts(node, |b, p| match p {
            Part::Own("{") if !inside => {
                if timed {
                    b.close();
                }
                inside = true;
                b.gap_or(Gap::Space);
                b.open();
                b.token();
                b.indent(1);
            }
            Part::Own("}") => {
                b.dedent();
                b.gap(if empty && !b.comment_next() { Gap::Tight } else { gap });
                b.token();
                b.close();
            }
            Part::Child(c) if inside => {
                empty = false;
                b.gap(gap);
                b.node(c);
            }
            Part::Child(c) if c.as_rule() == Rule::expr => b.guard(c),
            Part::Child(c) if c.as_rule() == Rule::timing => b.clause(c, 2),
            p => b.plain(p),
        });
    }

    /// A header, whose clauses go on lines of their own when it is too long, and a block.
    fn headed(&mut self, node: Node<'_>) {
        let mut header = true;
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::block if header => {
                    header = false;
                    b.close();
                    b.node(c);
                }
                Rule::timing | Rule::action_until | Rule::action_fails => b.clause(c, 2),
                _ => b.node(c),
            },
            p => b.plain(p),
        });
    }

    /// A clause that goes on a line of its own when its group is broken.
    fn clause(&mut self, node: Node<'_>, levels: usize) {
        self.indent(levels);
        self.gap(Gap::Line);
        self.parts(node, |b, p| match p {
            Part::Child(c) if c.as_rule() == Rule::expr => b.expr(c, 1),
            p => b.plain(p),
        });
        self.dedent();
    }

    /// A head and clauses; the group is the caller's.
    fn clauses(&mut self, node: Node<'_>) {
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::K_ACHIEVED | Rule::K_LEADS | Rule::K_UNTIL => {
                    b.indent(1);
                    b.gap(Gap::Line);
                    b.node(c);
                    b.dedent();
                }
                Rule::within | Rule::layer_suppresses | Rule::layer_for | Rule::layer_inhibited => {
                    b.clause(c, 1);
                }
                Rule::binding => {
                    b.indent(1);
                    b.gap(if b.follows_comma() { Gap::Line } else { Gap::Space });
                    b.node(c);
                    b.dedent();
                }
                Rule::expr => b.expr(c, 2),
                _ => b.node(c),
            },
            p => b.plain(p),
        });
    }

    fn grouped_clauses(&mut self, node: Node<'_>) {
        self.open();
        self.clauses(node);
        self.close();
    }

    /// What is said to whom, in clauses that go on lines of their own when it is too long.
    fn talk(&mut self, node: Node<'_>) {
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::K_TO => {
                    b.indent(1);
                    b.gap(Gap::Line);
                    b.node(c);
                    b.dedent();
                }
                Rule::open_within | Rule::reply_in => b.clause(c, 1),
                Rule::expr => b.expr(c, 1),
                _ => b.node(c),
            },
            p => b.plain(p),
        });
        self.close();
    }

    /// What is improved, how, and for what price, each on a line of its own when it is too long.
    fn refine(&mut self, node: Node<'_>) {
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::K_BY | Rule::K_COST => {
                    b.indent(1);
                    b.gap(Gap::Line);
                    b.node(c);
                    b.dedent();
                }
                Rule::refine_until => b.clause(c, 1),
                Rule::expr => b.expr(c, 2),
                _ => b.node(c),
            },
            p => b.plain(p),
        });
        self.close();
    }

    fn expect(&mut self, node: Node<'_>) {
        let whole = |r| matches!(r, Rule::expect_always | Rule::expect_never | Rule::expect_finally);
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) if whole(c.as_rule()) => b.valued(c),
            p => b.plain(p),
        });
        self.close();
    }

    /// What it runs goes on the next line first; where it stands and goes only when that is not enough.
    fn robot(&mut self, node: Node<'_>) {
        let mut inner = true;
        self.open();
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::K_AT => {
                    b.indent(1);
                    b.gap(Gap::Line);
                    b.node(c);
                    b.dedent();
                }
                Rule::expr => {
                    b.indent(1);
                    b.expr(c, 1);
                    b.dedent();
                }
                Rule::robot_target | Rule::robot_scatter => b.clause(c, 1),
                Rule::robot_runs => {
                    inner = false;
                    b.close();
                    b.indent(1);
                    b.gap(Gap::Line);
                    b.open();
                    b.node(c);
                    b.close();
                    b.dedent();
                }
                _ => b.node(c),
            },
            p => b.plain(p),
        });
        if inner {
            self.close();
        }
        self.close();
    }

    fn type_name(&mut self, node: Node<'_>) {
        self.parts(node, |b, p| match p {
            Part::Own(text @ ("<" | ">" | "?")) => {
                b.gap(Gap::Tight);
                b.token();
                if text == "<" {
                    b.gap(Gap::Tight);
                }
            }
            p => b.plain(p),
        });
    }

    /// A head, perhaps, and parts in brackets: on one line, or one a line; plain numbers fill their lines.
    fn bracketed(&mut self, node: Node<'_>) {
        if matches!(node.as_rule(), Rule::params | Rule::args) {
            self.gap(Gap::Tight);
        }
        let parts: Vec<_> = children(node.clone()).filter(|c| is_part(c.as_rule())).collect();
        let fill = parts.len() > 1 && parts.iter().all(super::values::is_literal);
        // A bracket right inside another shares its indentation, and so does what a function argument gives.
        let lambda = parts.len() == 1 && parts.iter().all(super::values::is_lambda);
        let alone = lambda || parts.len() == 1 && parts.iter().all(super::values::is_bracket);
        let (mut inside, mut last) = (false, None);
        self.parts(node, |b, p| match p {
            Part::Own("(" | "[") if !inside => {
                inside = true;
                b.open();
                b.token();
                if !alone {
                    b.indent(1);
                }
            }
            Part::Own(")" | "]") => {
                b.end_fill(last);
                if !alone {
                    b.dedent();
                }
                let empty = parts.is_empty() && !b.comment_next();
                b.gap(if lambda {
                    Gap::AfterValue
                } else if alone || empty {
                    Gap::Tight
                } else {
                    Gap::Soft
                });
                b.token();
                b.close();
            }
            Part::Child(c) if inside => {
                match (alone, b.follows_comma()) {
                    (true, _) => b.gap(Gap::Tight),
                    (_, false) => b.gap(Gap::Soft),
                    (_, true) if fill => last = Some(b.fill(last)),
                    (_, true) => b.gap(Gap::Line),
                }
                match c.as_rule() {
                    // Inside plain brackets nothing but the expression needs its place.
                    Rule::expr if parts.len() == 1 => b.expr(c, 0),
                    _ => b.node(c),
                }
            }
            p => b.plain(p),
        });
    }
}

fn is_part(rule: Rule) -> bool {
    matches!(rule, Rule::expr | Rule::arg | Rule::param_decl | Rule::ident | Rule::source)
}

/// Whether a plan node has a single child that is no node with children.
fn has_single_leaf(node: &Node<'_>) -> bool {
    let mut inner = children(node.clone()).filter(|c| c.as_rule() == Rule::plan_node);
    let (Some(first), None) = (inner.next(), inner.next()) else { return false };
    only_child(first).is_some_and(|c| match c.as_rule() {
        Rule::plan_control => false,
        Rule::stmt => super::behaviour::is_plain(&c),
        _ => true,
    })
}
