//! Typing: syntax trees become typed graph expressions and statements.

mod arguments;
mod call;
mod choice;
mod expr;
mod govern;
mod indexed;
mod lists;
mod names;
mod special;
mod stmt;
mod talk;
mod types;

pub use indexed::Indexed;

use crate::{ast, code, decls::Decls};
use soifra_graph::{Diagnostic, Expr, Name, Op, Span, Stmt, Texts, Topic, Type, TypeTable, UserFunction};
use std::collections::{BTreeMap, BTreeSet};

/// What an expression may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Constants only: parameter defaults, array sizes of parameters' types.
    Constant,
    /// Constants and parameters: initial states, periods, channels.
    Start,
    /// As `Start`, and draws: world and robot arguments.
    Scene,
    /// Constants, parameters and the function's own parameters.
    Function,
    /// What an agent can know.
    Behaviour,
    /// An agent's states, arguments and parameters: whether a sub-goal is achieved.
    Belief,
    /// World truth: `done`, `expect`, `metric`.
    Truth,
}

/// The names of the agent whose body is being checked.
#[derive(Debug, Default)]
pub struct AgentScope<'a> {
    /// Its name.
    pub name: Name,
    /// Parameters.
    pub params: Vec<(Name, Type)>,
    /// States: name, type, place.
    pub states: Vec<(Name, Type, Span)>,
    /// Sensors: name, type without optional, optional.
    pub sensors: Vec<(Name, Type, bool)>,
    /// Actuators.
    pub actuators: Vec<(Name, Type)>,
    /// Events.
    pub events: Vec<Name>,
    /// Devices.
    pub devices: Vec<Name>,
    /// Services, machines and plans.
    pub units: Vec<Name>,
    /// Those of them that are offered to the planner-matcher.
    pub offered: Vec<Name>,
    /// All that is offered, in order.
    pub offers: Vec<Name>,
    /// Agent-level `let`s.
    pub lets: BTreeMap<Name, &'a ast::Constant>,
    /// Actions.
    pub actions: BTreeMap<Name, &'a ast::Action>,
}

/// The body being checked: a unit, an arbiter, a function, or a single expression.
#[derive(Debug)]
pub struct Body {
    /// What it may use.
    pub place: Place,
    /// Types of its locals.
    pub locals: Vec<Type>,
    /// Names of locals in scope, innermost last.
    pub scope: Vec<(Name, u32, Type)>,
    /// Agent-level `let`s used so far, with their locals.
    pub lets: BTreeMap<Name, (u32, Type)>,
    /// Their statements, in order.
    pub prelude: Vec<Stmt>,
    /// Data of the machine state: name, slot, type.
    pub data: Vec<(Name, u32, Type)>,
    /// Whether `elapsed` means something (in a machine).
    pub in_machine: bool,
    /// Whether a robot is the subject (`each robot:`).
    pub of_robot: bool,
    /// The conversation whose message, time-out or end releases the unit, with the local for it.
    pub thread: Option<(u32, u32)>,
    /// Whether the body is that of a service with a budget, which has not refined anything yet.
    pub refines: bool,
}

impl Body {
    /// An empty body for a place.
    pub fn new(place: Place) -> Self {
        Body {
            place,
            locals: Vec::new(),
            scope: Vec::new(),
            lets: BTreeMap::new(),
            prelude: Vec::new(),
            data: Vec::new(),
            in_machine: false,
            of_robot: false,
            thread: None,
            refines: false,
        }
    }

    /// A new local of type `ty`.
    pub fn local(&mut self, ty: &Type) -> u32 {
        self.locals.push(ty.clone());
        (self.locals.len() - 1) as u32
    }

    /// A new local that can be named until the scope is cut back.
    pub fn bind(&mut self, name: &ast::Ident, ty: &Type) -> u32 {
        let local = self.local(ty);
        self.scope.push((name.name.clone(), local, ty.clone()));
        local
    }
}

/// State of the compilation.
pub struct Checker<'a> {
    /// Declarations of all files.
    pub decls: &'a Decls<'a>,
    /// Findings.
    pub errors: Vec<Diagnostic>,
    /// Records and enums lowered so far (all declared ones, from the start).
    pub types: TypeTable,
    /// Enums by the variants that they have.
    pub variants: BTreeMap<Name, BTreeSet<Name>>,
    /// Constant texts.
    pub texts: Texts,
    /// Parameters: name, type, place.
    pub params: Indexed<(Name, Type, Span)>,
    /// Interface of a parameter that selects a service, by parameter index.
    pub services: BTreeMap<u32, Name>,
    /// Functions lowered so far.
    pub functions: Vec<UserFunction>,
    /// Index of a lowered function; `None` while it is being lowered.
    pub function_index: BTreeMap<Name, Option<u32>>,
    /// Functions that could not be lowered: reported once, where they stand.
    pub broken: BTreeSet<Name>,
    /// Topics: name and message type.
    pub topics: Indexed<Topic>,
    /// Conversations.
    pub conversations: Indexed<soifra_graph::Conversation>,
    /// Capacity of `heard` for each topic.
    pub topic_capacity: Vec<u32>,
    /// The agent whose body is being checked.
    pub agent: AgentScope<'a>,
    /// States and parameters of agents lowered so far, for beliefs.
    pub agents: Indexed<soifra_graph::Agent>,
    /// Robot groups: name, whether an array, agents by index.
    pub robots: Indexed<(Name, bool, Vec<u32>)>,
    /// Goals, by name.
    pub goals: Indexed<Name>,
    /// Goals of the mission with whether they are pursued on request; none without a mission.
    pub pursuable: Option<Vec<(ast::Ident, bool)>>,
    /// Mission-level constants.
    pub mission_lets: BTreeMap<Name, &'a ast::Constant>,
    /// World regions, by name.
    pub regions: Indexed<Name>,
    /// The body being checked.
    pub body: Body,
    /// File-level constants that something uses.
    pub used_constants: BTreeSet<Name>,
    /// Statements that actions were written out to.
    pub written_statements: usize,
    /// Constants being expanded, against rings.
    pub expanding: Vec<Name>,
    /// Depth of the expression being checked.
    pub depth: usize,
    /// Names whose declaration is wrong: what follows from that is not the user's second mistake.
    /// With the number of errors until then: only later ones follow from it.
    pub poisoned: BTreeMap<Name, usize>,
    /// Expression nodes that constants were written out to.
    pub written_out: usize,
    /// Whether that was too much, which is reported once.
    pub too_much: bool,
}

/// Deepest expression, counted in the tree.
const MAX_DEPTH: usize = 512;

impl<'a> Checker<'a> {
    /// Reports an error.
    pub fn report(&mut self, d: Diagnostic) {
        self.errors.push(d);
    }

    /// Adds an enum, or gives one that was added its variants.
    pub fn add_enum(&mut self, name: &Name, variants: Vec<Name>) {
        for v in &variants {
            self.variants.entry(v.clone()).or_default().insert(name.clone());
        }
        self.types.enums.insert(name.clone(), soifra_graph::Enum { name: name.clone(), variants });
    }

    /// Remembers that the declaration of `name` is wrong.
    pub fn poison(&mut self, name: &Name) {
        let before = self.errors.len();
        self.poisoned.entry(name.clone()).or_insert(before);
    }

    /// Checks `f` in a fresh body and gives that body back with the result.
    pub fn in_body<T>(&mut self, body: Body, f: impl FnOnce(&mut Self) -> T) -> (T, Body) {
        let outer = std::mem::replace(&mut self.body, body);
        let result = f(self);
        (result, std::mem::replace(&mut self.body, outer))
    }

    /// An expression that must have type `want`.
    pub fn typed(&mut self, e: &ast::Expr, want: &Type) -> Option<Expr> {
        let value = self.expr(e, Some(want))?;
        self.coerce(value, want)
    }

    /// Makes a value fit `want`, or reports that it does not.
    pub fn coerce(&mut self, mut value: Expr, want: &Type) -> Option<Expr> {
        if value.ty == *want {
            return Some(value);
        }
        match (&value.ty, want) {
            (Type::Int, Type::Quantity(soifra_graph::Dim::NONE)) => {
                use soifra_graph::{Binary, Value};
                let span = value.span;
                if let Op::Const(Value::Int(i)) = value.op {
                    return Some(Expr::constant(Value::Number(i as f64), want.clone(), span));
                }
                // A sum with the number zero is a number; registers hold both alike.
                let zero = Expr::constant(Value::Number(0.0), want.clone(), span);
                value = Expr::new(Op::Binary(Binary::Add), vec![value, zero], want.clone(), span);
                Some(value)
            }
            (Type::List(t, n), Type::List(u, m))
                if n <= m && (*n == 0 || t == u) && matches!(value.op, Op::MakeList | Op::Const(_)) =>
            {
                value.ty = want.clone();
                Some(value)
            }
            // An angle written out stands for the direction it has in the frame that is wanted.
            (Type::Quantity(soifra_graph::Dim::ANGLE), Type::Heading(_)) if is_literal(&value) => {
                value.ty = want.clone();
                Some(value)
            }
            (have, Type::Option(inner)) if !matches!(have, Type::Option(_)) => {
                let span = value.span;
                let inner = self.coerce(value, inner)?;
                Some(Expr::new(Op::MakeSome, vec![inner], want.clone(), span))
            }
            _ => {
                let d = self.mismatch(&value, want);
                self.report(d);
                None
            }
        }
    }

    fn mismatch(&self, value: &Expr, want: &Type) -> Diagnostic {
        let have = &value.ty;
        if let Type::Option(inner) = have
            && **inner == *want
        {
            return Diagnostic::error(code::ABSENCE, "this value may be absent")
                    .at(value.span, format!("{have}, but {want} is wanted"))
                    .hint("give a value for absence with `or`, or take both ways with `match … { some(x) => … none(why) => … }`");
        }
        if same_but_frame(have, want) {
            return Diagnostic::error(code::FRAMES, "this value is in another frame")
                .at(value.span, format!("{have}, but {want} is wanted"))
                .hint("change frames with `place`, `from_body` or `to_body`");
        }
        let d = Diagnostic::error(code::MISMATCH, format!("{want} is wanted, this is {have}"))
            .at(value.span, have.to_string());
        match (have, want) {
            (Type::Int | Type::Quantity(soifra_graph::Dim::NONE), Type::Quantity(dim)) => {
                d.hint(format!("write its unit, for example `{}`", dim.si_unit()))
            }
            (Type::Quantity(have), Type::Quantity(dim))
                if have.times(*dim) == Some(soifra_graph::Dim::NONE) =>
            {
                d.hint(format!("its inverse is wanted, a value in {}", dim.si_unit()))
            }
            (Type::Quantity(have), Type::Distribution(dim)) if have == dim => {
                d.hint("write a distribution, such as `normal(sd: …)` or `uniform(…)`")
            }
            (Type::Quantity(_), Type::Quantity(dim)) => {
                d.hint(format!("a value in {} is needed", dim.si_unit()))
            }
            (Type::Quantity(_), Type::Heading(_)) => {
                d.hint("a direction on the map is made with `towards(angle)`")
            }
            (Type::Heading(_), Type::Quantity(_)) => d.hint(
                "the angle of a heading is `angle_of(heading)`; the turn between two is their difference",
            ),
            (Type::List(..), Type::List(_, n)) => {
                d.hint(format!("lists here hold up to {n} items; declare the same capacity on both sides"))
            }
            (Type::Quantity(_), Type::Twist) => {
                d.hint("a twist is made with `twist(forward)` or `twist(forward, turn: …)`")
            }
            (Type::Int | Type::Quantity(_), Type::Bool) => {
                d.hint("compare it with something, for example `> 0`")
            }
            (Type::Quantity(dim), Type::Int) if *dim == soifra_graph::Dim::NONE => {
                d.hint("declare a `Number` where it goes, or keep to whole numbers")
            }
            (Type::Quantity(_), Type::Int) => d.hint("write a whole number without a unit"),
            _ => d.hint("change the value, or the type that is declared"),
        }
    }

    /// Evaluates a typed expression that must be constant.
    pub fn fold(&mut self, e: &Expr) -> Option<soifra_graph::Value> {
        if let Some(v) = e.as_const() {
            return Some(v.clone());
        }
        let locals: Vec<(Type, Option<soifra_graph::Value>)> =
            e.local_types(&[]).into_iter().map(|t| (t, None)).collect();
        let known = soifra_graph::eval::Known {
            types: &self.types,
            functions: &self.functions,
            params: &Default::default(),
            locals: &locals,
        };
        match soifra_graph::eval::constant(e, &known, &mut self.texts) {
            Ok(v) => Some(v),
            Err(fault) => {
                self.report(crate::check::not_computable(&fault));
                None
            }
        }
    }

    /// Enters one level of expression depth; false (and an error) when that is too deep.
    pub fn deeper(&mut self, span: Span) -> bool {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            if self.depth == MAX_DEPTH + 1 {
                self.report(
                    Diagnostic::error(code::NESTING, "an expression nests too deep")
                        .at(span, "too deep")
                        .hint("give inner parts names with `let`"),
                );
            }
            return false;
        }
        true
    }
}

fn is_literal(e: &Expr) -> bool {
    matches!(e.op, Op::Const(_)) || (e.op == Op::Neg && e.args.iter().all(is_literal))
}

/// Whether two types differ in nothing but their frame.
pub fn same_but_frame(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Point(f), Type::Point(g))
        | (Type::Pose(f), Type::Pose(g))
        | (Type::Heading(f), Type::Heading(g)) => f != g,
        (Type::Vector(f, d), Type::Vector(g, e)) => f != g && d == e,
        _ => false,
    }
}
