//! How much two maps have in common.

use crate::grid::{Grid, SURE};

/// Intersection over union of what is not free in two grids, 0 to 1: cells that are free in neither, of those that are not
/// free in both. Cells are those of the first grid. What is occupied is not free, nor is that of which nothing is known: the
/// inside of things, which nobody sees, and ground that was never looked at, which so counts against a map. Where all is free
/// in both it is 1.
pub fn overlap(a: &Grid, b: &Grid) -> f64 {
    let (mut both, mut either) = (0_u32, 0_u32);
    for i in 0..a.layout.cells() {
        let cell = a.layout.cell_at(i);
        let (p, q) =
            (!is_free(a, cell), b.layout.cell_of(a.layout.centre(cell)).is_none_or(|c| !is_free(b, c)));
        both += u32::from(p && q);
        either += u32::from(p || q);
    }
    if either == 0 { 1.0 } else { f64::from(both) / f64::from(either) }
}

fn is_free(grid: &Grid, cell: [usize; 2]) -> bool {
    grid.at(cell) <= -SURE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, shape::Shape};

    #[test]
    fn what_is_unknown_is_not_free() {
        let layout = Layout::covering([0.0, 0.0], [2.0, 1.0], 0.1).expect("a layout");
        let left = Grid::known(layout, &[Shape::block([0.5, 0.5], [1.0, 1.0], 0.0)]);
        let none = Grid::known(layout, &[]);
        assert_eq!(overlap(&left, &left), 1.0);
        assert_eq!(overlap(&none, &none), 1.0);
        assert_eq!(overlap(&left, &none), 0.0);
        // Half of what is unknown stands; a cell more where the shape touches the next ones.
        let share = overlap(&Grid::unknown(layout), &left);
        assert!((0.5..=0.56).contains(&share), "{share}");
    }
}
