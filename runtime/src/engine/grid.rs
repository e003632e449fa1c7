//! A uniform grid over senders, to find the near ones without asking all.

/// A sender at a place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Site {
    pub at: [f64; 3],
    /// Who sent it: an instance.
    pub sender: u32,
    /// Its message.
    pub message: u32,
}

/// Who looks at sites.
pub(crate) trait Visitor {
    /// Looks at some sites.
    fn look(&mut self, sites: &[Site]);

    /// Whether no more sites are wanted when all up to a distance have been looked at.
    fn enough(&self, seen: f64) -> bool;
}

/// Sites sorted into square cells of the xy-plane: about two in each, or as wide as the range when that is
/// less, as far as memory in proportion to the sites allows.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    cell: f64,
    /// Cells a metre.
    density: f64,
    low: [f64; 2],
    size: [usize; 2],
    /// First site of each cell, and the end.
    starts: Vec<u32>,
    sites: Vec<Site>,
    /// Cell of each site, while it is built.
    cell_of: Vec<u32>,
}

impl Grid {
    /// Sorts sites, to be asked for those within `range`. Sites of one cell stay in order.
    pub fn build(&mut self, sites: &[Site], range: f64) {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for s in sites {
            for a in 0..2 {
                low[a] = low[a].min(s.at[a]);
                high[a] = high[a].max(s.at[a]);
            }
        }
        let extent = [0, 1].map(|a| (high[a] - low[a]).max(0.0));
        // A row of robots has no area: then the cells share its length.
        let n = sites.len().max(1) as f64;
        let (area, length) = (extent[0] * extent[1], extent[0].max(extent[1]));
        let even = (2.0 * area / n).sqrt().max(2.0 * length / n);
        // Robots in a ring leave most of its square empty: then finer cells pay.
        let finest = (area / (32.0 * n)).sqrt().max(length / (8.0 * n));
        // A little wider than the range, so that the cells around a place hold all within it.
        let cell = even.min((1.000_001 * range).max(finest));
        self.cell =
            if cell.is_finite() && cell > 1e-9 { cell } else { 1e-9_f64.max(extent[0].max(extent[1])) };
        self.density = 1.0 / self.cell;
        self.low = if sites.is_empty() { [0.0; 2] } else { low };
        let most = 8 * sites.len() + 2;
        self.size = extent.map(|e| ((e / self.cell) as usize + 1).min(most));
        self.starts.clear();
        self.starts.resize(self.size[0] * self.size[1] + 1, 0);
        self.cell_of.clear();
        for s in sites {
            let [x, y] =
                [0, 1].map(|a| (((s.at[a] - self.low[a]) * self.density) as usize).min(self.size[a] - 1));
            let c = y * self.size[0] + x;
            self.cell_of.push(c as u32);
            self.starts[c] += 1;
        }
        let mut sum = 0;
        for c in &mut self.starts {
            sum += *c;
            *c = sum;
        }
        self.sites.clear();
        self.sites.resize(sites.len(), Site { at: [0.0; 3], sender: 0, message: 0 });
        // From the ends, which so become the starts.
        for (s, &c) in sites.iter().zip(&self.cell_of).rev() {
            let end = &mut self.starts[c as usize];
            *end -= 1;
            self.sites[*end as usize] = *s;
        }
    }

    /// Shows sites around `at` in growing squares until all within `range` are seen, or the visitor has
    /// enough.
    pub fn around(&self, at: [f64; 3], range: f64, visitor: &mut impl Visitor) {
        if self.sites.is_empty() {
            return;
        }
        let index = |a: usize| {
            let x = ((at[a] - self.low[a]) * self.density).clamp(-1e9, 1e9);
            // Rounds down, without a call of `floor`.
            x as i64 - i64::from(x < x as i64 as f64)
        };
        let center = [index(0), index(1)];
        let size = [self.size[0] as i64, self.size[1] as i64];
        if range < self.cell {
            let [from, to] = [(center[0] - 1).max(0), (center[0] + 1).min(size[0] - 1)];
            if from <= to {
                for y in (center[1] - 1).max(0)..=(center[1] + 1).min(size[1] - 1) {
                    self.cells(y, from, to, visitor);
                }
            }
            return;
        }
        let gap = |a: usize| (-center[a]).max(center[a] - (size[a] - 1)).max(0);
        let reach = |a: usize| center[a].abs().max((size[a] - 1 - center[a]).abs());
        let mut ring = gap(0).max(gap(1));
        let last = reach(0).max(reach(1));
        while ring <= last {
            let (x0, x1) = (center[0] - ring, center[0] + ring);
            for y in (center[1] - ring).max(0)..=(center[1] + ring).min(size[1] - 1) {
                if y == center[1] - ring || y == center[1] + ring {
                    self.row(y, x0.max(0), x1.min(size[0] - 1), visitor);
                } else {
                    if x0 >= 0 {
                        self.row(y, x0, x0, visitor);
                    }
                    if x1 < size[0] && ring > 0 {
                        self.row(y, x1, x1, visitor);
                    }
                }
            }
            let seen = ring as f64 * self.cell;
            if seen > range || visitor.enough(seen) {
                return;
            }
            ring += 1;
        }
    }

    fn row(&self, y: i64, from: i64, to: i64, visitor: &mut impl Visitor) {
        if from <= to && to >= 0 && from < self.size[0] as i64 {
            self.cells(y, from, to, visitor);
        }
    }

    /// Cells of a row that are there.
    #[inline(always)]
    fn cells(&self, y: i64, from: i64, to: i64, visitor: &mut impl Visitor) {
        let c = y as usize * self.size[0];
        let (a, b) = (self.starts[c + from as usize], self.starts[c + to as usize + 1]);
        visitor.look(&self.sites[a as usize..b as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::chance;

    struct Seen(Vec<Site>);

    impl Visitor for Seen {
        fn look(&mut self, sites: &[Site]) {
            self.0.extend_from_slice(sites);
        }

        fn enough(&self, _: f64) -> bool {
            false
        }
    }

    #[test]
    fn finds_what_a_search_of_all_finds() {
        for n in [0u32, 1, 2, 17, 300] {
            for flat in [false, true] {
                let sites: Vec<Site> = (0..n)
                    .map(|i| {
                        let c = |k| 20.0 * chance(5, u64::from(n), k, u64::from(i), 0);
                        Site { at: [c(1), if flat { 3.0 } else { c(2) }, 0.0], sender: i, message: 0 }
                    })
                    .collect();
                let mut grid = Grid::default();
                for (at, range) in
                    [([3.0, 4.0, 0.0], 2.5), ([-30.0, 4.0, 0.0], 35.0), ([10.0, 10.0, 0.0], 1e9)]
                {
                    grid.build(&sites, range);
                    let near = |s: &Site| {
                        let d = [0, 1].map(|a| s.at[a] - at[a]);
                        d[0] * d[0] + d[1] * d[1] <= range * range
                    };
                    let mut seen = Seen(Vec::new());
                    grid.around(at, range, &mut seen);
                    let mut found: Vec<u32> = seen.0.iter().filter(|s| near(s)).map(|s| s.sender).collect();
                    found.sort_unstable();
                    let all: Vec<u32> = sites.iter().filter(|s| near(s)).map(|s| s.sender).collect();
                    assert_eq!(found, all, "{n} {flat} {at:?}");
                }
            }
        }
    }
}
