//! Contours and segments: Canny and the probabilistic Hough transform, with thresholds given or found from the
//! image itself.

use opencv::core::{self, Mat, Vec4i, Vector};
use opencv::{imgproc, prelude::*};
use std::cell::RefCell;

use crate::image::Gray;
use crate::segment::{Merging, Segment, merge};
use crate::why::Why;

/// Thresholds of Canny, in grey levels of the 3 x 3 Sobel derivative across the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thresholds {
    /// Found for each image from its noise and the strength of its gradients, so that they follow the lighting.
    Automatic,
    /// Given.
    Fixed {
        /// A contour goes on where the gradient is at least this.
        low: f64,
        /// A contour begins where the gradient is at least this.
        high: f64,
    },
}

/// Parameters of Hough's transform and of the choice among its segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contours {
    /// Canny's thresholds.
    pub thresholds: Thresholds,
    /// Votes that a line needs.
    pub votes: i32,
    /// Shortest segment, pixels.
    pub shortest: f64,
    /// Largest gap bridged within a segment, pixels.
    pub gap: f64,
    /// Largest deviation from roll-compensated vertical, radians.
    pub tolerance: f64,
    /// How pieces are merged.
    pub merging: Merging,
}

impl Default for Contours {
    fn default() -> Self {
        Self {
            thresholds: Thresholds::Automatic,
            votes: 30,
            shortest: 30.0,
            gap: 6.0,
            tolerance: 0.14,
            merging: Merging { across: 2.0, gap: 60.0 },
        }
    }
}

/// The roll-compensated near-vertical segments of `image`, merged, ordered by x. `roll` in radians, to the right
/// positive.
///
/// # Errors
/// [`Why::NoFeatures`] when there is none; [`Why::BadNumber`] for parameters or a roll that are not finite.
pub fn verticals(image: &Gray, roll: f64, how: &Contours) -> Result<Vec<Segment>, Why> {
    if ![roll, how.shortest, how.gap, how.tolerance].iter().all(|v| v.is_finite()) {
        return Err(Why::BadNumber);
    }
    let (low, high) = thresholds(image, how.thresholds)?;
    let lines = segments(image, (low, high), roll, how)?;
    let upright: Vec<Segment> = lines
        .iter()
        .map(|l| Segment::new([f64::from(l[0]), f64::from(l[1])], [f64::from(l[2]), f64::from(l[3])]))
        .filter(|s| s.off_vertical(roll) <= how.tolerance)
        .collect();
    if upright.is_empty() {
        return Err(Why::NoFeatures);
    }
    Ok(merge(&upright, &how.merging))
}

/// How far the direction of a gradient may be off that of an upright edge, beyond the tolerance, radians: at the lower
/// threshold, three standard deviations of the noise, the direction of a gradient scatters by a third.
const SCATTER: f64 = 0.35;

/// The bare calls: Canny, then Hough. Canny sees the derivative across the image only, and that only where it points
/// across an edge that may be upright: what lies flat or leans never becomes a contour, nor a vote, which in a room of
/// bricks, tiles and speckle are most of them.
fn segments(image: &Gray, (low, high): (f64, f64), roll: f64, how: &Contours) -> Result<Vector<Vec4i>, Why> {
    SPACE.with_borrow_mut(|(across, along, contours)| {
        derive(image, roll, how, (across, along))?;
        imgproc::canny_derivative(across, along, contours, low, high, false)?;
        let mut lines = Vector::<Vec4i>::new();
        imgproc::hough_lines_p(
            contours,
            &mut lines,
            1.0,
            std::f64::consts::PI / 180.0,
            how.votes.max(1),
            how.shortest.max(1.0),
            how.gap.max(0.0),
        )?;
        Ok(lines)
    })
}

thread_local! {
    /// Space for derivatives and contours, kept from image to image: to ask the system for two megabytes each time costs
    /// more than to fill them.
    static SPACE: RefCell<(Mat, Mat, Mat)> = RefCell::default();
}

/// The derivatives across and along the image (3 x 3 Sobel, 16 bits) that Canny is given: those across where an edge may
/// be upright, none along.
///
/// # Errors
/// Those of OpenCV.
pub fn derivatives(image: &Gray, roll: f64, how: &Contours) -> Result<(Mat, Mat), Why> {
    let (mut across, mut along) = (Mat::default(), Mat::default());
    derive(image, roll, how, (&mut across, &mut along))?;
    Ok((across, along))
}

fn derive(image: &Gray, roll: f64, how: &Contours, (across, along): (&mut Mat, &mut Mat)) -> Result<(), Why> {
    let border = core::BORDER_REPLICATE;
    let grey = image.mat()?;
    imgproc::sobel(&grey, across, core::CV_16S, 1, 0, 3, 1.0, 0.0, border)?;
    imgproc::sobel(&grey, along, core::CV_16S, 0, 1, 3, 1.0, 0.0, border)?;
    upright(across.data_typed_mut()?, along.data_typed_mut()?, how.tolerance + roll.abs() + SCATTER);
    Ok(())
}

/// Leaves of the derivatives across the image those whose gradient is at most `lean` radians off level; those along the
/// image are cleared.
fn upright(across: &mut [i16], along: &mut [i16], lean: f64) {
    // In units of 1/256, so that whole numbers do; steeper than that everything is left.
    let slope = if (0.0..1.5).contains(&lean) { (256.0 * libm::tan(lean)) as i32 } else { 4096 };
    for (x, y) in across.iter_mut().zip(along) {
        let flat = 256 * i32::from(*y).abs() > slope * i32::from(*x).abs();
        *x = if flat { 0 } else { *x };
        *y = 0;
    }
}

/// Canny's thresholds (low, high) for this image.
///
/// # Errors
/// [`Why::BadNumber`] for fixed thresholds that are not finite or not ordered.
pub fn thresholds(image: &Gray, wanted: Thresholds) -> Result<(f64, f64), Why> {
    match wanted {
        Thresholds::Fixed { low, high }
            if low.is_finite() && high.is_finite() && 0.0 <= low && low <= high =>
        {
            Ok((low, high))
        }
        Thresholds::Fixed { .. } => Err(Why::BadNumber),
        Thresholds::Automatic => Ok(automatic(image)),
    }
}

/// Rows and columns between the samples of the automatic thresholds.
const STRIDE: usize = 4;
/// The share of samples whose gradient is weaker than the upper threshold, before it is bounded by the noise.
const QUANTILE: f64 = 0.90;
/// Upper threshold in standard deviations of the gradient that noise alone gives.
const ABOVE_NOISE: f64 = 6.0;
/// Neither darkness nor a crowded picture shall push the upper threshold beyond these.
const BOUNDS: (f64, f64) = (24.0, 130.0);

/// Upper threshold: the quantile of the sampled Sobel derivatives, not below the noise; the lower is half of it. The
/// noise is the median absolute second difference along rows (for white noise 0.6745·√6·σ; 3 x 3 Sobel makes √12·σ
/// of it).
fn automatic(image: &Gray) -> (f64, f64) {
    let mut gradients = [0u32; 256]; // in steps of 8
    let mut seconds = [0u32; 512];
    let mut count = 0u32;
    for y in (1..image.height() - 1).step_by(STRIDE) {
        let (above, here, below) = (image.row(y - 1), image.row(y), image.row(y + 1));
        for x in (1..image.width() - 1).step_by(STRIDE) {
            let at = |row: &[u8], x: usize| i32::from(row[x]);
            let right = at(above, x + 1) + 2 * at(here, x + 1) + at(below, x + 1);
            let left = at(above, x - 1) + 2 * at(here, x - 1) + at(below, x - 1);
            let gradient = (right - left).unsigned_abs();
            gradients[(gradient as usize / 8).min(255)] += 1;
            let second = (at(here, x - 1) + at(here, x + 1) - 2 * at(here, x)).unsigned_abs();
            seconds[(second as usize).min(511)] += 1;
            count += 1;
        }
    }
    let noise = quantile(&seconds, count, 0.5) / (0.6745 * 2.449_489_742_783_178);
    let floor = ABOVE_NOISE * 3.464_101_615_137_754_6 * noise;
    let high = (8.0 * quantile(&gradients, count, QUANTILE)).max(floor).clamp(BOUNDS.0, BOUNDS.1);
    (high / 2.0, high)
}

/// The value below which `share` of the counts lie, interpolated within its bin.
fn quantile(counts: &[u32], total: u32, share: f64) -> f64 {
    let wanted = f64::from(total) * share;
    let mut below = 0.0;
    for (bin, &n) in counts.iter().enumerate() {
        let n = f64::from(n);
        if below + n >= wanted && n > 0.0 {
            return bin as f64 + (wanted - below) / n;
        }
        below += n;
    }
    0.0
}
