//! Layout of expressions.

use super::build::{Builder, Gap, Hug, Node, Part, children, only_child};
use crate::parse::{Rule, infix_power};

/// An operand of a chain, with the operator before it and the `is` tests after it.
struct Link<'i> {
    infix: Option<Node<'i>>,
    power: u8,
    operand: Node<'i>,
    tests: Vec<Node<'i>>,
}

impl Builder<'_, '_> {
    /// Lays out parts of expressions; all else stays on one line.
    pub fn expression(&mut self, rule: Rule, node: Node<'_>) {
        match rule {
            Rule::expr => self.expr(node, 1),
            Rule::operand => self.operand(node, 1),
            Rule::lambda => self.lambda(node),
            Rule::if_expr => self.if_expr(node),
            Rule::arg => self.arg(node),
            Rule::some_expr | Rule::is_test | Rule::pattern | Rule::on_told | Rule::on_topic => {
                self.parts(node, |b, p| {
                    if let Part::Own("(") = p {
                        b.gap(Gap::Tight);
                    }
                    b.plain(p);
                });
            }
            _ => self.parts(node, |b, p| b.plain(p)),
        }
    }

    /// An expression that may move to the next line as a whole.
    pub fn value(&mut self, node: Node<'_>) {
        self.open_value(hug(&node));
        self.expr(node, 0);
        self.close_value();
    }

    /// An expression whose further lines are indented by `levels`.
    pub fn expr(&mut self, node: Node<'_>, levels: usize) {
        let mut links: Vec<Link<'_>> = Vec::new();
        let mut infix = None;
        for c in children(node) {
            match (c.as_rule(), links.last_mut()) {
                (Rule::infix, _) => infix = Some(c),
                (Rule::is_test, Some(link)) => link.tests.push(c),
                _ => {
                    let infix = infix.take();
                    let power = infix.as_ref().map_or(0, |i: &Node<'_>| infix_power(i.as_str().trim()));
                    links.push(Link { infix, power, operand: c, tests: Vec::new() });
                }
            }
        }
        self.chain(&links, levels);
    }

    /// Breaks a chain before its loosest operators; what binds tighter is a group of its own.
    fn chain(&mut self, links: &[Link<'_>], levels: usize) {
        let Some(loosest) = links.iter().skip(1).map(|l| l.power).min() else {
            for link in links {
                self.operand(link.operand.clone(), levels.max(1));
                for test in &link.tests {
                    self.node(test.clone());
                }
            }
            return;
        };
        self.open();
        let mut from = 0;
        let ends = (1..links.len()).filter(|i| links[*i].power == loosest).chain([links.len()]);
        for to in ends.collect::<Vec<_>>() {
            if from == 0 {
                self.chain(&links[..to], 1);
                self.indent(levels);
            } else {
                let tight = links[from].infix.as_ref().is_some_and(|i| i.as_str().trim() == "^")
                    && !ends_in_unit(&links[from - 1].operand);
                self.gap(if tight { Gap::Tight } else { Gap::Line });
                if let Some(infix) = &links[from].infix {
                    self.node(infix.clone());
                }
                self.gap(if tight { Gap::Tight } else { Gap::Space });
                self.chain(&links[from..to], 1);
            }
            from = to;
        }
        self.dedent();
        self.close();
    }

    /// Signs, a primary, and what is called on it; several calls on each other go one a line, indented by
    /// `levels`.
    fn operand(&mut self, node: Node<'_>, levels: usize) {
        if method_calls(&node) < 2 {
            self.parts(node, |b, p| b.sign_or_plain(p));
            return;
        }
        let posts: Vec<_> = children(node.clone()).filter(|c| c.as_rule() == Rule::postfix).collect();
        let called = |i: usize| is_field(&posts[i]) && posts.get(i + 1).is_some_and(is_call);
        let (mut post, mut indented) = (0, false);
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) if c.as_rule() == Rule::postfix => {
                if called(post) {
                    if !indented {
                        b.indent(levels);
                        indented = true;
                    }
                    b.gap(Gap::Soft);
                }
                post += 1;
                b.node(c);
            }
            p => b.sign_or_plain(p),
        });
        self.dedent();
        self.close();
    }

    /// A function argument. What it gives may move to the next line; calls on each other do so together.
    fn lambda(&mut self, node: Node<'_>) {
        self.parts(node, |b, p| match p {
            Part::Child(c) if c.as_rule() == Rule::expr => {
                let hug = if is_call_chain(&c) { Hug::Never } else { hug(&c) };
                b.open_value(hug);
                b.expr(c, 0);
                b.close_value();
            }
            p => b.plain(p),
        });
    }

    fn sign_or_plain(&mut self, part: Part<'_, '_>) {
        match part {
            Part::Child(c) if c.as_rule() == Rule::prefix && c.as_str().starts_with('-') => {
                self.node(c);
                self.gap(Gap::Tight);
            }
            p => self.plain(p),
        }
    }

    /// Breaks before each `else`; before `then` only where what follows then fits on the line.
    fn if_expr(&mut self, node: Node<'_>) {
        let exprs: Vec<_> = children(node.clone()).filter(|c| c.as_rule() == Rule::expr).collect();
        let (mut seen, mut condition, mut value) = (0, false, false);
        self.open();
        self.parts(node, |b, p| match p {
            Part::Child(c) => match c.as_rule() {
                Rule::K_IF => {
                    condition = true;
                    b.node(c);
                }
                Rule::K_THEN => {
                    (condition, value) = (false, true);
                    let hug = exprs.get(seen).map_or(Hug::Never, hug);
                    b.open_value(if hug == Hug::Always { Hug::IfTooLong } else { hug });
                    b.node(c);
                }
                Rule::K_ELSE => {
                    b.gap(Gap::Line);
                    b.node(c);
                }
                Rule::expr => {
                    seen += 1;
                    if condition {
                        b.guard(c);
                    } else if value {
                        b.expr(c, 1);
                        b.close_value();
                        value = false;
                    } else {
                        b.value(c);
                    }
                }
                _ => b.node(c),
            },
            p => b.plain(p),
        });
        self.close();
    }

    /// A named argument's value may move to the next line.
    fn arg(&mut self, node: Node<'_>) {
        let named = children(node.clone()).next().is_some_and(|c| c.as_rule() == Rule::ident);
        self.parts(node, |b, p| match p {
            Part::Child(c) if named && c.as_rule() == Rule::expr => b.value(c),
            p => b.plain(p),
        });
    }
}

/// How a value is laid out that does not fit beside what it belongs to.
pub fn hug(expr: &Node<'_>) -> Hug {
    let Some(operand) = only_child(expr.clone()).filter(|c| c.as_rule() == Rule::operand) else {
        return Hug::Never;
    };
    if method_calls(&operand) > 1 {
        return Hug::Always;
    }
    let Some(last) = children(operand).last() else { return Hug::Never };
    let Some(inner) = children(last).next() else { return Hug::Never };
    match inner.as_rule() {
        Rule::args => {
            let mut args = children(inner).peekable();
            let some = args.peek().is_some();
            let named = args.all(|a| children(a).next().is_some_and(|c| c.as_rule() == Rule::ident));
            if some && named { Hug::Always } else { Hug::IfTooLong }
        }
        Rule::list | Rule::match_expr => Hug::Always,
        Rule::tuple if only_child(inner.clone()).is_none() => Hug::Always,
        Rule::some_expr => Hug::IfTooLong,
        _ => Hug::Never,
    }
}

/// Whether an expression is several calls on each other.
fn is_call_chain(expr: &Node<'_>) -> bool {
    only_child(expr.clone()).is_some_and(|o| method_calls(&o) > 1)
}

/// How many calls on a value an operand has, as `.first()`.
fn method_calls(operand: &Node<'_>) -> usize {
    let mut after_field = false;
    children(operand.clone())
        .filter(|c| {
            let call = after_field && is_call(c);
            after_field = c.as_rule() == Rule::postfix && is_field(c);
            call
        })
        .count()
}

fn is_call(postfix: &Node<'_>) -> bool {
    children(postfix.clone()).next().is_some_and(|c| c.as_rule() == Rule::args)
}

fn is_field(postfix: &Node<'_>) -> bool {
    children(postfix.clone()).next().is_some_and(|c| c.as_rule() == Rule::ident)
}

/// The only primary of an expression without operators or calls; signs do not count.
fn bare<'i>(expr: &Node<'i>) -> Option<Node<'i>> {
    let expr = match expr.as_rule() {
        Rule::arg => only_child(expr.clone())?,
        _ => expr.clone(),
    };
    let operand = only_child(expr).filter(|c| c.as_rule() == Rule::operand)?;
    let last = children(operand).last().filter(|c| c.as_rule() == Rule::primary)?;
    children(last).next()
}

/// Whether an expression is a plain number or text, or a point of plain numbers.
pub fn is_literal(expr: &Node<'_>) -> bool {
    bare(expr).is_some_and(|p| match p.as_rule() {
        Rule::quantity | Rule::boolean | Rule::string => true,
        Rule::tuple => children(p).all(|c| is_literal(&c)),
        _ => false,
    })
}

/// Whether an argument is a function without a name.
pub fn is_lambda(arg: &Node<'_>) -> bool {
    arg.as_rule() == Rule::arg && only_child(arg.clone()).is_some_and(|c| c.as_rule() == Rule::lambda)
}

/// Whether an expression is a list or `match`, or a point.
pub fn is_bracket(expr: &Node<'_>) -> bool {
    let signs = children(expr.clone()).next().and_then(|o| children(o).next());
    signs.is_some_and(|c| c.as_rule() != Rule::prefix)
        && bare(expr).is_some_and(|p| match p.as_rule() {
            Rule::list | Rule::match_expr => true,
            Rule::tuple => only_child(p).is_none(),
            _ => false,
        })
}

/// Whether a quantity with a unit ends an operand: a `^` right after it would belong to the unit.
fn ends_in_unit(operand: &Node<'_>) -> bool {
    children(operand.clone())
        .last()
        .and_then(|p| children(p).next())
        .is_some_and(|p| p.as_rule() == Rule::quantity && children(p).count() > 1)
}
