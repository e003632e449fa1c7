//! What a run came to.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The result of a run: the fields of `soifra run --format json` that the runtime knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Mission name.
    pub mission: String,
    /// Seed.
    pub seed: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Why, in one line.
    pub reason: String,
    /// Virtual time at the end.
    pub sim_time_s: f64,
    /// Contacts of all robots, each counted once from touch to parting.
    pub collisions: u32,
    /// The first of these contacts; the trace has all.
    pub contacts: Vec<ContactReport>,
    /// Expectations, in order of declaration.
    pub expectations: Vec<ExpectationReport>,
    /// Goals, in order of declaration.
    pub goals: Vec<GoalReport>,
    /// Robots, in order of declaration.
    pub robots: Vec<RobotReport>,
    /// Metrics; absent when the value is not finite or cannot be computed.
    pub metrics: BTreeMap<String, Option<f64>>,
    /// Deadlines missed, of all units.
    pub missed_deadlines: u64,
    /// What went wrong, each with its place in the sources.
    pub faults: Vec<FaultReport>,
}

/// Something that went wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaultReport {
    /// When it did first.
    pub at_s: f64,
    /// What, and where in the sources.
    pub text: String,
    /// How often.
    pub times: u32,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The done condition was met and every expectation held.
    Success,
    /// The done condition was met and an expectation was violated, or nothing was left to happen.
    Failed,
    /// The time limit came first.
    Timeout,
    /// By a fault, a platform, a trace that is not writable any more, or the operator.
    Aborted,
}

impl Outcome {
    /// As in a trace and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Success => "success",
            Outcome::Failed => "failed",
            Outcome::Timeout => "timeout",
            Outcome::Aborted => "aborted",
        }
    }
}

/// The reason of a run that the operator stopped.
pub const INTERRUPTED: &str = "interrupted";

/// Stands for the agent in records of a lost platform.
pub const PLATFORM: &str = "platform";

/// Reason of a run that ended with its recording, and of the last safe actions in it.
pub const OVER: &str = "the recording is over";

/// How the text of such a record begins; the platform's reason follows.
pub const LOST: &str = "the platform is lost: ";

impl RunReport {
    /// Whether the operator stopped it.
    pub fn interrupted(&self) -> bool {
        self.outcome == Outcome::Aborted && self.reason == INTERRUPTED
    }
}

/// A contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactReport {
    /// When it began.
    pub at_s: f64,
    /// The robot.
    pub robot: String,
    /// What it touched: a robot, a mover, a thing of the world.
    pub with: String,
}

/// What became of an expectation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpectationReport {
    /// As written.
    pub text: String,
    /// Whether it held, for every robot where it is watched for each; absent when it asks for world truth
    /// and there is none.
    pub held: Option<bool>,
    /// The first instant at which it was violated.
    pub first_violation_s: Option<f64>,
    /// The least distance to the bound, in SI units; negative when violated. Absent for conditions that
    /// compare no quantities. For `leads to … within`: the time left in the slowest answer, in seconds.
    pub margin: Option<f64>,
}

/// Status of a goal at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct GoalReport {
    /// Name.
    pub name: String,
    /// `active`, `achieved` or `failed`.
    pub status: &'static str,
    /// Which of its sub-goals have no agents, and why; absent when none.
    pub reason: Option<String>,
}

/// A robot at the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotReport {
    /// Name.
    pub name: String,
    /// Profile.
    pub platform: String,
    /// Start pose in `map`, with this seed's scatter.
    pub start: PoseReport,
    /// True final pose; absent without a simulator.
    #[serde(rename = "final")]
    pub last: Option<PoseReport>,
    /// True path length.
    pub path_length_m: Option<f64>,
    /// Ticks of the step clock that lay behind it when it first had achieved all its sub-goals, which is
    /// the number of steps it made; absent without a step clock or when it never did.
    pub steps: Option<u64>,
    /// Whether it believes that all its sub-goals are achieved.
    pub reached: bool,
    /// True distance from its target.
    pub distance_to_target_m: Option<f64>,
    /// Contacts it took part in.
    pub collisions: u32,
    /// How often it fell back to its safe action, as when its commands had expired.
    pub safe_actions: u32,
}

/// A pose in `map`: position, and roll, pitch, yaw (ZYX).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PoseReport {
    /// East.
    pub x_m: f64,
    /// North.
    pub y_m: f64,
    /// Up.
    pub z_m: f64,
    /// About x.
    pub roll_rad: f64,
    /// About y.
    pub pitch_rad: f64,
    /// About z, counter-clockwise from east.
    pub yaw_rad: f64,
}

impl From<[f64; 7]> for PoseReport {
    fn from([x, y, z, qx, qy, qz, qw]: [f64; 7]) -> Self {
        let sine = (2.0 * (qw * qy - qz * qx)).clamp(-1.0, 1.0);
        PoseReport {
            x_m: x,
            y_m: y,
            z_m: z,
            roll_rad: libm::atan2(2.0 * (qw * qx + qy * qz), 1.0 - 2.0 * (qx * qx + qy * qy)),
            pitch_rad: libm::asin(sine),
            yaw_rad: libm::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz)),
        }
    }
}
