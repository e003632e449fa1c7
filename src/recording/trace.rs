//! A recorded trace as a recording: its readings as they were, its images taken again.

use super::{Everywhere, Shots, Trouble, Wanted, Written};
use crate::trace_file::{Reader, Trace};
use soifra_platforms::recording::{Footage, Picture, Stamp};
use soifra_runtime::{
    Event, Scene, Time,
    objects::{Cameras, Retake},
    scene::{PlatformScene, RobotScene},
};
use std::{collections::BTreeMap, sync::Arc};

const ANOTHER: &str =
    "record another run, or choose a platform whose sensors are those of the recorded robot";

/// A trace in memory, without what nobody asks for.
#[derive(Debug)]
pub struct Taped {
    trace: Trace,
    /// How many traces this one is a recording of, one of the other.
    depth: u32,
}

/// An image of a trace.
#[derive(Debug)]
struct Taken {
    captured: Time,
    view: Vec<f64>,
    digest: String,
}

/// All images of one camera of a trace.
#[derive(Debug)]
struct Film {
    scene: Scene,
    robot: u32,
    sensor: u32,
    taken: Vec<Taken>,
    depth: u32,
}

/// A film being shown.
struct Shown {
    film: Arc<Film>,
    again: Box<dyn Retake>,
}

impl Taped {
    /// Reads a trace.
    pub fn open(path: &str, depth: u32) -> Result<Taped, Trouble> {
        let hint = "name a trace that `soifra run` wrote";
        let wrong = |e: crate::trace_file::TraceError| Trouble::not_read(e.to_string(), hint);
        let mut trace = Reader::open(path).and_then(Reader::into_trace).map_err(wrong)?;
        trace
            .records
            .retain(|r| matches!(r.event, Event::Reading { .. } | Event::Image { .. } | Event::End { .. }));
        Ok(Taped { trace, depth })
    }

    /// When it ends.
    pub fn end(&self) -> Time {
        self.trace.last_time()
    }

    /// What was recorded of the sensor that is wanted: of the robot of that name, else of the only robot there was.
    pub fn written(&self, wanted: &Wanted<'_>) -> Result<Written, Trouble> {
        let scene = &self.trace.header.scene;
        let (robot, sensor) = self.find(wanted)?;
        let mut stamps = Vec::new();
        let (mut registers, mut taken) = (Vec::new(), Vec::new());
        let mut width = 0;
        for record in &self.trace.records {
            match &record.event {
                Event::Reading { robot: r, sensor: s, captured, registers: values }
                    if (*r, *s) == (robot, sensor) =>
                {
                    width = values.len();
                    registers.extend_from_slice(values);
                    stamps.push(Stamp { captured: *captured, delivered: record.t });
                }
                Event::Image { robot: r, sensor: s, captured, view, digest, .. }
                    if (*r, *s) == (robot, sensor) =>
                {
                    taken.push(Taken { captured: *captured, view: view.clone(), digest: digest.clone() });
                    stamps.push(Stamp { captured: *captured, delivered: record.t });
                }
                _ => {}
            }
        }
        if stamps.is_empty() {
            let seen = format!(
                "nobody read `{}` in the recorded run, so nothing is recorded of it",
                wanted.sensor()
            );
            return Err(Trouble::not_named(seen, ANOTHER));
        }
        if taken.is_empty() {
            return Ok(Written::Numbers { stamps, width, registers: registers.into() });
        }
        let film = Film { scene: scene.clone(), robot, sensor, taken, depth: self.depth };
        Ok(Written::Images { stamps, shots: Arc::new(Arc::new(film)) })
    }

    fn find(&self, wanted: &Wanted<'_>) -> Result<(u32, u32), Trouble> {
        let scene = &self.trace.header.scene;
        let bodies = scene.bodies();
        let robot = match bodies {
            [_] => Some(0),
            _ => bodies.iter().position(|r| r.name == wanted.robot),
        };
        let Some(robot) = robot else {
            let names: Vec<&str> = bodies.iter().map(|r| r.name.as_str()).collect();
            let seen = format!(
                "no robot in the recorded run is called `{}`; there were {}",
                wanted.robot,
                names.join(", ")
            );
            return Err(Trouble::not_named(seen, "give the robot of the mission the name of one of them"));
        };
        let platform = bodies.get(robot).and_then(|r: &RobotScene| scene.platforms.get(r.platform as usize));
        let sensors = |p: &PlatformScene| {
            p.of_role("sensor").map(|s| (s.name.clone(), s.ty.clone())).collect::<BTreeMap<_, _>>()
        };
        let place = platform.and_then(|p| p.of_role("sensor").position(|s| s.name == wanted.part.name));
        let Some(sensor) = place else {
            let names: Vec<String> = platform.map(sensors).unwrap_or_default().into_keys().collect();
            let seen = format!(
                "the recorded robot had no sensor `{}`; it had {}",
                wanted.sensor(),
                names.join(", ")
            );
            return Err(Trouble::not_named(seen, ANOTHER));
        };
        let ty = platform.and_then(|p| p.of_role("sensor").nth(sensor)).and_then(|s| s.ty.clone());
        if ty != wanted.part.ty {
            let shown =
                |t: &Option<soifra_graph::Type>| t.as_ref().map_or("nothing".into(), ToString::to_string);
            let seen = format!(
                "`{}` gave {} in the recorded run, and {} is wanted",
                wanted.sensor(),
                shown(&ty),
                shown(&wanted.part.ty)
            );
            return Err(Trouble::not_named(seen, ANOTHER));
        }
        Ok((robot as u32, sensor as u32))
    }
}

impl Shots for Arc<Film> {
    fn show(&self) -> Result<Box<dyn Footage>, Trouble> {
        let again = Everywhere { depth: self.depth }.of(&self.scene);
        let again = again.ok_or_else(|| Trouble::not_read("its images cannot be taken again", ANOTHER))?;
        Ok(Box::new(Shown { film: Arc::clone(self), again }))
    }
}

impl Footage for Shown {
    fn image(&mut self, number: usize) -> Result<Picture, String> {
        let taken = self.film.taken.get(number).ok_or("there is no such image")?;
        let frame = self.again.retake(self.film.robot, self.film.sensor, taken.captured, &taken.view);
        let frame = frame.ok_or("it cannot be taken again")?;
        if format!("{:016x}", frame.digest) != taken.digest {
            return Err("taken again, it is another one: the trace is of another version of soifra".into());
        }
        let (width, height, optics) = (frame.width, frame.height, frame.optics);
        let data = match Arc::try_unwrap(frame) {
            Ok(frame) => frame.data,
            Err(shared) => shared.data.clone(),
        };
        Ok(Picture { width, height, data, optics })
    }
}
