//! A robot that avoids what it sees stands still when it sees nothing, and the trace says why.

use crate::support::{code, file, folder, json, root, soifra, stderr, stdout};
use serde_json::Value;

/// A robot that drives at an obstacle 4 m ahead, for 5 s, with something wrong.
fn mission(wrong: &str) -> String {
    format!(
        "
edition 1
import \"{}/missions/soifra/avoidance.soi\"

param gain: Number = 1

mission drive {{
  world square_room
  light = lamp(gain: gain)
  robot scout: any of [turtlebot2, ardrone2] at pose((-9.5 m, 0 m), 0 deg)
    runs steering, detector, avoider, navigator
  {wrong}
  goal avoid_collision {{
    subgoal detect_obstacle
    subgoal avoid_obstacle
  }}
  goal reach_target {{ subgoal navigate }}
  done when now >= 5 s
  within 10 s
  expect never collision
  metric way = scout.truth.path_length
  metric looks = scout.detector.looks
}}
",
        root().display()
    )
}

/// The report of a run, and what its trace notes.
fn run(name: &str, wrong: &str, platform: &str, set: &str) -> (Value, String) {
    run_of(name, mission(wrong), platform, set)
}

fn run_of(name: &str, mission: String, platform: &str, set: &str) -> (Value, String) {
    let dir = folder(&format!("blind_{name}"));
    let path = file(&dir, "blind.soi", mission);
    let trace = dir.join("blind.mcap").to_string_lossy().into_owned();
    let o = soifra(&[
        "run",
        &path,
        "--mission",
        "drive",
        "--platform",
        platform,
        "--set",
        set,
        "--trace",
        &trace,
        "--format",
        "json",
    ]);
    assert_eq!(code(&o), 0, "{name}: {}{}", stdout(&o), stderr(&o));
    let log = stdout(&soifra(&["log", &trace]));
    let notes = log.lines().filter(|l| l.contains(" note ")).collect::<Vec<_>>().join("\n");
    (json(&o), notes)
}

fn metric(report: &Value, name: &str) -> f64 {
    report["metrics"][name].as_f64().unwrap_or_else(|| panic!("{name}: {report}"))
}

/// A robot that looks for people, for 5 s.
fn looking_for_people() -> String {
    format!(
        "
edition 1
import \"{}/missions/soifra/search.soi\"

param gain: Number = 1

mission drive {{
  world gallery
  light = lamp(gain: gain)
  robot scout: any of [turtlebot2, husky] at pose((5 m, 6 m), 0 deg) runs watcher, follower
  goal find_people {{ subgoal look by watcher achieved when found.length() >= 1 }}
  goal follow_person {{ subgoal follow by follower achieved when done }}
  done when now >= 5 s
  within 10 s
  expect never collision
  metric turned = abs(scout.watcher.turned)
  metric looks = scout.watcher.looks
}}
",
        root().display()
    )
}

#[test]
fn without_light_nobody_is_looked_for() {
    for (name, gain, reason) in
        [("nobody_black", "gain=0", "image all black"), ("nobody_white", "gain=1000", "image all white")]
    {
        let (report, notes) = run_of(name, looking_for_people(), "turtlebot2", gain);
        // In bright light an image may show something dark now and then.
        assert!(metric(&report, "looks") < 3.0, "{name}: {report}");
        // It begins to look around, and stands when it is known that nothing is seen.
        assert!(metric(&report, "turned") < 0.5, "{name}: {report}");
        assert!(notes.contains(&format!("blind: {reason}")), "{name}: {notes}");
        assert!(notes.contains("nothing seen for"), "{name}: {notes}");
    }
    let (report, notes) = run_of("nobody_day", looking_for_people(), "husky", "gain=1");
    assert!(metric(&report, "looks") > 40.0 && metric(&report, "turned") > 1.0, "{report} {notes}");
}

#[test]
fn without_light_it_does_not_move() {
    for (name, gain, reason) in
        [("black", "gain=0", "image all black"), ("white", "gain=1000", "image all white")]
    {
        for platform in ["turtlebot2", "ardrone2"] {
            let (report, notes) = run(name, "", platform, gain);
            assert_eq!(metric(&report, "looks"), 0.0, "{name}: {report}");
            // Half a second passes until it is known that nothing is seen.
            assert!(metric(&report, "way") < 0.6, "{name} on {platform}: {report}");
            assert!(notes.contains(&format!("blind: {reason}")), "{name}: {notes}");
            assert!(notes.contains("nothing seen for"), "{name}: {notes}");
        }
    }
}

#[test]
fn a_camera_that_falls_silent_stops_it() {
    for (platform, braking) in [("turtlebot2", 0.5), ("ardrone2", 1.5)] {
        let silent = "fault = dropout(sensor: \"scout.camera\", from: 2 s)";
        let (report, notes) = run("silent", silent, platform, "gain=1");
        let (two, _) = run("two", "", platform, "gain=1");
        let way = metric(&report, "way");
        assert!(way < metric(&two, "way") - 1.0, "{platform}: {report} {two}");
        assert!(way > 0.3 && way < 2.0 * metric(&two, "way") / 5.0 + braking, "{platform}: {report} {two}");
        assert!(notes.contains("nothing seen for"), "{platform}: {notes}");
    }
}

#[test]
fn it_goes_on_when_it_sees_again() {
    let dazzled = "fault = dropout(sensor: \"scout.camera\", from: 1 s, until: 3 s)";
    let (report, notes) = run("again", dazzled, "turtlebot2", "gain=1");
    assert!(metric(&report, "way") > 1.0, "{report}");
    assert!(notes.contains("nothing seen for"), "{notes}");
}

/// A robot that stands before an obstacle and looks at it.
const STANDING: &str = "
edition 1
import std.vision

agent watcher {
  sensor camera: Image
  sensor imu: Imu
  sensor odometry: Odometry
  state sight: Sight? = none
  state looks: Int = 0
  state answers: Int = 0

  service watch on sensor camera {
    match look(camera, before: sight, imu: imu, odometry: odometry) {
      some(s) => {
        set sight = some(s)
        set looks = looks + 1
        match expansion(s) {
          some(t) => set answers = answers + 1
          none(why) => note \"by expansion\", why
        }
        match flow(s) {
          some(t) => set answers = answers + 1
          none(why) => note \"by flow\", why
        }
        match flow_robust(s) {
          some(t) => set answers = answers + 1
          none(why) => note \"by robust flow\", why
        }
      }
      none(why) => note \"blind\", why
    }
  }
}

mission stand {
  world square_room
  robot scout: turtlebot2 at pose((-9 m, 0 m), 0 deg) runs watcher
  goal watch { subgoal watch by watcher achieved when looks > 20 }
  done when now >= 2 s
  within 10 s
  metric answers = scout.watcher.answers
  metric looks = scout.watcher.looks
}
";

#[test]
fn who_stands_meets_nothing() {
    let dir = folder("blind_standing");
    let path = file(&dir, "stand.soi", STANDING);
    let trace = dir.join("stand.mcap").to_string_lossy().into_owned();
    let o = soifra(&["run", &path, "--trace", &trace, "--format", "json"]);
    assert_eq!(code(&o), 0, "{}{}", stdout(&o), stderr(&o));
    let report = json(&o);
    assert_eq!(metric(&report, "answers"), 0.0, "{report}");
    assert!(metric(&report, "looks") > 30.0, "{report}");
    let log = stdout(&soifra(&["log", &trace]));
    for way in ["by expansion", "by flow", "by robust flow"] {
        let of = log.lines().filter(|l| l.contains(&format!("{way}: "))).count() as f64;
        assert_eq!(of, metric(&report, "looks"), "{way}: {log}");
    }
}
