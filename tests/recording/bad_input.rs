//! Recordings that are none: a code, a hint and exit code 2 before anything starts, and never a panic.

use super::{
    MISSION,
    support::{SIZE, files, image, jpeg, png, png_of, y4m},
};
use crate::support::{code, file, folder, json, soifra, stderr};
use std::path::Path;

/// Refused with this code, in these words.
fn refused(arguments: &[&str], wanted: &str, says: &str) {
    let mut all = vec!["run"];
    all.extend(arguments);
    all.extend(["--trace", "none", "--format", "json"]);
    let o = soifra(&all);
    let text = stderr(&o);
    assert_eq!(code(&o), 2, "{all:?}: {text}");
    let first = &json(&o)["diagnostics"][0];
    assert_eq!(first["code"], wanted, "{all:?}: {text}");
    assert!(first["hint"].as_str().is_some_and(|h| !h.is_empty()), "{all:?}: no hint: {first}");
    // The report breaks lines where the terminal ends.
    let flat = text.replace("│", " ").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains(says), "{all:?}: {text}");
    assert!(!text.contains("panicked") && !text.contains("S9999"), "{text}");
}

fn reading(recording: &str, wanted: &str, says: &str) {
    refused(&[MISSION, "--recording", recording, "--rate", "20Hz"], wanted, says);
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

#[test]
fn nothing_there() {
    let dir = folder("recording_nothing");
    refused(&[MISSION], "S9030", "none is named");
    reading(&text(&dir.join("absent")), "S9031", "no such file or folder");
    reading(&text(&dir.join("absent/%04d.png")), "S9031", "no such file");
    reading(&text(&dir), "S9031", "no PNG or JPEG file");
    reading(&text(&dir.join("%d.png")), "S9031", "no file has a name like that");
    reading(&text(&dir.join("%x.png")), "S9031", "this pattern is not understood");
    reading(&file(&dir, "empty.y4m", ""), "S9031", "the file is empty");
    // A file that is no recording for a mission that takes none.
    refused(&["missions/soifra/room.soi", "--recording", &text(&dir)], "S9030", "reads a recording");
}

#[test]
fn what_is_no_image_or_not_all_of_one() {
    let dir = folder("recording_images");
    type Change = fn(Vec<u8>) -> Vec<u8>;
    type Case = (&'static str, &'static str, fn(usize) -> Vec<u8>, Change, &'static str);
    let half: Change = |mut b| {
        b.truncate(b.len() / 2);
        b
    };
    let damaged: Change = |mut b| {
        let middle = b.len() / 2;
        b[middle..].iter_mut().take(40).for_each(|x| *x = !*x);
        b
    };
    let cases: [Case; 6] = [
        ("png_half", "png", png, half, "image3.png: the file is cut off"),
        ("png_damaged", "png", png, damaged, "image3.png: a damaged PNG"),
        ("png_empty", "png", png, |_| Vec::new(), "image3.png: the file is empty"),
        ("jpeg_half", "jpg", jpeg, half, "image3.jpg: the file is cut off"),
        (
            "jpeg_end",
            "jpg",
            jpeg,
            |mut b| {
                b.truncate(b.len() - 2);
                b
            },
            "image3.jpg: the file is cut off",
        ),
        ("text", "jpg", jpeg, |_| b"no image".to_vec(), "image3.jpg: this is neither PNG nor JPEG"),
    ];
    for (name, ending, make, change, says) in cases {
        let folder = files(&dir.join(name), 6, ending, make);
        let third = dir.join(name).join(format!("image3.{ending}"));
        let bytes = change(std::fs::read(&third).expect("an image"));
        std::fs::write(&third, bytes).expect("an image");
        reading(&folder, "S9031", says);
    }
    reading(&text(&dir.join("png_half/image0.png")), "S9031", "this is one image");
}

#[test]
fn images_that_do_not_fit() {
    let dir = folder("recording_sizes");
    let folder = files(&dir.join("sizes"), 4, "png", png);
    let (width, height) = SIZE;
    let small: Vec<u8> = image(0)[..3 * width * (height - 2)].to_vec();
    std::fs::write(dir.join("sizes/image2.png"), png_of((width, height - 2), &small)).expect("an image");
    reading(&folder, "S9032", "image2.png has 320 x 238 pixels, those before it have 320 x 240");
    // Four channels of ink.
    let folder = files(&dir.join("inks"), 2, "jpg", |_| {
        let mut out = Vec::new();
        let pixels = vec![90; 4 * 64 * 48];
        let encoder = jpeg_encoder::Encoder::new(&mut out, 90);
        encoder.encode(&pixels, 64, 48, jpeg_encoder::ColorType::Cmyk).expect("a JPEG");
        out
    });
    reading(&folder, "S9032", "4 colour channels");
    // A camera that declares another size.
    let mission = file(
        &dir,
        "sized.soi",
        std::fs::read_to_string(crate::support::root().join(MISSION)).expect("the mission").replace(
            "platform my_camera extends recorded_camera {",
            "platform sized extends turtlebot2 {\n  drive = recorded()\n}\n\nplatform my_camera extends recorded_camera {",
        ),
    );
    let video = file(&dir, "box.y4m", y4m(3));
    refused(
        &[&mission, "--platform", "sized", "--recording", &video],
        "S9032",
        "declared with 640 x 480 pixels, the images have 320 x 240",
    );
}

#[test]
fn videos_that_cannot_be_read() {
    let dir = folder("recording_videos");
    let whole = y4m(4);
    let cut = |n: usize| whole[..whole.len() - n].to_vec();
    let with = |head: &str| [head.as_bytes(), b"\nFRAME\n", &[0; 64]].concat();
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (cut(1), "the file ends within frame 3"),
        (cut(SIZE.0 * SIZE.1 + 3), "the file ends within frame 3"),
        (b"YUV4MPEG2 W4 H4 F20:1\n".to_vec(), "it has no frames"),
        (b"YUV4MPEG2 W4 H4".to_vec(), "its first line does not end"),
        (with("YUV4MPEG2 W0 H4 F20:1"), "a width of \"0\" pixels"),
        (with("YUV4MPEG2 W4 H99999 F20:1"), "a height of \"99999\" pixels"),
        (with("YUV4MPEG2 H4 F20:1"), "no width or no height"),
        (with("YUV4MPEG2 W4 H4 F20:1 C420p10"), "colours are stored as \"420p10\""),
        (with("YUV4MPEG2 W4 H4 F20:1 It"), "interlaced"),
        (with("YUV4MPEG2 W4 H4 F20:1 A16:15"), "not square"),
        ([&whole[..], b"FRAMES OF SOMETHING"].concat(), "ends within frame 4"),
        ([&whole[..], b"GARBAGE\n", &[0; 64]].concat(), "something else"),
        (b"\0\0\0\x18ftypmp42....".to_vec(), "MP4 or MOV"),
        (b"RIFF1234AVI LIST".to_vec(), "AVI video"),
        (b"\x1a\x45\xdf\xa3........".to_vec(), "Matroska or WebM"),
        (b"something else entirely".to_vec(), "no format that can be read"),
    ];
    for (bytes, says) in cases {
        reading(&file(&dir, "video.y4m", bytes), "S9031", says);
    }
    reading(&file(&dir, "bad.mcap", b"\x89MCAP0\r\n"), "S9030", "no rate");
    let bad = file(&dir, "bad.mcap", b"\x89MCAP0\r\n");
    refused(&[MISSION, "--recording", &bad], "S9031", "ends before its header");
}

#[test]
fn a_trace_over_its_own_recording() {
    let dir = folder("recording_over");
    let video = file(&dir, "box.y4m", y4m(3));
    // Named on the command line, or in the profile.
    let shipped = std::fs::read_to_string(crate::support::root().join(MISSION)).expect("the mission");
    let drive =
        format!("platform my_camera extends recorded_camera {{\n  drive = recorded(file: \"{video}\")");
    let own = file(&dir, "own.soi", shipped.replace("platform my_camera extends recorded_camera {", &drive));
    for arguments in [vec!["run", MISSION, "--recording", &video], vec!["run", &own]] {
        let o = soifra(&[&arguments[..], &["--trace", &video]].concat());
        assert_eq!((code(&o), stderr(&o).contains("S9012")), (2, true), "{arguments:?}: {}", stderr(&o));
        assert_eq!(std::fs::read(&video).expect("the video"), y4m(3));
        let o = soifra(&[&arguments[..], &["--trace", "none"]].concat());
        assert_eq!(code(&o), 0, "{arguments:?}: {}", stderr(&o));
    }
}

#[test]
fn rates_that_are_none() {
    let dir = folder("recording_rates");
    let folder = files(&dir.join("png"), 2, "png", png);
    refused(&[MISSION, "--recording", &folder], "S9033", "nothing says how fast");
    for (rate, says) in [
        ("0Hz", "never follow each other"),
        ("-5Hz", "never follow each other"),
        ("20", ""),
        ("20 m", ""),
        ("nan", ""),
        ("3000000Hz", "cannot be played"),
        ("1e-18Hz", "cannot be played"),
    ] {
        refused(&[MISSION, "--recording", &folder, "--rate", rate], "S9033", says);
    }
    let (width, height) = SIZE;
    let timeless =
        [format!("YUV4MPEG2 W{width} H{height} F0:0 Cmono\nFRAME\n").into_bytes(), vec![9; width * height]];
    let timeless = file(&dir, "timeless.y4m", timeless.concat());
    refused(&[MISSION, "--recording", &timeless], "S9033", "nothing says how fast");
    // In a profile the check finds it.
    let text = std::fs::read_to_string(crate::support::root().join(MISSION)).expect("the mission");
    let zero = text.replace(
        "platform my_camera extends recorded_camera {",
        "platform my_camera extends recorded_camera {\n  drive = recorded(rate: 0 Hz)",
    );
    let o = soifra(&["check", &file(&dir, "zero.soi", zero)]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("must be above 0"), "{}", stderr(&o));
}

#[test]
fn sensors_that_were_not_recorded() {
    let dir = folder("recording_sensors");
    let video = file(&dir, "box.y4m", y4m(3));
    let mission = file(&dir, "drive.soi", super::DRIVING);
    refused(
        &[&mission, "--platform", "replayed", "--recording", &video],
        "S9030",
        "images alone have no readings of `odometry`",
    );
    // A robot that moves beside one that was recorded.
    let mixed =
        super::DRIVING.replace("  goal go", "  robot other: replayed at (-9 m, 5 m) runs watcher\n  goal go");
    let mixed = file(&dir, "mixed.soi", mixed);
    refused(&[&mixed, "--recording", &video], "S9030", "is simulated beside robots that are recorded");
    // A recorded camera on wheels that move.
    let wheels = super::DRIVING.replace(
        "drive = recorded()",
        "sensor camera = footage(field_of_view: 60 deg, at: (0 m, 0 m, 30 cm))",
    );
    let wheels = file(&dir, "wheels.soi", wheels.replace("scout: turtlebot2", "scout: replayed"));
    let o = soifra(&["check", &wheels]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("needs a recorded drive"), "{}", stderr(&o));
}

#[test]
fn an_image_that_goes_during_the_run() {
    // Whoever takes it away after it was looked at ends the run, and the trace says so.
    let dir = folder("recording_gone");
    files(&dir.join("png"), 4, "png", png);
    let paths = [0usize, 1, 2, 3].map(|n| dir.join(format!("png/image{n}.png")));
    assert!(paths.iter().all(|p| p.exists()));
    let text = std::fs::read_to_string(crate::support::root().join(MISSION)).expect("the mission");
    let slow = file(&dir, "slow.soi", text);
    let trace = text_of(&dir, "gone.mcap");
    let child = crate::support::command(&[
        "run",
        &slow,
        "--recording",
        &super::Path::new(&dir).join("png").to_string_lossy(),
        "--rate",
        "1Hz",
        "--realtime",
        "--trace",
        &trace,
    ])
    .stdin(std::process::Stdio::null())
    .stdout(std::process::Stdio::piped())
    .stderr(std::process::Stdio::piped())
    .spawn()
    .expect("the program starts");
    std::thread::sleep(std::time::Duration::from_millis(1_500));
    std::fs::remove_file(&paths[3]).expect("the last image");
    let o = child.wait_with_output().expect("it ends");
    assert_eq!(code(&o), 3, "{}", stderr(&o));
    assert!(String::from_utf8_lossy(&o.stdout).contains("image 3 of its recording"), "{}", stderr(&o));
}

fn text_of(dir: &Path, name: &str) -> String {
    dir.join(name).to_string_lossy().into_owned()
}
