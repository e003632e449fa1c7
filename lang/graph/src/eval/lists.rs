//! What the machine does with lists and with registers in any space.

use super::code::{ListRef, Program, Space};
use super::{FaultKind, Memory};
use crate::reason;

type Done = Result<(), FaultKind>;

impl Program {
    /// The registers of a space.
    #[inline]
    fn registers<'s>(&'s self, space: Space, frame: &'s [f64], memory: &'s Memory<'_>) -> &'s [f64] {
        match space {
            Space::Frame => frame,
            Space::States => memory.states,
            Space::Arguments => memory.arguments,
            Space::Params => memory.params,
            Space::Constants => &self.constants,
        }
    }

    /// Copies `n` registers from a space into the frame.
    #[inline]
    pub(super) fn transfer(
        &self,
        space: Space,
        from: usize,
        frame: &mut [f64],
        to: usize,
        n: usize,
        memory: &Memory<'_>,
    ) -> Done {
        if let Space::Frame = space {
            if from + n > frame.len() || to + n > frame.len() {
                return Err(FaultKind::Malformed);
            }
            frame.copy_within(from..from + n, to);
            return Ok(());
        }
        let source = self.registers(space, &[], memory).get(from..from + n).ok_or(FaultKind::Malformed)?;
        frame.get_mut(to..to + n).ok_or(FaultKind::Malformed)?.copy_from_slice(source);
        Ok(())
    }

    /// Number of items.
    #[inline]
    pub(super) fn count(&self, l: &ListRef, frame: &[f64], memory: &Memory<'_>) -> Result<usize, FaultKind> {
        let count = self.registers(l.space, frame, memory).get(l.at as usize).ok_or(FaultKind::Malformed)?;
        Ok((*count as usize).min(l.capacity as usize))
    }

    /// All registers of all items.
    pub(super) fn items<'s>(
        &'s self,
        l: &ListRef,
        frame: &'s [f64],
        memory: &'s Memory<'_>,
    ) -> Result<&'s [f64], FaultKind> {
        let n = self.count(l, frame, memory)? * l.width as usize;
        let from = l.at as usize + 1;
        self.registers(l.space, frame, memory).get(from..from + n).ok_or(FaultKind::Malformed)
    }

    /// First register of item `i`.
    #[inline]
    fn place(l: &ListRef, i: usize) -> usize {
        l.at as usize + 1 + i * l.width as usize
    }

    /// Puts what the body reads of item `i` where the body wants it.
    #[inline]
    pub(super) fn item(&self, l: &ListRef, i: usize, frame: &mut [f64], memory: &Memory<'_>) -> Done {
        let (from, n) = (l.part.0 as usize, l.part.1 as usize);
        if n == 0 {
            return Ok(());
        }
        self.transfer(l.space, Program::place(l, i) + from, frame, l.item as usize + from, n, memory)
    }

    /// Appends item `i` to the list at `d`.
    pub(super) fn keep(
        &self,
        l: &ListRef,
        i: usize,
        frame: &mut [f64],
        d: usize,
        memory: &Memory<'_>,
    ) -> Done {
        let count = frame.get_mut(d).ok_or(FaultKind::Malformed)?;
        let n = *count as usize;
        if n >= l.out_capacity as usize {
            return Err(FaultKind::Malformed);
        }
        *count = (n + 1) as f64;
        let width = l.width as usize;
        self.transfer(l.space, Program::place(l, i), frame, d + 1 + n * width, width, memory)
    }

    /// Item `i` as an optional at `d`.
    pub(super) fn found(
        &self,
        l: &ListRef,
        i: usize,
        frame: &mut [f64],
        d: usize,
        memory: &Memory<'_>,
    ) -> Done {
        *frame.get_mut(d).ok_or(FaultKind::Malformed)? = 0.0;
        self.transfer(l.space, Program::place(l, i), frame, d + 1, l.width as usize, memory)
    }

    /// The item at an index, as an optional at `d`.
    pub(super) fn at(
        &self,
        l: &ListRef,
        index: f64,
        frame: &mut [f64],
        d: usize,
        memory: &Memory<'_>,
    ) -> Done {
        if index >= 0.0 && index < self.count(l, frame, memory)? as f64 {
            return self.found(l, index as usize, frame, d, memory);
        }
        *frame.get_mut(d).ok_or(FaultKind::Malformed)? = reason::tag(reason::NO_SUCH_ITEM);
        Ok(())
    }

    /// The list with the value at `a` at its end, at `d`; a full list loses its first item.
    pub(super) fn push(
        &self,
        l: &ListRef,
        frame: &mut [f64],
        d: usize,
        a: usize,
        memory: &Memory<'_>,
    ) -> Done {
        let (width, capacity) = (l.width as usize, l.capacity as usize);
        let count = self.count(l, frame, memory)?;
        if capacity == 0 {
            *frame.get_mut(d).ok_or(FaultKind::Malformed)? = 0.0;
            return Ok(());
        }
        let (first, kept) = if count == capacity { (1, count - 1) } else { (0, count) };
        self.transfer(l.space, Program::place(l, first), frame, d + 1, kept * width, memory)?;
        self.transfer(Space::Frame, a, frame, d + 1 + kept * width, width, memory)?;
        *frame.get_mut(d).ok_or(FaultKind::Malformed)? = (kept + 1) as f64;
        Ok(())
    }
}

/// Appends the value at `a` to the list at `d`.
pub(super) fn append(l: &ListRef, frame: &mut [f64], d: usize, a: usize) -> Done {
    let count = frame.get_mut(d).ok_or(FaultKind::Malformed)?;
    let (n, width) = (*count as usize, l.out_width as usize);
    if n >= l.out_capacity as usize {
        return Err(FaultKind::Malformed);
    }
    *count = (n + 1) as f64;
    let to = d + 1 + n * width;
    if a + width > frame.len() || to + width > frame.len() {
        return Err(FaultKind::Malformed);
    }
    frame.copy_within(a..a + width, to);
    Ok(())
}

/// A number or none, at `d`.
pub(super) fn optional(value: Option<f64>, frame: &mut [f64], d: usize) -> Done {
    let out = frame.get_mut(d..d + 2).ok_or(FaultKind::Malformed)?;
    match value {
        Some(x) => out.copy_from_slice(&[0.0, x]),
        None => out.copy_from_slice(&[reason::tag(reason::NONE_FOUND), 0.0]),
    }
    Ok(())
}
