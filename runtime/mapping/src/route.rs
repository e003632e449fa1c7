//! A way over a grid: A* (Hart, Nilsson and Raphael, 1968) over the eight neighbours of a cell. Near to what stands a way costs
//! more, so that it keeps clear of it where there is room.

use crate::{
    field::Field,
    place::apart,
    smooth,
    why::{Why, finite},
};
use std::{cmp::Ordering, collections::BinaryHeap};

/// How much room a way is to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Nothing comes nearer than this, m.
    pub clearance: f64,
    /// More room than that is liked, m.
    pub comfort: f64,
}

/// What the last metre of comfort costs beside a metre of way.
const DISLIKE: f64 = 5.0;
/// A body that stands too near to something may go away from it over so much ground, in clearances.
const ESCAPE: f64 = 1.0;

/// Points of a way from one point of `map` to another, about 10 cm apart, smoothed.
///
/// # Errors
/// [`Why::BadNumber`], [`Why::StartNotFree`], [`Why::TargetNotFree`], [`Why::NoWay`].
pub fn plan(field: &Field, from: [f64; 2], to: [f64; 2], room: &Room) -> Result<Vec<[f64; 2]>, Why> {
    finite(&[from[0], from[1], to[0], to[1], room.clearance, room.comfort])?;
    if room.clearance < 0.0 || room.comfort < 0.0 {
        return Err(Why::BadNumber);
    }
    let first = field.layout.cell_of(from).ok_or(Why::StartNotFree)?;
    let last = field.layout.cell_of(to).ok_or(Why::TargetNotFree)?;
    if field.at(first) <= field.layout.cell {
        return Err(Why::StartNotFree);
    }
    if field.at(last) < room.clearance {
        return Err(Why::TargetNotFree);
    }
    let cells = Search::new(field, first, last, *room).run().ok_or(Why::NoWay)?;
    let mut points: Vec<[f64; 2]> = cells.into_iter().map(|c| field.layout.centre(c)).collect();
    if let Some(p) = points.first_mut() {
        *p = from;
    }
    match points.len() {
        1 => points.push(to),
        n => points[n - 1] = to,
    }
    Ok(smooth::smooth(field, &points, room))
}

/// A cell to be looked at.
#[derive(Clone, Copy, PartialEq)]
struct Open {
    /// Cost of the way through it at the least.
    cost: f64,
    index: usize,
}

impl Eq for Open {}

impl Ord for Open {
    /// The least cost first; of equals the first cell.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

struct Search<'a> {
    field: &'a Field,
    first: [usize; 2],
    last: [usize; 2],
    room: Room,
    /// The room where it begins: what is too near there may be left.
    begin: f64,
}

impl<'a> Search<'a> {
    fn new(field: &'a Field, first: [usize; 2], last: [usize; 2], room: Room) -> Search<'a> {
        Search { field, first, last, room, begin: field.at(first) }
    }

    /// What a metre costs in a cell; none where there is no room.
    fn price(&self, cell: [usize; 2]) -> Option<f64> {
        let d = self.field.at(cell);
        let Room { clearance, comfort } = self.room;
        if d < clearance {
            let layout = &self.field.layout;
            let near = apart(layout.centre(cell), layout.centre(self.first)) <= ESCAPE * clearance;
            if !near || d < self.begin - layout.cell {
                return None;
            }
        }
        let lack = if comfort > 0.0 { ((clearance + comfort - d) / comfort).max(0.0) } else { 0.0 };
        Some(1.0 + DISLIKE * lack * lack)
    }

    /// The least that is left to go, in cells.
    fn left(&self, cell: [usize; 2]) -> f64 {
        let (dx, dy) = (cell[0].abs_diff(self.last[0]), cell[1].abs_diff(self.last[1]));
        dx.max(dy) as f64 + (std::f64::consts::SQRT_2 - 1.0) * dx.min(dy) as f64
    }

    fn run(&self) -> Option<Vec<[usize; 2]>> {
        let layout = self.field.layout;
        let mut costs = vec![f64::INFINITY; layout.cells()];
        let mut before = vec![usize::MAX; layout.cells()];
        let mut open = BinaryHeap::new();
        let (start, end) = (layout.index(self.first), layout.index(self.last));
        *costs.get_mut(start)? = 0.0;
        open.push(Open { cost: self.left(self.first), index: start });
        while let Some(Open { cost, index }) = open.pop() {
            if index == end {
                return Some(self.back(&before, index));
            }
            let (here, so_far) = (layout.cell_at(index), *costs.get(index)?);
            // It was reached more cheaply since it was put here.
            if cost > so_far + self.left(here) + 1e-9 {
                continue;
            }
            for (cell, step) in neighbours(here, layout.size) {
                let Some(price) = self.price(cell) else { continue };
                let (i, cost) = (layout.index(cell), so_far + step * price);
                if cost < *costs.get(i)? {
                    *costs.get_mut(i)? = cost;
                    *before.get_mut(i)? = index;
                    open.push(Open { cost: cost + self.left(cell), index: i });
                }
            }
        }
        None
    }

    fn back(&self, before: &[usize], end: usize) -> Vec<[usize; 2]> {
        let mut out = vec![self.field.layout.cell_at(end)];
        let mut at = end;
        while let Some(i) = before.get(at).copied().filter(|i| *i != usize::MAX) {
            out.push(self.field.layout.cell_at(i));
            at = i;
        }
        out.reverse();
        out
    }
}

/// The eight neighbours that are in the grid, and how far they are, in cells.
fn neighbours([x, y]: [usize; 2], [nx, ny]: [usize; 2]) -> impl Iterator<Item = ([usize; 2], f64)> {
    let near = |c: usize, n: usize| c.saturating_sub(1)..=(c + 1).min(n - 1);
    near(y, ny)
        .flat_map(move |b| near(x, nx).map(move |a| [a, b]))
        .filter(move |c| *c != [x, y])
        .map(move |c| (c, if c[0] != x && c[1] != y { std::f64::consts::SQRT_2 } else { 1.0 }))
}
