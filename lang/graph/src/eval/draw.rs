//! Draws from distributions. Everybody who draws does it here, with a generator of his own.

use crate::Distribution;

/// A draw from `from`; `next` gives 64 uniformly distributed bits.
///
/// Exact values take no bits, uniform and skewed ones one word, normal ones two, so that what a draw
/// costs depends on the kind of the distribution only.
///
/// - uniform: `low + (high - low) u` with `u` in \[0, 1).
/// - normal: Box and Muller, A Note on the Generation of Random Normal Deviates (1958), equation (1),
///   first of the pair.
/// - skewed: `best + (worst - best) B` where `B` is Beta(1, b)-distributed with `b = 1/m - 1` and
///   `m = (mean - best) / (worst - best)`; its mean is `m`, its density is highest at 0 for `m < 1/2`, and
///   its distribution function `1 - (1 - x)^b` is inverted in closed form.
pub fn sample(from: Distribution, next: &mut impl FnMut() -> u64) -> f64 {
    match from {
        Distribution::Exact(value) => value,
        Distribution::Uniform(low, high) => low + (high - low) * unit(next()),
        Distribution::Normal(mean, deviation) => {
            let (u, v) = (1.0 - unit(next()), unit(next()));
            let radius = (-2.0 * libm::log(u)).sqrt();
            mean + deviation * radius * libm::cos(std::f64::consts::TAU * v)
        }
        Distribution::Skewed(best, mean, worst) => {
            let u = unit(next());
            let m = (mean - best) / (worst - best);
            if m.is_nan() || m <= 0.0 {
                return best;
            }
            if m >= 1.0 {
                return worst;
            }
            best + (worst - best) * (1.0 - libm::pow(1.0 - u, m / (1.0 - m)))
        }
    }
}

/// 53 bits as a number in \[0, 1).
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}
