//! How far to turn until the way is free. Pure geometry.

/// The ground that an obstacle takes, as its corners from the middle of the body: metres ahead and to the left.
pub type Footprint = [[f64; 2]; 4];

/// Steps of the search, radians.
const STEP: f64 = 0.035;
/// Steps to a half turn.
const STEPS: u32 = 90;
/// Points along each side of a footprint.
const POINTS: u32 = 8;
/// Between places of the body that are tried on a curve, radians.
const ARC: f64 = 0.1;

/// How a body turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Half width of the body, metres.
    pub half_width: f64,
    /// Kept free on each side of it on the way after the turn, metres.
    pub margin: f64,
    /// Radius of the curve of its middle, metres; 0 on the spot.
    pub radius: f64,
    /// For how far the way after the turn is to be free, metres.
    pub length: f64,
    /// The least turn, radians.
    pub least: f64,
}

/// The smallest turn of at least `curve.least` radians, to the left (`sign` 1) or to the right (−1), whose curve touches
/// nothing and after which a lane is free; π when there is none.
pub fn free_turn(obstacles: &[Footprint], curve: &Curve, sign: f64) -> f64 {
    let outlines: Vec<[f64; 2]> = obstacles.iter().flat_map(outline).collect();
    let need = curve.half_width + curve.margin;
    // The middle of the body after a turn.
    let place = |turn: f64| {
        let (s, c) = libm::sincos(turn);
        [curve.radius * s, sign * curve.radius * (1.0 - c)]
    };
    let mut checked = 0.0;
    for k in 0..STEPS {
        let turn = STEP * f64::from(k);
        while curve.radius > 0.0 && checked + ARC <= turn {
            checked += ARC;
            let [x, y] = place(checked);
            // What is near at the beginning it may leave behind.
            let touches = |p: &[f64; 2]| {
                let (first, then) = (libm::hypot(p[0], p[1]), libm::hypot(p[0] - x, p[1] - y));
                then < need.min(first - 0.02)
            };
            if outlines.iter().any(touches) {
                return std::f64::consts::PI;
            }
        }
        if turn < curve.least {
            continue;
        }
        let ([x, y], (s, c)) = (place(turn), libm::sincos(sign * turn));
        let blocks = |p: &[f64; 2]| {
            let (dx, dy) = (p[0] - x, p[1] - y);
            let (ahead, left) = (dx * c + dy * s, dy * c - dx * s);
            ahead > 0.0 && ahead < curve.length && left.abs() < need
        };
        if !outlines.iter().any(blocks) {
            return turn;
        }
    }
    std::f64::consts::PI
}

/// Points along the sides.
pub(crate) fn outline(f: &Footprint) -> impl Iterator<Item = [f64; 2]> + '_ {
    (0..4).flat_map(move |i| {
        let (a, b) = (f[i], f[(i + 1) % 4]);
        (0..POINTS).map(move |k| {
            let t = f64::from(k) / f64::from(POINTS);
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(x: f64, y: f64) -> Footprint {
        [[x, y + 0.5], [x, y - 0.5], [x + 1.0, y - 0.5], [x + 1.0, y + 0.5]]
    }

    #[test]
    fn the_side_with_more_room_takes_the_smaller_turn() {
        let curve = Curve { half_width: 0.3, margin: 0.1, radius: 0.0, length: 3.0, least: 0.0 };
        assert_eq!(free_turn(&[], &curve, 1.0), 0.0);
        assert_eq!(free_turn(&[block(4.0, 0.0)], &curve, 1.0), 0.0, "far away");
        let here = [block(2.0, 0.3)];
        let (left, right) = (free_turn(&here, &curve, 1.0), free_turn(&here, &curve, -1.0));
        // To the left past the near corner (2, 0.8): atan2 plus the half width over the distance.
        let exact = libm::atan2(0.8, 2.0) + libm::asin(0.4 / libm::hypot(2.0, 0.8));
        assert!(left >= exact - STEP && left <= exact + 0.1, "{left} {exact}");
        assert!(right < left);
        // Another one on the right makes the left the shorter way.
        let both = [block(2.0, 0.3), block(1.5, -1.2)];
        assert!(free_turn(&both, &curve, -1.0) > left);
    }

    #[test]
    fn a_wide_curve_hits_what_a_turn_on_the_spot_does_not() {
        let beside = [block(0.6, 1.0), block(2.0, 0.0)];
        let spot = Curve { half_width: 0.3, margin: 0.1, radius: 0.0, length: 3.0, least: 0.0 };
        assert!(free_turn(&beside, &spot, 1.0) < 3.0);
        assert_eq!(free_turn(&beside, &Curve { radius: 1.0, ..spot }, 1.0), std::f64::consts::PI);
    }
}
