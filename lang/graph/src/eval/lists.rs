//! What the machine does with lists and with registers in any space. `None` stands for registers that
//! are not there.

use super::code::{ListRef, Program, Space};
use super::{Memory, copy_registers};
use crate::reason;

/// As [`copy_registers`], within the frame.
#[inline]
fn copy_within(frame: &mut [f64], from: usize, to: usize, n: usize) -> Option<()> {
    macro_rules! short {
        ($($n:literal)*) => {
            match n {
                0 => {}
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
        if n == 0 {
            return Some(());
        }
        let source = self.registers(space, &[], memory).get(from..from + n)?;
        copy_registers(source, frame.get_mut(to..to + n)?);
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

    /// Registers from one item to the next. What has no registers is counted as if it had one.
    #[inline(always)]
    fn stride(l: &ListRef) -> u64 {
        u64::from(l.width.max(1))
    }

    /// Puts what the body reads of an item where the body wants it; `from` is where it lies.
    #[inline(always)]
    fn item(&self, l: &ListRef, from: u64, frame: &mut [f64], memory: &Memory<'_>) -> Option<()> {
        let (from, n) = (from as usize, l.part.1 as usize);
        let to = l.item as usize + l.part.0 as usize;
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
        let first = u64::from(l.at) + 1 + u64::from(l.part.0);
        let state = frame.get_mut(l.state as usize..)?.first_chunk_mut::<2>()?;
        *state = [f64::from_bits(first), f64::from_bits(first + count as u64 * Program::stride(l))];
        self.item(l, first, frame, memory)?;
        Some(true)
    }

    /// Makes the next item current; false when there is none.
    #[inline(never)]
    pub(super) fn next_item(&self, list: u32, frame: &mut [f64], memory: &Memory<'_>) -> Option<bool> {
        let l = self.lists.get(list as usize)?;
        let at = l.state as usize;
        let next = frame.get(at)?.to_bits() + Program::stride(l);
        if next >= frame.get(at + 1)?.to_bits() {
            return Some(false);
        }
        *frame.get_mut(at)? = f64::from_bits(next);
        self.item(l, next, frame, memory)?;
        Some(true)
    }

    /// First register of the current item.
    #[inline]
    pub(super) fn current(l: &ListRef, frame: &[f64]) -> Option<usize> {
        (frame.get(l.state as usize)?.to_bits() as usize).checked_sub(l.part.0 as usize)
    }

    /// First register of the first item.
    #[inline]
    pub(super) fn first_place(l: &ListRef) -> usize {
        l.at as usize + 1
    }

    /// Appends the current item to the list at `d`.
    #[inline(never)]
    pub(super) fn keep(&self, list: u32, frame: &mut [f64], d: usize, memory: &Memory<'_>) -> Option<()> {
        let l = self.lists.get(list as usize)?;
        let from = Program::current(l, frame)?;
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
        let (item, key) = (Program::current(l, frame)?, *frame.get(a)?);
        let best = frame.get_mut(l.state as usize + 2)?;
        if item == Program::first_place(l) || key < *best {
            *best = key;
            self.found(l, item, frame, d, memory)?;
        }
        Some(())
    }

    /// The item from register `item` on as an optional at `d`.
    pub(super) fn found(
        &self,
        l: &ListRef,
        item: usize,
        frame: &mut [f64],
        d: usize,
        memory: &Memory<'_>,
    ) -> Option<()> {
        *frame.get_mut(d)? = 0.0;
        self.transfer(l.space, item, frame, d + 1, l.width as usize, memory)
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
            return self.found(
                l,
                Program::first_place(l) + index as usize * l.width as usize,
                frame,
                d,
                memory,
            );
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
        self.transfer(l.space, Program::first_place(l) + first * width, frame, d + 1, kept * width, memory)?;
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
