//! The command line: exit codes, documents, bad input.

mod bad_input;
mod check;
mod documents;
mod fmt;
mod graph;
mod plot;
mod realtime;
mod run;
mod sweep;
mod test;
mod tutorial;

use crate::support::{code, file, folder, soifra, stderr};
use std::path::Path;

/// A whole mission in one file: a cart drives to its target past a post.
pub const MISSION: &str = r#"edition 1

platform cart {
  body = cylinder(radius: 10 cm, height: 20 cm)
  drive = holonomic(max_speed: 1 m/s, max_turn: 1 rad/s, error: normal(sd: 1 %))
  sensor pose = ideal_pose(period: 100 ms)
  actuator base = twist()
  safe = stop()
}

mission errand "one cart, one post" {
  param speed: Velocity = 0.5 m/s
  bounds = rectangle(low: (-1 m, -1 m), high: (4 m, 1 m))
  obstacle post = cylinder(at: (1.5 m, 60 cm), radius: 10 cm)
  robot porter: cart at (0 m, 0 m) to (3 m, 0 m) scatter normal(sd: 2 cm) runs driver
  goal deliver { subgoal reach by driver achieved when arrived }
  done when achieved(deliver)
  within 30 s
  expect never collision
  metric way = sum robot: truth.path_length
}

agent driver {
  sensor pose: Pose<map>
  actuator base: Twist
  state arrived: Bool = false

  service drive every 100 ms {
    let way = to_body(robot.target - pose.position, pose)
    when norm(way) <= 5 cm => set arrived = true
    let step = min(speed, norm(way) / 200 ms)
    let aim = step * unit(way)
    command base twist(aim.x, left: aim.y)
  }
}

test errands {
  run errand
  seeds 1 .. 3
  expect way <= 3.2 m
}
"#;

/// The mission in a folder of its own.
pub fn mission(folder: &Path) -> String {
    file(folder, "errand.soi", MISSION)
}

/// The mission's graph as JSON.
pub fn small_graph() -> Option<Vec<u8>> {
    let dir = folder("small_graph");
    let o = soifra(&["graph", &mission(&dir), "--format", "json"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    Some(o.stdout)
}

/// A trace of the mission.
pub fn small_trace() -> Option<Vec<u8>> {
    let dir = folder("small_trace");
    let trace = dir.join("t.mcap");
    let o = soifra(&["run", &mission(&dir), "--trace", &trace.to_string_lossy()]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    std::fs::read(trace).ok()
}
