//! Seeded draws.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use std::f64::consts::TAU;

/// A generator that a number begins.
#[derive(Debug)]
pub struct Draws(ChaCha8Rng);

impl Draws {
    /// The generator of a number: of another number it is another one.
    pub fn new(seed: f64) -> Draws {
        Draws(ChaCha8Rng::seed_from_u64(seed.to_bits()))
    }

    /// Evenly within 0 .. 1, without 1.
    pub fn even(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normally about 0 with a deviation (Box and Muller, 1958).
    pub fn normal(&mut self, deviation: f64) -> f64 {
        let (u, v) = (1.0 - self.even(), self.even());
        deviation * (-2.0 * libm::log(u)).sqrt() * libm::cos(TAU * v)
    }
}
