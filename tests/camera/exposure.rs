//! Exposure: what turns is smeared the way it turns, what stands is as sharp as without.

use crate::support::{code, file, folder, soifra, stderr};
use soifra::{recording::Everywhere, trace_file::Reader};
use soifra_runtime::{
    Event,
    objects::{Cameras, Frame},
};
use std::{path::Path, sync::Arc};

fn mission(exposure: &str, turn: &str) -> String {
    format!(
        "edition 1

platform eye extends turtlebot2 {{
  sensor camera = camera(
    width: 320,
    height: 240,
    field_of_view: 60 deg,
    at: (0 m, 0 m, 30 cm),
    period: 100 ms,
    noise: 0{exposure}
  )
}}

agent pilot {{
  sensor camera: Image
  actuator base: Twist
  state light: Number = 0
  service go every 50 ms {{ command base twist(0 m/s, turn: {turn}) }}
  service look on sensor camera {{ set light = brightness(camera) }}
}}

mission look {{
  world square_room
  robot scout: eye at (-9 m, 0.3 m) runs pilot
  goal light {{ subgoal seen by pilot achieved when light > 0 }}
  done when now > 1.45 s and achieved(light)
  within 3 s
}}
"
    )
}

/// The last image of a run.
fn last(dir: &Path, name: &str, exposure: &str, turn: &str) -> Arc<Frame> {
    let path = file(dir, &format!("{name}.soi"), mission(exposure, turn));
    let trace = dir.join(format!("{name}.mcap")).to_string_lossy().into_owned();
    for way in [
        &["run", &path, "--seed", "3", "--trace", &trace][..],
        &["replay", &trace],
        &["replay", "--recorded", &trace],
    ] {
        let o = soifra(way);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
    }
    let mut reader = Reader::open(&trace).expect("a trace");
    let images = reader.by_ref().filter_map(Result::ok).filter_map(|r| match r.event {
        Event::Image { robot, sensor, captured, view, .. } => Some((robot, sensor, captured, view)),
        _ => None,
    });
    let (robot, sensor, captured, view) = images.last().expect("an image");
    let mut cameras = Everywhere::default().of(&reader.header().scene).expect("cameras");
    cameras.retake(robot, sensor, captured, &view).expect("the image again")
}

/// Mean difference between pixels beside each other, and between pixels above each other.
fn contrast(frame: &Frame) -> [f64; 2] {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let green = |x: usize, y: usize| f64::from(frame.data[3 * (y * width + x) + 1]);
    let mut sums = [0.0; 2];
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            sums[0] += (green(x + 1, y) - green(x, y)).abs();
            sums[1] += (green(x, y + 1) - green(x, y)).abs();
        }
    }
    sums.map(|s| s / ((width - 1) * (height - 1)) as f64)
}

#[test]
fn a_turning_robots_image_is_smeared_the_way_it_turns_and_a_standing_ones_is_not() {
    let dir = folder("camera_exposure");
    let open = ",\n    exposure: 20 ms";
    let standing = ["", open].map(|e| last(&dir, "standing", e, "0 deg/s"));
    assert!(standing[0].data == standing[1].data, "what stands has other bytes");
    let [sharp, smeared] = ["", open].map(|e| contrast(&last(&dir, "turning", e, "90 deg/s")));
    let left = [smeared[0] / sharp[0], smeared[1] / sharp[1]];
    assert!(left[0] < 0.6 && left[1] > left[0] + 0.2, "{left:?} of the contrast is left");
}

#[test]
fn an_exposure_ends_before_the_next_image_begins() {
    let dir = folder("camera_exposure_long");
    let path = file(&dir, "long.soi", mission(", exposure: 120 ms", "0 deg/s"));
    let o = soifra(&["run", &path, "--trace", "none"]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert!(stderr(&o).contains("exposure"), "{}", stderr(&o));
}
