//! Recordings as platforms: the same from every form, in every run and in replays; over when they are over.

mod bad_input;
mod bytes;
pub mod nothing_seen;
mod support;

use crate::support::{code, file, folder, json, soifra, stderr};
use serde_json::Value;
use std::path::Path;
use support::{RATE, contact, files, jpeg, png, y4m};

/// The shipped mission that looks at recordings.
pub const MISSION: &str = "missions/soifra/footage.soi";

/// Runs the shipped mission on a recording; the report and the trace.
fn look(dir: &Path, recording: &str, more: &[&str]) -> (Value, String) {
    let trace = dir.join(format!("{}.mcap", more.len())).to_string_lossy().into_owned();
    let mut arguments = vec!["run", MISSION, "--recording", recording, "--trace", &trace, "--format", "json"];
    arguments.extend(more);
    let o = soifra(&arguments);
    assert_eq!(code(&o), 0, "{arguments:?}: {}", stderr(&o));
    (json(&o), trace)
}

fn metric(report: &Value, name: &str) -> f64 {
    report["metrics"][name].as_f64().unwrap_or_else(|| panic!("{name}: {report}"))
}

#[test]
fn a_box_that_comes_nearer_is_timed() {
    let dir = folder("recording_box");
    let video = file(&dir, "box.y4m", y4m(60));
    let (report, _) = look(&dir, &video, &[]);
    let ended = (report["outcome"].as_str(), report["reason"].as_str());
    assert_eq!(ended, (Some("success"), Some("the recording is over")));
    // 60 images at 20 Hz.
    assert_eq!(report["sim_time_s"], 3.0);
    assert_eq!((metric(&report, "images"), metric(&report, "blind")), (60.0, 0.0));
    assert!(metric(&report, "answers") >= 20.0, "{report}");
    let (least, truth) = (metric(&report, "least_contact"), contact(59));
    assert!((least - truth).abs() < 0.05 * truth, "{least} s, it was {truth} s");
}

#[test]
fn folders_patterns_and_videos_say_the_same() {
    let dir = folder("recording_forms");
    let folder = files(&dir.join("png"), 30, "png", png);
    let rate = format!("{RATE}Hz");
    let (first, trace) = look(&dir, &folder, &["--rate", &rate]);
    assert_eq!(metric(&first, "images"), 30.0);
    for pattern in ["image%d.png", "image*.png", "*.png"] {
        let (other, _) = look(&dir, &format!("{folder}/{pattern}"), &["--rate", &rate, "--seed", "2"]);
        assert_eq!(first["metrics"], other["metrics"], "{pattern}");
    }
    let jpegs = files(&dir.join("jpeg"), 30, "jpg", jpeg);
    let (lossy, _) = look(&dir, &jpegs, &["--rate", &rate]);
    assert!(
        (metric(&first, "least_contact") - metric(&lossy, "least_contact")).abs() < 0.2,
        "{first} {lossy}"
    );
    // The trace of a run is a recording too: of the same images.
    let (again, _) = look(&dir, &look(&dir, &folder, &["--rate", &rate, "--seed", "3"]).1, &[]);
    assert_eq!(first["metrics"], again["metrics"]);
    assert!(std::fs::metadata(trace).is_ok_and(|m| m.len() < 200_000), "a trace holds no pixels");
}

#[test]
fn runs_and_replays_are_the_same() {
    let dir = folder("recording_same");
    let video = file(&dir, "box.y4m", y4m(25));
    let (one, trace) = look(&dir, &video, &["--threads", "1"]);
    let (two, _) = look(&dir, &video, &["--threads", "2", "--seed", "1"]);
    assert_eq!(one["trace"]["digest"], two["trace"]["digest"]);
    for way in [&["replay", &trace][..], &["replay", "--recorded", &trace]] {
        let o = soifra(way);
        assert_eq!(code(&o), 0, "{way:?}: {}", stderr(&o));
    }
    let o = soifra(&["plot", "--kind", "frames", &trace, "-o", &dir.join("sheet.png").to_string_lossy()]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert!(stderr(&o).contains("24 of 25 images"), "{}", stderr(&o));
    // Another recording under the same name is found out.
    let mut other = y4m(25);
    let last = other.len() - 1;
    other[last] ^= 0xff;
    file(&dir, "box.y4m", other);
    for way in [&["replay", &trace][..], &["replay", "--recorded", &trace]] {
        let o = soifra(way);
        assert_eq!((code(&o), stderr(&o).contains("S9023")), (1, true), "{way:?}: {}", stderr(&o));
    }
}

/// A simulated run gives readings of all that was read in it.
const DRIVING: &str = "
edition 1

agent watcher {
  sensor camera: Image
  sensor odometry: Odometry
  actuator base: Twist
  state light: Number = 0
  state way: Length = 0 m

  service drive every 100 ms {
    set way = odometry.pose.position.x
    command base twist(0.4 m/s)
  }

  service look on sensor camera {
    set light = light + brightness(camera)
  }
}

platform replayed extends turtlebot2 {
  drive = recorded()
}

mission drive {
  world square_room
  robot scout: turtlebot2 at (-9 m, 0.3 m) runs watcher
  goal go { subgoal go by watcher achieved when way > 0.5 m }
  done when now >= 2 s
  within 10 s
  metric light = scout.watcher.light
  metric way = scout.watcher.way
}
";

#[test]
fn a_trace_gives_every_reading_of_its_run_again() {
    let dir = folder("recording_trace");
    let mission = file(&dir, "drive.soi", DRIVING);
    let trace = dir.join("simulated.mcap").to_string_lossy().into_owned();
    let o = soifra(&["run", &mission, "--trace", &trace, "--format", "json"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let simulated = json(&o);
    let o = soifra(&[
        "run",
        &mission,
        "--platform",
        "replayed",
        "--recording",
        &trace,
        "--trace",
        "none",
        "--format",
        "json",
    ]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let replayed = json(&o);
    assert_eq!(simulated["metrics"], replayed["metrics"]);
    assert!(metric(&replayed, "way") > 0.5, "{replayed}");
    // Of the world's truth nobody knows anything.
    assert_eq!(replayed["robots"][0]["final"], Value::Null);
}

#[test]
fn a_mission_may_end_before_its_recording() {
    let dir = folder("recording_ends");
    let video = file(&dir, "box.y4m", y4m(20));
    let text = std::fs::read_to_string(crate::support::root().join(MISSION)).expect("the mission");
    let early = file(&dir, "early.soi", text.replace("done when false", "done when now >= 500 ms"));
    let o = soifra(&["run", &early, "--recording", &video, "--trace", "none", "--format", "json"]);
    assert_eq!((code(&o), json(&o)["reason"].as_str()), (0, Some("done")), "{}", stderr(&o));
    let late = file(&dir, "late.soi", text.replace("within 1 h", "within 500 ms"));
    let o = soifra(&["run", &late, "--recording", &video, "--trace", "none", "--format", "json"]);
    assert_eq!((code(&o), json(&o)["outcome"].as_str()), (1, Some("timeout")), "{}", stderr(&o));
    // What a mission expects is judged as ever.
    let judged = text.replace("within 1 h", "within 1 h\n  expect eventually eye.watcher.looks > 1000");
    let judged = file(&dir, "judged.soi", judged);
    let o = soifra(&["run", &judged, "--recording", &video, "--trace", "none", "--format", "json"]);
    assert_eq!((code(&o), json(&o)["outcome"].as_str()), (1, Some("failed")), "{}", stderr(&o));
}

/// A file of each form, small.
pub fn samples() -> Vec<Vec<u8>> {
    let video =
        [&b"YUV4MPEG2 W5 H3 F20:1 Ip A1:1 C420jpeg\nFRAME\n"[..], &[99; 27], b"FRAME\n", &[9; 27]].concat();
    vec![video, png(0), jpeg(0), Vec::new()]
}
