//! Recordings to try things on: a box that comes nearer, in every form that can be read.

use std::path::Path;

/// Pixels of the images.
pub const SIZE: (usize, usize) = (320, 240);

/// Images a second.
pub const RATE: f64 = 20.0;

/// Where the box is at the first image, m, and how fast it comes nearer, m/s.
const FROM: f64 = 6.0;
const SPEED: f64 = 1.0;

/// When it is met, counted from an image, s.
pub fn contact(image: usize) -> f64 {
    FROM / SPEED - image as f64 / RATE
}

/// An image as RGB: a box 0.8 m wide in the middle, before a wall far away, through a lens that sees 60 degrees.
pub fn image(number: usize) -> Vec<u8> {
    let (width, height) = SIZE;
    let focal = width as f64 / 2.0 / libm::tan(30f64.to_radians());
    let half = 0.4 * focal / (FROM - SPEED * number as f64 / RATE);
    let centre = width as f64 / 2.0;
    let mut out = Vec::with_capacity(3 * width * height);
    for row in 0..height {
        for column in 0..width {
            // How much of the pixel the box covers.
            let off = (column as f64 + 0.5 - centre).abs();
            let cover = (half - off + 0.5).clamp(0.0, 1.0);
            let grain = ((row * 7919 + column * 104_729 + (row * column) % 31) % 8) as f64;
            let value = (170.0 - 110.0 * cover + grain) as u8;
            out.extend([value, value.saturating_sub(8), value / 2]);
        }
    }
    out
}

/// A PNG of it.
pub fn png(number: usize) -> Vec<u8> {
    png_of(SIZE, &image(number))
}

/// A PNG of RGB pixels.
pub fn png_of((width, height): (usize, usize), data: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a PNG");
    writer.write_image_data(data).expect("pixels");
    writer.finish().expect("a PNG");
    out
}

/// A JPEG of it.
pub fn jpeg(number: usize) -> Vec<u8> {
    let mut out = Vec::new();
    let (width, height) = (SIZE.0 as u16, SIZE.1 as u16);
    let encoder = jpeg_encoder::Encoder::new(&mut out, 95);
    encoder.encode(&image(number), width, height, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    out
}

/// A Y4M of so many of them, luma alone.
pub fn y4m(images: usize) -> Vec<u8> {
    let (width, height) = SIZE;
    let mut out = format!("YUV4MPEG2 W{width} H{height} F20:1 Ip A1:1 Cmono\n").into_bytes();
    for number in 0..images {
        out.extend(b"FRAME\n");
        out.extend(image(number).chunks_exact(3).map(|p| p[0]));
    }
    out
}

/// A folder of so many files that `make` makes, `NAME0.ENDING` and so on.
pub fn files(folder: &Path, images: usize, ending: &str, make: fn(usize) -> Vec<u8>) -> String {
    std::fs::create_dir_all(folder).expect("a folder");
    for number in 0..images {
        std::fs::write(folder.join(format!("image{number}.{ending}")), make(number)).expect("an image");
    }
    folder.to_string_lossy().into_owned()
}
