//! Triangles as the camera sees them.
//!
//! A facet's inverse depth, and whatever varies linearly over its plane divided by depth, is linear over the image.
//! The functions come from the triangle's three corners in the camera's frame, not from projected corners, so they
//! are the same for a triangle that passes through the camera's plane.

use crate::clip::{MOST_CORNERS, Outline};
use crate::geometry::{Point, Pose, Rotation, add, cross, dot, scale, subtract};
use crate::lens::Lens;
use crate::light::Light;
use crate::mesh::{Mesh, NO_TRIANGLE};
use crate::scene::{PartPose, Scene};

/// Metres before the camera below which nothing is seen.
pub(crate) const NEAR: f64 = 0.005;

/// Steps of a pixel to which corners are rounded.
pub(crate) const SUBPIXELS: i32 = 256;

/// Pixels from the image's origin beyond which outlines are cut, so that fixed point does not overflow.
const GUARD: f64 = 131_072.0;

/// A facet whose functions are steeper is not drawn: nothing that is computed of smaller ones overflows.
const STEEPEST: f64 = 1e100;

/// Metres beyond which all depths are alike.
const FARTHEST: f64 = 1e9;

/// `[a, b, c]` stands for a·x + b·y + c at the pixel coordinates (x, y).
pub(crate) type Linear = [f64; 3];

#[inline(always)]
pub(crate) fn at(function: &Linear, x: f64, y: f64) -> f64 {
    function[0] * x + function[1] * y + function[2]
}

/// A pinhole in the world. Its frame is the image's: x right, y down, z forward.
pub(crate) struct Optics {
    pub width: usize,
    pub height: usize,
    focal: [f64; 2],
    centre: [f64; 2],
    eye: Point,
    /// Right, down and forward in the world.
    axes: [Point; 3],
}

/// A triangle, or the part of it that is before the camera.
#[derive(Clone)]
pub(crate) struct Facet {
    /// Corners over the image in [`SUBPIXELS`], going round to the left as the image is looked at.
    corners: [[i32; 2]; MOST_CORNERS],
    count: usize,
    /// First row that it may cover, and the one after the last.
    pub rows: (i32, i32),
    /// One for each side: how many pixels within it; negative beyond.
    pub sides: [Linear; 3],
    /// The facet beyond each side that faces the camera too, or [`NO_TRIANGLE`].
    pub beyond: [u32; 3],
    /// One over depth in metres.
    pub inverse_depth: Linear,
    /// Inverse depth of its farthest and its nearest point.
    pub farthest: f32,
    pub nearest: f32,
    /// Texture coordinates in repeats, over depth.
    pub u: Linear,
    pub v: Linear,
    pub texture: u32,
    /// Brightness in 256ths.
    pub shade: u32,
    /// Its plane: normal in the camera's frame, and distance from the eye along it.
    normal: Point,
    distance: f64,
}

impl Optics {
    /// None if nothing can be seen that way.
    pub fn new(lens: &Lens, pose: &Pose) -> Option<Self> {
        lens.check().ok()?;
        if !pose.position.iter().all(|c| c.is_finite()) {
            return None;
        }
        let m = pose.rotation.matrix();
        let column = |i: usize| [m[0][i], m[1][i], m[2][i]];
        Some(Self {
            width: lens.width,
            height: lens.height,
            focal: [lens.fx, lens.fy],
            centre: [lens.cx, lens.cy],
            eye: pose.position,
            axes: [scale(column(1), -1.0), scale(column(2), -1.0), column(0)],
        })
    }

    /// Sine of the elevation in the world at which a place of the image looks.
    pub fn elevation(&self, x: f64, y: f64) -> f64 {
        let (x, y) = ((x - self.centre[0]) / self.focal[0], (y - self.centre[1]) / self.focal[1]);
        let [right, down, forward] = self.axes;
        (forward[2] + x * right[2] + y * down[2]) / (1.0 + x * x + y * y).sqrt()
    }

    fn see(&self, point: Point) -> Point {
        let from_eye = subtract(point, self.eye);
        self.axes.map(|axis| dot(axis, from_eye))
    }

    /// A linear function of the direction (x/z, y/z, 1) as one of the pixel.
    fn over_pixels(&self, f: Point) -> Linear {
        let (a, b) = (f[0] / self.focal[0], f[1] / self.focal[1]);
        [a, b, f[2] - a * self.centre[0] - b * self.centre[1]]
    }

    fn project(&self, p: Point) -> [f64; 2] {
        [self.focal[0] * p[0] / p[2] + self.centre[0], self.focal[1] * p[1] / p[2] + self.centre[1]]
    }

    /// Cuts a triangle to what is before the camera and not too far aside. None if nothing is left in the image.
    fn outline(&self, corners: [Point; 3]) -> Option<Outline> {
        let mut outline = Outline::of(corners);
        if corners.iter().any(|p| p[2] < NEAR) {
            outline = outline.cut(|p| p[2] - NEAR);
        }
        let [fx, fy] = self.focal;
        let [cx, cy] = self.centre;
        // Linear in the point: how far within each guard, times depth.
        let guards = |p: Point| {
            [
                fx * p[0] + (cx + GUARD) * p[2],
                (GUARD - cx) * p[2] - fx * p[0],
                fy * p[1] + (cy + GUARD) * p[2],
                (GUARD - cy) * p[2] - fy * p[1],
            ]
        };
        for side in 0..4 {
            if outline.corners().iter().any(|p| guards(*p)[side] < 0.0) {
                outline = outline.cut(|p| guards(p)[side]);
            }
        }
        (outline.corners().len() >= 3).then_some(outline)
    }

    /// Whether all corners are beyond the same side of the image, or behind the camera.
    fn misses(&self, corners: &[Point; 3]) -> bool {
        let (width, height) = (self.width as f64, self.height as f64);
        let beyond = |outside: &dyn Fn(&Point) -> bool| corners.iter().all(outside);
        let x = |p: &Point| self.focal[0] * p[0] + self.centre[0] * p[2];
        let y = |p: &Point| self.focal[1] * p[1] + self.centre[1] * p[2];
        beyond(&|p| p[2] < NEAR)
            || beyond(&|p| x(p) < 0.0)
            || beyond(&|p| x(p) > width * p[2])
            || beyond(&|p| y(p) < 0.0)
            || beyond(&|p| y(p) > height * p[2])
    }
}

impl Facet {
    /// Corners over the image, in [`SUBPIXELS`].
    pub fn corners(&self) -> &[[i32; 2]] {
        &self.corners[..self.count]
    }

    /// Inverse depth at a place of the image, held within what the facet has anywhere: beside a facet seen edge-on
    /// it would go astray.
    #[inline(always)]
    pub fn inverse_depth_at(&self, x: f64, y: f64) -> f64 {
        let here = at(&self.inverse_depth, x, y);
        let (farthest, nearest) = (f64::from(self.farthest), f64::from(self.nearest));
        if here > nearest {
            nearest
        } else if here > farthest {
            here
        } else {
            farthest
        }
    }

    /// Whether the two are pieces of one flat face.
    pub fn continues(&self, other: &Self) -> bool {
        self.texture == other.texture
            && dot(self.normal, other.normal) > 1.0 - 1e-9
            && (self.distance - other.distance).abs() < 1e-4 * (1.0 + self.distance.abs())
    }

    fn new(optics: &Optics, corners: [Point; 3], uv: &[[f64; 2]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        if optics.misses(&corners) {
            return None;
        }
        // The inverse of the matrix of corners: row i gives corner i's share, over depth.
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let determinant = dot(a, bc);
        // Seen from the front its corners go round to the left, which in a frame with y down is negative.
        if determinant.is_nan() || determinant >= 0.0 {
            return None;
        }
        let sides = [bc, ca, ab].map(|row| optics.over_pixels(scale(row, 1.0 / determinant)));
        let weighted =
            |w: [f64; 3]| [0, 1, 2].map(|i| w[0] * sides[0][i] + w[1] * sides[1][i] + w[2] * sides[2][i]);
        let (u, v) = (weighted([0, 1, 2].map(|i| uv[i][0])), weighted([0, 1, 2].map(|i| uv[i][1])));
        let inverse_depth = weighted([1.0; 3]);
        let normal = cross(subtract(b, a), subtract(c, a));
        let length = dot(normal, normal).sqrt();
        let finite = [u, v, inverse_depth].iter().chain(&sides).flatten().all(|c| c.abs() < STEEPEST);
        if !(finite && length.is_finite() && length > 0.0) {
            return None;
        }
        let normal = scale(normal, 1.0 / length);

        let outline = optics.outline(corners)?;
        let mut snapped = [[0; 2]; MOST_CORNERS];
        let (mut left, mut right, mut top, mut bottom) = (i32::MAX, i32::MIN, i32::MAX, i32::MIN);
        let (mut farthest, mut nearest) = (f64::INFINITY, 0.0);
        for (snapped, corner) in snapped.iter_mut().zip(outline.corners()) {
            let [x, y] = optics.project(*corner).map(to_subpixels);
            (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
            *snapped = [x, y];
            let inverse = 1.0 / if corner[2] < FARTHEST { corner[2] } else { FARTHEST };
            farthest = if inverse < farthest { inverse } else { farthest };
            nearest = if inverse > nearest { inverse } else { nearest };
        }
        let rows = (first_centre(top).max(0), first_centre(bottom).min(optics.height as i32));
        if rows.0 >= rows.1 || first_centre(right) <= 0 || first_centre(left) >= optics.width as i32 {
            return None;
        }
        Some(Self {
            corners: snapped,
            count: outline.corners().len(),
            rows,
            sides: sides.map(in_pixels),
            beyond: [NO_TRIANGLE; 3],
            inverse_depth,
            farthest: farthest as f32,
            nearest: nearest as f32,
            u,
            v,
            texture: 0,
            shade: 0,
            normal,
            distance: dot(normal, a),
        })
    }
}

/// The same line, at which the function is zero, with a slope of one a pixel.
fn in_pixels(side: Linear) -> Linear {
    let slope = (side[0] * side[0] + side[1] * side[1]).sqrt();
    if slope > 0.0 { side.map(|c| c / slope) } else { side }
}

/// To whole [`SUBPIXELS`].
fn to_subpixels(pixels: f64) -> i32 {
    // Outlines are cut at the guard: this only holds what rounding or an odd lens leaves beyond it.
    const LIMIT: f64 = 2.0 * GUARD;
    let held = if pixels < LIMIT { pixels } else { LIMIT };
    let held = if held > -LIMIT { held } else { -LIMIT };
    // Rounded by truncation of a positive number: `floor` is a call where the instruction set has none.
    ((held + LIMIT) * f64::from(SUBPIXELS) + 0.5) as i32 - LIMIT as i32 * SUBPIXELS
}

/// The first pixel whose centre is at or after a place in [`SUBPIXELS`].
#[inline(always)]
pub(crate) fn first_centre(place: i32) -> i32 {
    (place + SUBPIXELS / 2 - 1).div_euclid(SUBPIXELS)
}

/// All facets of a frame, in the order of the scene: of two at the same depth the first is seen. `numbers` is
/// memory to work in.
pub(crate) fn collect(
    scene: &Scene,
    parts: &[PartPose],
    optics: &Optics,
    light: &Light,
    facets: &mut Vec<Facet>,
    numbers: &mut Vec<u32>,
) {
    facets.clear();
    let origin = Pose { position: [0.0; 3], rotation: Rotation::IDENTITY };
    let placed = parts.iter().filter_map(|placed| Some((scene.part(placed.part)?, &placed.pose)));
    for (mesh, pose) in [(&scene.fixed, &origin)].into_iter().chain(placed) {
        numbers.clear();
        let first = facets.len();
        add_mesh(mesh, pose, optics, light, scene, facets, numbers);
        for facet in &mut facets[first..] {
            facet.beyond =
                facet.beyond.map(|triangle| numbers.get(triangle as usize).copied().unwrap_or(NO_TRIANGLE));
        }
    }
}

/// Adds a mesh's facets, with the numbers of triangles beyond their sides, and notes for each triangle the number of
/// its facet.
fn add_mesh(
    mesh: &Mesh,
    pose: &Pose,
    optics: &Optics,
    light: &Light,
    scene: &Scene,
    facets: &mut Vec<Facet>,
    numbers: &mut Vec<u32>,
) {
    let still = pose.rotation == Rotation::IDENTITY;
    let rotation = pose.rotation.matrix();
    let turn = |p: Point| if still { p } else { rotation.map(|row| dot(row, p)) };
    for triangle in &mesh.triangles {
        let corners = triangle.corners.map(|corner| optics.see(add(turn(corner), pose.position)));
        let facet = scene.texture(triangle.texture).and_then(|texture| {
            // What is wider than high comes again sooner going up.
            let uv = triangle.uv.map(|[u, v]| [u, v * texture.proportion()]);
            Facet::new(optics, corners, &uv)
        });
        numbers.push(if facet.is_some() { facets.len() as u32 } else { NO_TRIANGLE });
        facets.extend(facet.map(|facet| Facet {
            texture: triangle.texture.0,
            shade: light.shade(turn(triangle.normal)),
            beyond: triangle.beyond,
            ..facet
        }));
    }
}
