//! Discs and boxes on the ground plane: distances, rays, cones, and when a moving disc overlaps them.
//!
//! Written out in f64 rather than taken from parry2d: every body here is a disc or a rectangle with a
//! height, for which the moving-overlap test is a quadratic with an exact root. A general library would
//! approach that root by iteration to a tolerance, works in f32 and shapes of its own, and is slower for
//! these two shapes.

/// A point or vector in the ground plane, metres.
pub type Vec2 = [f64; 2];

/// a · b
pub fn dot(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// z of a × b
pub fn cross(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// a - b
pub fn sub(a: Vec2, b: Vec2) -> Vec2 {
    [a[0] - b[0], a[1] - b[1]]
}

/// a + b k
pub fn along(a: Vec2, b: Vec2, k: f64) -> Vec2 {
    [a[0] + b[0] * k, a[1] + b[1] * k]
}

/// |a|
pub fn norm(a: Vec2) -> f64 {
    dot(a, a).sqrt()
}

/// `a` turned by the angle with this cosine and sine.
pub fn turned(a: Vec2, cos: f64, sin: f64) -> Vec2 {
    [a[0] * cos - a[1] * sin, a[0] * sin + a[1] * cos]
}

/// Times in seconds, first to last; may be infinite.
pub type Interval = (f64, f64);

/// An axis-parallel box around something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least x and y.
    pub low: Vec2,
    /// Greatest x and y.
    pub high: Vec2,
}

impl Aabb {
    /// Around a disc, or a square with this half side.
    pub fn around(at: Vec2, half: f64) -> Aabb {
        Aabb { low: [at[0] - half, at[1] - half], high: [at[0] + half, at[1] + half] }
    }

    /// Whether two share a point.
    pub fn meets(&self, o: &Aabb) -> bool {
        self.low[0] <= o.high[0]
            && o.low[0] <= self.high[0]
            && self.low[1] <= o.high[1]
            && o.low[1] <= self.high[1]
    }
}

/// The footprint of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A disc.
    Disc {
        /// Centre.
        at: Vec2,
        /// Radius.
        radius: f64,
    },
    /// A rectangle.
    Box {
        /// Centre.
        at: Vec2,
        /// Unit vector along its length.
        axis: Vec2,
        /// Half length and half width.
        half: Vec2,
    },
}

impl Shape {
    /// The box around it.
    pub fn aabb(&self) -> Aabb {
        match *self {
            Shape::Disc { at, radius } => Aabb::around(at, radius),
            Shape::Box { at, axis, half } => {
                let (c, s) = (axis[0].abs(), axis[1].abs());
                let reach = [c * half[0] + s * half[1], s * half[0] + c * half[1]];
                Aabb { low: sub(at, reach), high: along(at, reach, 1.0) }
            }
        }
    }

    /// Distance from a point to the rim, negative inside.
    pub fn distance(&self, p: Vec2) -> f64 {
        match *self {
            Shape::Disc { at, radius } => norm(sub(p, at)) - radius,
            Shape::Box { at, axis, half } => {
                let q = local(sub(p, at), axis);
                let over = [q[0].abs() - half[0], q[1].abs() - half[1]];
                let outside = norm([over[0].max(0.0), over[1].max(0.0)]);
                if outside > 0.0 { outside } else { over[0].max(over[1]) }
            }
        }
    }

    /// The point of it nearest to `p`; `p` itself when inside.
    pub fn nearest(&self, p: Vec2) -> Vec2 {
        match *self {
            Shape::Disc { at, radius } => {
                let d = sub(p, at);
                let n = norm(d);
                if n <= radius { p } else { along(at, d, radius / n) }
            }
            Shape::Box { at, axis, half } => {
                let q = local(sub(p, at), axis);
                let c = [q[0].clamp(-half[0], half[0]), q[1].clamp(-half[1], half[1])];
                along(at, turned(c, axis[0], axis[1]), 1.0)
            }
        }
    }

    /// How far from `origin` a ray in the unit direction `dir` meets it; 0 from inside.
    pub fn ray(&self, origin: Vec2, dir: Vec2) -> Option<f64> {
        let (enter, leave) = self.overlap(origin, dir, 0.0)?;
        (leave >= 0.0).then_some(enter.max(0.0))
    }

    /// How far from `origin` the nearest point within a cone is: unit direction `dir`, half opening angle
    /// (at most a right angle) given by its cosine and sine.
    ///
    /// The nearest point of a convex body, if outside the cone, is replaced by the nearest point on the
    /// cone's two edges: distance is a convex function, so its constrained minimum lies on the boundary.
    pub fn in_cone(&self, origin: Vec2, dir: Vec2, cos: f64, sin: f64) -> Option<f64> {
        let to = sub(self.nearest(origin), origin);
        let d = norm(to);
        if dot(to, dir) >= d * cos {
            return Some(d);
        }
        let edges = [turned(dir, cos, sin), turned(dir, cos, -sin)];
        edges.iter().filter_map(|e| self.ray(origin, *e)).reduce(f64::min)
    }

    /// When a disc of this radius, whose centre is at `p + v t`, overlaps it: first and last touch.
    pub fn overlap(&self, p: Vec2, v: Vec2, radius: f64) -> Option<Interval> {
        match *self {
            Shape::Disc { at, radius: r } => within(sub(p, at), v, r + radius),
            Shape::Box { at, axis, half } => {
                // The box grown by the radius is two rectangles and a disc at each corner. It is convex,
                // so the times at which the centre is in it are one interval.
                let (p, v) = (local(sub(p, at), axis), local(v, axis));
                let mut all = slab(p, v, [half[0] + radius, half[1]]);
                if radius > 0.0 {
                    all = joined(all, slab(p, v, [half[0], half[1] + radius]));
                    for corner in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                        all = joined(
                            all,
                            within(sub(p, [corner[0] * half[0], corner[1] * half[1]]), v, radius),
                        );
                    }
                }
                all
            }
        }
    }
}

/// Coordinates of `d` in the frame whose x-axis is `axis`.
fn local(d: Vec2, axis: Vec2) -> Vec2 {
    turned(d, axis[0], -axis[1])
}

fn joined(a: Option<Interval>, b: Option<Interval>) -> Option<Interval> {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (a, b) => a.or(b),
    }
}

/// When |p + v t| <= r.
///
/// The discriminant is a r² - (p × v)² rather than b² - a c: it does not cancel for a grazing pass.
pub fn within(p: Vec2, v: Vec2, r: f64) -> Option<Interval> {
    let (a, b, c) = (dot(v, v), dot(p, v), dot(p, p) - r * r);
    if a == 0.0 {
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let k = cross(p, v);
    let discriminant = a * r * r - k * k;
    if discriminant < 0.0 {
        return None;
    }
    let q = discriminant.sqrt();
    if q + b.abs() == 0.0 {
        return Some((0.0, 0.0));
    }
    // Of the two forms of a root the one without cancellation.
    Some(if b > 0.0 { ((-b - q) / a, c / (-b - q)) } else { (c / (q - b), (q - b) / a) })
}

/// When |x| and |y| of p + v t are within a rectangle around the origin.
fn slab(p: Vec2, v: Vec2, half: Vec2) -> Option<Interval> {
    let mut all = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..2 {
        if v[i] == 0.0 {
            if p[i].abs() > half[i] {
                return None;
            }
        } else {
            let (s, t) = ((-half[i] - p[i]) / v[i], (half[i] - p[i]) / v[i]);
            all = (all.0.max(s.min(t)), all.1.min(s.max(t)));
        }
    }
    (all.0 <= all.1).then_some(all)
}
