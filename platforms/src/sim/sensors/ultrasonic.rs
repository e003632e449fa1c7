//! Range by the first echo within a cone.

use super::{
    Mount, Needs, Sensor, View, draw,
    ranging::{Seen, beam, in_sight},
    unit,
};
use crate::sim::{
    geometry::{Vec2, along, turned},
    noise::{self, Stream},
};
use soifra_graph::Distribution;

/// Registers: count, then bearing, tag, range of each beam. Cones begin at the rim of the body; any surface
/// in a cone answers, from its nearest point.
#[derive(Debug)]
pub struct Ultrasonic {
    bearings: Vec<(f64, Vec2)>,
    range: (f64, f64),
    /// Cosine and sine of half the opening angle.
    half: Vec2,
    noise: Distribution,
    /// Over the base of the robot.
    height: f64,
    rim: f64,
    streams: Vec<Stream>,
    seen: Vec<Seen>,
}

impl Ultrasonic {
    /// From `ultrasonic(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Ultrasonic, String> {
        let args = mount.args;
        let (noise, cone) = (args.distribution("noise")?, args.at_least_zero("cone")?);
        if cone > std::f64::consts::PI {
            return Err(args.wrong("`cone` is wider than half a turn"));
        }
        Ok(Ultrasonic {
            bearings: args.numbers("bearings")?.into_iter().map(|b| (b, unit(b))).collect(),
            range: args.reach("range")?,
            half: unit(0.5 * cone),
            noise,
            height: args.at_least_zero("height")?,
            rim: mount.chassis.radius,
            streams: mount.streams(!noise::is_none(noise)),
            seen: Vec::new(),
        })
    }
}

impl Sensor for Ultrasonic {
    fn needs(&self) -> Needs {
        Needs { robots: true, movers: true }
    }

    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let body = &view.bodies[robot];
        let (at, ahead) = (body.place(view.at.0).at, body.direction(view.at));
        let reach = self.rim + self.range.1;
        in_sight(view, robot, at, reach, body.span(view.at.0)[0] + self.height, &mut self.seen);
        out.push(self.bearings.len() as f64);
        for &(bearing, dir) in &self.bearings {
            let dir = turned(dir, ahead[0], ahead[1]);
            let origin = along(at, dir, self.rim);
            let echoes =
                self.seen.iter().filter_map(|s| s.shape.in_cone(origin, dir, self.half[0], self.half[1]));
            let nearest = echoes.reduce(f64::min).filter(|d| *d <= self.range.1);
            let reads = nearest.map(|d| d + draw(&mut self.streams, seat, self.noise));
            beam(out, bearing, reads, self.range);
        }
    }
}
