//! Expressions: a uniform tree of an operator, its arguments, a type and a span.

use crate::{Function, Name, Span, Type, Value};
use serde::{Deserialize, Serialize};

/// A typed expression.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "flat::Nodes", into = "flat::Nodes")]
pub struct Expr {
    /// What is done with the arguments.
    pub op: Op,
    /// Arguments, in the order the operator documents.
    pub args: Vec<Expr>,
    /// Type of the result.
    pub ty: Type,
    /// Where it was written.
    pub span: Span,
}

/// Binary operators on values; typing in [`crate::typing`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Binary {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `<`
    Lt,
    /// `<=`
    Le,
    /// `>`
    Gt,
    /// `>=`
    Ge,
    /// `==`
    Eq,
    /// `!=`
    Ne,
    /// `and`; the right side is evaluated only when the left is true
    And,
    /// `or`; the right side is evaluated only when the left is false
    Or,
}

/// What a robot knows of itself, from its profile and the mission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Own {
    /// Position in the mission's robot list, from 0: `Int`.
    Index,
    /// Declared start pose, without the scatter: `Pose<map>`.
    Start,
    /// Declared target: `Point<map>`.
    Target,
    /// Body radius: `Length`.
    Radius,
    /// Body height: `Length`.
    Height,
    /// Cruise speed of the profile: `Velocity`.
    CruiseSpeed,
}

/// World truth about a robot. Readable in `done`, `expect` and `metric` only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Truth {
    /// True pose: `Pose<map>`.
    Pose,
    /// Path length so far: `Length`.
    PathLength,
    /// Collisions so far in which this robot took part: `Int`.
    Collisions,
    /// Whether it is in contact now: `Bool`.
    InCollision,
}

/// Facts about the run. Readable where truth is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Run {
    /// Collisions so far, each contact counted once from touch to parting: `Int`.
    Collisions,
    /// Whether any robot is in contact now: `Bool`.
    InCollision,
}

/// What is known of the executions of a unit. Readable where truth is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Execution {
    /// Activations so far: `Int`.
    Activations,
    /// Deadlines missed so far: `Int`.
    Misses,
    /// Longest time from a release to its completion so far: `Duration`.
    Response,
}

/// How a robot's answer of a quantified expression is combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantifier {
    /// `each robot: Bool`
    Each,
    /// `some robot: Bool`
    Some,
    /// `count robot: Bool`
    Count,
    /// `sum robot: quantity`
    Sum,
    /// `least robot: quantity`
    Least,
    /// `most robot: quantity`
    Most,
    /// `mean robot: quantity`
    Mean,
}

/// A named part of a built-in type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Of a point or vector.
    X,
    /// Of a point or vector.
    Y,
    /// Of a point or vector.
    Z,
    /// Of a pose: `Point`.
    Position,
    /// Of a pose: `Heading`, the yaw.
    Heading,
    /// Of a pose: `Angle`.
    Roll,
    /// Of a pose: `Angle`.
    Pitch,
    /// Of a twist: `Velocity` along x.
    Forward,
    /// Of a twist: `Velocity` along y.
    Left,
    /// Of a twist: `Velocity` along z.
    Up,
    /// Of a twist: `AngularVelocity` about z.
    Turn,
}

/// Operations on bounded lists with a body evaluated per item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ListOp {
    /// A list of the body's values.
    Map,
    /// The items for which the body is true.
    Filter,
    /// Whether the body is true for some item; stops at the first.
    Any,
    /// Whether the body is true for every item; stops at the first that is not.
    All,
    /// How many items the body is true for.
    Count,
    /// The first item for which the body is true, else none.
    Find,
    /// The item with the least body value (the first of equals), none for an empty list.
    MinBy,
    /// The item with the greatest body value (the first of equals), none for an empty list.
    MaxBy,
}

/// An operator. Locals are numbered within their unit (or scene, or expectation).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Op {
    /// A constant.
    Const(Value),
    /// A local bound by `let`, a pattern, a lambda, a message or a state's data.
    Local(u32),
    /// A state of the agent.
    State(u32),
    /// A mission parameter.
    Param(u32),
    /// An argument of the agent.
    Argument(u32),
    /// A reading of the agent's sensor port: the value, or an optional for an optional port.
    Reading(u32),
    /// Latest unexpired message of every other sender in range on a topic: a list.
    Heard(u32),
    /// Time since the run began: `Duration`.
    Now,
    /// Steps since the run began: `Steps`.
    StepCount,
    /// The agents that offer a service, first registered first: `List<Agent, 64>`.
    Offering(Name),
    /// Time since the current machine state was entered: `Duration`.
    Elapsed,
    /// What the robot knows of itself.
    Own(Own),
    /// World truth of the robot in question.
    Truth(Truth),
    /// A fact about the run.
    Run(Run),
    /// A state of an agent of the robot in question: (agent, state). Readable where truth is.
    Believed(u32, u32),
    /// What is known of the executions of a unit of the robot in question: (agent, unit, what). Readable where
    /// truth is.
    Executed(u32, u32, Execution),
    /// Whether a goal is achieved. Readable where truth is.
    Achieved(u32),
    /// Combines the argument over all robots.
    Quantified(Quantifier),
    /// The argument, for robot n.
    OfRobot(u32),
    /// A function of the mission's own: arguments in order.
    Call(u32),
    /// A built-in function.
    Builtin(Function),
    /// `sqrt`: halves the dimension.
    Sqrt,
    /// Dot product of two vectors: multiplies dimensions.
    Dot,
    /// A binary operator.
    Binary(Binary),
    /// Integer power.
    Power(i32),
    /// Unary minus.
    Neg,
    /// `not`
    Not,
    /// condition, then, else.
    If,
    /// value, body: the value is bound to the local in the body.
    Let(u32),
    /// optional, body with the value bound to the local, body without (the reason bound, if given).
    IfSome {
        /// Local for the value.
        local: u32,
        /// Local for the reason, a `Text`.
        reason: Option<u32>,
    },
    /// scrutinee, one body a variant listed, and a last one for the rest when `rest`.
    Switch {
        /// Variant index of each body.
        variants: Vec<u32>,
        /// Whether a last body takes every other variant.
        rest: bool,
    },
    /// Fields in order.
    MakeRecord,
    /// Field of a record by index.
    Field(u32),
    /// Items.
    MakeList,
    /// A point, vector: x, y, z.
    MakeVector,
    /// A range: low, high.
    MakeRange,
    /// A matrix: items by row.
    MakeMatrix,
    /// A present optional.
    MakeSome,
    /// An absent optional, with its reason.
    MakeNone(String),
    /// A part of a built-in type.
    Part(Part),
    /// list, body with the item bound to the local.
    List(ListOp, u32),
    /// list, initial value, body with accumulator and item bound to two locals.
    Fold(u32, u32),
    /// Matrix transpose.
    Transpose,
    /// Matrix inverse: an optional.
    Inverse,
    /// Item of a matrix at (row, column): `Number`.
    Item(u8, u8),
}

impl Expr {
    /// A constant.
    pub fn constant(value: Value, ty: Type, span: Span) -> Self {
        Expr { op: Op::Const(value), args: Vec::new(), ty, span }
    }

    /// An operator on arguments.
    pub fn new(op: Op, args: Vec<Expr>, ty: Type, span: Span) -> Self {
        Expr { op, args, ty, span }
    }

    /// This expression and all below it, parents first.
    pub fn walk<'a>(&'a self, visit: &mut dyn FnMut(&'a Expr)) {
        visit(self);
        for a in &self.args {
            a.walk(visit);
        }
    }

    /// Types of the locals this expression binds by itself, numbered from 0; `known` are given from
    /// outside. Locals above 65,535 are not looked for: what uses them is refused when compiled.
    pub fn local_types(&self, known: &[Type]) -> Vec<Type> {
        let mut types = known.to_vec();
        let mut bind = |local: u32, ty: &Type| {
            let l = local as usize;
            if (known.len()..1 << 16).contains(&l) {
                if types.len() <= l {
                    types.resize(l + 1, Type::Bool);
                }
                types[l] = ty.clone();
            }
        };
        self.walk(&mut |e| match (&e.op, e.args.first().map(|a| &a.ty)) {
            (Op::Let(l), Some(t)) => bind(*l, t),
            (Op::IfSome { local, reason }, Some(Type::Option(t))) => {
                bind(*local, t);
                if let Some(r) = reason {
                    bind(*r, &Type::Text);
                }
            }
            (Op::List(_, l), Some(Type::List(t, _))) => bind(*l, t),
            (Op::Fold(accumulator, item), Some(Type::List(t, _))) => {
                bind(*item, t);
                bind(*accumulator, &e.ty);
            }
            _ => {}
        });
        types
    }

    /// The same expression with something else where `given` says so.
    pub fn replaced(&self, given: &impl Fn(&Op) -> Option<Expr>) -> Expr {
        given(&self.op).unwrap_or_else(|| Expr {
            args: self.args.iter().map(|a| a.replaced(given)).collect(),
            op: self.op.clone(),
            ty: self.ty.clone(),
            span: self.span,
        })
    }

    /// The constant value, when this is one.
    pub fn as_const(&self) -> Option<&Value> {
        match &self.op {
            Op::Const(v) => Some(v),
            _ => None,
        }
    }
}

/// A function of the mission's own. Its locals start with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UserFunction {
    /// Name.
    pub name: Name,
    /// Parameters, bound to locals 0, 1, …
    pub parameters: Vec<(Name, Type)>,
    /// Types of all locals, parameters first.
    pub locals: Vec<Type>,
    /// Value.
    pub body: Expr,
    /// Where it was written.
    pub span: Span,
}

/// In a file an expression is a flat list of nodes, arguments before their users, so that depth never
/// meets a reader's nesting limit.
mod flat {
    use super::{Expr, Op, Span, Type};
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    pub struct Node {
        op: Op,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        args: Vec<u32>,
        ty: Type,
        at: Span,
    }

    #[derive(Serialize, Deserialize)]
    #[serde(transparent)]
    pub struct Nodes(Vec<Node>);

    fn push(e: Expr, out: &mut Vec<Node>) -> u32 {
        let args = e.args.into_iter().map(|a| push(a, out)).collect();
        out.push(Node { op: e.op, args, ty: e.ty, at: e.span });
        (out.len() - 1) as u32
    }

    impl From<Expr> for Nodes {
        fn from(e: Expr) -> Self {
            let mut out = Vec::new();
            push(e, &mut out);
            Nodes(out)
        }
    }

    /// Deepest expression a graph file may hold; the checker refuses deeper ones in sources too.
    const DEPTH: usize = 2048;

    impl TryFrom<Nodes> for Expr {
        type Error = String;
        fn try_from(nodes: Nodes) -> Result<Self, String> {
            let mut done: Vec<Option<(Expr, usize)>> = Vec::new();
            for (i, n) in nodes.0.into_iter().enumerate() {
                let (mut args, mut depth) = (Vec::new(), 0);
                for a in n.args {
                    let taken = done.get_mut(a as usize).and_then(Option::take);
                    let (e, d) = taken
                        .ok_or_else(|| format!("node {i} uses node {a}, which is not free before it"))?;
                    depth = depth.max(d);
                    args.push(e);
                }
                if depth >= DEPTH {
                    return Err(format!("an expression nests deeper than {DEPTH}"));
                }
                done.push(Some((Expr { op: n.op, args, ty: n.ty, span: n.at }, depth + 1)));
            }
            match done.pop() {
                Some(Some((root, _))) if done.iter().all(Option::is_none) => Ok(root),
                _ => Err("an expression needs one root node, the last".into()),
            }
        }
    }
}
