//! Where an image shows the shape of a person: histograms of oriented gradients (Dalal and Triggs 2005) with OpenCV's detector of
//! whole people, which is trained on photographs.
//!
//! A person stands on the ground. So the detector is not run over all places and sizes, but for each of a few distances over the
//! strip of the image in which a person there would be, brought to the size that the detector knows.

use crate::{
    ground::{Ground, size},
    image::Gray,
    why::Why,
};
use opencv::{
    core::{self, Mat, Point, Rect, Scalar, Size, Vector},
    imgproc,
    objdetect::HOGDescriptor,
    prelude::*,
};

/// The shape of a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Metres ahead and left of the camera's foot.
    pub place: [f64; 2],
    /// Distance from the boundary of the classifier, towards people.
    pub score: f64,
}

/// Where shapes are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Searching {
    /// Metres; nearer, and a person is not in the image as a whole.
    pub nearest: f64,
    /// Metres.
    pub farthest: f64,
    /// Distance by distance before.
    pub step: f64,
    /// Metres that a person is taken to be tall.
    pub height: f64,
    /// The least score.
    pub least: f64,
}

impl Default for Searching {
    fn default() -> Self {
        Self { nearest: 3.2, farthest: 10.0, step: 1.18, height: 1.72, least: 0.3 }
    }
}

/// The detector's window, pixels; a person in it has [`TALL`], with a margin above and below.
const WINDOW: [i32; 2] = [64, 128];
const TALL: f64 = 96.0;
const MARGIN: f64 = 16.0;

/// Pixels that the window may go up and down beyond.
const PLAY: i32 = 8;

/// No image is enlarged by more.
const ENLARGED: f64 = 1.5;

/// The shapes of people, the surest first; of several at one bearing the surest alone.
///
/// # Errors
/// Those of [`Gray::lit`], [`Why::BadLens`], [`Why::BadNumber`] for a camera that is not over the ground.
pub fn shapes(image: &Gray, ground: &Ground, how: &Searching) -> Result<Vec<Shape>, Why> {
    image.lit()?;
    ground.lens.check()?;
    if !(ground.height > 0.0 && ground.height < 100.0 && ground.attitude.is_finite()) {
        return Err(Why::BadNumber);
    }
    let mut hog = HOGDescriptor::default()?;
    hog.set_svm_detector(HOGDescriptor::get_default_people_detector()?);
    let whole = image.mat()?;
    let mut found: Vec<(Shape, f64, f64)> = Vec::new();
    let mut distance = how.nearest;
    while distance <= how.farthest && how.step > 1.0 && found.len() < 1000 {
        found.extend(strip(&hog, &whole, size(image), ground, distance, how)?);
        distance *= how.step;
    }
    found.sort_by(|a, b| b.0.score.total_cmp(&a.0.score));
    let mut kept: Vec<(Shape, f64, f64)> = Vec::new();
    for f in found {
        // One hides the other.
        if kept.iter().all(|k| (k.1 - f.1).abs() > 0.5 * k.2.max(f.2)) {
            kept.push(f);
        }
    }
    Ok(kept.into_iter().map(|f| f.0).collect())
}

/// The shapes at a distance, each with its column and width in pixels.
fn strip(
    hog: &HOGDescriptor,
    whole: &impl core::MatTraitConst,
    (width, height): (usize, usize),
    ground: &Ground,
    distance: f64,
    how: &Searching,
) -> Result<Vec<(Shape, f64, f64)>, Why> {
    let ends = [0.0, how.height].map(|up| ground.pixel([distance, 0.0, up]));
    let [Some([_, foot]), Some([_, head])] = ends else { return Ok(Vec::new()) };
    let tall = foot - head;
    let scale = TALL / tall;
    if !(tall > 1.0) || scale > ENLARGED {
        return Ok(Vec::new());
    }
    let rows = WINDOW[1] + 2 * PLAY;
    let top = foot - (f64::from(WINDOW[1]) - MARGIN + f64::from(PLAY)) / scale;
    let bottom = top + f64::from(rows) / scale;
    let first = top.clamp(0.0, height as f64).round() as i32;
    let last = bottom.clamp(0.0, height as f64).round() as i32;
    let wide = (width as f64 * scale).round() as i32;
    let inner = (f64::from(last - first) * scale).round() as i32;
    if inner < WINDOW[1] / 2 || wide < WINDOW[0] {
        return Ok(Vec::new());
    }
    let part = Mat::roi(whole, Rect::new(0, first, width as i32, last - first))?;
    let mut small = Mat::default();
    imgproc::resize(&part, &mut small, Size::new(wide, inner), 0.0, 0.0, imgproc::INTER_AREA)?;
    let above = ((f64::from(first) - top) * scale).round().max(0.0) as i32;
    let below = (rows - inner - above).max(0);
    let mut padded = Mat::default();
    core::copy_make_border(
        &small,
        &mut padded,
        above,
        below,
        0,
        0,
        core::BORDER_REPLICATE,
        Scalar::default(),
    )?;
    let (mut places, mut scores) = (Vector::<Point>::new(), Vector::<f64>::new());
    hog.detect_weights(
        &padded,
        &mut places,
        &mut scores,
        how.least,
        Size::new(8, 8),
        Size::new(0, 0),
        &Vector::new(),
    )?;
    let shape = |(p, score): (Point, f64)| {
        let x = (f64::from(p.x) + 0.5 * f64::from(WINDOW[0])) / scale;
        let y = top + (f64::from(p.y + WINDOW[1]) - MARGIN) / scale;
        // The foot of somebody at that distance is less sure than the distance.
        let near = ground.place(x, y).map(|p| libm::hypot(p[0], p[1]) / distance);
        let [a, l] = ground.place(x, foot)?;
        let by = near.unwrap_or(1.0).clamp(1.0 / how.step, how.step);
        Some((Shape { place: [a * by, l * by], score }, x, 0.4 * tall))
    };
    Ok(places.iter().zip(scores.iter()).filter_map(shape).collect())
}
