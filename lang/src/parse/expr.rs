//! Expressions: operator precedence is climbed here, the grammar lists operands and operators flat.

use super::{Builder, Cursor, MAX_CHAIN, Rule, unquote};
use crate::{ast::*, code};
use pest::iterators::Pair;
use soifra_graph::{Binary, Diagnostic, Dim, Quantifier, QuantityUnit, Span, did_you_mean, dim::unit_names};

/// An operator between operands, loosest first.
#[derive(Clone, Copy, PartialEq)]
enum Infix {
    Binary(Binary),
    Range,
    Power,
}

fn infix(text: &str) -> (Infix, u8) {
    use Binary as B;
    match text {
        "or" => (Infix::Binary(B::Or), 1),
        "and" => (Infix::Binary(B::And), 2),
        "<" => (Infix::Binary(B::Lt), 4),
        "<=" => (Infix::Binary(B::Le), 4),
        ">" => (Infix::Binary(B::Gt), 4),
        ">=" => (Infix::Binary(B::Ge), 4),
        "==" => (Infix::Binary(B::Eq), 4),
        "!=" => (Infix::Binary(B::Ne), 4),
        ".." => (Infix::Range, 5),
        "+" => (Infix::Binary(B::Add), 6),
        "-" => (Infix::Binary(B::Sub), 6),
        "*" => (Infix::Binary(B::Mul), 7),
        "/" => (Infix::Binary(B::Div), 7),
        _ => (Infix::Power, 9),
    }
}

/// How tightly an operator binds.
pub(crate) fn infix_power(text: &str) -> u8 {
    infix(text).1
}

const COMPARISON: u8 = 4;
const NOT: u8 = 3;
const MINUS: u8 = 8;

/// Operands, operators and `is` tests of one expression, in order.
enum Piece<'i> {
    Operand(Vec<Pair<'i, Rule>>, Pair<'i, Rule>),
    Infix(Infix, u8),
    Is(bool, Option<Ident>, Span),
}

impl Builder {
    /// The next part, which must be an expression.
    pub fn expr_in(&mut self, c: &mut Cursor<'_>) -> Expr {
        match c.take(Rule::expr) {
            Some(p) => self.expr(p),
            None => Expr { kind: Box::new(ExprKind::Bad), span: Span::new(self.file, 0, 0) },
        }
    }

    pub fn expr(&mut self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let mut pieces = Vec::new();
        for p in pair.into_inner() {
            match p.as_rule() {
                Rule::operand => {
                    let mut prefixes = Vec::new();
                    let mut rest = p.clone().into_inner().peekable();
                    while let Some(x) = rest.next_if(|x| matches!(x.as_rule(), Rule::prefix | Rule::COMMENT))
                    {
                        if x.as_rule() == Rule::prefix {
                            prefixes.push(x);
                        }
                    }
                    pieces.push(Piece::Operand(prefixes, p));
                }
                Rule::infix => {
                    let (op, power) = infix(p.as_str().trim());
                    pieces.push(Piece::Infix(op, power));
                }
                Rule::is_test => {
                    let at = self.span(&p);
                    let mut c = Cursor::new(p);
                    c.word(Rule::K_IS);
                    let some = c.word(Rule::K_SOME);
                    let name = c.take(Rule::ident).map(|p| self.name(&p));
                    pieces.push(Piece::Is(some, name, at));
                }
                _ => {}
            }
        }
        if pieces.len() > 2 * MAX_CHAIN {
            self.errors.push(
                Diagnostic::error(code::NESTING, format!("an expression of more than {MAX_CHAIN} operators"))
                    .at(span, "too long a chain")
                    .hint("give parts of it names with `let`"),
            );
            return Expr { kind: Box::new(ExprKind::Bad), span };
        }
        let mut pieces = pieces.into_iter().peekable();
        self.climb(&mut pieces, 0)
    }

    fn climb(&mut self, pieces: &mut std::iter::Peekable<std::vec::IntoIter<Piece<'_>>>, least: u8) -> Expr {
        let Some(Piece::Operand(prefixes, operand)) = pieces.next() else {
            return Expr { kind: Box::new(ExprKind::Bad), span: Span::new(self.file, 0, 0) };
        };
        let mut left = self.prefixed(&prefixes, operand, pieces);
        loop {
            match pieces.peek() {
                Some(Piece::Is(..)) if least <= COMPARISON => {
                    let Some(Piece::Is(some, name, at)) = pieces.next() else { break };
                    let span = left.span.to(at);
                    left = Expr { kind: Box::new(ExprKind::Is(left, some, name)), span };
                }
                Some(Piece::Infix(_, power)) if *power >= least => {
                    let Some(Piece::Infix(op, power)) = pieces.next() else { break };
                    // Powers bind to the right, all others to the left.
                    let right = self.climb(pieces, if op == Infix::Power { power } else { power + 1 });
                    let span = left.span.to(right.span);
                    let kind = match op {
                        Infix::Binary(b) => ExprKind::Binary(b, left, right),
                        Infix::Range => ExprKind::Range(left, right),
                        Infix::Power => ExprKind::Power(left, right),
                    };
                    left = Expr { kind: Box::new(kind), span };
                }
                _ => break,
            }
        }
        left
    }

    fn prefixed(
        &mut self,
        prefixes: &[Pair<'_, Rule>],
        operand: Pair<'_, Rule>,
        pieces: &mut std::iter::Peekable<std::vec::IntoIter<Piece<'_>>>,
    ) -> Expr {
        let mut e = self.operand(operand);
        if prefixes.len() > MAX_CHAIN {
            self.errors.push(
                Diagnostic::error(code::NESTING, format!("more than {MAX_CHAIN} signs before a value"))
                    .at(e.span, "too long a chain")
                    .hint("leave out the signs that cancel"),
            );
            return e;
        }
        // `-a ^ 2` is `-(a ^ 2)`; `not a < b` is `not (a < b)`: the operators that bind tighter come first.
        for p in prefixes.iter().rev() {
            let at = self.span(p);
            let minus = p.as_str().starts_with('-');
            let tighter = if minus { MINUS } else { NOT + 1 };
            while let Some(Piece::Infix(_, power)) = pieces.peek() {
                if *power < tighter {
                    break;
                }
                let Some(Piece::Infix(op, power)) = pieces.next() else { break };
                let right = self.climb(pieces, if op == Infix::Power { power } else { power + 1 });
                let span = e.span.to(right.span);
                let kind = match op {
                    Infix::Binary(b) => ExprKind::Binary(b, e, right),
                    Infix::Range => ExprKind::Range(e, right),
                    Infix::Power => ExprKind::Power(e, right),
                };
                e = Expr { kind: Box::new(kind), span };
            }
            if !minus
                && let Some(Piece::Is(..)) = pieces.peek()
                && let Some(Piece::Is(some, name, to)) = pieces.next()
            {
                let span = e.span.to(to);
                e = Expr { kind: Box::new(ExprKind::Is(e, some, name)), span };
            }
            let span = at.to(e.span);
            e = Expr { kind: Box::new(if minus { ExprKind::Neg(e) } else { ExprKind::Not(e) }), span };
        }
        e
    }

    fn operand(&mut self, pair: Pair<'_, Rule>) -> Expr {
        let mut c = Cursor::new(pair);
        while c.take(Rule::prefix).is_some() {}
        let Some(p) = c.take(Rule::primary) else {
            return Expr { kind: Box::new(ExprKind::Bad), span: Span::new(self.file, 0, 0) };
        };
        let mut e = self.primary(p);
        let mut links = 0;
        while let Some(p) = c.take(Rule::postfix) {
            links += 1;
            if links > MAX_CHAIN {
                self.errors.push(
                    Diagnostic::error(code::NESTING, "too long a chain of calls")
                        .at(self.span(&p), "too many")
                        .hint("give parts of it names with `let`"),
                );
                break;
            }
            let span = e.span.to(self.span(&p));
            let Some(inner) = Cursor::new(p).any() else { continue };
            let kind = match inner.as_rule() {
                Rule::ident => ExprKind::Field(e, self.name(&inner)),
                _ => {
                    let args = self.args(inner);
                    match *e.kind {
                        ExprKind::Name(name) => ExprKind::Call(Ident { name, span: e.span }, args),
                        ExprKind::Field(on, name) => ExprKind::Method(on, name, args),
                        ExprKind::Bad => ExprKind::Bad,
                        _ => {
                            self.errors.push(
                                Diagnostic::error(code::SYNTAX, "only a function can be called")
                                    .at(e.span, "this is a value")
                                    .hint("to multiply, write `*` between the value and the bracket"),
                            );
                            ExprKind::Bad
                        }
                    }
                }
            };
            e = Expr { kind: Box::new(kind), span };
        }
        e
    }

    pub fn args(&mut self, pair: Pair<'_, Rule>) -> Vec<Arg> {
        let mut c = Cursor::new(pair);
        let mut out = Vec::new();
        for p in c.all(Rule::arg) {
            let mut c = Cursor::new(p);
            let name = c.take(Rule::ident).map(|p| self.name(&p));
            if let Some(l) = c.take(Rule::lambda) {
                let mut c = Cursor::new(l);
                let params =
                    c.take(Rule::lambda_params).map(|p| Cursor::new(p).all(Rule::ident)).unwrap_or_default();
                let params = params.iter().map(|p| self.name(p)).collect();
                let value = self.expr_in(&mut c);
                out.push(Arg { name, lambda: Some(params), value });
            } else {
                let value = self.expr_in(&mut c);
                out.push(Arg { name, lambda: None, value });
            }
        }
        out
    }

    fn primary(&mut self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let Some(p) = pair.into_inner().find(|p| p.as_rule() != Rule::COMMENT) else {
            return Expr { kind: Box::new(ExprKind::Bad), span };
        };
        let text = p.as_str().trim();
        let kind = match p.as_rule() {
            Rule::ident => ExprKind::Name(self.name(&p).name),
            Rule::quantity => self.quantity(p),
            Rule::string => ExprKind::Text(unquote(text)),
            Rule::boolean => ExprKind::Bool(text == "true"),
            Rule::list => {
                ExprKind::List(Cursor::new(p).all(Rule::expr).into_iter().map(|p| self.expr(p)).collect())
            }
            Rule::tuple => {
                let mut items: Vec<Expr> =
                    Cursor::new(p).all(Rule::expr).into_iter().map(|p| self.expr(p)).collect();
                match items.len() {
                    1 => return Expr { span, ..items.swap_remove(0) },
                    2 | 3 => ExprKind::Tuple(items),
                    n => {
                        self.errors.push(
                            Diagnostic::error(code::SYNTAX, format!("a point or vector of {n} parts"))
                                .at(span, "two or three parts are possible")
                                .hint("write (x, y) or (x, y, z); a list is written with square brackets"),
                        );
                        ExprKind::Bad
                    }
                }
            }
            Rule::some_expr => ExprKind::Some(self.expr_in(&mut Cursor::new(p))),
            Rule::none_expr => ExprKind::None(Cursor::new(p).take(Rule::string).map(|s| unquote(s.as_str()))),
            Rule::if_expr => {
                let mut exprs: Vec<Expr> =
                    Cursor::new(p).all(Rule::expr).into_iter().map(|p| self.expr(p)).collect();
                if exprs.len() > 2 * MAX_CHAIN {
                    self.errors.push(
                        Diagnostic::error(code::NESTING, format!("an `if` of more than {MAX_CHAIN} ways"))
                            .at(span, "too long a chain")
                            .hint("use `match` on an enum, or move parts into functions"),
                    );
                    return Expr { kind: Box::new(ExprKind::Bad), span };
                }
                let last = exprs.pop();
                let mut arms = Vec::new();
                let mut it = exprs.into_iter();
                while let (Some(c), Some(v)) = (it.next(), it.next()) {
                    arms.push((c, v));
                }
                match last {
                    Some(last) => ExprKind::If(arms, last),
                    None => ExprKind::Bad,
                }
            }
            Rule::match_expr => {
                let mut c = Cursor::new(p);
                let value = self.expr_in(&mut c);
                let mut arms = Vec::new();
                for a in c.all(Rule::match_arm) {
                    let mut c = Cursor::new(a);
                    let Some(pat) = c.take(Rule::pattern) else { continue };
                    let pat = self.pattern(pat);
                    arms.push((pat, self.expr_in(&mut c)));
                }
                ExprKind::Match(value, arms)
            }
            Rule::quantified => {
                let mut c = Cursor::new(p);
                let words = [
                    (Rule::K_EACH, Quantifier::Each),
                    (Rule::K_ANY, Quantifier::Some),
                    (Rule::K_COUNT, Quantifier::Count),
                    (Rule::K_SUM, Quantifier::Sum),
                    (Rule::K_LEAST, Quantifier::Least),
                    (Rule::K_MOST, Quantifier::Most),
                    (Rule::K_MEAN, Quantifier::Mean),
                ];
                let q = words.iter().find(|(w, _)| c.word(*w)).map_or(Quantifier::Each, |(_, q)| *q);
                ExprKind::Quantified(q, self.expr_in(&mut c))
            }
            _ => ExprKind::Bad,
        };
        Expr { kind: Box::new(kind), span }
    }

    pub fn pattern(&mut self, p: Pair<'_, Rule>) -> Pattern {
        let span = self.span(&p);
        let mut c = Cursor::new(p);
        let kind = if c.word(Rule::K_SOME) {
            PatternKind::Some(self.ident(&mut c))
        } else if c.word(Rule::K_NONE) {
            PatternKind::None(c.take(Rule::ident).map(|p| self.name(&p)))
        } else if c.word(Rule::K_OTHERWISE) {
            PatternKind::Otherwise
        } else {
            PatternKind::Variants(c.all(Rule::ident).iter().map(|p| self.name(p)).collect())
        };
        Pattern { kind, span }
    }

    fn quantity(&mut self, pair: Pair<'_, Rule>) -> ExprKind {
        let span = self.span(&pair);
        let mut c = Cursor::new(pair);
        let number = c.take(Rule::number).map(|p| p.as_str().to_string()).unwrap_or_default();
        let unit = c.take(Rule::unit);
        let whole = unit.is_none() && !number.contains(['.', 'e', 'E']);
        let parsed = match &unit {
            None => QuantityUnit::parse("1"),
            Some(u) => QuantityUnit::parse(u.as_str()),
        };
        match parsed {
            Ok(u) => match u.value(&number) {
                Some(v) if whole && v > (1u64 << 53) as f64 => {
                    self.too_large(span);
                    ExprKind::Quantity(0.0, Dim::NONE, Some(0))
                }
                Some(v) => ExprKind::Quantity(v, u.dim, whole.then_some(v as i64)),
                None => {
                    self.too_large(span);
                    ExprKind::Quantity(0.0, u.dim, None)
                }
            },
            Err(part) => {
                let at = unit.map_or(span, |u| self.span(&u));
                let d = Diagnostic::error(code::UNIT, format!("`{part}` is no unit")).at(at, "unknown unit");
                self.errors.push(match did_you_mean(&part, unit_names()) {
                    Some(near) => d.hint(format!("did you mean `{near}`?")),
                    None => d.hint(
                        "units are listed in docs/language.md; an operator before a name needs spaces: `2 m / t`, `2 m * n`",
                    ),
                });
                ExprKind::Bad
            }
        }
    }

    fn too_large(&mut self, span: Span) {
        self.errors.push(
            Diagnostic::error(code::NUMBER_RANGE, "this number is too large")
                .at(span, "does not fit")
                .hint("whole numbers go to 9007199254740992, quantities to about 1.8e308"),
        );
    }
}
