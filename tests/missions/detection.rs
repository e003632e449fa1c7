//! The published detection as a service: what it says before an obstacle, and why it says nothing.

use crate::{
    recording,
    support::{code, file, folder, json, soifra, stderr, stdout},
};

/// A robot that drives at a box, 3.5 m ahead and a little to one side.
const APPROACH: &str = "
edition 1
import std.vision

param aside: Length = 20 cm
param detection: service Detection = published

agent watcher {
  sensor camera: Image
  sensor imu: Imu
  sensor odometry: Odometry
  actuator base: Twist
  state sight: Sight? = none
  state collision: Int = 0
  state free: Int = 0
  state left: Int = 0
  state right: Int = 0
  state distance: Length = 0 m

  service go every 100 ms {
    command base twist(0.5 m/s)
  }

  service watch on sensor camera {
    match look(camera, before: sight, imu: imu, odometry: odometry, half_width: robot.radius) {
      some(s) => {
        set sight = some(s)
        match detection(s, 1 m, 0 rad) {
          some(c) => {
            set distance = distance_since(s, distance: c.distance, instant: now)
            set collision = collision + (if c.collision then 1 else 0)
            set free = free + (if c.collision then 0 else 1)
            set left = left + (if c.left_is_freer then 1 else 0)
            set right = right + (if c.left_is_freer then 0 else 1)
          }
          none(why) => note \"nothing detected\", why
        }
      }
      none(why) => note \"blind\", why
    }
  }
}

mission approach {
  floor = plane(material: \"carpet\")
  material dark = plain(color: \"#303038\")
  obstacle box = box(at: (4 m, aside), size: (1 m, 1 m, 2 m), material: \"dark\")
  robot scout: turtlebot2 at pose((0 m, 0 m), 0 deg) runs watcher
  goal go { subgoal go by watcher achieved when collision > 5 }
  done when now >= 3 s
  within 10 s
  metric collision = scout.watcher.collision
  metric free = scout.watcher.free
  metric left = scout.watcher.left
  metric right = scout.watcher.right
  metric mae = mean of abs(scout.watcher.distance - (3.5 m - scout.truth.position.x)) upon scout.watcher.collision
}
";

#[test]
fn both_tests_know_the_side_of_an_obstacle() {
    let dir = folder("detection_sides");
    let path = file(&dir, "approach.soi", APPROACH);
    for (detection, aside, freer, other) in [
        ("published", "20cm", "right", "left"),
        ("published", "-20cm", "left", "right"),
        ("clearance", "20cm", "right", "left"),
        ("clearance", "-20cm", "left", "right"),
    ] {
        let (how, place) = (format!("detection={detection}"), format!("aside={aside}"));
        let o =
            soifra(&["run", &path, "--set", &how, "--set", &place, "--trace", "none", "--format", "json"]);
        assert_eq!(code(&o), 0, "{}{}", stdout(&o), stderr(&o));
        let report = json(&o);
        let metric = |name: &str| report["metrics"][name].as_f64().unwrap_or(f64::NAN);
        assert!(metric("collision") >= 10.0, "{how} {place}: {report}");
        assert!(metric("collision") > 3.0 * metric("free"), "{how} {place}: {report}");
        assert!(metric(freer) > 2.0 * metric(other), "{how} {place}: {report}");
        // What is published takes edges within the face for those of the obstacle, and flow sees it too near.
        let bound = if detection == "published" { 1.0 } else { 0.3 };
        assert!(metric("mae") < bound, "{how} {place}: {report}");
    }
}

#[test]
fn the_published_detection_says_why_it_says_nothing() {
    let dir = folder("detection_reasons");
    let shipped =
        std::fs::read_to_string(crate::support::root().join(recording::MISSION)).expect("a mission");
    // The same mission, which notes what the detection says instead of the time to contact.
    let asked = shipped.replace("match ttc(s) {", "match published(s, 1 m, 0 rad) {");
    let asked = asked.replace("set contact = some(t)", "set contact = some(t.distance / 1 m/s)");
    let asked = asked.replace("note \"time to contact\", t\n", "note \"distance\", t.distance\n");
    let path = file(&dir, "asked.soi", asked);
    for (name, scene, says) in recording::nothing_seen::SCENES {
        let video = file(&dir, "seen.y4m", recording::nothing_seen::video(*scene, 12));
        let trace = dir.join("asked.mcap").to_string_lossy().into_owned();
        let o = soifra(&["run", &path, "--recording", &video, "--trace", &trace, "--format", "json"]);
        assert_eq!(code(&o), 0, "{name}: {}{}", stdout(&o), stderr(&o));
        assert_eq!(json(&o)["metrics"]["answers"], 0.0, "{name}");
        let log = stdout(&soifra(&["log", &trace]));
        assert!(log.contains(says), "{name}: {log}");
    }
}
