//! What the machine does with lists and with registers in any space. `None` stands for registers that
//! are not there.

use super::Memory;
use super::code::{ListRef, Program, Space};
use crate::reason;

/// Copies registers between two places of which the compiler does not know that they are apart, without
/// the call that a copy of unknown length costs where it is short.
#[inline]
fn copy(from: &[f64], to: &mut [f64]) {
    macro_rules! short {
        ($($n:literal)*) => {
            match from.len() {
                $($n => {
                    if let (Some(from), Some(to)) = (from.first_chunk::<$n>(), to.first_chunk_mut::<$n>()) {
                        *to = *from;
                    }
                })*
                _ => to.copy_from_slice(from),
            }
        };
    }
    short!(0 1 2 3 4 5 6 7 8);
}

/// As [`copy`], within the frame.
#[inline]
fn copy_within(frame: &mut [f64], from: usize, to: usize, n: usize) -> Option<()> {
    macro_rules! short {
        ($($n:literal)*) => {
            match n {
                $($n => {
                    let value = *frame.get(from..)?.first_chunk::<$n>()?;
                    *frame.get_mut(to..)?.first_chunk_mut::<$n>()? = value;
                })*
                _ => {
                    if from + n > frame.len() || to + n > frame.len() {
                        return None;
                    }
                    frame.copy_within(from..from + n, to);
                }
            }
        };
    }
    short!(1 2 3 4 5 6 7 8);
    Some(())
}

/// So few registers are copied one by one.
const FEW: usize = 8;

/// Copies a few registers to a place that does not overlap theirs.
#[inline(always)]
fn few(frame: &mut [f64], from: usize, to: usize, n: usize) -> Option<()> {
    for i in 0..n {
        let x = *frame.get(from + i)?;
        *frame.get_mut(to + i)? = x;
    }
    Some(())
}

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
    pub(super) fn transfer(
        &self,
        space: Space,
        from: usize,
        frame: &mut [f64],
        to: usize,
        n: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        if let Space::Frame = space {
            return copy_within(frame, from, to, n);
        }
        let source = self.registers(space, &[], memory).get(from..from + n)?;
        copy(source, frame.get_mut(to..to + n)?);
        Some(())
    }

    /// Number of items.
    #[inline]
    pub(super) fn count(&self, l: &ListRef, frame: &[f64], memory: &Memory<'_>) -> Option<usize> {
        let count = self.registers(l.space, frame, memory).get(l.at as usize)?;
        Some((*count as usize).min(l.capacity as usize))
    }

    /// All registers of all items.
    pub(super) fn items<'s>(
        &'s self,
        l: &ListRef,
        frame: &'s [f64],
        memory: &'s Memory<'_>,
    ) -> Option<&'s [f64]> {
        let n = self.count(l, frame, memory)? * l.width as usize;
        let from = l.at as usize + 1;
        self.registers(l.space, frame, memory).get(from..from + n)
    }

    /// First register of item `i`.
    #[inline]
    fn place(l: &ListRef, i: usize) -> usize {
        l.at as usize + 1 + i * l.width as usize
    }

    /// Puts what the body reads of item `i` where the body wants it.
    #[inline(always)]
    fn item(&self, l: &ListRef, i: usize, frame: &mut [f64], memory: &Memory<'_>) -> Option<()> {
        let (from, n) = (l.part.0 as usize, l.part.1 as usize);
        let (from, to) = (Program::place(l, i) + from, l.item as usize + from);
        if l.space == Space::Frame && n <= FEW {
            return few(frame, from, to, n);
        }
        self.transfer(l.space, from, frame, to, n, memory)
    }

    /// Makes the first item current; false when there is none.
    #[inline(never)]
    pub(super) fn first_item(&self, list: u32, frame: &mut [f64], memory: &Memory<'_>) -> Option<bool> {
        let l = self.lists.get(list as usize)?;
        let count = self.count(l, frame, memory)?;
        if count == 0 {
            return Some(false);
        }
        let state = frame.get_mut(l.state as usize..)?.first_chunk_mut::<2>()?;
        *state = [f64::from_bits(0), f64::from_bits(count as u64)];
        self.item(l, 0, frame, memory)?;
        Some(true)
    }

    /// Makes the next item current; false when there is none.
    #[inline(never)]
    pub(super) fn next_item(&self, list: u32, frame: &mut [f64], memory: &Memory<'_>) -> Option<bool> {
        let l = self.lists.get(list as usize)?;
        let at = l.state as usize;
        let next = frame.get(at)?.to_bits() + 1;
        if next >= frame.get(at + 1)?.to_bits() {
            return Some(false);
        }
        *frame.get_mut(at)? = f64::from_bits(next);
        self.item(l, next as usize, frame, memory)?;
        Some(true)
    }

    /// Index of the current item.
    #[inline]
    pub(super) fn current(l: &ListRef, frame: &[f64]) -> Option<usize> {
        Some(frame.get(l.state as usize)?.to_bits() as usize)
    }

    /// Appends the current item to the list at `d`.
    #[inline(never)]
    pub(super) fn keep(&self, list: u32, frame: &mut [f64], d: usize, memory: &Memory<'_>) -> Option<()> {
        let l = self.lists.get(list as usize)?;
        let from = Program::place(l, Program::current(l, frame)?);
        let to = grow(l, frame, d, l.width as usize)?;
        self.transfer(l.space, from, frame, to, l.width as usize, memory)
    }

    /// Appends the value at `a` to the list at `d`.
    #[inline(never)]
    pub(super) fn append(
        &self,
        list: u32,
        frame: &mut [f64],
        d: usize,
        a: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        let l = self.lists.get(list as usize)?;
        let n = l.out_width as usize;
        let to = grow(l, frame, d, n)?;
        if n <= FEW { few(frame, a, to, n) } else { self.transfer(Space::Frame, a, frame, to, n, memory) }
    }

    /// The current item as an optional at `d` when its key, at `a`, is the least so far.
    #[inline(never)]
    pub(super) fn least(
        &self,
        list: u32,
        frame: &mut [f64],
        d: usize,
        a: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        let l = self.lists.get(list as usize)?;
        let (i, key) = (Program::current(l, frame)?, *frame.get(a)?);
        let best = frame.get_mut(l.state as usize + 2)?;
        if i == 0 || key < *best {
            *best = key;
            self.found(l, i, frame, d, memory)?;
        }
        Some(())
    }

    /// Item `i` as an optional at `d`.
    pub(super) fn found(
        &self,
        l: &ListRef,
        i: usize,
        frame: &mut [f64],
        d: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        *frame.get_mut(d)? = 0.0;
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
    ) -> Option<()> {
        if index >= 0.0 && index < self.count(l, frame, memory)? as f64 {
            return self.found(l, index as usize, frame, d, memory);
        }
        *frame.get_mut(d)? = reason::tag(reason::NO_SUCH_ITEM);
        Some(())
    }

    /// The list with the value at `a` at its end, at `d`; a full list loses its first item.
    pub(super) fn push(
        &self,
        l: &ListRef,
        frame: &mut [f64],
        d: usize,
        a: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        let (width, capacity) = (l.width as usize, l.capacity as usize);
        let count = self.count(l, frame, memory)?;
        if capacity == 0 {
            *frame.get_mut(d)? = 0.0;
            return Some(());
        }
        let (first, kept) = if count == capacity { (1, count - 1) } else { (0, count) };
        self.transfer(l.space, Program::place(l, first), frame, d + 1, kept * width, memory)?;
        self.transfer(Space::Frame, a, frame, d + 1 + kept * width, width, memory)?;
        *frame.get_mut(d)? = (kept + 1) as f64;
        Some(())
    }
}

/// Makes room for one more item in the list at `d`; returns its first register.
#[inline]
fn grow(l: &ListRef, frame: &mut [f64], d: usize, width: usize) -> Option<usize> {
    let count = frame.get_mut(d)?;
    let n = *count as usize;
    if n >= l.out_capacity as usize {
        return None;
    }
    *count = (n + 1) as f64;
    Some(d + 1 + n * width)
}

/// A number or none, at `d`.
pub(super) fn optional(value: Option<f64>, frame: &mut [f64], d: usize) -> Option<()> {
    let out = frame.get_mut(d..)?.first_chunk_mut::<2>()?;
    *out = match value {
        Some(x) => [0.0, x],
        None => [reason::tag(reason::NONE_FOUND), 0.0],
    };
    Some(())
}
