//! How much two maps have in common.

use crate::{field::Field, grid::Grid};

/// Intersection over union of what stands in two grids, 0 to 1: cells that are solid in both, of those that are in either. A
/// cell is solid when it is occupied, or when nothing is known of it and it is nowhere near to free ground: the inside of things
/// that are seen from all sides. Cells are those of the first grid; where both are empty it is 1.
pub fn overlap(a: &Grid, b: &Grid) -> f64 {
    let (mut both, mut either) = (0_u32, 0_u32);
    for i in 0..a.layout.cells() {
        let cell = a.layout.cell_at(i);
        let other = b.layout.cell_of(a.layout.centre(cell));
        let (p, q) = (a.is_occupied(cell), other.is_some_and(|c| b.is_occupied(c)));
        both += u32::from(p && q);
        either += u32::from(p || q);
    }
    if either == 0 { 1.0 } else { f64::from(both) / f64::from(either) }
}

/// Share of cells of the first grid's occupied ones that have an occupied one of the second within `near`, m.
pub fn covered(a: &Grid, b: &Field, near: f64) -> f64 {
    let occupied = (0..a.layout.cells()).map(|i| a.layout.cell_at(i)).filter(|c| a.is_occupied(*c));
    let (mut all, mut found) = (0_u32, 0_u32);
    for c in occupied {
        all += 1;
        found += u32::from(
            b.of_point(a.layout.centre(c)) <= near && b.layout.cell_of(a.layout.centre(c)).is_some(),
        );
    }
    if all == 0 { 1.0 } else { f64::from(found) / f64::from(all) }
}
