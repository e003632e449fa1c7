//! `test`: test blocks and goldens.

use super::{MISSION, mission};
use crate::support::{code, file, folder, json, soifra, stderr, stdout};

#[test]
fn tests_pass_and_fail() {
    let dir = folder("test_blocks");
    let path = mission(&dir);
    let o = soifra(&["test", &path]);
    assert_eq!(code(&o), 0, "{}{}", stdout(&o), stderr(&o));
    assert!(stdout(&o).contains("1 passed, 0 failed"));
    file(&dir, "strict.soi", MISSION.replace("way <= 3.2 m", "way <= 1 m"));
    let o = soifra(&["test", &dir.to_string_lossy(), "--format", "json"]);
    let d = json(&o);
    assert_eq!((code(&o), d["passed"].clone(), d["failed"].clone()), (1, 1.into(), 1.into()));
    assert!(stderr(&o).contains("S9022"), "{}", stderr(&o));
    let o = soifra(&["test", &file(&dir, "none.soi", MISSION.split("test errands").next().unwrap())]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("S9021"));
}

#[test]
fn goldens_are_accepted_and_compared() {
    let dir = folder("test_goldens");
    let path = mission(&dir);
    assert_eq!(code(&soifra(&["test", &path, "--accept"])), 0);
    assert!(dir.join("golden/errand.json").exists());
    let o = soifra(&["test", &path]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    assert!(stdout(&o).contains("2 passed, 0 failed"), "{}", stdout(&o));
    file(&dir, "errand.soi", MISSION.replace("0.5 m/s", "0.4 m/s"));
    let o = soifra(&["test", &path]);
    assert_eq!(code(&o), 1);
    assert!(stderr(&o).contains("S9019"), "{}", stderr(&o));
    assert_eq!(code(&soifra(&["test", &path, "--accept"])), 0);
    assert_eq!(code(&soifra(&["test", &path])), 0);
}
