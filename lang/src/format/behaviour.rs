//! Layout of guards, statements and transitions.

use super::build::{Builder, Gap, Hug, Node, Part, children, only_child};
use crate::parse::Rule;

impl Builder<'_, '_> {
    /// Lays out what behaves; all else goes on to the expressions.
    pub fn behaviour(&mut self, rule: Rule, node: Node<'_>) {
        match rule {
            Rule::guarded | Rule::when_stmt | Rule::match_stmt_arm => self.guarded(node),
            Rule::on_enter | Rule::on_exit | Rule::if_stmt | Rule::for_stmt => self.guarded(node),
            Rule::transition => self.transition(node),
            Rule::body => self.body(node),
            _ => self.expression(rule, node),
        }
    }

    /// A condition and what it guards.
    fn guarded(&mut self, node: Node<'_>) {
        let one_line = node.as_rule() != Rule::if_stmt;
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::expr => b.guard(c),
                Rule::block if one_line => b.short_block(c),
                _ => b.node(c),
            },
            p => b.plain(p),
        });
    }

    /// A condition, where it leads, and what is done on the way.
    fn transition(&mut self, node: Node<'_>) {
        let mut head = true;
        self.open();
        self.parts(node, |b, p| match p {
            Part::Own("->") => {
                b.indent(2);
                b.gap(Gap::Line);
                b.token();
                b.dedent();
            }
            Part::Child(c) => match c.as_rule() {
                Rule::expr => b.guard(c),
                Rule::block => {
                    head = false;
                    b.close();
                    b.short_block(c);
                }
                _ => b.node(c),
            },
            p => b.plain(p),
        });
        if head {
            self.close();
        }
    }

    /// A condition: its own further lines are indented twice.
    pub fn guard(&mut self, node: Node<'_>) {
        self.expr(node, 2);
    }

    /// What follows `=>`.
    fn body(&mut self, node: Node<'_>) {
        let Some(inner) = only_child(node) else { return };
        match inner.as_rule() {
            Rule::block => self.short_block(inner),
            _ if is_blocky(&inner) => self.node(inner),
            _ => {
                self.open_value(Hug::Never);
                self.node(inner);
                self.close_value();
            }
        }
    }

    /// A block that may stay on one line if it holds a single plain statement.
    fn short_block(&mut self, node: Node<'_>) {
        let short = only_child(node.clone()).is_some_and(|s| is_plain(&s));
        self.braced(node, if short { Gap::Line } else { Gap::Hard });
    }
}

/// Whether a statement has no statements inside.
pub fn is_plain(stmt: &Node<'_>) -> bool {
    children(stmt.clone()).all(|c| {
        !matches!(
            c.as_rule(),
            Rule::if_stmt | Rule::for_stmt | Rule::match_stmt | Rule::rules_stmt | Rule::when_stmt
        )
    })
}

/// Whether a statement is mostly braces, which open on its first line.
fn is_blocky(stmt: &Node<'_>) -> bool {
    children(stmt.clone())
        .all(|c| matches!(c.as_rule(), Rule::if_stmt | Rule::for_stmt | Rule::match_stmt | Rule::rules_stmt))
}
