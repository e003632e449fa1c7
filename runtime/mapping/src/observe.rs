//! Puts what a scan says into a grid: the occupancy grid mapping of Moravec and Elfes (1985) in the form with logarithms of
//! odds (Thrun, Burgard and Fox, Probabilistic Robotics, 2005, Table 9.1), with the inverse model of a scanner of thin beams.

use crate::{
    grid::{Grid, MOST_ODDS},
    place::Place,
    scan::Beam,
};

/// What a scan adds to the odds of a cell in which beams end, and of one that they go through. A cell counts once a scan: it
/// fills when more beams end in it than go through.
const HIT: f32 = 0.9;
const MISS: f32 = -0.4;

/// The grid after a scan from a pose. Beams count as far as `reach`, also those that met nothing.
pub fn observe(grid: &Grid, from: Place, scan: &[Beam], reach: f64) -> Grid {
    let mut out = grid.clone();
    if !from.is_finite() || !(reach > 0.0) {
        return out;
    }
    let layout = grid.layout;
    // How many beams end in each cell, and how many go through.
    let mut said = vec![[0_u16; 2]; layout.cells()];
    let mut touched: Vec<usize> = Vec::new();
    let mut say = |index: usize, what: usize| {
        if let Some(s) = said.get_mut(index) {
            if *s == [0; 2] {
                touched.push(index);
            }
            s[what] = s[what].saturating_add(1);
        }
    };
    for beam in scan.iter().filter(|b| b.is_sound()) {
        let (s, c) = libm::sincos(from.yaw + beam.bearing);
        let end = |r: f64| [from.at[0] + r * c, from.at[1] + r * s];
        let met = beam.range.filter(|r| *r <= reach);
        let to = met.unwrap_or(reach);
        let last = met.and_then(|r| layout.cell_of(end(r)));
        for cell in Along::new(layout.position(from.at), layout.position(end(to)), layout.size) {
            if Some(cell) != last {
                say(layout.index(cell), 1);
            }
        }
        if let Some(cell) = last {
            say(layout.index(cell), 0);
        }
    }
    for index in touched {
        let change = if said.get(index).is_some_and(|s| s[0] > s[1]) { HIT } else { MISS };
        if let Some(odds) = out.odds.get_mut(index) {
            *odds = (*odds + change).clamp(-MOST_ODDS, MOST_ODDS);
        }
    }
    out
}

/// The cells that a line goes through (Amanatides and Woo, 1987), as far as they are in the grid without a break.
struct Along {
    cell: [i64; 2],
    step: [i64; 2],
    next: [f64; 2],
    delta: [f64; 2],
    size: [usize; 2],
    left: i64,
}

impl Along {
    fn new(from: [f64; 2], to: [f64; 2], size: [usize; 2]) -> Along {
        let cell = [from[0].floor() as i64, from[1].floor() as i64];
        let last = [to[0].floor() as i64, to[1].floor() as i64];
        let (mut step, mut next, mut delta) = ([0; 2], [f64::INFINITY; 2], [f64::INFINITY; 2]);
        for a in 0..2 {
            let d = to[a] - from[a];
            if d != 0.0 {
                step[a] = if d > 0.0 { 1 } else { -1 };
                delta[a] = 1.0 / d.abs();
                let edge = if d > 0.0 { cell[a] as f64 + 1.0 - from[a] } else { from[a] - cell[a] as f64 };
                next[a] = edge / d.abs();
            }
        }
        let left = (0..2).map(|a| (last[a] - cell[a]).abs()).sum::<i64>() + 1;
        Along { cell, step, next, delta, size, left }
    }
}

impl Iterator for Along {
    type Item = [usize; 2];

    fn next(&mut self) -> Option<[usize; 2]> {
        let inside = |a: usize| self.cell[a] >= 0 && (self.cell[a] as u64) < self.size[a] as u64;
        if self.left <= 0 || !inside(0) || !inside(1) {
            return None;
        }
        let here = [self.cell[0] as usize, self.cell[1] as usize];
        self.left -= 1;
        let a = usize::from(self.next[1] < self.next[0]);
        self.cell[a] += self.step[a];
        self.next[a] += self.delta[a];
        Some(here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Layout;

    fn grid() -> Grid {
        Grid::unknown(Layout::covering([0.0, 0.0], [4.0, 4.0], 0.1).expect("a layout"))
    }

    #[test]
    fn a_beam_frees_its_way_and_fills_its_end() {
        let from = Place::new(1.05, 2.05, 0.0);
        let seen = observe(&grid(), from, &[Beam { bearing: 0.0, range: Some(2.0) }], 10.0);
        assert!(seen.at([30, 20]) > 0.0);
        assert!((10..28).all(|x| seen.at([x, 20]) < 0.0));
        assert_eq!(seen.at([32, 20]), 0.0);
        assert_eq!(seen.at([9, 20]), 0.0);
    }

    #[test]
    fn beams_to_nowhere_and_poses_outside_do_no_harm() {
        let from = Place::new(1.05, 2.05, 1.0);
        let seen = observe(&grid(), from, &[Beam { bearing: 0.0, range: None }], 100.0);
        assert!(seen.odds.iter().all(|o| *o <= 0.0) && seen.odds.iter().any(|o| *o < 0.0));
        let bad = Beam { bearing: f64::NAN, range: Some(1.0) };
        assert_eq!(observe(&grid(), from, &[bad], 10.0), grid());
        let outside = Place::new(-5.0, 2.0, 0.0);
        let seen = observe(&grid(), outside, &[Beam { bearing: 0.0, range: None }], 3.0);
        assert_eq!(seen, grid());
    }
}
