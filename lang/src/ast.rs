//! The syntax tree: what was written, with spans, before anything is resolved.

use soifra_graph::{Binary, Name, Quantifier, Span, Type};

/// A name and its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Ident {
    /// The name.
    pub name: Name,
    /// Where it stands.
    pub span: Span,
}

/// A source file.
#[derive(Debug, Clone, Default)]
pub struct File {
    /// Language edition, if stated.
    pub edition: Option<(i64, Span)>,
    /// Imports in order.
    pub imports: Vec<Import>,
    /// Items in order.
    pub items: Vec<Item>,
    /// What could not be read as an item.
    pub unread: Vec<Span>,
}

/// `import "rules.soi"` or `import std.motion`.
#[derive(Debug, Clone)]
pub struct Import {
    /// File path, or dotted library path.
    pub path: String,
    /// Whether it is a file path.
    pub is_file: bool,
    /// Where it stands.
    pub span: Span,
}

/// A top-level item.
#[derive(Debug, Clone)]
pub enum Item {
    /// `mission`
    Mission(Mission),
    /// `agent`
    Agent(Agent),
    /// `platform`
    Platform(Profile),
    /// `world`
    World(Profile),
    /// `record`
    Record(Record),
    /// `enum`
    Enum(Enum),
    /// `interface`
    Interface(Interface),
    /// `fn`
    Function(Function),
    /// `let`
    Constant(Constant),
    /// `topic`
    Topic(Topic),
    /// `param`
    Param(Param),
    /// `test`
    Test(Test),
}

/// A type as written.
#[derive(Debug, Clone)]
pub struct TypeRef {
    /// What.
    pub kind: TypeKind,
    /// Where.
    pub span: Span,
}

/// Kinds of written types.
#[derive(Debug, Clone)]
pub enum TypeKind {
    /// A type by its text; record names in it may turn out to be enums or unknown.
    Named(Type),
    /// Text that is no type, with the reason.
    Bad(String),
    /// `enum { a, b }`
    InlineEnum(Vec<Ident>),
    /// `service I`: one of the functions that implement interface `I`.
    Service(Ident),
}

/// `record`
#[derive(Debug, Clone)]
pub struct Record {
    /// Name.
    pub name: Ident,
    /// Fields.
    pub fields: Vec<(Ident, TypeRef)>,
}

/// `enum`
#[derive(Debug, Clone)]
pub struct Enum {
    /// Name.
    pub name: Ident,
    /// Variants.
    pub variants: Vec<Ident>,
}

/// `interface`
#[derive(Debug, Clone)]
pub struct Interface {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Result.
    pub result: TypeRef,
}

/// `fn`
#[derive(Debug, Clone)]
pub struct Function {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Result, inferred when absent.
    pub result: Option<TypeRef>,
    /// Interface it implements.
    pub implements: Option<Ident>,
    /// `let`s of the body.
    pub lets: Vec<Constant>,
    /// Value.
    pub body: Expr,
}

/// `let name = value`
#[derive(Debug, Clone)]
pub struct Constant {
    /// Name.
    pub name: Ident,
    /// Value.
    pub value: Expr,
}

/// `param`
#[derive(Debug, Clone)]
pub struct Param {
    /// Name.
    pub name: Ident,
    /// Type, inferred from the default when absent.
    pub ty: Option<TypeRef>,
    /// Default.
    pub value: Expr,
}

/// `topic`
#[derive(Debug, Clone)]
pub struct Topic {
    /// Name.
    pub name: Ident,
    /// Message type.
    pub ty: TypeRef,
    /// Channel model and arguments.
    pub channel: Option<(Ident, Vec<Arg>)>,
}

/// A platform or world: named, perhaps extending another, made of entries.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Name.
    pub name: Ident,
    /// What it extends.
    pub extends: Option<Ident>,
    /// Entries.
    pub entries: Vec<Entry>,
}

/// `role name[count] = model(args)`
#[derive(Debug, Clone)]
pub struct Entry {
    /// Role.
    pub role: Ident,
    /// Name.
    pub name: Option<Ident>,
    /// Array size.
    pub count: Option<Expr>,
    /// Model.
    pub model: Ident,
    /// Arguments.
    pub args: Vec<Arg>,
    /// All of it.
    pub span: Span,
}

/// A mission.
#[derive(Debug, Clone)]
pub struct Mission {
    /// Name.
    pub name: Ident,
    /// Title.
    pub title: Option<String>,
    /// Members in order.
    pub members: Vec<MissionMember>,
}

/// A member of a mission.
#[derive(Debug, Clone)]
pub enum MissionMember {
    /// `param`
    Param(Param),
    /// `clock step`
    Clock(Expr),
    /// `robot`
    Robot(Robot),
    /// `goal`
    Goal(Goal),
    /// `done when`
    Done(Expr, Span),
    /// `within`
    Within(Expr, Span),
    /// `expect`
    Expect(Expect),
    /// `metric`
    Metric(Constant),
    /// `let`
    Constant(Constant),
    /// `world NAME`
    World(Ident),
    /// A world entry of the mission's own.
    Entry(Entry),
}

/// A robot, or an array of robots.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Name.
    pub name: Ident,
    /// Array size.
    pub count: Option<Expr>,
    /// Platforms, the first is used unless another is asked for.
    pub platforms: Vec<Ident>,
    /// Start.
    pub at: Expr,
    /// Target.
    pub target: Option<Expr>,
    /// Scatter.
    pub scatter: Option<Expr>,
    /// Agents.
    pub runs: Vec<(Ident, Vec<Arg>)>,
}

/// A goal with sub-goals: name, agent, condition.
#[derive(Debug, Clone)]
pub struct Goal {
    /// Name.
    pub name: Ident,
    /// Sub-goals.
    pub subgoals: Vec<SubGoal>,
}

/// `subgoal name by agent achieved when …`
#[derive(Debug, Clone)]
pub struct SubGoal {
    /// Name.
    pub name: Ident,
    /// Agent.
    pub agent: Ident,
    /// Condition.
    pub achieved: Option<Expr>,
}

/// An expectation.
#[derive(Debug, Clone)]
pub struct Expect {
    /// For each robot by itself.
    pub each_robot: bool,
    /// What.
    pub kind: ExpectKind,
    /// All of it.
    pub span: Span,
}

/// Kinds of expectations.
#[derive(Debug, Clone)]
pub enum ExpectKind {
    /// `always`
    Always(Expr),
    /// `never`
    Never(Expr),
    /// `eventually … within`
    Eventually(Expr, Option<Expr>),
    /// `… until …`
    Until(Expr, Expr),
    /// `… leads to … within`
    LeadsTo(Expr, Expr, Option<Expr>),
    /// At the end.
    Finally(Expr),
}

/// `test`
#[derive(Debug, Clone)]
pub struct Test {
    /// Name.
    pub name: Ident,
    /// `run`
    pub run: Vec<Ident>,
    /// `seeds`
    pub seeds: Option<Expr>,
    /// `set`
    pub sets: Vec<Constant>,
    /// `expect outcome`
    pub outcome: Option<Ident>,
    /// `expect`
    pub expects: Vec<Expr>,
}

/// An agent.
#[derive(Debug, Clone)]
pub struct Agent {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Collaborative.
    pub collaborative: bool,
    /// Members in order.
    pub members: Vec<AgentMember>,
}

/// A member of an agent.
#[derive(Debug, Clone)]
pub enum AgentMember {
    /// `offers`
    Offers(Ident, Vec<(Ident, TypeRef)>),
    /// `sensor`
    Sensor(Ident, TypeRef),
    /// `actuator`
    Actuator(Ident, TypeRef),
    /// `state`
    State(Ident, Option<TypeRef>, Expr),
    /// `event`
    Event(Ident),
    /// `let`
    Constant(Constant),
    /// `action`
    Action(Action),
    /// `service`, `machine`, `plan`
    Unit(Box<Unit>),
    /// `arbitrate`
    Arbiter(Arbiter),
}

/// An action.
#[derive(Debug, Clone)]
pub struct Action {
    /// Name.
    pub name: Ident,
    /// Parameters.
    pub params: Vec<(Ident, TypeRef)>,
    /// Success.
    pub until: Option<Expr>,
    /// Failure.
    pub fails: Option<Expr>,
    /// What it does.
    pub body: Vec<Stmt>,
    /// When halted.
    pub halt: Vec<Stmt>,
}

/// A service, machine or plan.
#[derive(Debug, Clone)]
pub struct Unit {
    /// Name.
    pub name: Ident,
    /// Trigger.
    pub trigger: Trigger,
    /// Timing clauses.
    pub timing: Vec<Timing>,
    /// What.
    pub kind: UnitKind,
}

/// Kinds of units.
#[derive(Debug, Clone)]
pub enum UnitKind {
    /// `service`
    Service(Vec<Stmt>),
    /// `machine`
    Machine(Vec<MachineState>),
    /// `plan [for sub-goal]`
    Plan(Option<Ident>, PlanNode),
}

/// A trigger.
#[derive(Debug, Clone)]
pub struct Trigger {
    /// What.
    pub kind: TriggerKind,
    /// Where.
    pub span: Span,
}

/// Kinds of triggers.
#[derive(Debug, Clone)]
pub enum TriggerKind {
    /// `every step after …`
    Step(Option<Expr>),
    /// `every … after …`
    Every(Expr, Option<Expr>),
    /// `on event`
    Event(Ident),
    /// `on sensor`
    Sensor(Ident),
    /// `on inform Record(x) from agent`
    Told(Ident, Ident, Ident, Option<Ident>),
    /// `on topic(x)`
    Topic(Ident, Ident),
}

/// A timing clause.
#[derive(Debug, Clone)]
pub enum Timing {
    /// `deadline`
    Deadline(Expr),
    /// `worst`
    Worst(Expr),
    /// `budget`
    Budget(Expr),
    /// `at most every`
    AtMostEvery(Expr),
    /// `priority`
    Priority(i64),
    /// `core`
    Core(i64),
}

/// A state of a machine.
#[derive(Debug, Clone)]
pub struct MachineState {
    /// Name.
    pub name: Ident,
    /// Data it carries.
    pub data: Vec<(Ident, TypeRef)>,
    /// On entry.
    pub entry: Vec<Stmt>,
    /// On exit.
    pub exit: Vec<Stmt>,
    /// Body.
    pub body: Vec<Stmt>,
    /// Ways out.
    pub transitions: Vec<Transition>,
}

/// `when … -> target(args) { … }`
#[derive(Debug, Clone)]
pub struct Transition {
    /// Guard.
    pub guard: Expr,
    /// Target.
    pub target: Ident,
    /// Data of the target.
    pub args: Vec<Arg>,
    /// Actions.
    pub body: Vec<Stmt>,
}

/// A plan node.
#[derive(Debug, Clone)]
pub struct PlanNode {
    /// What.
    pub kind: PlanKind,
    /// Children.
    pub children: Vec<PlanNode>,
    /// Where.
    pub span: Span,
}

/// Kinds of plan nodes.
#[derive(Debug, Clone)]
pub enum PlanKind {
    /// `[reactive] sequence`
    Sequence(bool),
    /// `[reactive] fallback`
    Fallback(bool),
    /// `parallel [n]`
    Parallel(Option<i64>),
    /// `retry n`
    Retry(i64),
    /// `timeout d`
    Timeout(Expr),
    /// `repeat n`
    Repeat(i64),
    /// `repeat while c`
    RepeatWhile(Expr),
    /// `invert`
    Invert,
    /// `succeed`
    Succeed,
    /// `check c`
    Check(Expr),
    /// `wait d`
    Wait(Expr),
    /// `wait until c`
    WaitUntil(Expr),
    /// A statement.
    Stmt(Stmt),
}

/// An arbiter.
#[derive(Debug, Clone)]
pub struct Arbiter {
    /// Actuator.
    pub actuator: Ident,
    /// Strategy.
    pub strategy: Strategy,
    /// Where.
    pub span: Span,
}

/// `unit` or `agent.unit`
#[derive(Debug, Clone)]
pub struct Source {
    /// Agent, when it is another's unit.
    pub agent: Option<Ident>,
    /// Unit.
    pub unit: Ident,
}

/// Strategies.
#[derive(Debug, Clone)]
pub enum Strategy {
    /// Index for each source.
    Priority(Vec<(Source, Expr)>),
    /// Weight for each source.
    Blend(Vec<(Source, Expr)>),
    /// Order.
    Switch(Vec<Source>),
    /// Layers, topmost first.
    Layers(Vec<Layer>),
}

/// A layer.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Who.
    pub source: Source,
    /// Whom it suppresses; all below when absent.
    pub suppresses: Option<Vec<Source>>,
    /// For how long.
    pub hold: Option<Expr>,
    /// While this, it does not count.
    pub inhibited: Option<Expr>,
}

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
