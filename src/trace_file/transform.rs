//! Poses as MCAP viewers draw them.
//!
//! A pose is recorded once: its `foxglove.FrameTransform` carries the record's number and causes as
//! further members, so that the record can be read back from it.

use serde::{Deserialize, Serialize};
use soifra_runtime::{Event, Record, Time};
use std::borrow::Cow;

const NANOS: i64 = 1_000_000_000;

/// Frame of a robot's body.
pub(crate) fn robot_frame(name: &str) -> String {
    format!("{name}/base_link")
}

/// A record of a pose as `foxglove.FrameTransform`.
#[derive(Serialize, Deserialize)]
pub(crate) struct Transform<'a> {
    timestamp: Stamp,
    #[serde(borrow)]
    parent_frame_id: Cow<'a, str>,
    #[serde(borrow)]
    child_frame_id: Cow<'a, str>,
    translation: Translation,
    rotation: Rotation,
    n: u64,
    #[serde(default, skip_serializing_if = "no_causes")]
    causes: Cow<'a, [u64]>,
    /// Index and path length of a robot; a mover has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    robot: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    path_m: Option<f64>,
}

fn no_causes(causes: &[u64]) -> bool {
    causes.is_empty()
}

#[derive(Serialize, Deserialize)]
struct Stamp {
    sec: i64,
    nsec: i64,
}

#[derive(Serialize, Deserialize)]
struct Translation {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Serialize, Deserialize)]
struct Rotation {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl<'a> Transform<'a> {
    /// The transform of a record of a pose; `None` for other records and for poses a transform cannot
    /// carry (not finite, or of an unknown robot). `frames` are the frames of the robots.
    pub(crate) fn of(record: &'a Record, frames: &'a [String]) -> Option<Self> {
        let (child, robot, pose, path_m) = match &record.event {
            Event::Pose { robot, pose, path_m } => {
                (frames.get(*robot as usize)?, Some(*robot), pose, Some(*path_m))
            }
            Event::Mover { name, pose } => (name, None, pose, None),
            _ => return None,
        };
        let [x, y, z, qx, qy, qz, qw] = *pose;
        pose.iter().chain(&path_m).all(|x| x.is_finite()).then(|| Transform {
            timestamp: Stamp { sec: record.t.0 / NANOS, nsec: record.t.0 % NANOS },
            parent_frame_id: "map".into(),
            child_frame_id: child.as_str().into(),
            translation: Translation { x, y, z },
            rotation: Rotation { x: qx, y: qy, z: qz, w: qw },
            n: record.n,
            causes: (&*record.causes).into(),
            robot,
            path_m,
        })
    }

    /// The record back; `None` when the time does not fit.
    pub(crate) fn into_record(self) -> Option<Record> {
        let Transform { translation: p, rotation: q, .. } = self;
        let pose = [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
        Some(Record {
            n: self.n,
            t: Time(self.timestamp.sec.checked_mul(NANOS)?.checked_add(self.timestamp.nsec)?),
            causes: self.causes.into_owned(),
            event: match self.robot {
                Some(robot) => Event::Pose { robot, pose, path_m: self.path_m.unwrap_or_default() },
                None => Event::Mover { name: self.child_frame_id.into_owned(), pose },
            },
        })
    }
}
