//! Reads the arguments of a component and refuses what a simulation cannot work with.

use soifra_graph::{Distribution, Value};
use soifra_runtime::{Time, scene::Part};

/// The arguments of one component, with where it stands for messages.
#[derive(Debug, Clone, Copy)]
pub struct Args<'a> {
    /// The component.
    pub part: &'a Part,
    /// `the world`, or the platform it belongs to.
    pub of: &'a str,
}

impl<'a> Args<'a> {
    /// A message about this component.
    pub fn wrong(&self, what: impl std::fmt::Display) -> String {
        let Part { role, name, model, .. } = self.part;
        let name = if name.is_empty() { String::new() } else { format!(" `{name}`") };
        format!("{}: {role}{name} ({model}): {what}", self.of)
    }

    /// The argument as it came, an optional opened.
    fn get(&self, name: &str) -> Option<&'a Value> {
        match self.part.args.get(name)? {
            Value::Some(v) => Some(v),
            Value::None(_) => None,
            v => Some(v),
        }
    }

    fn missing(&self, name: &str) -> String {
        self.wrong(format_args!("`{name}` is missing or of the wrong type"))
    }

    /// A finite number, SI units.
    pub fn number(&self, name: &str) -> Result<f64, String> {
        let x = self.get(name).and_then(Value::number).ok_or_else(|| self.missing(name))?;
        if x.is_finite() { Ok(x) } else { Err(self.wrong(format_args!("`{name}` is not finite"))) }
    }

    /// A number that is at least zero.
    pub fn at_least_zero(&self, name: &str) -> Result<f64, String> {
        let x = self.number(name)?;
        if x >= 0.0 { Ok(x) } else { Err(self.wrong(format_args!("`{name}` is negative"))) }
    }

    /// A number greater than zero.
    pub fn positive(&self, name: &str) -> Result<f64, String> {
        let x = self.number(name)?;
        if x > 0.0 { Ok(x) } else { Err(self.wrong(format_args!("`{name}` must be greater than zero"))) }
    }

    /// A chance, 0 to 1.
    pub fn chance(&self, name: &str) -> Result<f64, String> {
        let x = self.number(name)?;
        if (0.0..=1.0).contains(&x) {
            Ok(x)
        } else {
            Err(self.wrong(format_args!("`{name}` is no chance between 0 and 1")))
        }
    }

    /// Whether an optional argument was given.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// A number of things, at least one and at most `most`.
    pub fn count(&self, name: &str, most: i64) -> Result<usize, String> {
        match self.get(name) {
            Some(Value::Int(n)) if (1..=most).contains(n) => Ok(*n as usize),
            Some(Value::Int(_)) => Err(self.wrong(format_args!("`{name}` must be between 1 and {most}"))),
            _ => Err(self.missing(name)),
        }
    }

    /// A span of time that is not negative.
    pub fn duration(&self, name: &str) -> Result<Time, String> {
        Time::from_seconds(self.at_least_zero(name)?)
            .ok_or_else(|| self.wrong(format_args!("`{name}` is longer than virtual time can count")))
    }

    /// A period: at least a microsecond, so that a run has a bounded number of events.
    pub fn period(&self, name: &str) -> Result<Time, String> {
        let t = self.duration(name)?;
        if t >= Time(1000) { Ok(t) } else { Err(self.wrong(format_args!("`{name}` is shorter than 1 us"))) }
    }

    /// A point or vector.
    pub fn vector(&self, name: &str) -> Result<[f64; 3], String> {
        match self.get(name) {
            Some(Value::Vector(v)) if v.iter().all(|x| x.is_finite()) => Ok(*v),
            Some(Value::Vector(_)) => Err(self.wrong(format_args!("`{name}` is not finite"))),
            _ => Err(self.missing(name)),
        }
    }

    /// A list of items.
    pub fn list(&self, name: &str) -> Result<&'a [Value], String> {
        match self.get(name) {
            Some(Value::List(items)) => Ok(items),
            _ => Err(self.missing(name)),
        }
    }

    /// A list of numbers, not empty.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        let items = self.list(name)?;
        let all: Vec<f64> = items.iter().filter_map(Value::number).filter(|x| x.is_finite()).collect();
        if all.is_empty() || all.len() < items.len() { Err(self.missing(name)) } else { Ok(all) }
    }

    /// A list of points in the plane, not empty.
    pub fn points(&self, name: &str) -> Result<Vec<[f64; 2]>, String> {
        let items = self.list(name)?;
        let all: Vec<[f64; 2]> = items
            .iter()
            .filter_map(|v| match v {
                Value::Vector([x, y, _]) if x.is_finite() && y.is_finite() => Some([*x, *y]),
                _ => None,
            })
            .collect();
        if all.is_empty() || all.len() < items.len() { Err(self.missing(name)) } else { Ok(all) }
    }

    /// A closed interval, low end first.
    pub fn range(&self, name: &str) -> Result<(f64, f64), String> {
        match self.get(name) {
            Some(Value::Range(a, b)) if a.is_finite() && b.is_finite() && a <= b => Ok((*a, *b)),
            Some(Value::Range(..)) => Err(self.wrong(format_args!("`{name}` is no interval, low end first"))),
            _ => Err(self.missing(name)),
        }
    }

    /// A range of distances: none below zero, and not empty.
    pub fn reach(&self, name: &str) -> Result<(f64, f64), String> {
        match self.range(name)? {
            (a, b) if a >= 0.0 && b > 0.0 => Ok((a, b)),
            _ => Err(self.wrong(format_args!("`{name}` must be greater than zero"))),
        }
    }

    /// A distribution; a plain number is an exact one.
    pub fn distribution(&self, name: &str) -> Result<Distribution, String> {
        let d = match self.get(name) {
            Some(Value::Distribution(d)) => *d,
            Some(v) => Distribution::Exact(v.number().ok_or_else(|| self.missing(name))?),
            None => return Err(self.missing(name)),
        };
        if d.registers().iter().all(|x| x.is_finite()) {
            Ok(d)
        } else {
            Err(self.wrong(format_args!("`{name}` is not finite")))
        }
    }

    /// A text.
    pub fn text(&self, name: &str) -> &'a str {
        match self.get(name) {
            Some(Value::Text(s)) => s,
            _ => "",
        }
    }
}
