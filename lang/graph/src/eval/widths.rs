//! Register layouts of types, checked: unknown and endless records are errors here.

use super::code::Shape;
use crate::{Name, Type, TypeTable, types::MAX_WIDTH};
use std::{collections::BTreeMap, sync::Arc};

/// Layout of a record: first register of each field, and registers of all.
#[derive(Debug)]
pub(super) struct RecordLayout {
    pub offsets: Vec<u32>,
    pub width: u32,
}

/// Widths, with those of records remembered.
#[derive(Debug)]
pub(super) struct Widths<'g> {
    pub table: &'g TypeTable,
    /// `None` while a record is being measured.
    records: BTreeMap<Name, Option<Arc<RecordLayout>>>,
}

impl<'g> Widths<'g> {
    pub fn new(table: &'g TypeTable) -> Self {
        Widths { table, records: BTreeMap::new() }
    }

    /// Registers of a value; as [`TypeTable::width`], but a type without a layout is an error.
    pub fn width(&mut self, t: &Type) -> Result<u32, String> {
        let wide = || format!("a value of type {t} takes too many registers");
        let width = match t {
            Type::List(_, 0) => 1,
            Type::List(item, n) => {
                let all = self.width(item)?.checked_mul(*n).and_then(|w| w.checked_add(1));
                all.ok_or_else(wide)?
            }
            Type::Option(value) => self.width(value)? + 1,
            Type::Record(name) => self.record(name)?.width,
            Type::Enum(name) if !self.table.enums.contains_key(name) => {
                return Err(format!("there is no enum `{name}`"));
            }
            _ => self.table.width(t) as u32,
        };
        if width as usize > MAX_WIDTH { Err(wide()) } else { Ok(width) }
    }

    /// Layout of a record.
    pub fn record(&mut self, name: &Name) -> Result<Arc<RecordLayout>, String> {
        match self.records.get(name) {
            Some(Some(layout)) => return Ok(layout.clone()),
            Some(None) => return Err(format!("the record `{name}` holds itself")),
            None => {}
        }
        let table = self.table;
        let record = table.records.get(name).ok_or_else(|| format!("there is no record `{name}`"))?;
        if self.records.values().filter(|r| r.is_none()).count() > 64 {
            return Err(format!("the record `{name}` nests too deep"));
        }
        self.records.insert(name.clone(), None);
        let mut layout = RecordLayout { offsets: Vec::new(), width: 0 };
        for (_, t) in &record.fields {
            layout.offsets.push(layout.width);
            layout.width += self.width(t)?;
            if layout.width as usize > MAX_WIDTH {
                return Err(format!("a value of type {name} takes too many registers"));
            }
        }
        let layout = Arc::new(layout);
        self.records.insert(name.clone(), Some(layout.clone()));
        Ok(layout)
    }

    /// Offset and type of a field.
    pub fn field(&mut self, name: &Name, index: u32) -> Result<(u32, &'g Type), String> {
        let layout = self.record(name)?;
        let table = self.table;
        let field = table.records.get(name).and_then(|r| r.fields.get(index as usize));
        match (field, layout.offsets.get(index as usize)) {
            (Some((_, t)), Some(offset)) => Ok((*offset, t)),
            _ => Err(format!("the record `{name}` has no field {index}")),
        }
    }

    /// Where a type may leave registers unused; `None` when it uses all of them always.
    pub fn shape(&mut self, t: &Type) -> Result<Option<Shape>, String> {
        let shape = self.full_shape(t)?;
        Ok((!matches!(shape, Shape::Flat(_))).then_some(shape))
    }

    fn full_shape(&mut self, t: &Type) -> Result<Shape, String> {
        Ok(match t {
            Type::List(_, 0) => Shape::List(0, 0, Box::new(Shape::Flat(0))),
            Type::List(item, n) => {
                Shape::List(*n as usize, self.width(item)? as usize, Box::new(self.full_shape(item)?))
            }
            Type::Option(value) => {
                Shape::Option(self.width(value)? as usize, Box::new(self.full_shape(value)?))
            }
            Type::Record(name) => {
                let width = self.record(name)?.width as usize;
                let table = self.table;
                let mut parts = Vec::new();
                for (_, t) in table.records.get(name).map(|r| r.fields.as_slice()).unwrap_or_default() {
                    parts.push((self.width(t)? as usize, self.full_shape(t)?));
                }
                if parts.iter().all(|(_, p)| matches!(p, Shape::Flat(_))) {
                    Shape::Flat(width)
                } else {
                    Shape::Parts(parts)
                }
            }
            _ => Shape::Flat(self.width(t)? as usize),
        })
    }
}

/// Whether values of two types have the same registers.
pub(super) fn same_layout(a: &Type, b: &Type) -> bool {
    let scalar = |t: &Type| {
        matches!(
            t,
            Type::Bool
                | Type::Int
                | Type::Quantity(_)
                | Type::Text
                | Type::Heading(_)
                | Type::Enum(_)
                | Type::Handle(_)
                | Type::Agent
                | Type::Conversation(_)
        )
    };
    let vector = |t: &Type| matches!(t, Type::Point(_) | Type::Vector(..));
    match (a, b) {
        (Type::Pose(_), Type::Pose(_))
        | (Type::Twist, Type::Twist)
        | (Type::Range(_), Type::Range(_))
        | (Type::Distribution(_), Type::Distribution(_)) => true,
        (Type::Record(a), Type::Record(b)) => a == b,
        (Type::List(a, n), Type::List(b, m)) => n == m && (*n == 0 || same_layout(a, b)),
        (Type::Option(a), Type::Option(b)) => same_layout(a, b),
        (Type::Matrix(..), Type::Matrix(..)) => a == b,
        _ => (scalar(a) && scalar(b)) || (vector(a) && vector(b)),
    }
}
