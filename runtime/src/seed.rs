//! Seeded randomness: one ChaCha8 stream for each source, by name, and a counter-based hash for
//! questions that are too many to keep a generator for.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use soifra_graph::{Distribution, eval};

/// The number of the stream called `name`: FNV-1a, 64 bits. It depends on nothing but the name, so a
/// source draws the same whatever else a mission declares.
pub fn stream_id(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// A generator at a position of a stream. What has to be kept between draws is the position alone.
#[derive(Debug, Clone)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of the source called `name`, at its beginning.
    pub fn new(seed: u64, name: &str) -> Self {
        Stream::at(seed, stream_id(name), 0)
    }

    /// Stream `id`, `position` words in.
    pub fn at(seed: u64, id: u64, position: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(id);
        rng.set_word_pos(u128::from(position));
        Stream(rng)
    }

    /// Words taken so far.
    pub fn position(&self) -> u64 {
        self.0.get_word_pos() as u64
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A draw.
    pub fn draw(&mut self, from: Distribution) -> f64 {
        eval::sample(from, &mut || self.0.next_u64())
    }
}

/// A number in \[0, 1) that depends on the five numbers alone: whether message `number` of a sender is
/// lost for a receiver is known without keeping anything for the pair.
/// Mixing steps: Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators (2014), mix64.
pub fn chance(seed: u64, topic: u64, sender: u64, receiver: u64, number: u64) -> f64 {
    let bits =
        [topic, sender, receiver, number].into_iter().fold(mix(seed), |h, x| mix(h ^ mix(x.wrapping_add(h))));
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_continues_where_it_was_left() {
        let mut whole = Stream::new(7, "robot/a");
        let mut part = Stream::new(7, "robot/a");
        let d = Distribution::Normal(0.0, 1.0);
        let first: Vec<f64> = (0..20).map(|_| whole.draw(d)).collect();
        for x in first {
            assert_eq!(part.draw(d), x);
            part = Stream::at(7, stream_id("robot/a"), part.position());
        }
        assert_ne!(Stream::new(7, "robot/a").bits(), Stream::new(7, "robot/b").bits());
        assert_ne!(Stream::new(7, "robot/a").bits(), Stream::new(8, "robot/a").bits());
    }

    #[test]
    fn chances_are_spread_evenly() {
        let n = 40_000;
        let lost = (0..n).filter(|i| chance(1, 2, i % 10, i / 10 % 10, i / 100) < 0.3).count();
        assert!((lost as f64 / n as f64 - 0.3).abs() < 0.01, "{lost} of {n}");
    }
}
