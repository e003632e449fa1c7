//! Batteries: what standing by and driving take from them. An empty one moves no robot.

use super::{args::Args, body::Body, body::seconds};
use soifra_runtime::scene::PlatformScene;

/// A battery of a platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Battery {
    /// What it holds when it is full (J).
    energy: f64,
    /// What a metre of way takes (N).
    drive: f64,
    /// What a second takes (W).
    standby: f64,
}

impl Battery {
    /// That of a platform, when it has one.
    pub fn of(platform: &PlatformScene) -> Result<Option<Battery>, String> {
        let Some(part) = platform.of_role("power").next() else { return Ok(None) };
        let of = format!("platform `{}`", platform.name);
        let args = Args { part, of: &of };
        let (drive, standby) = (args.at_least_zero("drive")?, args.at_least_zero("standby")?);
        Ok(Some(Battery { energy: args.positive("energy")?, drive, standby }))
    }

    /// How full it is, 0 to 1, after a robot has come so far.
    pub fn charge(&self, body: &Body, now: i64) -> f64 {
        let used = self.drive * body.place(now).path + self.standby * seconds(0, now);
        (1.0 - used / self.energy).clamp(0.0, 1.0)
    }
}
