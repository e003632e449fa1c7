//! What the noise is like.

use soifra_camera::{Image, noise};

fn grey(level: u8) -> Image {
    let mut image = Image::new(640, 480);
    image.data.fill(level);
    image
}

/// Differences from the grey that was there.
fn added(sigma: f64, key: u64, frame: u64) -> Vec<f64> {
    let mut image = grey(128);
    noise(&mut image, sigma, key, frame);
    image.data.iter().map(|byte| f64::from(*byte) - 128.0).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let squares = |of: &[f64]| of.iter().map(|v| v * v).sum::<f64>();
    product / (squares(a) * squares(b)).sqrt()
}

#[test]
fn mean_and_sigma_are_what_was_asked_for() {
    for sigma in [0.3, 0.5, 1.0, 2.0, 5.0, 20.0] {
        let added = added(sigma, 7, 3);
        let mean = added.iter().sum::<f64>() / added.len() as f64;
        let square = added.iter().map(|v| v * v).sum::<f64>() / added.len() as f64;
        assert!(mean.abs() < 0.01 * sigma, "mean {mean} for {sigma}");
        assert!((square.sqrt() / sigma - 1.0).abs() < 0.03, "sigma {} for {sigma}", square.sqrt());
    }
}

#[test]
fn its_tails_are_the_normal_distributions() {
    let added = added(10.0, 1, 1);
    for (limit, share) in [(10.5, 0.2938), (20.5, 0.0404), (30.5, 0.00228)] {
        let beyond = added.iter().filter(|v| v.abs() > limit).count() as f64 / added.len() as f64;
        assert!((beyond / share - 1.0).abs() < 0.1, "{beyond} beyond {limit}");
    }
}

#[test]
fn neighbours_frames_and_keys_are_not_correlated() {
    let first = added(4.0, 7, 3);
    // A channel, a pixel, what shares hashes, a row on: each standard error is about 0.001.
    for apart in [1, 2, 3, 4, 5, 6, 15, 640 * 3 - 3, 640 * 3, 640 * 3 + 3] {
        let found = correlation(&first[apart..], &first[..first.len() - apart]);
        assert!(found.abs() < 0.005, "{found} at {apart}");
    }
    for (key, frame) in [(7, 4), (8, 3), (3, 7), (7, u64::MAX), (0, 0)] {
        let found = correlation(&first, &added(4.0, key, frame));
        assert!(found.abs() < 0.005, "{found} for {key}, {frame}");
    }
    assert!(first == added(4.0, 7, 3));
}

#[test]
fn it_saturates_and_ignores_what_is_no_sigma() {
    for level in [0, 255] {
        let mut image = grey(level);
        noise(&mut image, 50.0, 1, 1);
        let there = image.data.iter().filter(|byte| **byte == level).count();
        assert!((there as f64 / image.data.len() as f64 - 0.5).abs() < 0.02);
    }
    for sigma in [0.0, -1.0, f64::NAN] {
        let mut image = grey(77);
        noise(&mut image, sigma, 1, 1);
        assert!(image == grey(77));
    }
    for sigma in [f64::INFINITY, 1e300] {
        noise(&mut grey(77), sigma, 1, 1);
    }
    noise(&mut Image::default(), 2.0, 1, 1);
}
