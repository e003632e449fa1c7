//! Dead reckoning from pulses, with or without a gyroscope.

use super::{Mount, Sensor, View, draw, encoders::pulses, unit};
use crate::sim::{
    geometry::{Vec2, along, sub, turned},
    motion::{Travel, chord},
    noise::{self, Stream},
};
use soifra_graph::Distribution;

/// Registers: pose in `odom` (x y z qx qy qz qw), twist, the time. Starts at the origin. Pulses are read at
/// every capture; between two captures the robot is taken to have moved along an arc.
///
/// Slip and turning errors of the drive are not seen, so the estimate drifts as a real one does. A drive
/// without wheels reckons its own pose, to the pulse.
#[derive(Debug)]
pub struct Odometry {
    pulse: f64,
    period: f64,
    seats: Vec<Reckoning>,
    gyroscope: Option<Gyroscope>,
}

/// Tells the turn in place of the wheels.
#[derive(Debug)]
struct Gyroscope {
    noise: Distribution,
    /// By seat.
    biases: Vec<f64>,
    streams: Vec<Stream>,
    /// True headings at the last capture.
    headings: Vec<Option<f64>>,
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
            gyroscope: None,
        })
    }

    /// From `gyro_odometry(…)`.
    pub fn with_gyroscope(mount: Mount<'_>) -> Result<Odometry, String> {
        let (noise, bias) = (mount.args.distribution("turn_noise")?, mount.args.distribution("turn_bias")?);
        let mut streams = mount.streams([noise, bias].into_iter().any(|d| !noise::is_none(d)));
        let biases = (0..mount.robots.len()).map(|seat| draw(&mut streams, seat, bias)).collect();
        let headings = vec![None; mount.robots.len()];
        let gyroscope = Some(Gyroscope { noise, biases, streams, headings });
        Ok(Odometry { gyroscope, ..Odometry::new(mount)? })
    }
}

impl Sensor for Odometry {
    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let count = |d: f64| pulses(d, self.pulse) * self.pulse;
        let was = self.seats[seat];
        let told = self
            .gyroscope
            .as_mut()
            .map(|g| g.turn(seat, view.bodies[robot].place(view.at.0).heading, self.period));
        let (now, ahead, left) = match view.drives[robot].travel(view.at.0) {
            Travel::Wheels { left, right, base } => {
                let wheels = [count(left), count(right)];
                let way = sub(wheels, was.wheels);
                let (ahead, turn) = (0.5 * (way[0] + way[1]), told.unwrap_or((way[1] - way[0]) / base));
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
        out.push(view.at.seconds());
    }
}

impl Gyroscope {
    /// By how much a robot has turned since the last capture, as far as it can tell.
    fn turn(&mut self, seat: usize, heading: f64, period: f64) -> f64 {
        let was = self.headings[seat].replace(heading).unwrap_or(heading);
        heading - was + (self.biases[seat] + draw(&mut self.streams, seat, self.noise)) * period
    }
}
