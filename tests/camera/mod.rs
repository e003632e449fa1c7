//! Cameras: the same images whatever the threads, in replays, and only where somebody reads them.

mod exposure;
mod image_files;
#[cfg(feature = "vision")]
mod overlay;

use crate::support::{code, file, folder, soifra, stderr};

/// A robot that looks and drives, and one that has a camera and does not look.
const LOOKING: &str = "
edition 1

agent pilot {
  sensor camera: Image
  actuator base: Twist
  state before: Image? = none
  state light: Number = 0
  state change: Number = 0

  service go every 100 ms {
    command base twist(robot.cruise_speed, turn: if now > 3 s then 40 deg/s else 0 deg/s)
  }

  service look on sensor camera {
    set light = brightness(camera)
    when before is some(last) => {
      set change = brightness(camera) - brightness(last)
    }
    set before = some(camera)
    note \"light\", light
  }
}

agent driver {
  actuator base: Twist
  service go every 100 ms {
    command base twist(0.3 m/s)
  }
}

mission look {
  world square_room
  robot scout: ardrone2 at (-9 m, 0.3 m) runs pilot
  robot other: turtlebot2 at (-6.5 m, 0 m) runs driver
  goal light { subgoal seen by pilot achieved when light > 0.2 and change > -1 }
  done when now > 3.5 s and achieved(light)
  within 10 s
}
";

fn path(folder: &std::path::Path, name: &str) -> String {
    folder.join(name).to_string_lossy().into_owned()
}

#[test]
fn images_are_the_same_on_any_threads_and_in_replays() {
    let dir = folder("camera_threads");
    let mission = file(&dir, "look.soi", LOOKING);
    let run = |name: &str, threads: &str| {
        let trace = path(&dir, name);
        let o = soifra(&["run", &mission, "--seed", "3", "--threads", threads, "--trace", &trace]);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
        (std::fs::read(&trace).expect("a trace"), trace)
    };
    let ((one, trace), (two, _)) = (run("one.mcap", "1"), run("two.mcap", "2"));
    assert!(one == two, "the bytes of the traces differ");
    for way in [&["replay", &trace][..], &["replay", "--recorded", &trace]] {
        let o = soifra(way);
        assert_eq!(code(&o), 0, "{}", stderr(&o));
    }
    // The trace holds no pixels: 70 images of 900 kB each.
    assert!(one.len() < 1_000_000, "{} bytes", one.len());
    let reader = soifra::trace_file::Reader::open(&trace).expect("a trace");
    let images = reader.filter_map(Result::ok).filter_map(|r| match r.event {
        soifra_runtime::Event::Image { robot, captured, digest, .. } => Some((robot, captured, digest)),
        _ => None,
    });
    let images: Vec<_> = images.collect();
    assert!(images.len() >= 65, "{}", images.len());
    assert!(images.iter().all(|i| i.0 == 0), "nobody reads the camera of the other");
    let digests: std::collections::BTreeSet<_> = images.iter().map(|i| &i.2).collect();
    assert_eq!(digests.len(), images.len(), "noise makes every image another one");
}

#[test]
fn a_contact_sheet_is_drawn_from_the_trace() {
    let dir = folder("camera_sheet");
    let mission = file(&dir, "look.soi", LOOKING);
    let trace = path(&dir, "look.mcap");
    let o = soifra(&["run", &mission, "--trace", &trace]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let o = soifra(&["plot", "--kind", "frames", &trace, "--limit", "5", "--from", "1 s"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert!(stderr(&o).contains("5 of "), "{}", stderr(&o));
    let png = std::fs::read(path(&dir, "look-frames.png")).expect("a sheet");
    assert_eq!(&png[1..4], b"PNG");
    let o = soifra(&["plot", "--kind", "frames", &trace, "-o", &path(&dir, "sheet.svg")]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert!(stderr(&o).contains("end its name in .png"), "{}", stderr(&o));
}

#[test]
fn a_platform_without_a_camera_is_refused() {
    let dir = folder("camera_lacks");
    let mission =
        file(&dir, "look.soi", LOOKING.replace("scout: ardrone2", "scout: any of [ardrone2, khepera4]"));
    let o = soifra(&["check", &mission, "--platform", "khepera4"]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("has no sensor `camera`"), "{}", stderr(&o));
    let o = soifra(&["check", &mission, "--platform", "khepera4_camera"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
}
