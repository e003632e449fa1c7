//! What is drawn into images lies where the edges of things are.

use super::path;
use crate::support::{code, file, folder, soifra, stderr};
use soifra::trace_file;
use soifra_runtime::Event;

/// A robot that drives at a box.
const APPROACH: &str = "
edition 1

world hall {
  bounds = rectangle(low: (-10 m, -10 m), high: (10 m, 10 m))
  floor = plane(material: \"concrete\")
  wall end = segment(from: (9 m, -9 m), to: (9 m, 9 m), height: 3 m, thickness: 10 cm)
  obstacle block = box(at: (2 m, 10 cm), size: (60 cm, 80 cm, 2 m), material: \"bricks\")
}

agent pilot {
  sensor camera: Image
  sensor imu: Imu
  sensor odometry: Odometry
  actuator base: Twist
  state light: Number = 0
  state turned: Angle = 0 rad
  state read: Duration = 0 s

  service go every 100 ms {
    command base twist(0.5 m/s)
  }

  service look on sensor camera {
    set light = brightness(camera)
    set turned = imu.roll
    set read = odometry.captured
  }
}

mission approach {
  world hall
  robot scout: turtlebot2 at (-4 m, 0 m) runs pilot
  goal light { subgoal seen by pilot achieved when light > 0.1 }
  done when now > 5 s
  within 10 s
}
";

/// Left and right end of the box's front, m; how far away it is.
const FRONT: (f64, [f64; 2]) = (1.7, [0.5, -0.3]);
/// The camera of the profile: place in the body, focal length for 640 columns over 60 degrees.
const AT: [f64; 2] = [-0.087, -0.0135];
const HALF: f64 = 320.0;
/// On the sheet: pixels beside an image, and their scale.
const GAP: f64 = 8.0;
const SCALE: f64 = 0.75;

/// Columns of the sheet at which the ends of the front are.
fn columns(pose: &[f64; 7]) -> [f64; 2] {
    let yaw = 2.0 * libm::atan2(pose[5], pose[6]);
    let (s, c) = libm::sincos(yaw);
    let eye = [pose[0] + c * AT[0] - s * AT[1], pose[1] + s * AT[0] + c * AT[1]];
    let focal = HALF / libm::tan(std::f64::consts::FRAC_PI_6);
    FRONT.1.map(|y| {
        let (dx, dy) = (FRONT.0 - eye[0], y - eye[1]);
        let (ahead, left) = (c * dx + s * dy, c * dy - s * dx);
        GAP + SCALE * (HALF - focal * left / ahead)
    })
}

#[test]
fn edges_are_drawn_where_they_are() {
    let dir = folder("camera_overlay");
    let mission = file(&dir, "approach.soi", APPROACH);
    let (trace, sheet) = (path(&dir, "a.mcap"), path(&dir, "a.png"));
    let o = soifra(&["run", &mission, "--seed", "2", "--trace", &trace]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let records = trace_file::read(&trace).expect("a trace").records;
    let captured = records.iter().rev().find_map(|r| match r.event {
        Event::Image { captured, .. } if captured.seconds() < 4.01 => Some(captured),
        _ => None,
    });
    let captured = captured.expect("an image");
    let away = |t: f64| (t - captured.seconds()).abs();
    let poses = records.iter().filter_map(|r| match &r.event {
        Event::Pose { pose, .. } => Some((r.t.seconds(), *pose)),
        _ => None,
    });
    let (at, pose) = poses.min_by(|a, b| away(a.0).total_cmp(&away(b.0))).expect("a pose");
    assert!(away(at) < 0.051, "{at}");
    let wanted = columns(&pose);

    let from = format!("{}", captured.seconds() - 0.001);
    let plot = |overlay: &[&str]| {
        let mut args =
            vec!["plot", "--kind", "frames", &trace, "--limit", "1", "--from", &from, "-o", &sheet];
        args.extend(overlay);
        let o = soifra(&args);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        soifra::recording::decode(&std::fs::read(&sheet).expect("a sheet")).expect("a picture")
    };
    let of = |overlay: &[&str], which: fn(&[u8]) -> bool| -> Vec<f64> {
        let picture = plot(overlay);
        let width = picture.width;
        let pixels = picture.data.chunks_exact(3).enumerate().filter(|(_, p)| which(p));
        pixels.map(|(i, _)| (i % width) as f64 + 0.5).collect()
    };
    let blue = |p: &[u8]| p[0] < 20 && (60..100).contains(&p[1]) && p[2] > 235;
    let red = |p: &[u8]| p[0] > 235 && p[1] < 20 && p[2] < 20;
    let green = |p: &[u8]| p[0] < 60 && p[1] > 200 && p[2] < 60;
    let both = ["--overlay", "edges,flow"];
    for (seen, wanted) in [(of(&both, blue), wanted[0]), (of(&both, red), wanted[1])] {
        assert!(seen.len() > 50, "{} pixels", seen.len());
        assert!(seen.iter().all(|x| (x - wanted).abs() < 4.0), "{wanted}: {seen:?}");
    }
    assert!(of(&both, green).len() > 20);
    assert_eq!(of(&["--overlay", "edges"], green), [0.0; 0]);
    assert_eq!(of(&["--overlay", "flow"], red), [0.0; 0]);
    assert_eq!(of(&[], blue), [0.0; 0]);

    let o = soifra(&["plot", &trace, "--overlay", "flow"]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("choose `--kind frames`"), "{}", stderr(&o));
}
