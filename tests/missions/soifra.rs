//! The mission of the room does not ask which robot it runs on, but for what it needs.

use crate::support::{code, soifra, stderr};

const ROOM: &str = "missions/soifra/room.soi";

#[test]
fn a_robot_without_a_camera_is_refused_and_one_with_it_is_not() {
    let o = soifra(&["check", ROOM, "--platform", "khepera4"]);
    assert_eq!(code(&o), 2, "{}", stderr(&o));
    assert!(stderr(&o).contains("camera"), "{}", stderr(&o));
    let o = soifra(&["check", ROOM, "--platform", "khepera4_camera"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
}

#[test]
fn every_robot_and_service_passes_the_check_unchanged() {
    for robot in ["turtlebot2", "husky", "hector_quadrotor", "ardrone2", "khepera4_camera", "bluerov2"] {
        let o = soifra(&["check", "--deny", "warnings", ROOM, "--platform", robot]);
        assert_eq!(code(&o), 0, "{robot}: {}", stderr(&o));
    }
}
