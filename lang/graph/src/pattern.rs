//! Textual types, and types with holes: the signatures of functions and components.

use crate::OPAQUE;
use crate::{Dim, Frame, Type, dim::Unit};
use std::collections::BTreeMap;

/// A type with variables: a single capital letter (optionally with digits) where a type, dimension,
/// frame or capacity could stand.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// Any type, the same at each place the variable stands.
    Var(String),
    /// A quantity of a dimension variable.
    Quantity(DimPattern),
    /// `Heading<F>`
    Heading(String),
    /// `Point<F>`
    Point(String),
    /// `Vector<F, D>`
    Vector(String, DimPattern),
    /// `Pose<F>`
    Pose(String),
    /// `Range<D>`
    Range(DimPattern),
    /// `Distribution<D>`
    Distribution(DimPattern),
    /// `List<T, N>`; the capacity is a number, a variable, or the name of a parameter whose value
    /// (an `Int`) or length (a list) it is.
    List(Box<Pattern>, String),
    /// `T?`
    Option(Box<Pattern>),
    /// A type without holes.
    Exact(Type),
}

/// A dimension, or a variable for one.
#[derive(Debug, Clone, PartialEq)]
pub enum DimPattern {
    /// Fixed.
    Exact(Dim),
    /// Variable.
    Var(String),
}

fn is_variable(s: &str) -> bool {
    let mut c = s.chars();
    c.next().is_some_and(|c| c.is_ascii_uppercase()) && c.all(|c| c.is_ascii_digit())
}

/// Parses the textual form of a type without holes.
pub fn parse_type(text: &str) -> Result<Type, String> {
    match Pattern::parse(text)? {
        Pattern::Exact(t) => Ok(t),
        p => settle(p).ok_or_else(|| format!("`{text}` is no type")),
    }
}

/// In a type without holes, a capital letter with digits is the name of a record or enum.
fn settle(p: Pattern) -> Option<Type> {
    Some(match p {
        Pattern::Exact(t) => t,
        Pattern::Var(name) => Type::Record(name.into()),
        Pattern::Option(p) => settle(*p)?.optional(),
        Pattern::List(p, n) => Type::List(Box::new(settle(*p)?), n.parse().ok()?),
        _ => return None,
    })
}

impl Pattern {
    /// Whether it is an opaque type, or an optional of one: only services look into its values.
    pub fn is_opaque(&self) -> bool {
        let is = |t: &Type| matches!(t, Type::Handle(name) if OPAQUE.contains(&&**name));
        match self {
            Pattern::Exact(Type::Option(inner)) => is(inner),
            Pattern::Exact(t) => is(t),
            _ => false,
        }
    }

    /// Parses a pattern such as `List<Point<F>, N>`.
    pub fn parse(text: &str) -> Result<Pattern, String> {
        parse_nested(text.trim(), 32)
    }

    /// Matches `t` against this pattern, binding variables; false when it does not match. Whole numbers
    /// match plain numbers; values match optionals when the pattern is one.
    pub fn matches(&self, t: &Type, vars: &mut Bindings) -> bool {
        match (self, t) {
            (Pattern::Var(v), _) => vars.bind_type(v, t),
            (Pattern::Quantity(d), Type::Quantity(e)) => d.matches(*e, vars),
            (Pattern::Quantity(d), Type::Int) => d.matches(Dim::NONE, vars),
            (Pattern::Heading(v), Type::Heading(f)) => vars.bind_frame(v, f),
            (Pattern::Point(v), Type::Point(f)) => vars.bind_frame(v, f),
            (Pattern::Pose(v), Type::Pose(f)) => vars.bind_frame(v, f),
            (Pattern::Vector(v, d), Type::Vector(f, e)) => vars.bind_frame(v, f) && d.matches(*e, vars),
            (Pattern::Range(d), Type::Range(e)) => d.matches(*e, vars),
            (Pattern::Distribution(d), Type::Distribution(e)) => d.matches(*e, vars),
            (Pattern::List(p, n), Type::List(t, m)) => {
                (*m == 0 || p.matches(t, vars)) && vars.bind_capacity(n, *m)
            }
            (Pattern::Option(p), Type::Option(t)) => p.matches(t, vars),
            (Pattern::Exact(e), _) => t.fits(e),
            _ => false,
        }
    }

    /// The type with every variable replaced; `None` when one is unbound.
    pub fn instantiate(&self, vars: &Bindings) -> Option<Type> {
        Some(match self {
            Pattern::Var(v) => vars.types.get(v)?.clone(),
            Pattern::Quantity(d) => Type::Quantity(d.instantiate(vars)?),
            Pattern::Heading(f) => Type::Heading(vars.frame(f)?),
            Pattern::Point(f) => Type::Point(vars.frame(f)?),
            Pattern::Pose(f) => Type::Pose(vars.frame(f)?),
            Pattern::Vector(f, d) => Type::Vector(vars.frame(f)?, d.instantiate(vars)?),
            Pattern::Range(d) => Type::Range(d.instantiate(vars)?),
            Pattern::Distribution(d) => Type::Distribution(d.instantiate(vars)?),
            Pattern::List(p, n) => Type::List(Box::new(p.instantiate(vars)?), vars.capacity(n)?),
            Pattern::Option(p) => Type::Option(Box::new(p.instantiate(vars)?)),
            Pattern::Exact(t) => t.clone(),
        })
    }
}

impl DimPattern {
    fn matches(&self, d: Dim, vars: &mut Bindings) -> bool {
        match self {
            DimPattern::Exact(e) => *e == d,
            DimPattern::Var(v) => *vars.dims.entry(v.clone()).or_insert(d) == d,
        }
    }

    fn instantiate(&self, vars: &Bindings) -> Option<Dim> {
        match self {
            DimPattern::Exact(d) => Some(*d),
            DimPattern::Var(v) => vars.dims.get(v).copied(),
        }
    }
}

/// What the variables of a signature stand for.
#[derive(Debug, Clone, Default)]
pub struct Bindings {
    /// Types.
    pub types: BTreeMap<String, Type>,
    /// Dimensions.
    pub dims: BTreeMap<String, Dim>,
    /// Frames.
    pub frames: BTreeMap<String, Frame>,
    /// List capacities, by variable or parameter name.
    pub capacities: BTreeMap<String, u32>,
}

impl Bindings {
    fn bind_type(&mut self, v: &str, t: &Type) -> bool {
        match self.types.get(v) {
            None => {
                self.types.insert(v.to_string(), t.clone());
                true
            }
            Some(bound) if *bound == Type::Int && *t == Type::NUMBER => {
                self.types.insert(v.to_string(), t.clone());
                true
            }
            Some(bound) => t.fits(bound),
        }
    }

    fn bind_frame(&mut self, v: &str, f: &Frame) -> bool {
        if !is_variable(v) {
            return *v == *f.0;
        }
        self.frames.entry(v.to_string()).or_insert_with(|| f.clone()) == f
    }

    fn bind_capacity(&mut self, v: &str, n: u32) -> bool {
        match v.parse::<u32>() {
            Ok(limit) => n <= limit,
            Err(_) => {
                let bound = self.capacities.entry(v.to_string()).or_insert(n);
                *bound = n.max(*bound);
                true
            }
        }
    }

    fn frame(&self, v: &str) -> Option<Frame> {
        if is_variable(v) { self.frames.get(v).cloned() } else { Some(Frame(v.into())) }
    }

    fn capacity(&self, v: &str) -> Option<u32> {
        v.parse().ok().or_else(|| self.capacities.get(v).copied())
    }
}

fn split_arguments(s: &str) -> Vec<&str> {
    let (mut depth, mut from, mut parts) = (0i32, 0, Vec::new());
    for (i, c) in s.char_indices() {
        match c {
            '<' => depth += 1,
            '>' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(s[from..i].trim());
                from = i + 1;
            }
            _ => {}
        }
    }
    parts.push(s[from..].trim());
    parts
}

fn dim_pattern(s: &str) -> Result<DimPattern, String> {
    if is_variable(s) {
        return Ok(DimPattern::Var(s.to_string()));
    }
    match parse_type(s)? {
        Type::Quantity(d) => Ok(DimPattern::Exact(d)),
        _ => Err(format!("`{s}` is no quantity")),
    }
}

fn parse_nested(text: &str, depth: usize) -> Result<Pattern, String> {
    let bad = || format!("`{text}` is no type");
    if depth == 0 {
        return Err(bad());
    }
    if let Some(inner) = text.strip_suffix('?') {
        return Ok(match parse_nested(inner.trim(), depth - 1)? {
            Pattern::Exact(t) => Pattern::Exact(t.optional()),
            p => Pattern::Option(Box::new(p)),
        });
    }
    let exact = |t| Ok(Pattern::Exact(t));
    if let Some(open) = text.find('<') {
        let inner = text[open + 1..].strip_suffix('>').ok_or_else(bad)?;
        let args = split_arguments(inner);
        return match (text[..open].trim(), args.as_slice()) {
            ("Quantity", [u]) => match Unit::parse(u) {
                _ if is_variable(u) => Ok(Pattern::Quantity(DimPattern::Var((*u).to_string()))),
                Ok(unit) => exact(Type::Quantity(unit.dim)),
                Err(e) => Err(format!("`{e}` is no unit")),
            },
            ("Heading", [f]) if is_variable(f) => Ok(Pattern::Heading((*f).to_string())),
            ("Point", [f]) if is_variable(f) => Ok(Pattern::Point((*f).to_string())),
            ("Pose", [f]) if is_variable(f) => Ok(Pattern::Pose((*f).to_string())),
            ("Heading", [f]) => exact(Type::Heading(Frame((*f).into()))),
            ("Point", [f]) => exact(Type::Point(Frame((*f).into()))),
            ("Pose", [f]) => exact(Type::Pose(Frame((*f).into()))),
            ("Vector", [f, d @ ..]) if d.len() < 2 => {
                let d = d.first().map_or(Ok(DimPattern::Exact(Dim::LENGTH)), |d| dim_pattern(d))?;
                match d {
                    DimPattern::Exact(d) if !is_variable(f) => exact(Type::Vector(Frame((*f).into()), d)),
                    d => Ok(Pattern::Vector((*f).to_string(), d)),
                }
            }
            ("Range", [d]) => Ok(match dim_pattern(d)? {
                DimPattern::Exact(d) => Pattern::Exact(Type::Range(d)),
                v => Pattern::Range(v),
            }),
            ("Distribution", [d]) => Ok(match dim_pattern(d)? {
                DimPattern::Exact(d) => Pattern::Exact(Type::Distribution(d)),
                v => Pattern::Distribution(v),
            }),
            ("List", [t, n]) => Ok(match (parse_nested(t, depth - 1)?, n.parse::<u32>()) {
                (Pattern::Exact(t), Ok(n)) => Pattern::Exact(Type::List(Box::new(t), n)),
                (p, _) => Pattern::List(Box::new(p), (*n).to_string()),
            }),
            ("Conversation", [name]) => exact(Type::Conversation((*name).into())),
            ("Matrix", [r, c]) => {
                let size = |s: &str| s.parse::<u8>().ok().filter(|n| (1..=8).contains(n)).ok_or_else(bad);
                exact(Type::Matrix(size(r)?, size(c)?))
            }
            _ => Err(bad()),
        };
    }
    if is_variable(text) {
        return Ok(Pattern::Var(text.to_string()));
    }
    if let Some(name) = text.strip_prefix("enum ") {
        return exact(Type::Enum(name.trim().into()));
    }
    if let Some(name) = text.strip_prefix("handle ") {
        return exact(Type::Handle(name.trim().into()));
    }
    match text {
        _ if OPAQUE.contains(&text) => exact(Type::Handle(text.into())),
        "Bool" => exact(Type::Bool),
        "Int" => exact(Type::Int),
        "Text" => exact(Type::Text),
        "Twist" => exact(Type::Twist),
        "Agent" => exact(Type::Agent),
        _ if Dim::named(text).is_some() => exact(Type::Quantity(Dim::named(text).unwrap_or_default())),
        _ if text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !text.is_empty() => {
            exact(Type::Record(text.into()))
        }
        _ => Err(bad()),
    }
}
