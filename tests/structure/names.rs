//! No Rust outside drivers and tests knows a robot or a paper: missions and profiles do.

use crate::support::{files, root};

/// Robots that profiles exist or will exist for, and roles of the papers' scenarios. A name stands for
/// itself in any case of letters, also inside longer words.
const NAMES: &[&str] = &[
    "khepera",
    "turtlebot",
    "kobuki",
    "husky",
    "ardrone",
    "ar.drone",
    "ar_drone",
    "parrot",
    "hector",
    "bluerov",
    "pioneer",
    "p3dx",
    "corobot",
    "disc_robot",
    "clearpath",
    "k-team",
    "stm32",
    "pandaboard",
    "referee",
    "vocalist",
    "navigator",
    "drive_me_crazy",
    "path_setter",
    "sim1",
    "sim2",
    "sim3",
    "sim4",
    "bench1",
    "bench2",
];

#[test]
fn rust_names_no_robot_and_no_paper() {
    let mut found = Vec::new();
    for path in files("", ".rs") {
        let relative = path.strip_prefix(root()).unwrap_or(&path).to_string_lossy().replace('\\', "/");
        let exempt = |folder: &str| {
            relative.starts_with(&format!("{folder}/")) || relative.contains(&format!("/{folder}/"))
        };
        if exempt("tests") || exempt("drivers") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            let lower = line.to_lowercase();
            found.extend(
                NAMES
                    .iter()
                    .filter(|n| lower.contains(**n))
                    .map(|n| format!("{relative}:{}: {n}", number + 1)),
            );
        }
    }
    assert!(found.is_empty(), "robots and roles belong into .soi files:\n{}", found.join("\n"));
}
