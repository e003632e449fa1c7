//! The same triangles with the crate retrofire-core: bilinear, no mipmaps, no light.
//!
//! It is given what makes it fast: textures as packed integers, one call for each texture, back faces culled, the
//! whole inverse depth buffer and no clearing of colours.

use retrofire_core::geom::{Tri, Vertex3, tri, vertex};
use retrofire_core::math::mat::ProjMat3;
use retrofire_core::math::{Color4, pt3, rgba, vec::vec2};
use retrofire_core::render::ctx::{DepthSort, FaceCull};
use retrofire_core::render::target::{Colorbuf, Framebuf};
use retrofire_core::render::{Context, Frag, Model, TexCoord, render, shader};
use retrofire_core::util::Buf2;
use retrofire_core::util::Dims;
use retrofire_core::util::pixfmt::Xrgb8888;
use soifra_camera::{Image, Lens, Pose};

use crate::room::Room;

/// A texture whose sides are powers of two: `0x00_BB_GG_RR`, bottom row first.
struct Texels {
    log_width: u32,
    mask: [u32; 2],
    size: [f32; 2],
    colours: Vec<u32>,
}

impl Texels {
    fn new(image: &Image) -> Self {
        let rows = image.data.chunks_exact(3 * image.width).rev();
        let colour = |p: &[u8]| u32::from(p[0]) | u32::from(p[1]) << 8 | u32::from(p[2]) << 16;
        Self {
            log_width: image.width.trailing_zeros(),
            mask: [image.width as u32 - 1, image.height as u32 - 1],
            size: [image.width as f32, image.height as f32],
            colours: rows.flat_map(|row| row.chunks_exact(3).map(colour)).collect(),
        }
    }

    /// Between four texels, in 256ths, two channels at a time.
    #[inline(always)]
    fn sample(&self, uv: TexCoord) -> Color4 {
        let fine = |c: f32, size: f32| (c * size * 256.0) as i32 as u32;
        let (x, y) =
            (fine(uv.x(), self.size[0]).wrapping_sub(128), fine(uv.y(), self.size[1]).wrapping_sub(128));
        let (fx, fy) = (x & 255, y & 255);
        let (x0, y0) = ((x >> 8) & self.mask[0], (y >> 8) & self.mask[1]);
        let (x1, y1) = ((x0 + 1) & self.mask[0], (y0 + 1) & self.mask[1]);
        let at = |x: u32, y: u32| self.colours[((y << self.log_width) + x) as usize];
        let blend = |a: u32, b: u32, share: u32| {
            let red_blue = (a & 0xff_00ff) * (256 - share) + (b & 0xff_00ff) * share;
            let green = (a & 0xff00) * (256 - share) + (b & 0xff00) * share;
            ((red_blue >> 8) & 0xff_00ff) | ((green >> 8) & 0xff00)
        };
        let low = blend(at(x0, y0), at(x1, y0), fx);
        let high = blend(at(x0, y1), at(x1, y1), fx);
        let [r, g, b, _] = blend(low, high, fy).to_le_bytes();
        rgba(r, g, b, 255)
    }
}

/// The triangles of one texture.
struct Batch {
    vertices: Vec<Vertex3<TexCoord>>,
    faces: Vec<Tri<usize>>,
}

pub struct Reference {
    textures: Vec<Texels>,
    batches: Vec<Batch>,
    frame: Framebuf<Colorbuf<Buf2<u32>, Xrgb8888>, Buf2<f32>>,
    context: Context,
    dims: Dims,
}

impl Reference {
    /// `sorted`: nearest triangles of a batch first.
    pub fn new(room: &Room, lens: &Lens, sorted: bool) -> Self {
        let textures: Vec<Texels> = room.textures.iter().map(Texels::new).collect();
        let mut batches: Vec<Batch> =
            textures.iter().map(|_| Batch { vertices: Vec::new(), faces: Vec::new() }).collect();
        for (corners, uv, texture) in room.scene.fixed.triangles() {
            let batch = &mut batches[texture.number()];
            let first = batch.vertices.len();
            batch.vertices.extend(corners.iter().zip(uv).map(|(p, [u, v])| {
                vertex(pt3(p[0] as f32, p[1] as f32, p[2] as f32), vec2(*u as f32, *v as f32))
            }));
            batch.faces.push(tri(first, first + 1, first + 2));
        }
        let dims = Dims(lens.width as u32, lens.height as u32);
        let frame = Framebuf {
            color_buf: Colorbuf { buf: Buf2::new(dims), fmt: Xrgb8888 },
            depth_buf: Buf2::new(dims),
        };
        let depth_sort = sorted.then_some(DepthSort::FrontToBack);
        Self {
            textures,
            batches,
            frame, // Its windings are those of an image with y up.
            context: Context { depth_sort, face_cull: Some(FaceCull::Front), ..Context::default() },
            dims,
        }
    }

    pub fn render(&mut self, lens: &Lens, pose: &Pose) {
        let m = pose.rotation.matrix();
        let column = |i: usize| [m[0][i], m[1][i], m[2][i]];
        let row = |axis: [f64; 3], by: f64| {
            let offset: f64 = axis.iter().zip(pose.position).map(|(a, p)| a * p).sum();
            [axis[0] * by, axis[1] * by, axis[2] * by, -offset * by].map(|c| c as f32)
        };
        let (across, up) = (2.0 * lens.fx / lens.width as f64, 2.0 * lens.fy / lens.height as f64);
        let forward = row(column(0), 1.0);
        // Depth between 0.005 and 1000 m, as in the reference's own matrix.
        let (near, far) = (0.005_f32, 1000.0_f32);
        let mut depth = forward.map(|c| c * (far + near) / (far - near));
        depth[3] += 2.0 * far * near / (near - far);
        let projection: ProjMat3<Model> =
            ProjMat3::new([row(column(1), -across), row(column(2), -up), depth, forward]);
        let viewport = retrofire_core::math::mat::viewport((self.dims).into());
        self.frame.depth_buf.fill(0.0);
        for (texture, batch) in self.textures.iter().zip(&self.batches) {
            let shader = shader::new(
                |v: Vertex3<TexCoord>, projection: &ProjMat3<Model>| {
                    vertex(projection.apply(&v.pos), v.attrib)
                },
                |frag: Frag<TexCoord>, _: &ProjMat3<Model>| texture.sample(frag.var),
            );
            render(
                &batch.faces,
                &batch.vertices,
                &shader,
                &projection,
                viewport,
                &mut self.frame,
                &self.context,
            );
        }
    }

    /// The mean difference to another image, in grey levels: that both show the same.
    pub fn difference(&self, image: &Image) -> f64 {
        let pixels = self.frame.color_buf.buf.data().iter();
        let sum: u64 = pixels
            .zip(image.data.chunks_exact(3))
            .flat_map(|(ours, theirs)| {
                let [_, r, g, b] = ours.to_be_bytes();
                [r.abs_diff(theirs[0]), g.abs_diff(theirs[1]), b.abs_diff(theirs[2])]
            })
            .map(u64::from)
            .sum();
        sum as f64 / image.data.len().max(1) as f64
    }
}
