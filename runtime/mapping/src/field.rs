//! How far from each cell the nearest occupied one is: Felzenszwalb and Huttenlocher, Distance Transforms of Sampled
//! Functions (2012), exact, in time proportional to the number of cells.

use crate::grid::{Grid, Layout};

/// Distances between middles of cells, m.
#[derive(Clone, Debug)]
pub struct Field {
    /// Which cells there are.
    pub layout: Layout,
    /// Distances in metres, row by row; infinite where nothing is occupied.
    distances: Vec<f32>,
}

/// Farther than anything in a grid, in squared cells, and small enough to be added to without loss.
const FAR: f64 = 1e12;

impl Field {
    /// The field of a grid's occupied cells.
    pub fn of(grid: &Grid) -> Field {
        let layout = grid.layout;
        let [nx, ny] = layout.size;
        let occupied = |i: usize| grid.is_occupied(layout.cell_at(i));
        let mut squares: Vec<f64> =
            (0..layout.cells()).map(|i| if occupied(i) { 0.0 } else { FAR }).collect();
        let mut room = Room::new(nx.max(ny));
        let mut line = vec![0.0; nx.max(ny)];
        for row in squares.chunks_mut(nx) {
            line[..nx].copy_from_slice(row);
            room.transform(&line[..nx], row.iter_mut());
        }
        for x in 0..nx {
            for (slot, s) in line.iter_mut().zip(squares.iter().skip(x).step_by(nx)) {
                *slot = *s;
            }
            room.transform(&line[..ny], squares.iter_mut().skip(x).step_by(nx));
        }
        let metres = |s: f64| if s >= FAR { f32::INFINITY } else { (s.sqrt() * layout.cell) as f32 };
        Field { layout, distances: squares.into_iter().map(metres).collect() }
    }

    /// The distance at a cell, m.
    pub fn at(&self, cell: [usize; 2]) -> f64 {
        self.distances.get(self.layout.index(cell)).map_or(0.0, |d| f64::from(*d))
    }

    /// The distance at the cell of a point, m; 0 outside, where nobody knows.
    pub fn of_point(&self, at: [f64; 2]) -> f64 {
        self.layout.cell_of(at).map_or(0.0, |cell| self.at(cell))
    }

    /// The distance at a point, between the middles of the four cells around it; far outside.
    pub fn between(&self, at: [f64; 2]) -> f64 {
        let [x, y] = self.layout.position(at).map(|v| v - 0.5);
        let (i, j) = (x.floor(), y.floor());
        let [nx, ny] = self.layout.size;
        if !(i >= 0.0 && j >= 0.0 && i + 1.0 < nx as f64 && j + 1.0 < ny as f64) {
            return f64::INFINITY;
        }
        let (u, v, i, j) = (x - i, y - j, i as usize, j as usize);
        let low = (1.0 - u) * self.at([i, j]) + u * self.at([i + 1, j]);
        let high = (1.0 - u) * self.at([i, j + 1]) + u * self.at([i + 1, j + 1]);
        let d = (1.0 - v) * low + v * high;
        if d.is_nan() { f64::INFINITY } else { d }
    }
}

/// Room for one line: the parabolas of its lower envelope, and where each begins to be the lowest.
struct Room {
    sites: Vec<usize>,
    begins: Vec<f64>,
}

impl Room {
    fn new(n: usize) -> Room {
        Room { sites: Vec::with_capacity(n), begins: Vec::with_capacity(n) }
    }

    /// The transform of one line (the algorithm DT(f) of the paper).
    fn transform<'a>(&mut self, line: &[f64], out: impl Iterator<Item = &'a mut f64>) {
        self.sites.clear();
        self.begins.clear();
        for (q, f) in line.iter().enumerate() {
            let height = |p: usize| line.get(p).copied().unwrap_or(FAR) + (p * p) as f64;
            let mut begin = f64::NEG_INFINITY;
            while let (Some(p), Some(b)) = (self.sites.last(), self.begins.last()) {
                begin = ((f + (q * q) as f64) - height(*p)) / (2.0 * (q - p) as f64);
                if begin > *b {
                    break;
                }
                self.sites.pop();
                self.begins.pop();
                begin = f64::NEG_INFINITY;
            }
            self.sites.push(q);
            self.begins.push(begin);
        }
        let mut k = 0;
        for (q, slot) in out.enumerate() {
            while self.begins.get(k + 1).is_some_and(|b| *b < q as f64) {
                k += 1;
            }
            let p = self.sites.get(k).copied().unwrap_or(q);
            let d = q.abs_diff(p) as f64;
            *slot = (d * d + line.get(p).copied().unwrap_or(FAR)).min(FAR);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn distances_are_those_of_the_nearest(cells in proptest::collection::btree_set(0_usize..35, 1..6)) {
            let layout = Layout::covering([0.0, 0.0], [0.7, 0.5], 0.1).expect("a layout");
            let mut grid = Grid::unknown(layout);
            cells.iter().for_each(|c| grid.odds[*c] = 1.0);
            let field = Field::of(&grid);
            for i in 0..layout.cells() {
                let [x, y] = layout.cell_at(i);
                let nearest = cells.iter().map(|c| {
                    let [a, b] = layout.cell_at(*c);
                    libm::hypot(x as f64 - a as f64, y as f64 - b as f64) * 0.1
                });
                let wanted = nearest.fold(f64::INFINITY, f64::min);
                prop_assert!((field.at([x, y]) - wanted).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn nothing_is_infinitely_far() {
        let layout = Layout::covering([0.0, 0.0], [1.0, 1.0], 0.1).expect("a layout");
        assert_eq!(Field::of(&Grid::unknown(layout)).at([3, 3]), f64::INFINITY);
    }
}
