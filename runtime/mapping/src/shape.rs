//! What a map shows: footprints of things that stand.

use crate::place::{Place, apart};

/// A footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Round.
    Disc {
        /// Its middle, m.
        at: [f64; 2],
        /// m.
        radius: f64,
    },
    /// Rectangular.
    Block {
        /// Its middle and heading.
        place: Place,
        /// Half its length and width, m.
        half: [f64; 2],
    },
}

impl Shape {
    /// A rectangle of a length and width, whose length points along `yaw`.
    pub fn block(at: [f64; 2], size: [f64; 2], yaw: f64) -> Shape {
        Shape::Block { place: Place { at, yaw }, half: [0.5 * size[0], 0.5 * size[1]] }
    }

    /// A rectangle along a line from a to b.
    pub fn wall(a: [f64; 2], b: [f64; 2], thickness: f64) -> Shape {
        let yaw = libm::atan2(b[1] - a[1], b[0] - a[0]);
        let at = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        Shape::block(at, [apart(a, b), thickness], yaw)
    }

    /// The same, no thinner than that, m.
    pub fn at_least(&self, thickness: f64) -> Shape {
        let least = 0.5 * thickness;
        match *self {
            Shape::Disc { at, radius } => Shape::Disc { at, radius: radius.max(least) },
            Shape::Block { place, half } => Shape::Block { place, half: half.map(|h| h.max(least)) },
        }
    }

    /// How far a point is from it, m; 0 inside.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        match self {
            Shape::Disc { at, radius } => (apart(*at, point) - radius).max(0.0),
            Shape::Block { place, half } => {
                let [x, y] = place.inward(point);
                libm::hypot((x.abs() - half[0]).max(0.0), (y.abs() - half[1]).max(0.0))
            }
        }
    }

    /// The lower left and upper right corner of what it lies in.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let (at, reach) = match self {
            Shape::Disc { at, radius } => (*at, [*radius; 2]),
            Shape::Block { place, half } => {
                let (s, c) = libm::sincos(place.yaw);
                let (s, c) = (s.abs(), c.abs());
                (place.at, [c * half[0] + s * half[1], s * half[0] + c * half[1]])
            }
        };
        [[at[0] - reach[0], at[1] - reach[1]], [at[0] + reach[0], at[1] + reach[1]]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_the_rim() {
        let wall = Shape::wall([0.0, 0.0], [0.0, 2.0], 0.2);
        assert!((wall.distance([1.0, 1.0]) - 0.9).abs() < 1e-12);
        assert_eq!(wall.distance([0.05, 1.0]), 0.0);
        let disc = Shape::Disc { at: [1.0, 0.0], radius: 0.5 };
        assert!((disc.distance([3.0, 0.0]) - 1.5).abs() < 1e-12);
        assert_eq!(disc.bounds(), [[0.5, -0.5], [1.5, 0.5]]);
    }
}
