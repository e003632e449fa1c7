//! Numbers of a record as text, exactly. JSON has no NaN and no infinity, yet a driver may hand one
//! over, and a replay must see what the run saw: they are written as the texts `"NaN"`, `"inf"` and
//! `"-inf"`. For `#[serde(with = …)]`.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser::SerializeSeq};
use std::fmt;

/// One number.
#[derive(Clone, Copy, Default)]
struct Exact(f64);

impl Serialize for Exact {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            x if x.is_finite() => s.serialize_f64(x),
            x if x.is_nan() => s.serialize_str("NaN"),
            x if x > 0.0 => s.serialize_str("inf"),
            _ => s.serialize_str("-inf"),
        }
    }
}

impl<'de> Deserialize<'de> for Exact {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Exact;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number, \"NaN\", \"inf\" or \"-inf\"")
            }
            fn visit_f64<E>(self, x: f64) -> Result<Exact, E> {
                Ok(Exact(x))
            }
            fn visit_i64<E>(self, x: i64) -> Result<Exact, E> {
                Ok(Exact(x as f64))
            }
            fn visit_u64<E>(self, x: u64) -> Result<Exact, E> {
                Ok(Exact(x as f64))
            }
            fn visit_str<E: de::Error>(self, s: &str) -> Result<Exact, E> {
                match s {
                    "NaN" => Ok(Exact(f64::NAN)),
                    "inf" => Ok(Exact(f64::INFINITY)),
                    "-inf" => Ok(Exact(f64::NEG_INFINITY)),
                    _ => Err(E::invalid_value(de::Unexpected::Str(s), &self)),
                }
            }
        }
        d.deserialize_any(Visitor)
    }
}

/// Registers.
pub(crate) mod registers {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(values: &[f64], s: S) -> Result<S::Ok, S::Error> {
        let mut seq = s.serialize_seq(Some(values.len()))?;
        for x in values {
            seq.serialize_element(&Exact(*x))?;
        }
        seq.end()
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<f64>, D::Error> {
        Ok(Vec::<Exact>::deserialize(d)?.into_iter().map(|x| x.0).collect())
    }
}

/// A pose.
pub(crate) mod pose {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(pose: &[f64; 7], s: S) -> Result<S::Ok, S::Error> {
        registers::serialize(pose, s)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<[f64; 7], D::Error> {
        Ok(<[Exact; 7]>::deserialize(d)?.map(|x| x.0))
    }
}

/// A number.
pub(crate) mod number {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(x: &f64, s: S) -> Result<S::Ok, S::Error> {
        Exact(*x).serialize(s)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<f64, D::Error> {
        Ok(Exact::deserialize(d)?.0)
    }
}

/// A number that may be absent.
pub(crate) mod optional {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(x: &Option<f64>, s: S) -> Result<S::Ok, S::Error> {
        x.map(Exact).serialize(s)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<Exact>::deserialize(d)?.map(|x| x.0))
    }
}
