//! Uniform grids over boxes and over discs, so that asking what is near costs the same however many things there are.
//!
//! Cells are hashed into a table of about as many buckets as there are things: the plane is unbounded and
//! memory stays linear. Filled by counting, in order of the things, so answers are in a fixed order.

use super::geometry::{Aabb, Vec2, dot, sub};

/// A thing in more cells than this is kept in a list of its own.
const MANY_CELLS: i64 = 64;

/// A grid of boxes, by index.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    boxes: Vec<Aabb>,
    per_metre: f64,
    mask: u32,
    /// Where a bucket's entries start; one more than there are buckets.
    heads: Vec<u32>,
    entries: Vec<Entry>,
    large: Vec<u32>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    cell: [i32; 2],
    /// The cell of the low corner: of the cells that a thing and a question share, only the first counts.
    low: [i32; 2],
    item: u32,
}

/// The cells a box covers.
#[derive(Debug, Clone, Copy)]
struct Cells {
    low: [i32; 2],
    high: [i32; 2],
}

impl Cells {
    fn count(&self) -> i64 {
        let side = |i: usize| i64::from(self.high[i]) - i64::from(self.low[i]) + 1;
        side(0).saturating_mul(side(1))
    }

    fn each(&self, mut f: impl FnMut([i32; 2])) {
        for y in self.low[1]..=self.high[1] {
            for x in self.low[0]..=self.high[0] {
                f([x, y]);
            }
        }
    }
}

impl Grid {
    /// Forgets all and takes these boxes.
    pub fn fill(&mut self, boxes: impl Iterator<Item = Aabb>) {
        self.boxes.clear();
        self.boxes.extend(boxes);
        self.large.clear();
        self.entries.clear();
        let n = self.boxes.len();
        self.per_metre = 1.0 / self.cell_side();
        let buckets = n.next_power_of_two().clamp(1, 1 << 30);
        self.mask = (buckets - 1) as u32;
        self.heads.clear();
        self.heads.resize(buckets + 1, 0);
        let mut total = 0u32;
        for i in 0..n {
            let cells = self.cells(&self.boxes[i]);
            if cells.count() > MANY_CELLS {
                self.large.push(i as u32);
                continue;
            }
            cells.each(|c| {
                self.heads[bucket(c, self.mask)] += 1;
                total += 1;
            });
        }
        // Each head becomes one past its bucket's entries; filling backwards brings it to the start.
        let mut sum = 0;
        for head in &mut self.heads {
            sum += *head;
            *head = sum;
        }
        self.entries.resize(total as usize, Entry::default());
        for i in (0..n).rev() {
            let cells = self.cells(&self.boxes[i]);
            if cells.count() > MANY_CELLS {
                continue;
            }
            cells.each(|cell| {
                let head = &mut self.heads[bucket(cell, self.mask)];
                *head -= 1;
                self.entries[*head as usize] = Entry { cell, low: cells.low, item: i as u32 };
            });
        }
    }

    /// About one thing a cell, and no thing in many cells.
    fn cell_side(&self) -> f64 {
        let n = self.boxes.len().max(1) as f64;
        let (mut low, mut high, mut extent) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], 0.0);
        for b in &self.boxes {
            for i in 0..2 {
                low[i] = low[i].min(b.low[i]);
                high[i] = high[i].max(b.high[i]);
                extent += 0.5 * (b.high[i] - b.low[i]);
            }
        }
        let area = (high[0] - low[0]) * (high[1] - low[1]);
        let side = (area / n).sqrt().max(extent / n);
        if side.is_finite() && side > 1e-9 { side } else { 1.0 }
    }

    fn cells(&self, b: &Aabb) -> Cells {
        Cells { low: cell(b.low, self.per_metre), high: cell(b.high, self.per_metre) }
    }

    /// Calls `f` once with every thing whose box meets `area`.
    pub fn query(&self, area: &Aabb, mut f: impl FnMut(u32)) {
        let cells = self.cells(area);
        if cells.count() > self.boxes.len() as i64 {
            for (i, b) in self.boxes.iter().enumerate() {
                if b.meets(area) {
                    f(i as u32);
                }
            }
            return;
        }
        for i in &self.large {
            if self.boxes[*i as usize].meets(area) {
                f(*i);
            }
        }
        cells.each(|c| {
            let at = bucket(c, self.mask);
            for e in &self.entries[self.heads[at] as usize..self.heads[at + 1] as usize] {
                let first = [e.low[0].max(cells.low[0]), e.low[1].max(cells.low[1])];
                if e.cell == c && first == c && self.boxes[e.item as usize].meets(area) {
                    f(e.item);
                }
            }
        });
    }
}

fn bucket(cell: [i32; 2], mask: u32) -> usize {
    let h = (cell[0] as u32).wrapping_mul(0x9e37_79b1) ^ (cell[1] as u32).wrapping_mul(0x85eb_ca77);
    ((h ^ (h >> 15)) & mask) as usize
}

/// The cell of a point. What is far outside shares the outermost cells, for `as` saturates.
fn cell(p: Vec2, per_metre: f64) -> [i32; 2] {
    p.map(|x| {
        let x = x * per_metre;
        // Rounds down, without a call of `floor`; one below the saturated end stays in range.
        let towards_zero = x.clamp(-1e9, 1e9) as i32;
        towards_zero - i32::from(x < f64::from(towards_zero))
    })
}

/// A disc whose neighbours are wanted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spot {
    /// Centre.
    pub at: Vec2,
    /// Radius.
    pub reach: f64,
    /// Whose.
    pub item: u32,
}

/// Finds all pairs of discs that overlap. Each disc is in the one cell of its centre; cells are so wide that
/// only a cell and the eight around it can hold its neighbours. The few discs that are much larger than the
/// others are kept apart.
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    spots: Vec<Spot>,
    per_metre: f64,
    mask: u32,
    heads: Vec<u32>,
    /// Ordinary spots with their cells, by bucket.
    filed: Vec<(Spot, [i32; 2])>,
    large: Vec<Spot>,
    grid: Grid,
}

impl Neighbours {
    /// Forgets all and takes these.
    pub fn fill(&mut self, spots: impl Iterator<Item = Spot>) {
        self.spots.clear();
        self.spots.extend(spots);
        let mean = self.spots.iter().map(|s| s.reach).sum::<f64>() / self.spots.len().max(1) as f64;
        let (limit, mut widest) = (4.0 * mean, 0.0f64);
        self.large.clear();
        self.heads.clear();
        let buckets = self.spots.len().next_power_of_two().clamp(1, 1 << 30);
        self.mask = (buckets - 1) as u32;
        self.heads.resize(buckets + 1, 0);
        for s in &self.spots {
            if s.reach > limit {
                self.large.push(*s);
            } else {
                widest = widest.max(s.reach);
            }
        }
        // Two that overlap are at most twice the widest reach apart.
        self.per_metre = 0.5 / widest.max(1e-9);
        for s in self.spots.iter().filter(|s| s.reach <= limit) {
            self.heads[bucket(cell(s.at, self.per_metre), self.mask)] += 1;
        }
        let mut sum = 0;
        for head in &mut self.heads {
            sum += *head;
            *head = sum;
        }
        self.filed.clear();
        self.filed.resize(sum as usize, (Spot::default(), [0; 2]));
        for s in self.spots.iter().rev().filter(|s| s.reach <= limit) {
            let cell = cell(s.at, self.per_metre);
            let head = &mut self.heads[bucket(cell, self.mask)];
            *head -= 1;
            self.filed[*head as usize] = (*s, cell);
        }
        if !self.large.is_empty() {
            self.grid.fill(self.large.iter().map(|s| Aabb::around(s.at, s.reach)));
        }
    }

    /// Calls `f` once for each pair that overlaps, with the distance of their centres.
    pub fn each(&self, mut f: impl FnMut(u32, u32, f64)) {
        for (i, (s, cell)) in self.filed.iter().enumerate() {
            let mut near = |others: &[(Spot, [i32; 2])], cell: [i32; 2]| {
                for (o, c) in others {
                    if *c == cell {
                        meet(s, o, &mut f);
                    }
                }
            };
            let here = bucket(*cell, self.mask);
            near(&self.filed[i + 1..self.heads[here + 1] as usize], *cell);
            // Of each two cells that touch, one looks at the other.
            for [dx, dy] in [[1, 0], [-1, 1], [0, 1], [1, 1]] {
                let there = [cell[0] + dx, cell[1] + dy];
                let b = bucket(there, self.mask);
                near(&self.filed[self.heads[b] as usize..self.heads[b + 1] as usize], there);
            }
        }
        if self.large.is_empty() {
            return;
        }
        for (s, _) in &self.filed {
            self.grid.query(&Aabb::around(s.at, s.reach), |o| meet(s, &self.large[o as usize], &mut f));
        }
        for (i, s) in self.large.iter().enumerate() {
            self.grid.query(&Aabb::around(s.at, s.reach), |o| {
                if o as usize > i {
                    meet(s, &self.large[o as usize], &mut f);
                }
            });
        }
    }
}

fn meet(a: &Spot, b: &Spot, f: &mut impl FnMut(u32, u32, f64)) {
    let (d, reach) = (sub(a.at, b.at), a.reach + b.reach);
    let square = dot(d, d);
    if square <= reach * reach {
        f(a.item, b.item, square.sqrt());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
        let one =
            (-9.0f64..9.0, -9.0f64..9.0, -3i32..3).prop_map(|(x, y, k)| Aabb::around([x, y], 10f64.powi(k)));
        prop::collection::vec(one, 0..80)
    }

    proptest! {
        #[test]
        fn a_question_is_answered_as_by_trying_all(all in boxes(), questions in boxes()) {
            let mut grid = Grid::default();
            grid.fill(all.iter().copied());
            for q in questions {
                let mut found = Vec::new();
                grid.query(&q, |i| found.push(i as usize));
                found.sort_unstable();
                let expected: Vec<usize> = (0..all.len()).filter(|i| all[*i].meets(&q)).collect();
                prop_assert_eq!(found, expected);
            }
        }

        #[test]
        fn neighbours_are_found_as_by_trying_all(all in boxes()) {
            let spot = |(i, b): (usize, &Aabb)| {
                let reach = 0.5 * (b.high[0] - b.low[0]);
                Spot { at: [b.low[0] + reach, b.low[1] + reach], reach, item: i as u32 }
            };
            let spots: Vec<Spot> = all.iter().enumerate().map(spot).collect();
            let mut neighbours = Neighbours::default();
            neighbours.fill(spots.iter().copied());
            let mut found = Vec::new();
            neighbours.each(|a, b, _| found.push((a.min(b), a.max(b))));
            found.sort_unstable();
            let mut expected = Vec::new();
            for (i, a) in spots.iter().enumerate() {
                for b in &spots[i + 1..] {
                    meet(a, b, &mut |x, y, _| expected.push((x, y)));
                }
            }
            expected.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}
