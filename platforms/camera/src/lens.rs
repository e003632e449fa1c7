//! Where on the image a point is seen, and what a pixel looks at.

use core::fmt;

use crate::geometry::Point;

/// A camera's intrinsic parameters: a pinhole, and the Brown-Conrady distortion as OpenCV has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Focal length in pixels along x.
    pub fx: f64,
    /// Focal length in pixels along y.
    pub fy: f64,
    /// Optical centre in pixels along x.
    pub cx: f64,
    /// Optical centre in pixels along y.
    pub cy: f64,
    /// k1, k2, p1, p2; none for a pinhole.
    pub distortion: Option<[f64; 4]>,
}

/// Why there is no such lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensError {
    /// No pixels, or more than [`Lens::MOST_PIXELS`] along a side.
    Size,
    /// A horizontal field of view that is not between 0 and half a turn.
    FieldOfView,
    /// A focal length that is not positive, or any parameter that is not a number or beyond a million.
    Parameters,
}

impl fmt::Display for LensError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => write!(f, "an image has 1 to {} pixels along each side", Lens::MOST_PIXELS),
            Self::FieldOfView => f.write_str("a field of view is between 0 and 180 degrees"),
            Self::Parameters => {
                f.write_str("focal lengths are positive, and no parameter is beyond a million")
            }
        }
    }
}

impl core::error::Error for LensError {}

/// Pixels: a longer focal length or a centre farther aside is none of a camera.
const MOST_FOCAL: f64 = 1e6;

/// Steps of Newton's method: from a good start four are enough.
const STEPS: usize = 12;

/// In focal lengths: how near a distorted point must come to the one asked for.
const CLOSE: f64 = 1e-11;

impl Lens {
    /// Along each side.
    pub const MOST_PIXELS: usize = 8192;

    /// A pinhole with square pixels, centred, whose rows see `horizontal` radians.
    ///
    /// # Errors
    /// If there is no such lens.
    pub fn from_field_of_view(width: usize, height: usize, horizontal: f64) -> Result<Self, LensError> {
        Self::from_distorted_field_of_view(width, height, horizontal, None)
    }

    /// As [`Self::from_field_of_view`], with a distortion: the middle row still sees `horizontal` radians (tangential
    /// terms left aside), so the focal length is larger the more the lens draws its image together.
    ///
    /// # Errors
    /// If there is no such lens.
    pub fn from_distorted_field_of_view(
        width: usize,
        height: usize,
        horizontal: f64,
        distortion: Option<[f64; 4]>,
    ) -> Result<Self, LensError> {
        if !(horizontal > 0.0 && horizontal < core::f64::consts::PI) {
            return Err(LensError::FieldOfView);
        }
        let edge = libm::tan(horizontal / 2.0);
        let radial = distortion.map_or(1.0, |[k1, k2, ..]| 1.0 + edge * edge * (k1 + edge * edge * k2));
        let focal = width as f64 / 2.0 / (edge * radial);
        let (cx, cy) = (width as f64 / 2.0, height as f64 / 2.0);
        let lens = Self { width, height, fx: focal, fy: focal, cx, cy, distortion };
        // Beyond the radius where the distortion turns back, one pixel would see two directions.
        if edge > lens.widest() {
            return Err(LensError::FieldOfView);
        }
        lens.check().map(|()| lens)
    }

    /// # Errors
    /// If one cannot render through it.
    pub fn check(&self) -> Result<(), LensError> {
        if [self.width, self.height].iter().any(|side| !(1..=Self::MOST_PIXELS).contains(side)) {
            return Err(LensError::Size);
        }
        let focal = [self.fx, self.fy].iter().all(|f| *f > 0.0 && *f <= MOST_FOCAL);
        let rest = [self.cx, self.cy].into_iter().chain(self.distortion.unwrap_or_default());
        if focal && rest.into_iter().all(|c| c.abs() <= MOST_FOCAL) {
            Ok(())
        } else {
            Err(LensError::Parameters)
        }
    }

    /// Where a point of the camera's frame (x forward, y left, z up) is seen, in pixels, within the image or not;
    /// none if it is not before the camera or so far aside that the distortion is not defined.
    #[must_use]
    pub fn project(&self, point: Point) -> Option<[f64; 2]> {
        let [forward, left, up] = point;
        if forward.is_nan() || forward <= 0.0 {
            return None;
        }
        let (x, y) = (-left / forward, -up / forward);
        let (x, y) = match self.distortion {
            None => (x, y),
            Some(_) if (x * x + y * y).sqrt() > self.widest() => return None,
            Some(coefficients) => distort(coefficients, x, y),
        };
        let pixel = [self.fx * x + self.cx, self.fy * y + self.cy];
        pixel.iter().all(|c| c.is_finite()).then_some(pixel)
    }

    /// The direction, of unit length in the camera's frame, that is seen at a place of the image in pixels; none
    /// if nothing is seen there.
    #[must_use]
    pub fn unproject(&self, pixel: [f64; 2]) -> Option<Point> {
        let (x, y) = ((pixel[0] - self.cx) / self.fx, (pixel[1] - self.cy) / self.fy);
        let (x, y) = self.straighten(x, y)?;
        let length = (1.0 + x * x + y * y).sqrt();
        length.is_finite().then(|| [1.0 / length, -x / length, -y / length])
    }

    /// From distorted to straight image coordinates, both in focal lengths from the centre.
    pub(crate) fn straighten(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        let Some(coefficients) = self.distortion else { return Some((x, y)) };
        // The radial part alone, by bisection, is a start from which Newton's method does not stray.
        let (wanted, widest) = ((x * x + y * y).sqrt(), self.widest());
        let (mut low, mut high) = (0.0, widest.min(1e3));
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            if radial(coefficients, middle) < wanted { low = middle } else { high = middle }
        }
        let grow = if wanted > 0.0 { (low + high) / 2.0 / wanted } else { 1.0 };
        let (mut a, mut b) = (x * grow, y * grow);
        for _ in 0..STEPS {
            let (fa, fb) = distort(coefficients, a, b);
            let (ea, eb) = (fa - x, fb - y);
            let [[aa, ab], [ba, bb]] = slope(coefficients, a, b);
            let determinant = aa * bb - ab * ba;
            if determinant.abs() < 1e-9 {
                break;
            }
            a -= (ea * bb - eb * ab) / determinant;
            b -= (eb * aa - ea * ba) / determinant;
        }
        let (fa, fb) = distort(coefficients, a, b);
        let met = (fa - x).abs() < CLOSE && (fb - y).abs() < CLOSE;
        (met && (a * a + b * b).sqrt() <= widest).then_some((a, b))
    }

    /// The radius, in focal lengths, up to which the radial distortion grows; beyond, it would fold back.
    fn widest(&self) -> f64 {
        let [k1, k2, ..] = self.distortion.unwrap_or_default();
        // 1 + 3 k1 s + 5 k2 s² = 0 in s, the radius squared.
        let (a, b) = (5.0 * k2, 3.0 * k1);
        let under = b * b - 4.0 * a;
        if under < 0.0 {
            return f64::INFINITY;
        }
        // The form of the quadratic's solution that does not cancel: s = 2c / (-b ± root), c = 1.
        let root = under.sqrt();
        let first = [2.0 / (-b + root), 2.0 / (-b - root)]
            .into_iter()
            .filter(|s| *s > 0.0)
            .fold(f64::INFINITY, |least, s| if s < least { s } else { least });
        first.sqrt()
    }
}

/// The radial distortion alone of a radius.
fn radial([k1, k2, ..]: [f64; 4], r: f64) -> f64 {
    r * (1.0 + r * r * (k1 + r * r * k2))
}

/// OpenCV's distortion of straight image coordinates.
fn distort([k1, k2, p1, p2]: [f64; 4], x: f64, y: f64) -> (f64, f64) {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * k2);
    (
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )
}

/// Its derivatives: rows x', y'; columns by x, by y.
fn slope([k1, k2, p1, p2]: [f64; 4], x: f64, y: f64) -> [[f64; 2]; 2] {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * k2);
    let growth = 2.0 * k1 + 4.0 * k2 * r2;
    let both = x * y * growth + 2.0 * p1 * x + 2.0 * p2 * y;
    [
        [radial + x * x * growth + 2.0 * p1 * y + 6.0 * p2 * x, both],
        [both, radial + y * y * growth + 6.0 * p1 * y + 2.0 * p2 * x],
    ]
}
