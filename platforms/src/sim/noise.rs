//! Seeded noise: one stream of random numbers for each source.
//!
//! A source (`scout/ir`, `mover/block[1]`) has a stream of its own, so that adding a sensor or a robot
//! leaves the numbers of all others as they were.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use soifra_graph::Distribution;

/// The stream of one source. About 330 bytes.
#[derive(Debug, Clone)]
pub struct Stream(ChaCha8Rng);

/// FNV-1a, 64 bits (Fowler, Noll and Vo): the same on every machine and in every version.
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// A number for a source in the run with this seed, for noise that is no stream.
pub fn source(seed: u64, source: &str) -> u64 {
    fnv1a(source).rotate_left(17) ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

impl Stream {
    /// The stream of `source` in the run with this seed.
    pub fn new(seed: u64, source: &str) -> Stream {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&fnv1a(source).to_le_bytes());
        key[16..].copy_from_slice(b"soifra/platforms");
        Stream(ChaCha8Rng::from_seed(key))
    }

    /// Uniform in [0, 1), 53 bits.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Standard normal, by Box and Muller's transform of two uniform numbers.
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        libm::sqrt(-2.0 * libm::log(u)) * libm::cos(std::f64::consts::TAU * v)
    }

    /// A draw from a distribution, in the unit of its parameters.
    ///
    /// `Skewed(best, mean, worst)` is a beta distribution with α = 1 scaled to `[best, worst]`: its density is
    /// greatest at the best case and its mean is the given one.
    pub fn draw(&mut self, from: Distribution) -> f64 {
        match from {
            Distribution::Exact(x) => x,
            Distribution::Normal(mean, sd) => mean + sd * self.normal(),
            Distribution::Uniform(low, high) => low + (high - low) * self.uniform(),
            Distribution::Skewed(best, mean, worst) => {
                let share = (mean - best) / (worst - best);
                if !(share > 0.0 && share < 1.0) {
                    return mean;
                }
                // Mean of Beta(1, β) is 1 / (1 + β); its inverse cumulative is 1 - (1 - u)^(1 / β).
                let beta = 1.0 / share - 1.0;
                best + (worst - best) * (1.0 - libm::pow(1.0 - self.uniform(), 1.0 / beta))
            }
        }
    }

    /// A relative error as a factor: 1 + a draw, kept within 0 and 2 so that nothing runs backwards.
    pub fn factor(&mut self, error: Distribution) -> f64 {
        1.0 + self.draw(error).clamp(-1.0, 1.0)
    }
}

/// Whether every draw is zero, so that no stream is needed.
pub fn is_none(d: Distribution) -> bool {
    match d {
        Distribution::Exact(x) => x == 0.0,
        Distribution::Normal(mean, sd) => mean == 0.0 && sd == 0.0,
        Distribution::Uniform(low, high) => low == 0.0 && high == 0.0,
        Distribution::Skewed(..) => false,
    }
}
