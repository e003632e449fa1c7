//! Reference frames: a change of a single byte is seen. If it was meant, look at the frames (`cargo run --example
//! look`) and take over the new numbers.

use soifra_camera::{Filter, Lens, noise};

use crate::support::{digest, frame, lens, pose, room};

#[test]
fn reference_frames_are_what_they_were() {
    let (scene, parts) = room();
    let straight = frame(&scene, &parts, &lens(), pose([-3.0, 0.2, 0.7], 0.1, 0.05, 0.1), Filter::Mipmap, 2);
    let bent =
        Lens::from_distorted_field_of_view(752, 480, 2.2863, Some([-0.035, 0.0006, 0.001, -0.0005])).unwrap();
    let wide = frame(&scene, &parts, &bent, pose([1.0, 0.4, 0.4], 0.0, -0.1, 2.9), Filter::Trilinear, 1);
    let mut noisy =
        frame(&scene, &parts, &lens(), pose([0.2, 0.1, 1.5], -0.2, 0.4, -0.7), Filter::Bilinear, 3);
    noise(&mut noisy, 2.0, 42, 7);
    let found = [straight, wide, noisy].map(|image| format!("{:016x}", digest(&image.data)));
    assert_eq!(found, ["2b85230d887190fc", "1c0c571af87b3dcd", "d38c893ef297fe50"]);
}
