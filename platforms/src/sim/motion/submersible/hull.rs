//! How water answers to a hull: rigid body and added mass, linear and quadratic drag.
//!
//! The equations of Fossen (Handbook of Marine Craft Hydrodynamics and Motion Control, 2011) for surge, sway, heave
//! and yaw of a hull that is symmetric ahead and aside, and neutrally buoyant. In a steady current without vortices,
//! what counts is the velocity against the water alone, for the added mass too.

/// Velocity against the water, in base_link.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Ahead, left, up (m/s).
    pub velocity: [f64; 3],
    /// About z (rad/s).
    pub turn: f64,
}

/// Masses and drag of a hull, in base_link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// That of the body and the water it drags along: ahead, left, up (kg).
    pub mass: [f64; 3],
    /// About z, that of the water included (kg m²).
    pub inertia: f64,
    /// Ahead, left, up (N for each m/s).
    pub linear: [f64; 3],
    /// Ahead, left, up (N for each (m/s)²).
    pub quadratic: [f64; 3],
    /// About z (N m for each rad/s).
    pub linear_turn: f64,
    /// About z (N m for each (rad/s)²).
    pub quadratic_turn: f64,
}

impl Hull {
    /// The motion after `dt` seconds of a force (ahead, left, up; N) and a torque about z (N m).
    ///
    /// Drag is taken at the new speed, so that no step is too long for it.
    pub fn step(&self, from: Motion, force: [f64; 3], torque: f64, dt: f64) -> Motion {
        let Motion { velocity: [u, v, _], turn: r } = from;
        let [mx, my, _] = self.mass;
        // What the masses ask for because the frame turns, and the moment by which a hull at an angle to its way
        // turns broadside on (Munk).
        let turning = [my * v * r, -mx * u * r, 0.0];
        let munk = (mx - my) * u * v;
        let velocity = std::array::from_fn(|i| {
            let now = from.velocity[i];
            let drag = self.linear[i] + self.quadratic[i] * now.abs();
            (self.mass[i] * now + (force[i] + turning[i]) * dt) / (self.mass[i] + drag * dt)
        });
        let drag = self.linear_turn + self.quadratic_turn * r.abs();
        let turn = (self.inertia * r + (torque + munk) * dt) / (self.inertia + drag * dt);
        Motion { velocity, turn }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.002;

    fn hull() -> Hull {
        Hull {
            mass: [20.0, 30.0, 40.0],
            inertia: 0.6,
            linear: [10.0, 20.0, 30.0],
            quadratic: [100.0, 200.0, 150.0],
            linear_turn: 0.1,
            quadratic_turn: 1.5,
        }
    }

    fn after(hull: &Hull, mut m: Motion, force: [f64; 3], torque: f64, seconds: f64) -> Motion {
        for _ in 0..(seconds / DT) as usize {
            m = hull.step(m, force, torque, DT);
        }
        m
    }

    /// The speed at which 10 v + 100 v² is 20 N.
    #[test]
    fn the_terminal_velocity_is_where_drag_equals_thrust() {
        let m = after(&hull(), Motion::default(), [20.0, 0.0, 0.0], 0.0, 60.0);
        let expected = (-10.0 + libm::sqrt(100.0 + 8000.0)) / 200.0;
        assert!((m.velocity[0] - expected).abs() < 1e-9, "{m:?} {expected}");
    }

    #[test]
    fn without_drag_and_force_the_momentum_in_the_water_stays() {
        let free =
            Hull { linear: [0.0; 3], quadratic: [0.0; 3], linear_turn: 0.0, quadratic_turn: 0.0, ..hull() };
        let from = Motion { velocity: [0.4, 0.1, 0.2], turn: 0.3 };
        let energy = |m: Motion| {
            let way: f64 = (0..3).map(|i| free.mass[i] * m.velocity[i] * m.velocity[i]).sum();
            0.5 * (way + free.inertia * m.turn * m.turn)
        };
        let to = after(&free, from, [0.0; 3], 0.0, 2.0);
        assert!((energy(to) / energy(from) - 1.0).abs() < 0.01, "{} {}", energy(to), energy(from));
        assert!((to.velocity[2] - 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_hull_that_slips_turns_broadside_on() {
        // More water is dragged along aside than ahead, so a slip to the left of a way ahead turns it to the right.
        let m = hull().step(Motion { velocity: [0.5, 0.1, 0.0], turn: 0.0 }, [0.0; 3], 0.0, DT);
        assert!(m.turn < 0.0, "{m:?}");
    }

    #[test]
    fn no_speed_is_too_high_for_a_step() {
        let m = after(&hull(), Motion { velocity: [20.0, -20.0, 20.0], turn: 0.0 }, [0.0; 3], 0.0, 60.0);
        assert!(m.velocity.iter().chain([&m.turn]).all(|x| x.abs() < 0.05), "{m:?}");
    }
}
