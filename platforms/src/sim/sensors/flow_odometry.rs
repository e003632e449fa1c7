//! Dead reckoning from the speed over the ground.

use super::{Mount, Sensor, View, draw, unit};
use crate::sim::{
    geometry::{Vec2, along, sub, turned},
    motion::chord,
    noise::{self, Stream},
};
use soifra_graph::Distribution;

/// Registers: pose in `odom` (x y z qx qy qz qw), twist, the time. Starts at the origin. Between two captures the
/// speed is what the body covered, along its mean heading, with errors.
#[derive(Debug)]
pub struct FlowOdometry {
    period: f64,
    speed_noise: Distribution,
    turn_noise: Distribution,
    streams: Vec<Stream>,
    seats: Vec<Reckoning>,
}

#[derive(Debug, Clone, Copy)]
struct Reckoning {
    /// Where the body was at the last capture; nowhere before the first.
    was: Option<(Vec2, f64)>,
    at: Vec2,
    heading: f64,
    scale: f64,
    /// Of the gyroscope, rad/s.
    bias: f64,
}

impl FlowOdometry {
    /// From `flow_odometry(…)`.
    pub fn new(mount: Mount<'_>) -> Result<FlowOdometry, String> {
        let args = mount.args;
        let (speed_noise, turn_noise) = (args.distribution("speed_noise")?, args.distribution("turn_noise")?);
        let (scale, bias) = (args.distribution("scale_error")?, args.distribution("turn_bias")?);
        let needed = [speed_noise, turn_noise, scale, bias].into_iter().any(|d| !noise::is_none(d));
        let mut streams = mount.streams(needed);
        let seat = |seat| Reckoning {
            was: None,
            at: [0.0; 2],
            heading: 0.0,
            scale: 1.0 + draw(&mut streams, seat, scale).clamp(-0.9, 0.9),
            bias: draw(&mut streams, seat, bias),
        };
        let seats = (0..mount.robots.len()).map(seat).collect();
        Ok(FlowOdometry { period: args.period("period")?.seconds(), speed_noise, turn_noise, streams, seats })
    }
}

impl Sensor for FlowOdometry {
    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let place = view.bodies[robot].place(view.at.0);
        let mut r = self.seats[seat];
        let (mut way, mut turn) = ([0.0; 2], 0.0);
        if let Some((at, heading)) = r.was {
            let [x, y] = unit(-0.5 * (heading + place.heading));
            way = turned(sub(place.at, at), x, y);
            turn = place.heading - heading;
            for d in &mut way {
                *d = *d * r.scale + draw(&mut self.streams, seat, self.speed_noise) * self.period;
            }
            turn += (r.bias + draw(&mut self.streams, seat, self.turn_noise)) * self.period;
        }
        r.at = along(r.at, chord(r.heading, way[0], way[1], turn, 1.0), 1.0);
        r.heading += turn;
        r.was = Some((place.at, place.heading));
        self.seats[seat] = r;
        let (s, c) = libm::sincos(0.5 * r.heading);
        let per = 1.0 / self.period;
        out.extend_from_slice(&[r.at[0], r.at[1], 0.0, 0.0, 0.0, s, c]);
        out.extend_from_slice(&[way[0] * per, way[1] * per, 0.0, 0.0, 0.0, turn * per]);
        out.push(view.at.seconds());
    }
}
