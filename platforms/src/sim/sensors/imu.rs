//! Inertial measurement: how the body is tilted, and how fast it turns.

use super::{Mount, Sensor, View, draw};
use crate::sim::noise::{self, Stream};
use soifra_graph::Distribution;

/// Registers: roll, pitch, the rates about x, y and z of base_link, the time.
#[derive(Debug)]
pub struct Imu {
    rate_noise: Distribution,
    tilt_noise: Distribution,
    /// By seat.
    biases: Vec<[f64; 3]>,
    streams: Vec<Stream>,
}

impl Imu {
    /// From `imu(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Imu, String> {
        let args = mount.args;
        let (rate_noise, tilt_noise) = (args.distribution("rate_noise")?, args.distribution("tilt_noise")?);
        let bias = args.distribution("rate_bias")?;
        let needed = [rate_noise, tilt_noise, bias].into_iter().any(|d| !noise::is_none(d));
        let mut streams = mount.streams(needed);
        let biases = (0..mount.robots.len()).map(|seat| [0; 3].map(|_| draw(&mut streams, seat, bias)));
        Ok(Imu { rate_noise, tilt_noise, biases: biases.collect(), streams })
    }
}

impl Sensor for Imu {
    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let body = &view.bodies[robot];
        let (a, (_, turn)) = (body.attitude(view.at.0), body.motion(view.at.0));
        let ((sr, cr), (sp, cp)) = (libm::sincos(a.roll), libm::sincos(a.pitch));
        // Rates of the angles as rates about the axes of the body.
        let rates =
            [a.rates[0] - turn * sp, a.rates[1] * cr + turn * cp * sr, turn * cp * cr - a.rates[1] * sr];
        for tilt in [a.roll, a.pitch] {
            out.push(tilt + draw(&mut self.streams, seat, self.tilt_noise));
        }
        for (rate, bias) in rates.into_iter().zip(self.biases[seat]) {
            out.push(rate + bias + draw(&mut self.streams, seat, self.rate_noise));
        }
        out.push(view.at.seconds());
    }
}
