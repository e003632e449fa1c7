//! A speed that follows its target.

use super::SUBSTEP;
use crate::sim::body::seconds;

/// First-order lag with a limit on the acceleration: v' = clamp((target - v) / tau, ±limit). In closed
/// form, so that the result does not depend on how a span of time is cut up (but for rounding).
#[derive(Debug, Clone, Copy)]
pub struct Lag {
    /// Time constant in seconds; 0 follows at the limit.
    pub tau: f64,
    /// Greatest acceleration; infinite for none.
    limit: f64,
    /// What has gone of a difference after one substep.
    substep: f64,
}

/// Nearer than this (m/s or rad/s) the target counts as reached.
const REACHED: f64 = 1e-9;

impl Lag {
    /// With a time constant and a limit.
    pub fn new(tau: f64, limit: f64) -> Lag {
        Lag { tau, limit, substep: gone(seconds(0, SUBSTEP), tau) }
    }

    /// The speed after `dt` seconds, and the distance covered.
    pub fn follow(&self, v: f64, target: f64, dt: f64) -> (f64, f64) {
        let error = target - v;
        if error.abs() < REACHED {
            return (target, target * dt);
        }
        if self.limit.is_infinite() {
            return self.decay(v, target, dt);
        }
        // First at the limit, until the lag alone asks for less.
        let ramp = ((error.abs() - self.limit * self.tau) / self.limit).clamp(0.0, dt);
        let a = self.limit * error.signum();
        let (v1, d1) = (v + a * ramp, (v + 0.5 * a * ramp) * ramp);
        if ramp >= dt {
            return (v1, d1);
        }
        let (v2, d2) = self.decay(v1, target, dt - ramp);
        (v2, d1 + d2)
    }

    fn decay(&self, v: f64, target: f64, dt: f64) -> (f64, f64) {
        if self.tau == 0.0 {
            return (target, target * dt);
        }
        let gone = if dt == seconds(0, SUBSTEP) { self.substep } else { gone(dt, self.tau) };
        (v + (target - v) * gone, target * dt + (v - target) * self.tau * gone)
    }
}

/// 1 - e^(-dt / tau), without cancellation.
fn gone(dt: f64, tau: f64) -> f64 {
    -libm::expm1(-dt / tau)
}
