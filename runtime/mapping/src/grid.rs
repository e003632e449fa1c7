//! Occupancy grids: for each cell of the ground, how likely something stands there.
//!
//! Kept is the logarithm of the odds (Thrun, Burgard and Fox, Probabilistic Robotics, 2005, Eq. 9.5): 0 is unknown, above
//! is occupied, below is free.

use crate::{shape::Shape, why::Why};

/// The most cells of a grid: 100 m by 100 m of 5 cm.
pub const MOST_CELLS: usize = 4_000_000;
/// Odds are kept within this, so that a cell can change its mind.
pub const MOST_ODDS: f32 = 4.0;
/// What is known beforehand to be occupied, and to be free. What was free is easier to change: things are left lying about
/// more often than walls are torn down.
pub const KNOWN: [f32; 2] = [MOST_ODDS, -2.0];
/// From here on a cell counts as occupied, or, below its negative, as free.
pub const SURE: f32 = 0.5;

/// Which cells there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// The lower left corner in `map`, m.
    pub low: [f64; 2],
    /// The side of a cell, m.
    pub cell: f64,
    /// Cells along x and y.
    pub size: [usize; 2],
}

impl Layout {
    /// The cells that cover a rectangle.
    ///
    /// # Errors
    /// [`Why::BadNumber`] for a rectangle without extent or a cell that is not above zero, [`Why::TooLarge`] for more than
    /// [`MOST_CELLS`].
    pub fn covering(low: [f64; 2], high: [f64; 2], cell: f64) -> Result<Layout, Why> {
        let side = |axis: usize| ((high[axis] - low[axis]) / cell - 1e-9).ceil();
        let (nx, ny) = (side(0), side(1));
        if !(cell > 0.0) || !(nx >= 1.0) || !(ny >= 1.0) || !low.iter().all(|x| x.is_finite()) {
            return Err(Why::BadNumber);
        }
        if !(nx * ny <= MOST_CELLS as f64) {
            return Err(Why::TooLarge);
        }
        Ok(Layout { low, cell, size: [nx as usize, ny as usize] })
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The cell of a point, as column and row; none outside.
    pub fn cell_of(&self, at: [f64; 2]) -> Option<[usize; 2]> {
        let [x, y] = self.position(at).map(f64::floor);
        let inside = x >= 0.0 && y >= 0.0 && x < self.size[0] as f64 && y < self.size[1] as f64;
        inside.then_some([x as usize, y as usize])
    }

    /// A point in cells from the lower left corner.
    pub fn position(&self, at: [f64; 2]) -> [f64; 2] {
        [(at[0] - self.low[0]) / self.cell, (at[1] - self.low[1]) / self.cell]
    }

    /// The middle of a cell.
    pub fn centre(&self, [x, y]: [usize; 2]) -> [f64; 2] {
        [self.low[0] + (x as f64 + 0.5) * self.cell, self.low[1] + (y as f64 + 0.5) * self.cell]
    }

    /// Where a cell lies in a row of all.
    pub fn index(&self, [x, y]: [usize; 2]) -> usize {
        y * self.size[0] + x
    }

    /// The cell of an index.
    pub fn cell_at(&self, index: usize) -> [usize; 2] {
        [index % self.size[0], index / self.size[0]]
    }
}

/// An occupancy grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Which cells there are.
    pub layout: Layout,
    /// Logarithms of the odds, row by row from the lower left.
    pub odds: Vec<f32>,
}

impl Grid {
    /// A grid of which nothing is known.
    pub fn unknown(layout: Layout) -> Grid {
        Grid { layout, odds: vec![0.0; layout.cells()] }
    }

    /// A grid that is free but for these shapes. A cell counts when its middle lies in a shape; what is thinner than a cell is
    /// taken to be as thick as one, so that thin walls have no holes.
    pub fn known(layout: Layout, shapes: &[Shape]) -> Grid {
        let mut grid = Grid { layout, odds: vec![KNOWN[1]; layout.cells()] };
        for shape in shapes.iter().map(|s| s.at_least(layout.cell)) {
            let [low, high] = shape.bounds();
            let first = layout.position(low).map(|x| x.floor().max(0.0) as usize);
            let last = layout.position(high).map(|x| x.ceil().max(0.0) as usize);
            for y in first[1]..last[1].min(layout.size[1]) {
                for x in first[0]..last[0].min(layout.size[0]) {
                    if shape.distance(layout.centre([x, y])) <= 0.0
                        && let Some(odds) = grid.odds.get_mut(layout.index([x, y]))
                    {
                        *odds = KNOWN[0];
                    }
                }
            }
        }
        grid
    }

    /// The odds of a cell.
    pub fn at(&self, cell: [usize; 2]) -> f32 {
        self.odds.get(self.layout.index(cell)).copied().unwrap_or(0.0)
    }

    /// Whether something stands in a cell.
    pub fn is_occupied(&self, cell: [usize; 2]) -> bool {
        self.at(cell) >= SURE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_walls_have_no_holes() {
        let layout = Layout::covering([0.0, 0.0], [2.0, 1.0], 0.05).expect("a layout");
        assert_eq!(layout.size, [40, 20]);
        let wall = Shape::block([1.0, 0.5], [1.8, 0.01], 0.3);
        let grid = Grid::known(layout, &[wall]);
        // Every column from one end to the other has an occupied cell.
        for x in 4..36 {
            assert!((0..20).any(|y| grid.is_occupied([x, y])), "{x}");
        }
        assert!(!grid.is_occupied([0, 0]));
    }

    #[test]
    fn what_is_no_rectangle_is_refused() {
        assert_eq!(Layout::covering([0.0, 0.0], [0.0, 1.0], 0.1), Err(Why::BadNumber));
        assert_eq!(Layout::covering([0.0, 0.0], [1.0, 1.0], 0.0), Err(Why::BadNumber));
        assert_eq!(Layout::covering([0.0, 0.0], [f64::NAN, 1.0], 0.1), Err(Why::BadNumber));
        assert_eq!(Layout::covering([0.0, 0.0], [1e6, 1e6], 0.1), Err(Why::TooLarge));
    }
}
