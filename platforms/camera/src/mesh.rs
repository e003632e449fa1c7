//! Triangles, and the shapes that are built of them.

use std::collections::BTreeMap;

use crate::geometry::{Point, Pose, Rotation, add, cross, dot, subtract, unit};
use crate::scene::TextureIndex;

/// What a face is covered with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Of the scene that the mesh is part of.
    pub texture: TextureIndex,
    /// Metres after which the texture repeats.
    pub repeat: f64,
}

/// A face, seen from the side from which its corners go round to the left.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Triangle {
    /// Metres.
    pub corners: [Point; 3],
    /// u, v of each corner, in repeats of the texture.
    pub uv: [[f64; 2]; 3],
    /// Of unit length, out of the face.
    pub normal: Point,
    pub texture: TextureIndex,
    /// The triangle of the mesh beyond the side opposite each corner, or [`NO_TRIANGLE`].
    pub beyond: [u32; 3],
}

/// Where a mesh ends.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// A side from corner to corner, by the bits of their coordinates.
type Side = [[u64; 3]; 2];

/// Triangles in one frame, metres. Each is seen from one side only, and so are the shapes: from outside a box,
/// from inside a room.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub(crate) triangles: Vec<Triangle>,
    /// Sides that no other triangle has met yet, with their triangle and the corner opposite.
    open: BTreeMap<Side, (u32, usize)>,
}

impl Mesh {
    /// No triangles.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How many triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Corners in metres and texture coordinates in repeats of every triangle.
    pub fn triangles(&self) -> impl Iterator<Item = (&[Point; 3], &[[f64; 2]; 3], TextureIndex)> {
        self.triangles.iter().map(|t| (&t.corners, &t.uv, t.texture))
    }

    /// A triangle whose corners go round to the left as seen from its visible side; u, v in repeats of the
    /// texture, v up. Nothing is added if it has no area or is not finite.
    pub fn triangle(&mut self, corners: [Point; 3], uv: [[f64; 2]; 3], texture: TextureIndex) {
        let area = cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]));
        let finite = uv.iter().flatten().all(|c| c.is_finite());
        if let (Some(normal), true) = (unit(area), finite) {
            let beyond = self.meet(&corners);
            self.triangles.push(Triangle { corners, uv, normal, texture, beyond });
        }
    }

    /// Finds the triangles that the sides of a new one have in common with it, and notes it for those to come.
    fn meet(&mut self, corners: &[Point; 3]) -> [u32; 3] {
        let new = self.triangles.len() as u32;
        // Adding zero makes one zero of the two.
        let [a, b, c] = corners.map(|corner| corner.map(|v| (v + 0.0).to_bits()));
        let mut beyond = [NO_TRIANGLE; 3];
        for (opposite, [from, to]) in [[b, c], [c, a], [a, b]].into_iter().enumerate() {
            // Two triangles with the same front go along their common side in opposite ways.
            if let Some((other, opposite_there)) = self.open.remove(&[to, from]) {
                beyond[opposite] = other;
                self.triangles[other as usize].beyond[opposite_there] = new;
            } else {
                self.open.insert([from, to], (new, opposite));
            }
        }
        beyond
    }

    /// A flat face whose corners go round to the left as seen from its visible side. Its texture begins at the
    /// first corner and goes along the edge to the second and up toward the last.
    pub fn quad(&mut self, corners: [Point; 4], surface: Surface) {
        self.quad_from(corners, surface, 0.0);
    }

    /// As [`Self::quad`], its texture moved on by so many metres along the first edge.
    fn quad_from(&mut self, corners: [Point; 4], surface: Surface, start: f64) {
        let [a, b, c, d] = corners;
        let area = add(cross(subtract(b, a), subtract(c, a)), cross(subtract(c, a), subtract(d, a)));
        let (Some(along), Some(normal)) = (unit(subtract(b, a)), unit(area)) else { return };
        let up = cross(normal, along);
        let uv = corners.map(|corner| {
            let from = subtract(corner, a);
            [(start + dot(from, along)) / surface.repeat, dot(from, up) / surface.repeat]
        });
        self.triangle([a, b, c], [uv[0], uv[1], uv[2]], surface.texture);
        self.triangle([a, c, d], [uv[0], uv[2], uv[3]], surface.texture);
    }

    /// A level rectangle between two corners (x, y), seen from above, at the height `z`.
    pub fn ground(&mut self, from: [f64; 2], to: [f64; 2], z: f64, surface: Surface) {
        let (x0, x1) = ordered(from[0], to[0]);
        let (y0, y1) = ordered(from[1], to[1]);
        self.quad([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]], surface);
    }

    /// An upright box: its middle, its sizes along its own x, y and z, and its heading in radians from east to
    /// the left.
    pub fn cuboid(&mut self, centre: Point, size: Point, heading: f64, surface: Surface) {
        self.cuboid_at(&Pose { position: centre, rotation: Rotation::from_heading(heading) }, size, surface);
    }

    /// A box around the origin of `pose`, with sizes along that frame's axes.
    pub fn cuboid_at(&mut self, pose: &Pose, size: Point, surface: Surface) {
        let [x, y, z] = size.map(|s| s.abs() / 2.0);
        let faces = [
            // Front, back, left, right: each begins at its lower left as seen from outside.
            [[x, -y, -z], [x, y, -z], [x, y, z], [x, -y, z]],
            [[-x, y, -z], [-x, -y, -z], [-x, -y, z], [-x, y, z]],
            [[x, y, -z], [-x, y, -z], [-x, y, z], [x, y, z]],
            [[-x, -y, -z], [x, -y, -z], [x, -y, z], [-x, -y, z]],
            // Top and bottom.
            [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]],
            [[-x, y, -z], [x, y, -z], [x, -y, -z], [-x, -y, -z]],
        ];
        for face in faces {
            self.quad(face.map(|corner| pose.apply(corner)), surface);
        }
    }

    /// A wall along a segment on the ground (x, y) from the height `base` up.
    pub fn wall(
        &mut self,
        from: [f64; 2],
        to: [f64; 2],
        base: f64,
        height: f64,
        thickness: f64,
        surface: Surface,
    ) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let centre = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0, base + height / 2.0];
        let length = (dx * dx + dy * dy).sqrt();
        self.cuboid(centre, [length, thickness, height], libm::atan2(dy, dx), surface);
    }

    /// An upright cylinder of at least three sides, standing on `base`.
    pub fn cylinder(&mut self, base: Point, radius: f64, height: f64, sides: usize, surface: Surface) {
        let sides = sides.clamp(3, 1024);
        let corner = |i: usize, up: f64| {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * (i % sides) as f64 / sides as f64);
            add(base, [radius * cos, radius * sin, up])
        };
        let side = 2.0 * radius * libm::sin(core::f64::consts::PI / sides as f64);
        for i in 0..sides {
            let (a, b) = (corner(i, 0.0), corner(i + 1, 0.0));
            let (c, d) = (corner(i + 1, height), corner(i, height));
            self.quad_from([a, b, c, d], surface, side * i as f64);
            for (up, second, third) in [(height, i, i + 1), (0.0, i + 1, i)] {
                let corners = [add(base, [0.0, 0.0, up]), corner(second, up), corner(third, up)];
                let uv =
                    corners.map(|c| [(c[0] - base[0]) / surface.repeat, (c[1] - base[1]) / surface.repeat]);
                self.triangle(corners, uv, surface.texture);
            }
        }
    }

    /// A room between two corners (x, y) on the ground at height zero, seen from inside: four walls, a floor and,
    /// if it has a surface, a ceiling. From outside one looks in, as into a doll's house.
    pub fn room(
        &mut self,
        from: [f64; 2],
        to: [f64; 2],
        height: f64,
        walls: [Surface; 4],
        floor: Surface,
        ceiling: Option<Surface>,
    ) {
        let (x0, x1) = ordered(from[0], to[0]);
        let (y0, y1) = ordered(from[1], to[1]);
        // East, north, west, south: each from its left end as seen from inside.
        let ends = [([x1, y1], [x1, y0]), ([x0, y1], [x1, y1]), ([x0, y0], [x0, y1]), ([x1, y0], [x0, y0])];
        for (([ax, ay], [bx, by]), surface) in ends.into_iter().zip(walls) {
            self.quad([[ax, ay, 0.0], [bx, by, 0.0], [bx, by, height], [ax, ay, height]], surface);
        }
        self.ground([x0, y0], [x1, y1], 0.0, floor);
        if let Some(ceiling) = ceiling {
            let z = height;
            self.quad([[x0, y1, z], [x1, y1, z], [x1, y0, z], [x0, y0, z]], ceiling);
        }
    }

    /// Takes over another mesh's triangles, placed by `pose`.
    pub fn append(&mut self, other: &Self, pose: &Pose) {
        for triangle in &other.triangles {
            let corners = triangle.corners.map(|corner| pose.apply(corner));
            self.triangle(corners, triangle.uv, triangle.texture);
        }
    }
}

/// The smaller first.
fn ordered(a: f64, b: f64) -> (f64, f64) {
    if a <= b { (a, b) } else { (b, a) }
}

/// Whether all normals of a mesh around `centre` lead away from it: for tests of shapes.
#[cfg(test)]
fn faces_away(mesh: &Mesh, centre: Point) -> bool {
    mesh.triangles.iter().all(|t| {
        let middle = add(add(t.corners[0], t.corners[1]), t.corners[2]).map(|c| c / 3.0);
        dot(t.normal, subtract(middle, centre)) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::{Mesh, NO_TRIANGLE, Surface, faces_away};
    use crate::scene::TextureIndex;

    const SURFACE: Surface = Surface { texture: TextureIndex(0), repeat: 2.0 };

    #[test]
    fn shapes_face_out_and_rooms_in() {
        let mut mesh = Mesh::new();
        mesh.cuboid([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], 0.7, SURFACE);
        assert_eq!(mesh.len(), 12);
        assert!(faces_away(&mesh, [1.0, 2.0, 3.0]));

        let mut mesh = Mesh::new();
        mesh.cylinder([1.0, 2.0, 0.0], 0.5, 2.0, 7, SURFACE);
        assert_eq!(mesh.len(), 28);
        assert!(faces_away(&mesh, [1.0, 2.0, 1.0]));

        let mut mesh = Mesh::new();
        mesh.wall([0.0, 0.0], [3.0, 4.0], 0.0, 2.0, 0.1, SURFACE);
        assert!(faces_away(&mesh, [1.5, 2.0, 1.0]));

        let mut mesh = Mesh::new();
        mesh.room([-2.0, -2.0], [2.0, 2.0], 3.0, [SURFACE; 4], SURFACE, Some(SURFACE));
        for triangle in &mut mesh.triangles {
            triangle.normal = triangle.normal.map(|c| -c);
        }
        assert_eq!(mesh.len(), 12);
        assert!(faces_away(&mesh, [0.0, 0.0, 1.5]));
    }

    #[test]
    fn triangles_know_what_is_beyond_their_sides() {
        let mut mesh = Mesh::new();
        mesh.cuboid([1.0, 2.0, 3.0], [1.0, 2.0, 4.0], 0.7, SURFACE);
        mesh.cylinder([5.0, 2.0, 0.0], 0.5, 2.0, 7, SURFACE);
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            for other in triangle.beyond {
                assert!(mesh.triangles[other as usize].beyond.contains(&(number as u32)));
            }
        }
        let mut ground = Mesh::new();
        ground.ground([0.0, 0.0], [1.0, 1.0], 0.0, SURFACE);
        assert_eq!(ground.triangles[0].beyond, [NO_TRIANGLE, 1, NO_TRIANGLE]);
    }

    #[test]
    fn texture_coordinates_are_metres_over_the_repeat() {
        let mut mesh = Mesh::new();
        mesh.ground([0.0, 0.0], [4.0, 6.0], 0.0, SURFACE);
        assert_eq!(mesh.triangles[0].uv, [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0]]);
    }

    #[test]
    fn what_has_no_area_or_is_not_finite_is_not_added() {
        let mut mesh = Mesh::new();
        mesh.ground([0.0, 0.0], [0.0, 6.0], 0.0, SURFACE);
        mesh.cuboid([f64::NAN, 0.0, 0.0], [1.0; 3], 0.0, SURFACE);
        mesh.ground([0.0, 0.0], [1.0, 1.0], 0.0, Surface { repeat: 0.0, ..SURFACE });
        mesh.wall([0.0, 0.0], [f64::INFINITY, 0.0], 0.0, 1.0, 0.1, SURFACE);
        assert!(mesh.is_empty());
    }
}
