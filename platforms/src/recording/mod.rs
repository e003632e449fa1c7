//! Robots whose sensors read what was recorded. Commands move nothing: what is to be seen is what was seen then.
//!
//! The platform hands over what tracks hold, and knows nothing of files: whoever opens a recording gives a track for
//! each sensor that is read.

mod lens;

pub use lens::optics;

use crate::sim::{Endings, endings};
use soifra_runtime::{
    Platform, Readings, Report, Scene, Time, WorldTruth,
    objects::{Frame, Optics, digest},
};
use std::{fmt, sync::Arc};

/// Name of the drive of a platform that is a recording.
pub const DRIVE: &str = "recorded";

/// What was recorded of one sensor, in order of delivery.
#[derive(Debug)]
pub struct Track {
    /// Robot, by index.
    pub robot: u32,
    /// Sensor of its platform, by index.
    pub sensor: u32,
    /// When each reading was taken and delivered.
    pub stamps: Vec<Stamp>,
    /// The readings.
    pub what: What,
}

/// When a reading was taken and delivered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// Taken.
    pub captured: Time,
    /// Delivered; never before that.
    pub delivered: Time,
}

/// Readings.
pub enum What {
    /// So many registers each, one reading after the other.
    Numbers(usize, Vec<f64>),
    /// Images.
    Images(Box<dyn Footage>),
}

impl fmt::Debug for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            What::Numbers(..) => "Numbers",
            What::Images(_) => "Images",
        })
    }
}

/// Images that can be had by their number, from 0. The same number always gives the same image.
pub trait Footage {
    /// An image.
    ///
    /// # Errors
    /// Why it cannot be had, as a part of a sentence.
    fn image(&mut self, number: usize) -> Result<Picture, String>;
}

/// An image and the lens it was taken through.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// RGB, 8 bits each, row by row from the upper left.
    pub data: Vec<u8>,
    /// The lens.
    pub optics: Optics,
}

impl Picture {
    /// As what a camera took. That it can be taken again, its number says.
    pub fn into_frame(self, number: usize, captured: Time) -> Frame {
        Frame {
            digest: digest(self.width, self.height, &self.data),
            width: self.width,
            height: self.height,
            data: self.data,
            optics: self.optics,
            captured,
            view: vec![number as f64],
        }
    }
}

/// A recording as a platform.
#[derive(Debug)]
pub struct Recording {
    tracks: Vec<Track>,
    /// What of each track is handed over next.
    next: Vec<usize>,
    /// When it is over.
    end: Time,
    /// Nothing comes any more: it is over, or an image could not be had.
    told: bool,
    /// By platform.
    endings: Vec<Endings>,
    /// Platform of each robot.
    platforms: Vec<u32>,
}

impl Recording {
    /// Of a scene all of whose robots are recorded. It is over at `end`, or at its last reading if that is later.
    pub fn new(scene: &Scene, tracks: Vec<Track>, end: Time) -> Recording {
        let last = tracks.iter().filter_map(|t| t.stamps.last()).map(|s| s.delivered).max();
        Recording {
            next: vec![0; tracks.len()],
            end: last.map_or(end, |l| l.max(end)),
            tracks,
            told: false,
            endings: endings(&scene.platforms),
            platforms: scene.bodies().iter().map(|r| r.platform).collect(),
        }
    }

    /// The track whose next reading is delivered first; of several at once that of the first robot and sensor.
    fn first(&self) -> Option<(usize, Stamp)> {
        let due = self.tracks.iter().zip(&self.next).enumerate().filter_map(|(i, (track, next))| {
            let stamp = *track.stamps.get(*next)?;
            Some((stamp.delivered, track.robot, track.sensor, i, stamp))
        });
        due.min_by_key(|(delivered, robot, sensor, ..)| (*delivered, *robot, *sensor)).map(|d| (d.3, d.4))
    }

    fn ending(&self, robot: u32) -> Endings {
        let platform = self.platforms.get(robot as usize).and_then(|p| self.endings.get(*p as usize));
        platform.copied().unwrap_or(Endings { safe: "stop", finish: "stop" })
    }
}

impl Platform for Recording {
    fn next_due(&self) -> Option<Time> {
        if self.told {
            return None;
        }
        Some(self.first().map_or(self.end, |(_, s)| s.delivered))
    }

    fn poll(&mut self, now: Time, readings: &mut Readings, reports: &mut Vec<Report>) {
        while let Some((i, stamp)) = self.first().filter(|(_, s)| s.delivered <= now && !self.told) {
            let number = self.next[i];
            self.next[i] += 1;
            let track = &mut self.tracks[i];
            let (robot, sensor) = (track.robot, track.sensor);
            match &mut track.what {
                What::Numbers(width, registers) => {
                    let from = number * *width;
                    let all = registers.get(from..from + *width).unwrap_or_default();
                    readings.push(robot, sensor, stamp.captured, stamp.delivered, all);
                }
                What::Images(footage) => match footage.image(number) {
                    Ok(picture) => {
                        let frame = Arc::new(picture.into_frame(number, stamp.captured));
                        readings.push_image(robot, sensor, stamp.captured, stamp.delivered, frame);
                    }
                    Err(why) => {
                        let reason = format!("image {number} of its recording: {why}");
                        reports.push(Report::Lost { at: now, robot, reason });
                        self.told = true;
                    }
                },
            }
        }
        if now >= self.end && !self.told {
            self.told = true;
            reports.push(Report::Over { at: now });
        }
    }

    fn send(&mut self, _: Time, _: u32, _: u32, _: &[f64], _: Time) {}

    fn safe_action(&mut self, _: Time, robot: u32) -> &'static str {
        self.ending(robot).safe
    }

    fn finish(&mut self, _: Time, robot: u32) -> &'static str {
        self.ending(robot).finish
    }

    fn truth(&self) -> Option<&dyn WorldTruth> {
        None
    }
}
