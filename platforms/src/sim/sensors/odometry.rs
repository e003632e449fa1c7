//! Dead reckoning from pulses.

use super::{Mount, Sensor, View, encoders::pulses, unit};
use crate::sim::{
    geometry::{Vec2, along, sub, turned},
    motion::{Travel, chord},
};

/// Registers: pose in `odom` (x y z qx qy qz qw), then twist. Starts at the origin. Pulses are read at
/// every capture; between two captures the robot is taken to have moved along an arc.
///
/// Slip and turning errors of the drive are not seen, so the estimate drifts as a real one does. A drive
/// without wheels reckons its own pose, to the pulse.
#[derive(Debug)]
pub struct Odometry {
    pulse: f64,
    period: f64,
    seats: Vec<Reckoning>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Reckoning {
    /// Distance of the left and right wheel at the last capture.
    wheels: Vec2,
    at: Vec2,
    heading: f64,
}

impl Odometry {
    /// From `odometry(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Odometry, String> {
        let (pulse, period) = (mount.args.positive("pulse")?, mount.args.period("period")?);
        Ok(Odometry {
            pulse,
            period: period.seconds(),
            seats: vec![Reckoning::default(); mount.robots.len()],
        })
    }
}

impl Sensor for Odometry {
    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let count = |d: f64| pulses(d, self.pulse) * self.pulse;
        let was = self.seats[seat];
        let (now, ahead, left) = match view.drives[robot].travel(view.at.0) {
            Travel::Wheels { left, right, base } => {
                let wheels = [count(left), count(right)];
                let way = sub(wheels, was.wheels);
                let (ahead, turn) = (0.5 * (way[0] + way[1]), (way[1] - way[0]) / base);
                let at = along(was.at, chord(was.heading, ahead, 0.0, turn, 1.0), 1.0);
                (Reckoning { wheels, at, heading: was.heading + turn }, ahead, 0.0)
            }
            Travel::Pose { at, heading } => {
                let at = at.map(count);
                let [x, y] = unit(-0.5 * (was.heading + heading));
                let [ahead, left] = turned(sub(at, was.at), x, y);
                (Reckoning { at, heading, ..was }, ahead, left)
            }
        };
        self.seats[seat] = now;
        let (s, c) = libm::sincos(0.5 * now.heading);
        let per = 1.0 / self.period;
        out.extend_from_slice(&[now.at[0], now.at[1], 0.0, 0.0, 0.0, s, c]);
        out.extend_from_slice(&[ahead * per, left * per, 0.0, 0.0, 0.0, (now.heading - was.heading) * per]);
    }
}
