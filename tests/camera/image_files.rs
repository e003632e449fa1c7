//! Image files on things: cameras see them, imports name them from their own folder, and a replay notices another file.

use crate::support::{code, folder, root, soifra, stderr};
use std::{fs, path::Path};

/// A hall with a sign, in a folder of its own, imported.
const HALL: &str = "edition 1

world hall {
  bounds = rectangle(low: (-1 m, -1 m), high: (5 m, 3 m))
  material sign = image(\"signs/sign.png\", width: 80 cm)
  wall north = segment(from: (0 m, 2 m), to: (4 m, 2 m), height: 1 m, material: \"sign\")
}
";

const MISSION: &str = "edition 1
import \"halls/hall.soi\"

agent watcher {
  sensor camera: Image
  actuator base: Twist
  state light: Number = 0

  service watch on sensor camera {
    set light = brightness(camera)
    command base twist(0 m/s)
  }
}

mission signs {
  world hall
  robot a: turtlebot2 at pose((2 m, 0 m), 90 deg) runs watcher
  goal seen { subgoal see by watcher achieved when light > 0 }
  done when achieved(seen)
  within 2 s
  metric light = a.watcher.light
}
";

/// A PNG of one row, three bytes a pixel.
fn png(path: &Path, pixels: &[u8]) {
    let file = fs::File::create(path).expect("a file");
    let mut encoder = png::Encoder::new(file, (pixels.len() / 3) as u32, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut w| w.write_image_data(pixels)).expect("an image");
}

#[test]
fn image_files_are_seen_and_another_one_refuses_the_replay() {
    let dir = folder("image_files");
    fs::create_dir_all(dir.join("halls/signs")).expect("folders");
    fs::write(dir.join("halls/hall.soi"), HALL).expect("a world");
    fs::write(dir.join("signs.soi"), MISSION).expect("a mission");
    let (mission, sign) = (dir.join("signs.soi"), dir.join("halls/signs/sign.png"));
    let mission = mission.to_string_lossy();
    let trace = dir.join("a.mcap").to_string_lossy().into_owned();

    png(&sign, &[255, 0, 0, 0, 0, 255]);
    let o = soifra(&["run", &mission, "--trace", &trace]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let sheet = dir.join("a.png").to_string_lossy().into_owned();
    for way in [
        &["replay", &trace][..],
        &["replay", "--recorded", &trace],
        &["plot", "--kind", "frames", &trace, "-o", &sheet],
        &["sweep", &mission, "--seeds", "2"],
    ] {
        let o = soifra(way);
        assert_eq!(code(&o), 0, "{way:?}: {}", stderr(&o));
    }
    // Red and blue are on the sheet, and nothing of the kind where there is no such file.
    let seen = soifra::recording::decode(&fs::read(&sheet).expect("a sheet")).expect("a picture");
    let many = |which: fn(&[u8]) -> bool| seen.data.chunks_exact(3).filter(|p| which(p)).count();
    assert!(many(|p| p[0] > 100 && p[1] < 60 && p[2] < 60) > 1000);
    assert!(many(|p| p[2] > 100 && p[0] < 60 && p[1] < 60) > 1000);

    png(&sign, &[255, 0, 0, 0, 0, 254]);
    for way in
        [&["replay", &trace][..], &["replay", "--recorded", &trace], &["plot", "--kind", "frames", &trace]]
    {
        let o = soifra(way);
        assert_eq!(code(&o), 2, "{way:?}");
        assert!(stderr(&o).contains("S9035") && stderr(&o).contains("sign.png"), "{}", stderr(&o));
    }
    fs::remove_file(&sign).expect("a file");
    let o = soifra(&["run", &mission, "--trace", "none"]);
    assert_eq!(code(&o), 2);
    assert!(stderr(&o).contains("S9034"), "{}", stderr(&o));
}

#[test]
fn a_graph_names_images_from_the_folder_of_its_mission() {
    let path = root().join("missions/soifra/posters.soi").to_string_lossy().into_owned();
    let from_elsewhere = soifra::compile::compile(&path, None).expect("a sound mission");
    let here = soifra::compile::compile("missions/soifra/posters.soi", None).expect("a sound mission");
    assert!(from_elsewhere.graph == here.graph);
    assert_eq!(here.images.iter().map(|i| i.name.as_str()).collect::<Vec<_>>(), ["posters/warning.png"]);
}
