//! The bytes do not depend on the number of threads, nor on what the memory held before.

use soifra_camera::{Filter, Image, Lens, Scratch, View, noise, noise_in_bands, render};

use crate::support::{FULL, frame, lens, pose, room};

#[test]
fn any_number_of_bands_gives_the_same_bytes() {
    let (scene, parts) = room();
    let bent = Lens::from_distorted_field_of_view(376, 241, 2.2, Some([-0.03, 0.0005, 0.001, 0.0])).unwrap();
    for lens in [lens(), bent] {
        for filter in [Filter::Bilinear, Filter::Mipmap, Filter::Trilinear] {
            let pose = pose([-3.0, 0.2, 0.7], 0.1, 0.05, 0.1);
            let one = frame(&scene, &parts, &lens, pose, filter, 1);
            for bands in [0, 2, 3, 8, 1000] {
                assert!(frame(&scene, &parts, &lens, pose, filter, bands) == one, "{bands} bands");
            }
        }
    }
}

#[test]
fn memory_that_is_used_again_changes_nothing() {
    let (scene, parts) = room();
    let (mut image, mut scratch) = (Image::default(), Scratch::new());
    let small = Lens::from_field_of_view(63, 41, 1.0).unwrap();
    let bent = Lens { distortion: Some([-0.1, 0.01, 0.0, 0.0]), ..small };
    for (lens, yaw) in [(lens(), 0.0), (small, 1.0), (bent, 1.0), (lens(), 2.0), (bent, 0.0)] {
        let pose = pose([-3.0, 0.2, 0.7], 0.1, 0.05, yaw);
        let view = View { lens: &lens, pose, light: &FULL, filter: Filter::Mipmap };
        render(&scene, &parts, &view, 2, &mut image, &mut scratch);
        assert!(image == frame(&scene, &parts, &lens, pose, Filter::Mipmap, 1));
    }
}

#[test]
fn noise_does_not_depend_on_bands() {
    let mut one = Image::new(321, 243);
    one.data.fill(100);
    let mut many = one.clone();
    noise(&mut one, 3.0, 5, 9);
    for bands in [2, 3, 8] {
        many.data.fill(100);
        noise_in_bands(&mut many, 3.0, 5, 9, bands);
        assert!(one == many);
    }
}
