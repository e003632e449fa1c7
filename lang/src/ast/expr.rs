//! Statements and expressions.

use super::Ident;
use soifra_graph::{Binary, Name, Quantifier, Span};

/// A statement.
#[derive(Debug, Clone)]
pub struct Stmt {
    /// What.
    pub kind: StmtKind,
    /// Where.
    pub span: Span,
}

/// Kinds of statements.
#[derive(Debug, Clone)]
pub enum StmtKind {
    /// `let`
    Let(Ident, Expr),
    /// `open conversation performative content to agents within T`
    Open {
        /// Conversation.
        conversation: Ident,
        /// Performative.
        performative: Ident,
        /// A record.
        content: Option<Expr>,
        /// Whom.
        to: Expr,
        /// How long to wait.
        within: Option<Expr>,
    },
    /// `reply performative content in conversation`
    Reply {
        /// Performative.
        performative: Ident,
        /// A record.
        content: Option<Expr>,
        /// Why.
        reason: Option<String>,
        /// Which; the one at hand when absent.
        thread: Option<Expr>,
    },
    /// `use device for duration`
    Use(Ident, Expr),
    /// `for item in list { … }`
    For(Ident, Expr, Vec<Stmt>),
    /// `refine name = first by step cost c until u`
    Refine {
        /// What it binds.
        name: Ident,
        /// First value.
        first: Expr,
        /// Next value.
        step: Expr,
        /// Cost of a round.
        cost: Expr,
        /// Good enough.
        until: Option<Expr>,
    },
    /// `set`
    Set(Ident, Expr),
    /// `command`
    Command(Ident, Expr),
    /// `publish`
    Publish(Ident, Expr),
    /// `tell agent performative content`
    Tell(Ident, Ident, Expr),
    /// `note`
    Note(String, Option<Expr>),
    /// `raise`
    Raise(Ident),
    /// `start`, `stop`, `achieve`, `fail`, `pursue`, `offer`, `withdraw`
    Govern(Govern),
    /// `if … else if … else …`
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    /// `match`
    Match(Expr, Vec<(Pattern, Vec<Stmt>)>),
    /// `rules`: guard (absent for otherwise) and body
    Rules(Vec<(Option<Expr>, Vec<Stmt>, Span)>),
    /// `when … => …` on its own
    When(Expr, Vec<Stmt>),
    /// `do`
    Do(Ident, Vec<Arg>),
}

/// A pattern.
#[derive(Debug, Clone)]
pub struct Pattern {
    /// What.
    pub kind: PatternKind,
    /// Where.
    pub span: Span,
}

/// Kinds of patterns.
#[derive(Debug, Clone)]
pub enum PatternKind {
    /// `some(x)`
    Some(Ident),
    /// `none(why)`
    None(Option<Ident>),
    /// `a | b`
    Variants(Vec<Ident>),
    /// `otherwise`
    Otherwise,
}

/// A call argument.
#[derive(Debug, Clone)]
pub struct Arg {
    /// Name, when given.
    pub name: Option<Ident>,
    /// Lambda parameters, when it is a lambda.
    pub lambda: Option<Vec<Ident>>,
    /// Value, or lambda body.
    pub value: Expr,
}

/// An expression.
#[derive(Debug, Clone)]
pub struct Expr {
    /// What.
    pub kind: Box<ExprKind>,
    /// Where.
    pub span: Span,
}

/// Kinds of expressions.
#[derive(Debug, Clone)]
pub enum ExprKind {
    /// A number literal: value in SI, unit text, whether it is whole and without a unit.
    Quantity(f64, soifra_graph::Dim, Option<i64>),
    /// `true`
    Bool(bool),
    /// `"…"`
    Text(String),
    /// A name.
    Name(Name),
    /// `x.field`
    Field(Expr, Ident),
    /// `f(args)`
    Call(Ident, Vec<Arg>),
    /// `x.f(args)`
    Method(Expr, Ident, Vec<Arg>),
    /// Unary minus.
    Neg(Expr),
    /// `not`
    Not(Expr),
    /// Binary operator.
    Binary(Binary, Expr, Expr),
    /// `a .. b`
    Range(Expr, Expr),
    /// `a ^ n`
    Power(Expr, Expr),
    /// `x is some(y)` (true) or `x is none` (false)
    Is(Expr, bool, Option<Ident>),
    /// `if c then a else b`, chained
    If(Vec<(Expr, Expr)>, Expr),
    /// `match`
    Match(Expr, Vec<(Pattern, Expr)>),
    /// `some(x)`
    Some(Expr),
    /// `none "why"`
    None(Option<String>),
    /// `each robot: …`
    Quantified(Quantifier, Expr),
    /// `[a, b]`
    List(Vec<Expr>),
    /// `(a, b)` or `(a, b, c)`
    Tuple(Vec<Expr>),
    /// What could not be read; an error has been reported.
    Bad,
}

/// What an agent decides about its units, and tells the planner-matcher.
#[derive(Debug, Clone)]
pub enum Govern {
    /// `offer NAME`
    Offer(Ident),
    /// `withdraw NAME`
    Withdraw(Ident),
    /// `start UNIT`
    Start(Ident),
    /// `stop UNIT`
    Stop(Ident),
    /// `achieve`
    Achieve,
    /// `fail "why"`
    Fail(String),
    /// `pursue GOAL`
    Pursue(Ident),
}
