//! What holds a submersible at its commanded velocity over the ground: for each axis (ahead, left, up, turn) a
//! controller with a sum of what is left, and thrusters that give no more than they can, and not at once.

use crate::sim::body::seconds;
use crate::sim::motion::SUBSTEP;

/// Ahead, left, up (N) and about z (N m); or velocities along the same axes.
pub type Axes = [f64; 4];

/// What the autopilot knows of its hull, by axis, and what the thrusters can do.
#[derive(Debug, Clone, Copy)]
pub struct Autopilot {
    /// Masses and inertia, that of the water included.
    inertia: Axes,
    /// Time constants of the commanded speeds (s).
    lag: Axes,
    /// The most that the thrusters give.
    most: Axes,
    /// Time constant of the thrusters (s).
    thruster_lag: f64,
    /// What has gone of a difference of thrust after one substep.
    substep: f64,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Thrust {
    /// Force and torque at this instant.
    pub given: Axes,
    /// How far it has fallen behind the commanded velocity, along each axis: what the current and drag take.
    behind: Axes,
}

impl Autopilot {
    /// With masses and inertia, time constants (s) and limits by axis, and the time constant of the thrusters (s).
    pub fn new(inertia: Axes, lag: Axes, most: Axes, thruster_lag: f64) -> Autopilot {
        Autopilot { inertia, lag, most, thruster_lag, substep: gone(seconds(0, SUBSTEP), thruster_lag) }
    }

    /// Thrust after `dt` seconds, with `wanted` velocities over the ground that are `now`. Without power there is
    /// none.
    ///
    /// The demand is m (w - 2 v) / τ + m ∫(w - v) / τ²: without drag and lag of the thrusters the speed follows with
    /// a first-order lag of τ, and a steady current and drag leave no error.
    pub fn step(&self, from: Thrust, wanted: Axes, now: Axes, powered: bool, dt: f64) -> Thrust {
        let gone = if dt == seconds(0, SUBSTEP) { self.substep } else { gone(dt, self.thruster_lag) };
        let follow = |to: Axes| std::array::from_fn(|i| from.given[i] + (to[i] - from.given[i]) * gone);
        if !powered {
            return Thrust { given: follow([0.0; 4]), behind: [0.0; 4] };
        }
        let demand: Axes = std::array::from_fn(|i| {
            let rate = 1.0 / self.lag[i];
            self.inertia[i] * rate * (wanted[i] - 2.0 * now[i] + rate * from.behind[i])
        });
        let limited = self.limited(demand);
        let behind = std::array::from_fn(|i| {
            let error = wanted[i] - now[i];
            // What cannot be given does not pile up.
            let piling = limited[i] != demand[i] && error * demand[i] > 0.0;
            if piling { from.behind[i] } else { from.behind[i] + error * dt }
        });
        Thrust { given: follow(limited), behind }
    }

    /// The demand as far as the thrusters can meet it. Ahead, left and turn are given by the same ones: the shares of
    /// what each would take alone add up, and where that is more than there is, all three get less in proportion.
    fn limited(&self, demand: Axes) -> Axes {
        let share = |i: usize| (demand[i] / self.most[i]).abs();
        let level = 1.0 / (share(0) + share(1) + share(3)).max(1.0);
        let up = 1.0 / share(2).max(1.0);
        std::array::from_fn(|i| demand[i] * if i == 2 { up } else { level })
    }
}

/// 1 - e^(-dt / tau), without cancellation; all of it without a lag.
fn gone(dt: f64, tau: f64) -> f64 {
    if tau == 0.0 { 1.0 } else { -libm::expm1(-dt / tau) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.002;

    fn autopilot(thruster_lag: f64) -> Autopilot {
        Autopilot::new([20.0, 20.0, 30.0, 0.5], [0.5, 0.5, 0.5, 0.3], [80.0, 80.0, 120.0, 20.0], thruster_lag)
    }

    #[test]
    fn thrust_is_limited_and_shared() {
        let a = autopilot(0.0);
        let full = a.step(Thrust::default(), [9.0, 0.0, 9.0, 0.0], [0.0; 4], true, DT);
        assert_eq!(full.given, [80.0, 0.0, 120.0, 0.0]);
        let both = a.step(Thrust::default(), [9.0, 9.0, 0.0, 0.0], [0.0; 4], true, DT).given;
        assert!((both[0] - 40.0).abs() < 1e-9 && (both[1] - 40.0).abs() < 1e-9, "{both:?}");
    }

    #[test]
    fn what_cannot_be_given_does_not_pile_up() {
        let a = autopilot(0.0);
        let mut t = Thrust::default();
        for _ in 0..5000 {
            t = a.step(t, [9.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], true, DT);
        }
        assert_eq!(t.behind, [0.0; 4]);
        // So that it goes back at once.
        let back = a.step(t, [0.0; 4], [1.0, 0.0, 0.0, 0.0], true, DT).given[0];
        assert!(back < 0.0, "{back}");
    }

    #[test]
    fn thrust_follows_with_a_lag_and_fades_without_power() {
        let a = autopilot(0.1);
        let mut t = Thrust::default();
        for _ in 0..50 {
            t = a.step(t, [9.0, 0.0, 0.0, 0.0], [0.0; 4], true, DT);
        }
        let after_a_time_constant = 80.0 * (1.0 - libm::exp(-1.0));
        assert!((t.given[0] - after_a_time_constant).abs() < 1e-9, "{t:?}");
        for _ in 0..5000 {
            t = a.step(t, [9.0, 0.0, 0.0, 0.0], [0.0; 4], false, DT);
        }
        assert!(t.given[0].abs() < 1e-12, "{t:?}");
    }

    /// Free of drag and lag, the speed has come to 1 - 1/e of the commanded one after the time constant.
    #[test]
    fn the_speed_follows_with_the_time_constant() {
        let a = autopilot(0.0);
        let (mut t, mut v) = (Thrust::default(), 0.0);
        for _ in 0..250 {
            t = a.step(t, [0.5, 0.0, 0.0, 0.0], [v, 0.0, 0.0, 0.0], true, DT);
            v += t.given[0] / 20.0 * DT;
        }
        assert!((v - 0.5 * (1.0 - libm::exp(-1.0))).abs() < 2e-3, "{v}");
    }
}
