//! Dimensions of quantities, their names, and the units they are written in.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Exponents of length, mass, time, current, temperature, angle, step and pixel.
///
/// Angle, step and pixel are dimensions of their own, so that `deg/s` is not `1/s` and
/// `cm/step` is not `cm/s`. Values are stored in metres, kilograms, seconds, amperes, kelvins,
/// radians, steps and pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
pub struct Dim(pub [i8; 8]);

const BASE: [&str; 8] = ["m", "kg", "s", "A", "K", "rad", "step", "px"];

impl Dim {
    /// A plain number.
    pub const NONE: Dim = Dim([0; 8]);
    /// m
    pub const LENGTH: Dim = Dim([1, 0, 0, 0, 0, 0, 0, 0]);
    /// s
    pub const TIME: Dim = Dim([0, 0, 1, 0, 0, 0, 0, 0]);
    /// m/s
    pub const VELOCITY: Dim = Dim([1, 0, -1, 0, 0, 0, 0, 0]);
    /// rad
    pub const ANGLE: Dim = Dim([0, 0, 0, 0, 0, 1, 0, 0]);
    /// rad/s
    pub const ANGULAR_VELOCITY: Dim = Dim([0, 0, -1, 0, 0, 1, 0, 0]);
    /// step
    pub const STEP: Dim = Dim([0, 0, 0, 0, 0, 0, 1, 0]);

    /// Product of two quantities, `None` when an exponent leaves ±100.
    pub fn times(self, other: Dim) -> Option<Dim> {
        self.zip(other, |a, b| a + b)
    }

    /// Quotient of two quantities.
    pub fn over(self, other: Dim) -> Option<Dim> {
        self.zip(other, |a, b| a - b)
    }

    /// Integer power.
    pub fn power(self, n: i32) -> Option<Dim> {
        let mut out = [0; 8];
        for (o, a) in out.iter_mut().zip(self.0) {
            *o = narrow(i32::from(a).checked_mul(n)?)?;
        }
        Some(Dim(out))
    }

    /// Square root, `None` when an exponent is odd.
    pub fn sqrt(self) -> Option<Dim> {
        self.0.iter().all(|e| e % 2 == 0).then(|| Dim(self.0.map(|e| e / 2)))
    }

    fn zip(self, other: Dim, f: impl Fn(i32, i32) -> i32) -> Option<Dim> {
        let mut out = [0; 8];
        for (o, (a, b)) in out.iter_mut().zip(self.0.into_iter().zip(other.0)) {
            *o = narrow(f(i32::from(a), i32::from(b)))?;
        }
        Some(Dim(out))
    }

    /// The name a user writes for this dimension (`Length`), if it has one.
    pub fn name(self) -> Option<&'static str> {
        QUANTITIES.iter().find(|(_, dim)| *dim == self).map(|(n, _)| *n)
    }

    /// The dimension called `name`.
    pub fn named(name: &str) -> Option<Dim> {
        QUANTITIES.iter().find(|(n, _)| *n == name).map(|(_, d)| *d)
    }

    /// The SI unit, as `m/s2`; empty for a plain number.
    pub fn si_unit(self) -> String {
        let part = |sign: i8| {
            BASE.iter()
                .zip(self.0)
                .filter(|(_, e)| e * sign > 0)
                .map(|(b, e)| if e.abs() == 1 { (*b).to_string() } else { format!("{b}{}", e.abs()) })
                .collect::<Vec<_>>()
        };
        let (above, below) = (part(1), part(-1));
        let mut s = above.join("*");
        if !below.is_empty() {
            if s.is_empty() {
                s.push('1');
            }
            for b in below {
                s.push('/');
                s.push_str(&b);
            }
        }
        s
    }
}

fn narrow(e: i32) -> Option<i8> {
    (-100..=100).contains(&e).then_some(e as i8)
}

impl fmt::Display for Dim {
    /// `Length`, or `Quantity<m2/s>` for one without a name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(n) => f.write_str(n),
            None => write!(f, "Quantity<{}>", self.si_unit()),
        }
    }
}

/// Names of dimensions that types may use.
pub const QUANTITIES: &[(&str, Dim)] = &[
    ("Number", Dim::NONE),
    ("Length", Dim::LENGTH),
    ("Area", Dim([2, 0, 0, 0, 0, 0, 0, 0])),
    ("Volume", Dim([3, 0, 0, 0, 0, 0, 0, 0])),
    ("Mass", Dim([0, 1, 0, 0, 0, 0, 0, 0])),
    ("Duration", Dim::TIME),
    ("Frequency", Dim([0, 0, -1, 0, 0, 0, 0, 0])),
    ("Velocity", Dim::VELOCITY),
    ("Acceleration", Dim([1, 0, -2, 0, 0, 0, 0, 0])),
    ("Angle", Dim::ANGLE),
    ("AngularVelocity", Dim::ANGULAR_VELOCITY),
    ("AngularAcceleration", Dim([0, 0, -2, 0, 0, 1, 0, 0])),
    ("Force", Dim([1, 1, -2, 0, 0, 0, 0, 0])),
    ("Energy", Dim([2, 1, -2, 0, 0, 0, 0, 0])),
    ("Torque", Dim([2, 1, -2, 0, 0, 0, 0, 0])),
    ("Power", Dim([2, 1, -3, 0, 0, 0, 0, 0])),
    ("Inertia", Dim([2, 1, 0, 0, 0, 0, 0, 0])),
    ("Current", Dim([0, 0, 0, 1, 0, 0, 0, 0])),
    ("Voltage", Dim([2, 1, -3, -1, 0, 0, 0, 0])),
    ("Resistance", Dim([2, 1, -3, -2, 0, 0, 0, 0])),
    ("Inductance", Dim([2, 1, -2, -2, 0, 0, 0, 0])),
    ("Charge", Dim([0, 0, 1, 1, 0, 0, 0, 0])),
    ("Temperature", Dim([0, 0, 0, 0, 1, 0, 0, 0])),
    ("Steps", Dim::STEP),
    ("Pace", Dim([1, 0, 0, 0, 0, 0, -1, 0])),
    ("Pixels", Dim([0, 0, 0, 0, 0, 0, 0, 1])),
    ("Curvature", Dim([-1, 0, 0, 0, 0, 0, 0, 0])),
];

/// How a unit scales into SI: by a power of ten (exact in decimal), or by a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    Ten(i32),
    Factor(f64),
}

const ATOMS: &[(&str, Dim, Scale)] = &[
    ("m", Dim::LENGTH, Scale::Ten(0)),
    ("km", Dim::LENGTH, Scale::Ten(3)),
    ("dm", Dim::LENGTH, Scale::Ten(-1)),
    ("cm", Dim::LENGTH, Scale::Ten(-2)),
    ("mm", Dim::LENGTH, Scale::Ten(-3)),
    ("um", Dim::LENGTH, Scale::Ten(-6)),
    ("s", Dim::TIME, Scale::Ten(0)),
    ("ms", Dim::TIME, Scale::Ten(-3)),
    ("us", Dim::TIME, Scale::Ten(-6)),
    ("ns", Dim::TIME, Scale::Ten(-9)),
    ("min", Dim::TIME, Scale::Factor(60.0)),
    ("h", Dim::TIME, Scale::Factor(3600.0)),
    ("Hz", Dim([0, 0, -1, 0, 0, 0, 0, 0]), Scale::Ten(0)),
    ("kHz", Dim([0, 0, -1, 0, 0, 0, 0, 0]), Scale::Ten(3)),
    ("rad", Dim::ANGLE, Scale::Ten(0)),
    ("mrad", Dim::ANGLE, Scale::Ten(-3)),
    ("deg", Dim::ANGLE, Scale::Factor(std::f64::consts::PI / 180.0)),
    ("rpm", Dim::ANGULAR_VELOCITY, Scale::Factor(std::f64::consts::PI / 30.0)),
    ("kg", Dim([0, 1, 0, 0, 0, 0, 0, 0]), Scale::Ten(0)),
    ("g", Dim([0, 1, 0, 0, 0, 0, 0, 0]), Scale::Ten(-3)),
    ("N", Dim([1, 1, -2, 0, 0, 0, 0, 0]), Scale::Ten(0)),
    ("J", Dim([2, 1, -2, 0, 0, 0, 0, 0]), Scale::Ten(0)),
    ("kJ", Dim([2, 1, -2, 0, 0, 0, 0, 0]), Scale::Ten(3)),
    ("W", Dim([2, 1, -3, 0, 0, 0, 0, 0]), Scale::Ten(0)),
    ("V", Dim([2, 1, -3, -1, 0, 0, 0, 0]), Scale::Ten(0)),
    ("A", Dim([0, 0, 0, 1, 0, 0, 0, 0]), Scale::Ten(0)),
    ("mA", Dim([0, 0, 0, 1, 0, 0, 0, 0]), Scale::Ten(-3)),
    ("Ohm", Dim([2, 1, -3, -2, 0, 0, 0, 0]), Scale::Ten(0)),
    ("H", Dim([2, 1, -2, -2, 0, 0, 0, 0]), Scale::Ten(0)),
    ("K", Dim([0, 0, 0, 0, 1, 0, 0, 0]), Scale::Ten(0)),
    ("step", Dim::STEP, Scale::Ten(0)),
    ("steps", Dim::STEP, Scale::Ten(0)),
    ("px", Dim([0, 0, 0, 0, 0, 0, 0, 1]), Scale::Ten(0)),
    ("%", Dim::NONE, Scale::Ten(-2)),
];

/// Every unit name, for completion and did-you-mean.
pub fn unit_names() -> impl Iterator<Item = &'static str> {
    ATOMS.iter().map(|(n, _, _)| *n)
}

/// A unit expression such as `m`, `rad/s2`, `kg*m2`, `cm/step`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Its dimension.
    pub dim: Dim,
    ten: i32,
    factor: f64,
}

impl Unit {
    /// Parses a unit expression; the error is the part that is no unit.
    pub fn parse(text: &str) -> Result<Unit, String> {
        let mut unit = Unit { dim: Dim::NONE, ten: 0, factor: 1.0 };
        let mut below = false;
        for (i, part) in text.split_inclusive(['/', '*']).enumerate() {
            let atom = part.trim_end_matches(['/', '*']);
            let digits = atom.len() - atom.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            let (name, exponent) = atom.split_at(atom.len() - digits);
            let name = name.trim_end_matches('^');
            let mut n: i32 =
                if exponent.is_empty() { 1 } else { exponent.parse().map_err(|_| atom.to_string())? };
            if name.is_empty() && exponent == "1" && i == 0 {
                below = part.ends_with('/');
                continue;
            }
            if below {
                n = -n;
            }
            let (_, dim, scale) =
                ATOMS.iter().find(|(a, _, _)| *a == name).ok_or_else(|| atom.to_string())?;
            unit.dim = dim.power(n).and_then(|p| unit.dim.times(p)).ok_or_else(|| atom.to_string())?;
            match scale {
                Scale::Ten(t) => {
                    unit.ten = t
                        .checked_mul(n)
                        .and_then(|t| t.checked_add(unit.ten))
                        .filter(|t| t.abs() < 400)
                        .ok_or_else(|| atom.to_string())?
                }
                Scale::Factor(f) => unit.factor *= libm::pow(*f, f64::from(n)),
            }
            below = part.ends_with('/');
        }
        Ok(unit)
    }

    /// The SI value of a decimal literal in this unit. Powers of ten are applied in decimal, so that
    /// `70.4 mm` is the double nearest to 0.0704. `None` when the result is not finite.
    pub fn value(&self, literal: &str) -> Option<f64> {
        let clean: String = literal.chars().filter(|c| *c != '_').collect();
        let (mantissa, exponent) = match clean.split_once(['e', 'E']) {
            Some((m, e)) => (m.to_string(), e.parse::<i32>().ok()?),
            None => (clean, 0),
        };
        let v: f64 = format!("{mantissa}e{}", exponent.checked_add(self.ten)?).parse().ok()?;
        let v = v * self.factor;
        v.is_finite().then_some(v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_units_are_exact() {
        assert_eq!(Unit::parse("mm").unwrap().value("70.4"), Some(0.0704));
        assert_eq!(Unit::parse("us").unwrap().value("89.28"), Some(89.28e-6));
        assert_eq!(Unit::parse("rad/s2").unwrap().dim, Dim::named("AngularAcceleration").unwrap());
        assert_eq!(Unit::parse("cm/step").unwrap().dim, Dim::named("Pace").unwrap());
        assert_eq!(Unit::parse("1/s").unwrap().dim, Dim::named("Frequency").unwrap());
        assert_eq!(Unit::parse("furlong"), Err("furlong".into()));
    }
}
