//! A uniform grid over boxes, so that asking what is near costs the same however many things there are.
//!
//! Cells are hashed into a table of about as many buckets as there are things: the plane is unbounded and
//! memory stays linear. Filled by counting, in order of the things, so answers are in a fixed order.

use super::geometry::Aabb;

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
        // `as` saturates: what is far outside shares the outermost cells.
        let cell = |x: f64| (x * self.per_metre).floor().clamp(-1e9, 1e9) as i32;
        Cells { low: [cell(b.low[0]), cell(b.low[1])], high: [cell(b.high[0]), cell(b.high[1])] }
    }

    /// The box of a thing.
    pub fn area(&self, item: usize) -> &Aabb {
        &self.boxes[item]
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
