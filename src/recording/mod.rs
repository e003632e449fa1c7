//! Recordings: what robots read whose platforms are recordings, opened from files.
//!
//! A platform is a recording when its drive is `recorded(file, rate)`. Every sensor that somebody reads gets a track:
//! images out of a folder or pattern of files (`pictures.rs`) or out of a video (`y4m.rs`), all readings out of a trace
//! (`trace.rs`). All that can be wrong is told before a run starts, as `trouble.rs` words it. An image has a number in
//! its recording, by which a replay and a contact sheet have it again (`again.rs`).

mod again;
mod files;
mod name;
mod pictures;
mod trace;
mod trouble;
mod y4m;

pub use again::Everywhere;
pub use name::name;
pub use pictures::{Decoded, decode, read};
pub use trouble::Trouble;
pub use y4m::Y4m;

use crate::report::Refusal;
use files::Files;
use soifra_graph::Value;
use soifra_platforms::recording::{DRIVE, Footage, Recording, Stamp, Track, What};
use soifra_runtime::{
    Scene, Time,
    scene::{Part, PlatformScene},
};
use std::{fmt::Debug, sync::Arc};
use trace::Taped;

/// Recordings of recordings are followed so deep.
const DEEPEST: u32 = 8;

/// A sensor whose recording is wanted.
struct Wanted<'a> {
    /// Name of its robot.
    robot: &'a str,
    platform: &'a PlatformScene,
    part: &'a Part,
}

impl Wanted<'_> {
    fn sensor(&self) -> &str {
        &self.part.name
    }
}

/// What is written of a sensor.
#[derive(Debug, Clone)]
enum Written {
    Numbers { stamps: Vec<Stamp>, width: usize, registers: Arc<[f64]> },
    Images { stamps: Vec<Stamp>, shots: Arc<dyn Shots> },
}

/// Images that can be shown any number of times.
trait Shots: Debug + Send + Sync {
    /// From the first on.
    fn show(&self) -> Result<Box<dyn Footage>, Trouble>;
}

/// All recordings of a scene, opened.
#[derive(Debug)]
pub struct Opened {
    /// Where they lie, by robot.
    paths: Vec<String>,
    /// Robot, sensor, and what is written of it.
    written: Vec<(u32, u32, Written)>,
    end: Time,
}

/// Whether an image is looked at before it is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Care {
    Before,
    WhenWanted,
}

/// Opens the recordings of a scene; none when its robots are simulated.
pub fn open(scene: &Scene) -> Result<Option<Opened>, Refusal> {
    open_at(scene, Care::Before, 0).map_err(|(path, trouble)| trouble.refusal(&path))
}

fn open_at(scene: &Scene, care: Care, depth: u32) -> Result<Option<Opened>, (String, Trouble)> {
    let drive = |platform: u32| {
        let platform = scene.platforms.get(platform as usize)?;
        Some((platform, platform.of_role("drive").next().filter(|d| &*d.model == DRIVE)?))
    };
    let recorded = scene.bodies().iter().filter(|r| drive(r.platform).is_some()).count();
    if recorded == 0 {
        return Ok(None);
    }
    if recorded < scene.bodies().len() {
        let simulated = scene.bodies().iter().find(|r| drive(r.platform).is_none());
        let name = simulated.map_or("", |r| r.name.as_str());
        let seen = format!("`{name}` is simulated beside robots that are recorded");
        let hint = "a simulated robot cannot meet what was recorded: record all of them, or none";
        return Err((name.to_string(), Trouble::not_named(seen, hint)));
    }
    if depth > DEEPEST {
        let seen = format!("recordings of recordings, more than {DEEPEST} deep");
        return Err((String::new(), Trouble::not_read(seen, "record what was seen first")));
    }
    let mut opened = Opened { paths: Vec::new(), written: Vec::new(), end: Time::ZERO };
    for (r, robot) in (0..).zip(scene.bodies()) {
        let Some((platform, drive)) = drive(robot.platform) else { continue };
        let path = match drive.args.get("file") {
            Some(Value::Text(path)) if !path.is_empty() => path.clone(),
            _ => {
                let seen = format!("`{}` reads a recording, and none is named", robot.name);
                let hint = "name one: `--recording FOLDER`, a .y4m file, or a trace";
                return Err((robot.name.clone(), Trouble::not_named(seen, hint)));
            }
        };
        let read = platform.of_role("sensor").enumerate();
        let read = read.filter(|(s, _)| robot.consumed.get(*s).copied().unwrap_or(false));
        let wanted: Vec<_> =
            read.map(|(s, part)| (s as u32, Wanted { robot: &robot.name, platform, part })).collect();
        let rate = drive.optional("rate");
        let (written, end) = of_path(&path, rate, &wanted, care, depth).map_err(|t| (path.clone(), t))?;
        opened.written.extend(written.into_iter().map(|(s, w)| (r, s, w)));
        opened.end = opened.end.max(end);
        opened.paths.push(path);
    }
    Ok(Some(opened))
}

/// What is written of sensors, and when it ends.
type Recorded = (Vec<(u32, Written)>, Time);

fn of_path(
    path: &str,
    rate: Option<f64>,
    wanted: &[(u32, Wanted<'_>)],
    care: Care,
    depth: u32,
) -> Result<Recorded, Trouble> {
    if files::is_trace(path) {
        if rate.is_some() {
            let hint = "leave `rate` and `--rate` out";
            return Err(Trouble::not_named("a trace has the times of its images, and no rate", hint));
        }
        let taped = Taped::open(path, depth + 1)?;
        let of = |(s, w): &(u32, Wanted<'_>)| Ok((*s, taped.written(w)?));
        return Ok((wanted.iter().map(of).collect::<Result<_, Trouble>>()?, taped.end()));
    }
    let files = Files::find(path, rate, care)?;
    let of = |(s, w): &(u32, Wanted<'_>)| Ok((*s, files.written(w)?));
    Ok((wanted.iter().map(of).collect::<Result<_, Trouble>>()?, files.end()))
}

impl Opened {
    /// Where they lie.
    pub fn paths(&self) -> &[String] {
        &self.paths
    }

    /// As a platform, from its beginning.
    pub fn platform(&self, scene: &Scene) -> Result<Recording, Refusal> {
        let mut tracks = Vec::new();
        for (robot, sensor, written) in &self.written {
            let path = self.paths.get(*robot as usize).map_or("", String::as_str);
            let (stamps, what) = match written {
                Written::Numbers { stamps, width, registers } => {
                    (stamps, What::Numbers(*width, registers.to_vec()))
                }
                Written::Images { stamps, shots } => {
                    (stamps, What::Images(shots.show().map_err(|t| t.refusal(path))?))
                }
            };
            tracks.push(Track { robot: *robot, sensor: *sensor, stamps: stamps.clone(), what });
        }
        Ok(Recording::new(scene, tracks, self.end))
    }
}
