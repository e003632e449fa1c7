//! A room drawn exactly: rays through sub-samples of each pixel, procedural textures, Gaussian noise from a seed.
//! World: metres, z up; the camera looks along x at attitude zero.

use soifra_vision::Lens;
use soifra_vision::attitude::Attitude;

/// A surface pattern.
#[derive(Clone, Copy)]
#[allow(dead_code)] // one of the suite's scenes each
pub enum Paint {
    Plain(f64),
    Bricks,
    Checker(f64),
    Stripes(f64),
    Clouds(f64),
    Speckle,
}

#[derive(Clone, Copy)]
pub struct Block {
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub height: f64,
    pub paint: Paint,
}

pub struct Room {
    pub back: f64,
    pub sides: f64,
    pub wall: Paint,
    pub floor: Paint,
    pub blocks: Vec<Block>,
}

#[derive(Clone, Copy)]
pub struct Camera {
    pub at: [f64; 3],
    pub attitude: Attitude,
}

fn hash(x: i64, y: i64, seed: u64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ seed;
    h = (h ^ (h >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn clouds(u: f64, v: f64, seed: u64) -> f64 {
    let (i, j) = (u.floor(), v.floor());
    let (a, b) = (u - i, v - j);
    let (a, b) = (a * a * (3.0 - 2.0 * a), b * b * (3.0 - 2.0 * b));
    let at = |p: i64, q: i64| hash(i as i64 + p, j as i64 + q, seed);
    (at(0, 0) * (1.0 - a) + at(1, 0) * a) * (1.0 - b) + (at(0, 1) * (1.0 - a) + at(1, 1) * a) * b
}

impl Paint {
    fn level(self, u: f64, v: f64, seed: u64) -> f64 {
        match self {
            Paint::Plain(level) => level,
            Paint::Bricks => {
                let row = (v / 0.25).floor();
                let shifted = u + if row as i64 % 2 == 0 { 0.0 } else { 0.3 };
                let column = (shifted / 0.6).floor();
                let mortar = v - row * 0.25 < 0.03 || shifted - column * 0.6 < 0.03;
                if mortar { 190.0 } else { 90.0 + 50.0 * hash(column as i64, row as i64, seed) }
            }
            Paint::Checker(size) => {
                let odd = ((u / size).floor() + (v / size).floor()) as i64 % 2 == 0;
                if odd { 60.0 } else { 170.0 }
            }
            Paint::Stripes(size) => {
                if (u / size).floor() as i64 % 2 == 0 {
                    80.0
                } else {
                    150.0
                }
            }
            Paint::Clouds(size) => {
                let broad = clouds(u / size, v / size, seed);
                60.0 + 90.0 * broad + 60.0 * clouds(4.0 * u / size, 4.0 * v / size, seed ^ 7)
            }
            Paint::Speckle => 70.0 + 110.0 * hash((u / 0.06).floor() as i64, (v / 0.06).floor() as i64, seed),
        }
    }
}

impl Room {
    /// Grey level and surface number along a ray.
    fn shoot(&self, at: [f64; 3], ray: [f64; 3]) -> (f64, u32) {
        let mut best = (f64::INFINITY, 0u32, 0.0, 0.0, Paint::Plain(200.0));
        let mut offer = |t: f64, id: u32, u: f64, v: f64, paint: Paint| {
            if t > 1e-6 && t < best.0 {
                best = (t, id, u, v, paint);
            }
        };
        let on = |t: f64, k: usize| at[k] + t * ray[k];
        if ray[2] < 0.0 {
            let t = -at[2] / ray[2];
            offer(t, 1, on(t, 0), on(t, 1), self.floor);
        }
        if ray[0] > 0.0 {
            let t = (self.back - at[0]) / ray[0];
            offer(t, 2, on(t, 1), on(t, 2), self.wall);
        }
        if ray[1] != 0.0 {
            let t = (self.sides.copysign(ray[1]) - at[1]) / ray[1];
            offer(t, if ray[1] > 0.0 { 3 } else { 4 }, on(t, 0), on(t, 2), self.wall);
        }
        for (k, b) in self.blocks.iter().enumerate() {
            let id = 8 + 4 * k as u32;
            let bounds = [b.x, b.y, [0.0, b.height]];
            let (mut enter, mut leave, mut axis) = (0.0f64, f64::INFINITY, 3);
            for a in 0..3 {
                let (p, q) = ((bounds[a][0] - at[a]) / ray[a], (bounds[a][1] - at[a]) / ray[a]);
                let (near, far) = if p < q { (p, q) } else { (q, p) };
                if near > enter {
                    (enter, axis) = (near, a);
                }
                leave = leave.min(far);
            }
            if enter < leave && axis < 3 {
                let (u, v) = match axis {
                    0 => (on(enter, 1), on(enter, 2)),
                    1 => (on(enter, 0), on(enter, 2)),
                    _ => (on(enter, 0), on(enter, 1)),
                };
                offer(enter, id + axis as u32, u, v, b.paint);
            }
        }
        let (_, id, u, v, paint) = best;
        // Side faces are in the shade.
        let shade = if id >= 8 && id % 4 == 1 { 0.75 } else { 1.0 };
        (paint.level(u, v, u64::from(id)) * shade, id)
    }

    /// A grey frame of `width` x `height`, with noise of standard deviation `sigma` grey levels.
    pub fn frame(
        &self,
        camera: &Camera,
        lens: &Lens,
        width: usize,
        height: usize,
        sigma: f64,
        seed: u64,
    ) -> Vec<u8> {
        let m = camera.attitude.rotation();
        let sample = |x: f64, y: f64| {
            let ray = lens.ray(x, y).unwrap();
            self.shoot(camera.at, m.map(|r| r[0] * ray[0] + r[1] * ray[1] + r[2] * ray[2]))
        };
        let four = [(-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375)];
        let mut levels = vec![0.0; width * height];
        let mut ids = vec![(0u32, false); width * height];
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut id, mut mixed) = (0.0, 0, false);
                for (k, (dx, dy)) in four.iter().enumerate() {
                    let (level, surface) = sample(x as f64 + dx, y as f64 + dy);
                    sum += level;
                    mixed |= k > 0 && surface != id;
                    id = surface;
                }
                levels[y * width + x] = sum / 4.0;
                ids[y * width + x] = (id, mixed);
            }
        }
        // Silhouettes finer: sixteen columns, shifted from row to row of samples.
        for y in 0..height {
            for x in 0..width {
                let at = y * width + x;
                let other = |k: usize| ids[k].0 != ids[at].0 || ids[k].1;
                let edge = ids[at].1 || (x > 0 && other(at - 1)) || (x + 1 < width && other(at + 1));
                if edge {
                    let mut sum = 0.0;
                    for k in 0..64 {
                        let (i, j) = (k % 16, k / 16);
                        let dx = (f64::from(i) + (f64::from(j) + 0.5) / 4.0) / 16.0 - 0.5;
                        sum += sample(x as f64 + dx, y as f64 + (f64::from(j) + 0.5) / 4.0 - 0.5).0;
                    }
                    levels[at] = sum / 64.0;
                }
            }
        }
        let mut noise = Gauss::new(seed);
        levels.iter().map(|l| (l + sigma * noise.next()).round().clamp(0.0, 255.0) as u8).collect()
    }
}

/// Gaussian numbers from a seed (sum of twelve uniforms).
pub struct Gauss {
    state: u64,
}

impl Gauss {
    pub fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x1234_5678_9ABC_DEF1) }
    }

    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut h = self.state;
        h = (h ^ (h >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
