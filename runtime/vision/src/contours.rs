//! Contours and segments: Canny and the probabilistic Hough transform, with thresholds given or found from the
//! image itself.

use opencv::core::{self, Mat, Scalar, Vec4i, Vector};
use opencv::imgproc;

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
    let lines = segments(image, low, high, how)?;
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

/// The bare calls: Canny, then Hough. Canny sees the derivative across the image only: contours that lie flat never
/// arise, nor their votes, which in a room of bricks and tiles are most of them. An edge that leans by θ shows
/// cos θ of its gradient.
fn segments(image: &Gray, low: f64, high: f64, how: &Contours) -> Result<Vector<Vec4i>, Why> {
    let mut contours = Mat::default();
    let mut across = Mat::default();
    let border = core::BORDER_REPLICATE;
    imgproc::sobel(&image.mat()?, &mut across, core::CV_16S, 1, 0, 3, 1.0, 0.0, border)?;
    let (rows, columns) = (image.height() as i32, image.width() as i32);
    let along = Mat::new_rows_cols_with_default(rows, columns, core::CV_16S, Scalar::all(0.0))?;
    imgproc::canny_derivative(&across, &along, &mut contours, low, high, false)?;
    let mut lines = Vector::<Vec4i>::new();
    imgproc::hough_lines_p(
        &contours,
        &mut lines,
        1.0,
        std::f64::consts::PI / 180.0,
        how.votes.max(1),
        how.shortest.max(1.0),
        how.gap.max(0.0),
    )?;
    Ok(lines)
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
