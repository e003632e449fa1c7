//! The types of the language, and how many registers a value of each takes.

use crate::Dim;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt, sync::Arc};

/// An interned name.
pub type Name = Arc<str>;

/// A coordinate frame after REP-105: `map`, `odom`, `base_link`, or one ending in `_optical`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Frame(pub Name);

impl Frame {
    /// World-fixed, x east, y north, z up.
    pub fn map() -> Self {
        Frame("map".into())
    }
    /// World-fixed where odometry began; drifts against `map`.
    pub fn odom() -> Self {
        Frame("odom".into())
    }
    /// Fixed to the robot: x forward, y left, z up.
    pub fn base_link() -> Self {
        Frame("base_link".into())
    }
    /// Whether `name` is a frame a mission may use.
    pub fn is_known(name: &str) -> bool {
        matches!(name, "map" | "odom" | "base_link") || name.ends_with("_optical")
    }
}

/// A type. Its textual form (`List<Length?, 8>`) is also its form in a graph file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Type {
    /// `Bool`
    Bool,
    /// `Int`: whole numbers within ±2^53.
    Int,
    /// `Length`, `Number`, `Quantity<m2/s>`.
    Quantity(Dim),
    /// `Text`: a constant text; only printed, never computed.
    Text,
    /// `Heading<map>`: a direction in the xy-plane of a frame, counter-clockwise from x; wraps.
    Heading(Frame),
    /// `Point<map>`: a position in metres.
    Point(Frame),
    /// `Vector<map>` (a displacement) or `Vector<map, Velocity>`.
    Vector(Frame, Dim),
    /// `Pose<map>`: position and orientation (unit quaternion).
    Pose(Frame),
    /// `Twist`: linear and angular velocity in `base_link`.
    Twist,
    /// An enum by name.
    Enum(Name),
    /// A record by name.
    Record(Name),
    /// `List<T, N>`: at most N items.
    List(Box<Type>, u32),
    /// `T?`: a value, or none with a reason.
    Option(Box<Type>),
    /// `Matrix<R, C>` of plain numbers.
    Matrix(u8, u8),
    /// `Range<Length>`: a closed interval.
    Range(Dim),
    /// `Distribution<Length>`: something to draw from.
    Distribution(Dim),
    /// `Agent`: an agent on a robot or host.
    Agent,
    /// `Conversation<deliver>`: a conversation that is going on.
    Conversation(Name),
    /// An opaque handle (`Image`), owned by a service.
    Handle(Name),
}

impl Type {
    /// `Number`.
    pub const NUMBER: Type = Type::Quantity(Dim::NONE);

    /// `self?`
    pub fn optional(self) -> Type {
        Type::Option(Box::new(self))
    }

    /// Whether a value of this type may stand where `wanted` is wanted: the same type, a whole number
    /// for a number, a shorter list for a longer one, a value for an optional.
    pub fn fits(&self, wanted: &Type) -> bool {
        match (self, wanted) {
            (Type::Int, Type::Quantity(Dim::NONE)) => true,
            (Type::List(a, n), Type::List(b, m)) => n <= m && (*n == 0 || a.fits_inside(b)),
            (Type::Option(a), Type::Option(b)) => a.fits_inside(b),
            _ => self == wanted,
        }
    }

    /// Whether readings or commands of this type can be handed to a port of type `port`: the same type, or a shorter list.
    pub fn serves(&self, port: &Type) -> bool {
        match (self, port) {
            (Type::List(a, n), Type::List(b, m)) => a == b && n <= m,
            _ => self == port,
        }
    }

    /// As [`Type::fits`], for parts whose register layout must be equal.
    fn fits_inside(&self, wanted: &Type) -> bool {
        self == wanted || (*self == Type::Int && *wanted == Type::NUMBER)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Type::Bool => f.write_str("Bool"),
            Type::Int => f.write_str("Int"),
            Type::Quantity(d) => write!(f, "{d}"),
            Type::Text => f.write_str("Text"),
            Type::Heading(x) => write!(f, "Heading<{}>", x.0),
            Type::Point(x) => write!(f, "Point<{}>", x.0),
            Type::Vector(x, Dim::LENGTH) => write!(f, "Vector<{}>", x.0),
            Type::Vector(x, d) => write!(f, "Vector<{}, {d}>", x.0),
            Type::Pose(x) => write!(f, "Pose<{}>", x.0),
            Type::Twist => f.write_str("Twist"),
            Type::Enum(n) => write!(f, "enum {n}"),
            Type::Record(n) => write!(f, "{n}"),
            Type::List(t, n) => write!(f, "List<{t}, {n}>"),
            Type::Option(t) => write!(f, "{t}?"),
            Type::Matrix(r, c) => write!(f, "Matrix<{r}, {c}>"),
            Type::Range(d) => write!(f, "Range<{d}>"),
            Type::Distribution(d) => write!(f, "Distribution<{d}>"),
            Type::Agent => f.write_str("Agent"),
            Type::Conversation(n) => write!(f, "Conversation<{n}>"),
            Type::Handle(n) if OPAQUE.contains(&&**n) => write!(f, "{n}"),
            Type::Handle(n) => write!(f, "handle {n}"),
        }
    }
}

impl From<Type> for String {
    fn from(t: Type) -> String {
        t.to_string()
    }
}

impl TryFrom<String> for Type {
    type Error = String;
    fn try_from(s: String) -> Result<Self, String> {
        crate::pattern::parse_type(&s)
    }
}

/// Types whose values are passed around and never looked into: only services can.
pub const OPAQUE: [&str; 6] = ["Image", "Sight", "People", "OccupancyGrid", "Particles", "Path"];

/// A record: named fields in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its name.
    pub name: Name,
    /// Fields in declaration order.
    pub fields: Vec<(Name, Type)>,
}

/// An enum: named variants without data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Enum {
    /// Its name.
    pub name: Name,
    /// Variants in declaration order; a value is the index.
    pub variants: Vec<Name>,
}

/// The records and enums that types name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TypeTable {
    /// Records by name.
    pub records: BTreeMap<Name, Record>,
    /// Enums by name.
    pub enums: BTreeMap<Name, Enum>,
}

/// The greatest number of registers one value may take.
pub const MAX_WIDTH: usize = 1 << 20;

impl TypeTable {
    /// Registers (f64) a value of type `t` takes; saturates at [`MAX_WIDTH`]. Layouts:
    /// point and vector x y z; pose x y z qx qy qz qw; twist vx vy vz wx wy wz; range low high;
    /// distribution kind a b c; record its fields in order; list count then items;
    /// optional a tag (0 = some, 1 + text index = none because) then the value.
    pub fn width(&self, t: &Type) -> usize {
        self.width_within(t, 64, &mut BTreeMap::new())
    }

    /// `known` are the widths of records that have been worked out, so that each is worked out once.
    fn width_within(&self, t: &Type, depth: usize, known: &mut BTreeMap<Name, usize>) -> usize {
        if depth == 0 {
            return MAX_WIDTH;
        }
        let w = match t {
            Type::Bool | Type::Int | Type::Quantity(_) | Type::Text | Type::Heading(_) => 1,
            Type::Enum(_) | Type::Handle(_) | Type::Agent | Type::Conversation(_) => 1,
            Type::Point(_) | Type::Vector(..) => 3,
            Type::Pose(_) => 7,
            Type::Twist => 6,
            Type::Range(_) => 2,
            Type::Distribution(_) => 4,
            Type::Matrix(r, c) => usize::from(*r) * usize::from(*c),
            Type::Option(t) => 1 + self.width_within(t, depth - 1, known),
            Type::List(_, 0) => 1,
            Type::List(t, n) => {
                self.width_within(t, depth - 1, known).saturating_mul(*n as usize).saturating_add(1)
            }
            Type::Record(n) => {
                if let Some(width) = known.get(n) {
                    return *width;
                }
                let fields = self.records.get(n).map(|r| r.fields.as_slice()).unwrap_or_default();
                // A record that holds itself is as wide as can be; one look at it is enough.
                let mut width = 0;
                for (_, t) in fields {
                    if width < MAX_WIDTH {
                        width += self.width_within(t, depth - 1, known);
                    }
                }
                known.insert(n.clone(), width);
                width
            }
        };
        w.min(MAX_WIDTH)
    }

    /// Offset in registers and type of field `index` of record `name`.
    pub fn field(&self, name: &str, index: usize) -> Option<(usize, &Type)> {
        let record = self.records.get(name)?;
        let t = &record.fields.get(index)?.1;
        Some((record.fields[..index].iter().map(|(_, t)| self.width(t)).sum(), t))
    }
}
