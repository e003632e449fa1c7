//! Convex outlines cut by planes.

use crate::geometry::Point;

/// A triangle cut by five planes has no more corners than this.
pub(crate) const MOST_CORNERS: usize = 8;

/// A convex outline.
#[derive(Clone, Copy)]
pub(crate) struct Outline {
    corners: [Point; MOST_CORNERS],
    count: usize,
}

impl Outline {
    pub fn of([a, b, c]: [Point; 3]) -> Self {
        let mut corners = [[0.0; 3]; MOST_CORNERS];
        corners[..3].copy_from_slice(&[a, b, c]);
        Self { corners, count: 3 }
    }

    pub fn corners(&self) -> &[Point] {
        &self.corners[..self.count]
    }

    /// What is left where `inside` is not negative. It has to be linear in the point.
    ///
    /// A cut edge is cut at the same point whichever way round it is followed, to the last bit: two triangles that
    /// share it still share it afterwards, and there is no crack.
    pub fn cut(&self, inside: impl Fn(Point) -> f64) -> Self {
        let mut left = Self { corners: [[0.0; 3]; MOST_CORNERS], count: 0 };
        let corners = self.corners();
        for (i, &here) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let (at_here, at_next) = (inside(here), inside(next));
            if at_here >= 0.0 {
                left.push(here);
            }
            if (at_here >= 0.0) != (at_next >= 0.0) {
                let (kept, at_kept, lost, at_lost) = if at_here >= 0.0 {
                    (here, at_here, next, at_next)
                } else {
                    (next, at_next, here, at_here)
                };
                let share = at_kept / (at_kept - at_lost);
                left.push([0, 1, 2].map(|c| kept[c] + (lost[c] - kept[c]) * share));
            }
        }
        left
    }

    fn push(&mut self, corner: Point) {
        // Rounding could give a sliver one corner more than geometry allows: it does without.
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Outline;

    #[test]
    fn a_corner_cut_off_leaves_four() {
        let triangle = Outline::of([[0.0, 0.0, -1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
        let left = triangle.cut(|p| p[2]);
        assert_eq!(left.corners(), [[0.5, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.5, 0.0]]);
        assert!(triangle.cut(|p| p[2] - 2.0).corners().is_empty());
        assert_eq!(triangle.cut(|p| p[2] + 2.0).corners().len(), 3);
    }
}
