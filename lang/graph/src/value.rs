//! Values as data: constants in a graph, parameters, scene arguments, and what traces show.

use crate::{Name, Type, TypeTable};
use serde::{Deserialize, Serialize};

/// A value. Quantities are in SI units; headings and angles in radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Value {
    /// Truth value.
    Bool(bool),
    /// Whole number.
    Int(i64),
    /// Quantity or heading.
    Number(f64),
    /// Text.
    Text(String),
    /// Enum variant by name.
    Variant(Name),
    /// Point or vector.
    Vector([f64; 3]),
    /// Pose: x y z, qx qy qz qw.
    Pose([f64; 7]),
    /// Twist: vx vy vz, wx wy wz.
    Twist([f64; 6]),
    /// Record fields in declaration order.
    Record(Vec<Value>),
    /// List items.
    List(Vec<Value>),
    /// Present optional.
    Some(Box<Value>),
    /// Absent optional with its reason.
    None(String),
    /// Closed interval.
    Range(f64, f64),
    /// Distribution.
    Distribution(Distribution),
    /// Matrix rows, flattened.
    Matrix(Vec<f64>),
}

/// What can be drawn from. Parameters are in the unit of what is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Always this value.
    Exact(f64),
    /// Gaussian with mean and standard deviation.
    Normal(f64, f64),
    /// Uniform between low and high.
    Uniform(f64, f64),
    /// Best, mean and worst case, bulk at the best: a scaled beta with that mean.
    Skewed(f64, f64, f64),
}

impl Distribution {
    /// Register form: kind, a, b, c.
    pub fn registers(self) -> [f64; 4] {
        match self {
            Distribution::Exact(a) => [0.0, a, 0.0, 0.0],
            Distribution::Normal(a, b) => [1.0, a, b, 0.0],
            Distribution::Uniform(a, b) => [2.0, a, b, 0.0],
            Distribution::Skewed(a, b, c) => [3.0, a, b, c],
        }
    }

    /// Back from register form.
    pub fn from_registers(r: &[f64]) -> Self {
        match r[0] as i64 {
            1 => Distribution::Normal(r[1], r[2]),
            2 => Distribution::Uniform(r[1], r[2]),
            3 => Distribution::Skewed(r[1], r[2], r[3]),
            _ => Distribution::Exact(r[1]),
        }
    }
}

/// Texts that registers refer to by index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Texts(pub Vec<String>);

impl Default for Texts {
    /// The table of [`crate::reason::REASONS`], which every table starts with.
    fn default() -> Self {
        Texts(crate::reason::REASONS.iter().map(|r| (*r).to_string()).collect())
    }
}

impl Texts {
    /// Index of `text`, added when new.
    pub fn intern(&mut self, text: &str) -> usize {
        self.0.iter().position(|t| t == text).unwrap_or_else(|| {
            self.0.push(text.to_string());
            self.0.len() - 1
        })
    }

    /// The text at `index`, empty when there is none.
    pub fn get(&self, index: usize) -> &str {
        self.0.get(index).map_or("", String::as_str)
    }
}

impl Value {
    /// Appends the register form of this value as a `t`; `None` when it is not one.
    pub fn flatten(&self, t: &Type, table: &TypeTable, texts: &mut Texts, out: &mut Vec<f64>) -> Option<()> {
        let end = out.len() + table.width(t);
        match (self, t) {
            (Value::Bool(b), Type::Bool) => out.push(f64::from(u8::from(*b))),
            (
                Value::Int(i),
                Type::Int | Type::Quantity(_) | Type::Handle(_) | Type::Agent | Type::Conversation(_),
            ) => out.push(*i as f64),
            (Value::Number(x), Type::Quantity(_) | Type::Heading(_)) => out.push(*x),
            (Value::Text(s), Type::Text) => out.push(texts.intern(s) as f64),
            (Value::Variant(v), Type::Enum(n)) => {
                let i = table.enums.get(n)?.variants.iter().position(|x| x == v)?;
                out.push(i as f64);
            }
            (Value::Vector(v), Type::Point(_) | Type::Vector(..)) => out.extend(v),
            (Value::Pose(v), Type::Pose(_)) => out.extend(v),
            (Value::Twist(v), Type::Twist) => out.extend(v),
            (Value::Range(a, b), Type::Range(_)) => out.extend([a, b]),
            (Value::Distribution(d), Type::Distribution(_)) => out.extend(d.registers()),
            (Value::Matrix(m), Type::Matrix(r, c)) if m.len() == usize::from(*r) * usize::from(*c) => {
                out.extend(m)
            }
            (Value::Record(fields), Type::Record(n)) => {
                let record = table.records.get(n)?;
                if record.fields.len() != fields.len() {
                    return None;
                }
                for (v, (_, t)) in fields.iter().zip(&record.fields) {
                    v.flatten(t, table, texts, out)?;
                }
            }
            (Value::List(items), Type::List(t, n)) => {
                if items.len() > *n as usize {
                    return None;
                }
                out.push(items.len() as f64);
                for v in items {
                    v.flatten(t, table, texts, out)?;
                }
                out.resize(end, 0.0);
            }
            (Value::Some(v), Type::Option(t)) => {
                out.push(0.0);
                v.flatten(t, table, texts, out)?;
            }
            (Value::None(why), Type::Option(_)) => {
                out.push(1.0 + texts.intern(why) as f64);
                out.resize(end, 0.0);
            }
            _ => return None,
        }
        Some(())
    }

    /// Reads a `t` back from registers; missing registers read as zero.
    pub fn from_registers(r: &[f64], t: &Type, table: &TypeTable, texts: &Texts) -> Value {
        let at = |i: usize| r.get(i).copied().unwrap_or(0.0);
        match t {
            Type::Bool => Value::Bool(at(0) != 0.0),
            Type::Int | Type::Handle(_) | Type::Agent | Type::Conversation(_) => Value::Int(at(0) as i64),
            Type::Quantity(_) | Type::Heading(_) => Value::Number(at(0)),
            Type::Text => Value::Text(texts.get(at(0) as usize).to_string()),
            Type::Enum(n) => {
                let variant = table.enums.get(n).and_then(|e| e.variants.get(at(0) as usize));
                Value::Variant(variant.cloned().unwrap_or_else(|| "?".into()))
            }
            Type::Point(_) | Type::Vector(..) => Value::Vector(std::array::from_fn(at)),
            Type::Pose(_) => Value::Pose(std::array::from_fn(at)),
            Type::Twist => Value::Twist(std::array::from_fn(at)),
            Type::Range(_) => Value::Range(at(0), at(1)),
            Type::Distribution(_) => {
                Value::Distribution(Distribution::from_registers(&[at(0), at(1), at(2), at(3)]))
            }
            Type::Matrix(..) => Value::Matrix((0..table.width(t)).map(at).collect()),
            Type::Record(n) => {
                let mut from = 0;
                let fields = table.records.get(n).map(|r| r.fields.as_slice()).unwrap_or_default();
                Value::Record(
                    fields
                        .iter()
                        .map(|(_, t)| {
                            let v = Value::from_registers(r.get(from..).unwrap_or_default(), t, table, texts);
                            from += table.width(t);
                            v
                        })
                        .collect(),
                )
            }
            Type::List(t, n) => {
                let (w, count) = (table.width(t), (at(0) as usize).min(*n as usize));
                Value::List(
                    (0..count)
                        .map(|i| {
                            Value::from_registers(r.get(1 + i * w..).unwrap_or_default(), t, table, texts)
                        })
                        .collect(),
                )
            }
            Type::Option(t) => match at(0) as usize {
                0 => Value::Some(Box::new(Value::from_registers(
                    r.get(1..).unwrap_or_default(),
                    t,
                    table,
                    texts,
                ))),
                n => Value::None(texts.get(n - 1).to_string()),
            },
        }
    }

    /// The number of a quantity, heading or whole number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Number(x) => Some(*x),
            Value::Int(i) => Some(*i as f64),
            _ => None,
        }
    }
}
