//! Range by reflected infrared light.
//!
//! The light that comes back from a surface of reflectance ρ at distance d is as ρ / d². The sensor takes
//! every surface to be of [`REFLECTANCE`], so it reads d · sqrt(REFLECTANCE / ρ): a dark surface seems
//! farther than it is, and is seen only from nearer by; a shiny one seems nearer. The angle at which the
//! light falls on the surface is left out.

use super::{
    Mount, Needs, Sensor, View, draw,
    ranging::{Seen, beam, in_sight},
    unit,
};
use crate::sim::{
    geometry::{Vec2, along, turned},
    noise::{self, Stream},
    scene::REFLECTANCE,
};
use soifra_graph::Distribution;

/// Registers: count, then bearing, tag, range of each beam. Beams begin at the rim of the body.
#[derive(Debug)]
pub struct Infrared {
    bearings: Vec<(f64, Vec2)>,
    range: (f64, f64),
    noise: Distribution,
    false_alarm: f64,
    /// Over the base of the robot.
    height: f64,
    rim: f64,
    streams: Vec<Stream>,
    seen: Vec<Seen>,
}

impl Infrared {
    /// From `infrared(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Infrared, String> {
        let args = mount.args;
        let (noise, false_alarm) = (args.distribution("noise")?, args.chance("false_alarm")?);
        Ok(Infrared {
            bearings: args.numbers("bearings")?.into_iter().map(|b| (b, unit(b))).collect(),
            range: args.reach("range")?,
            noise,
            false_alarm,
            height: args.at_least_zero("height")?,
            rim: mount.chassis.radius,
            streams: mount.streams(!noise::is_none(noise) || false_alarm > 0.0),
            seen: Vec::new(),
        })
    }

    /// What a beam reads without noise.
    fn measure(&self, origin: Vec2, dir: Vec2) -> Option<f64> {
        let mut nearest = (f64::INFINITY, REFLECTANCE);
        for s in &self.seen {
            if let Some(d) = s.shape.ray(origin, dir)
                && d < nearest.0
            {
                nearest = (d, s.reflectance);
            }
        }
        let reads = nearest.0 * (REFLECTANCE / nearest.1).sqrt();
        (reads <= self.range.1).then_some(reads)
    }

    /// What a beam reads with nothing in range: now and then something.
    fn imagine(&mut self, seat: usize) -> Option<f64> {
        let stream = self.streams.get_mut(seat).filter(|_| self.false_alarm > 0.0)?;
        let alarm = stream.uniform() < self.false_alarm;
        alarm.then(|| stream.draw(Distribution::Uniform(self.range.0, self.range.1)))
    }
}

impl Sensor for Infrared {
    fn needs(&self) -> Needs {
        Needs { robots: true, movers: true }
    }

    fn capture(&mut self, seat: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let body = &view.bodies[robot];
        let (at, ahead) = (body.place(view.at.0).at, body.direction(view.at));
        // A shiny surface is seen from a little farther than the range.
        let reach = self.rim + self.range.1 / REFLECTANCE.sqrt();
        let mut seen = std::mem::take(&mut self.seen);
        in_sight(view, robot, at, reach, body.span(view.at.0)[0] + self.height, &mut seen);
        self.seen = seen;
        out.push(self.bearings.len() as f64);
        for i in 0..self.bearings.len() {
            let (bearing, dir) = self.bearings[i];
            let dir = turned(dir, ahead[0], ahead[1]);
            let reads = match self.measure(along(at, dir, self.rim), dir) {
                Some(r) => Some(r * (1.0 + draw(&mut self.streams, seat, self.noise))),
                None => self.imagine(seat),
            };
            beam(out, bearing, reads, self.range);
        }
    }
}
