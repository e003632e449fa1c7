//! Typing of operators. The checker uses it on sources, the verifier on graphs.

use crate::{Binary, Dim, Part, Type};

/// Result type of a binary operator; `None` when the operands do not go together.
pub fn binary(op: Binary, a: &Type, b: &Type) -> Option<Type> {
    use Binary as B;
    use Type as T;
    match op {
        B::And | B::Or => (*a == T::Bool && *b == T::Bool).then_some(T::Bool),
        B::Eq | B::Ne => comparable(a, b).then_some(T::Bool),
        B::Lt | B::Le | B::Gt | B::Ge => match (number(a)?, number(b)?) {
            (x, y) if x == y => Some(T::Bool),
            _ => None,
        },
        B::Add => match (a, b) {
            (T::Int, T::Int) => Some(T::Int),
            (T::Point(f), T::Vector(g, Dim::LENGTH)) if f == g => Some(a.clone()),
            (T::Vector(f, d), T::Vector(g, e)) if f == g && d == e => Some(a.clone()),
            (T::Heading(_), T::Quantity(Dim::ANGLE)) => Some(a.clone()),
            (T::Matrix(..), T::Matrix(..)) if a == b => Some(a.clone()),
            (T::Twist, T::Twist) => Some(T::Twist),
            _ => same_quantity(a, b),
        },
        B::Sub => match (a, b) {
            (T::Int, T::Int) => Some(T::Int),
            (T::Point(f), T::Point(g)) if f == g => Some(T::Vector(f.clone(), Dim::LENGTH)),
            (T::Point(f), T::Vector(g, Dim::LENGTH)) if f == g => Some(a.clone()),
            (T::Vector(f, d), T::Vector(g, e)) if f == g && d == e => Some(a.clone()),
            (T::Heading(f), T::Heading(g)) if f == g => Some(T::Quantity(Dim::ANGLE)),
            (T::Heading(_), T::Quantity(Dim::ANGLE)) => Some(a.clone()),
            (T::Matrix(..), T::Matrix(..)) if a == b => Some(a.clone()),
            _ => same_quantity(a, b),
        },
        B::Mul => match (a, b) {
            (T::Int, T::Int) => Some(T::Int),
            (T::Vector(f, d), s) | (s, T::Vector(f, d)) => Some(T::Vector(f.clone(), d.times(number(s)?)?)),
            (T::Matrix(r, n), T::Matrix(m, c)) => (n == m).then_some(T::Matrix(*r, *c)),
            (T::Matrix(r, c), s) | (s, T::Matrix(r, c)) => {
                (number(s)? == Dim::NONE).then_some(T::Matrix(*r, *c))
            }
            (T::Twist, s) | (s, T::Twist) => (number(s)? == Dim::NONE).then_some(T::Twist),
            _ => Some(T::Quantity(number(a)?.times(number(b)?)?)),
        },
        B::Div => match a {
            T::Vector(f, d) => Some(T::Vector(f.clone(), d.over(number(b)?)?)),
            _ => Some(T::Quantity(number(a)?.over(number(b)?)?)),
        },
    }
}

/// The dimension of a quantity or whole number.
pub fn number(t: &Type) -> Option<Dim> {
    match t {
        Type::Quantity(d) => Some(*d),
        Type::Int => Some(Dim::NONE),
        _ => None,
    }
}

fn same_quantity(a: &Type, b: &Type) -> Option<Type> {
    let d = number(a)?;
    (d == number(b)?).then_some(Type::Quantity(d))
}

/// Whether `==` is defined: between values of one type that hold no lists.
fn comparable(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (
            Type::List(..) | Type::Matrix(..) | Type::Record(_) | Type::Distribution(_) | Type::Option(_),
            _,
        ) => false,
        (Type::Quantity(_) | Type::Int, _) => number(a).is_some() && number(a) == number(b),
        _ => a == b,
    }
}

/// Result type of unary minus.
pub fn negate(t: &Type) -> Option<Type> {
    match t {
        Type::Int | Type::Quantity(_) | Type::Vector(..) | Type::Matrix(..) | Type::Twist => Some(t.clone()),
        _ => None,
    }
}

/// Result type of an integer power.
pub fn power(t: &Type, n: i32) -> Option<Type> {
    match t {
        Type::Int if n >= 0 => Some(Type::Int),
        _ => Some(Type::Quantity(number(t)?.power(n)?)),
    }
}

/// Result type of a square root.
pub fn sqrt(t: &Type) -> Option<Type> {
    Some(Type::Quantity(number(t)?.sqrt()?))
}

/// Result type of a dot product.
pub fn dot(a: &Type, b: &Type) -> Option<Type> {
    match (a, b) {
        (Type::Vector(f, d), Type::Vector(g, e)) if f == g => Some(Type::Quantity(d.times(*e)?)),
        _ => None,
    }
}

/// The part called `name` of a built-in type, with its type.
pub fn part(t: &Type, name: &str) -> Option<(Part, Type)> {
    let (part, ty) = match (t, name) {
        (Type::Point(_), "x") => (Part::X, Type::Quantity(Dim::LENGTH)),
        (Type::Point(_), "y") => (Part::Y, Type::Quantity(Dim::LENGTH)),
        (Type::Point(_), "z") => (Part::Z, Type::Quantity(Dim::LENGTH)),
        (Type::Vector(_, d), "x") => (Part::X, Type::Quantity(*d)),
        (Type::Vector(_, d), "y") => (Part::Y, Type::Quantity(*d)),
        (Type::Vector(_, d), "z") => (Part::Z, Type::Quantity(*d)),
        (Type::Pose(f), "position") => (Part::Position, Type::Point(f.clone())),
        (Type::Pose(f), "heading") => (Part::Heading, Type::Heading(f.clone())),
        (Type::Pose(_), "roll") => (Part::Roll, Type::Quantity(Dim::ANGLE)),
        (Type::Pose(_), "pitch") => (Part::Pitch, Type::Quantity(Dim::ANGLE)),
        (Type::Twist, "forward") => (Part::Forward, Type::Quantity(Dim::VELOCITY)),
        (Type::Twist, "left") => (Part::Left, Type::Quantity(Dim::VELOCITY)),
        (Type::Twist, "up") => (Part::Up, Type::Quantity(Dim::VELOCITY)),
        (Type::Twist, "turn") => (Part::Turn, Type::Quantity(Dim::ANGULAR_VELOCITY)),
        _ => return None,
    };
    Some((part, ty))
}

/// The names [`part`] knows for a type.
pub fn parts_of(t: &Type) -> &'static [&'static str] {
    match t {
        Type::Point(_) | Type::Vector(..) => &["x", "y", "z"],
        Type::Pose(_) => &["position", "heading", "roll", "pitch"],
        Type::Twist => &["forward", "left", "up", "turn"],
        _ => &[],
    }
}

/// Type of what is known of the executions of a unit.
pub fn execution(which: crate::Execution) -> Type {
    match which {
        crate::Execution::Activations | crate::Execution::Misses => Type::Int,
        crate::Execution::Response => Type::Quantity(Dim::TIME),
    }
}
