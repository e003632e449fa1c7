//! Images of a distorting lens as an ideal one would have taken them: straight things are straight again.

use opencv::core::{self, Mat, Scalar, Vec2f};
use opencv::imgproc;

use crate::image::Gray;
use crate::lens::Lens;
use crate::why::Why;

/// Where each pixel of the rectified image comes from: made once for a lens, the caller's to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Rectification {
    width: usize,
    height: usize,
    source: (usize, usize),
    places: Vec<Vec2f>,
}

impl Rectification {
    /// From a `lens` with images of `source` (width, height) pixels to the ideal lens `target` with images of
    /// `width` x `height`.
    ///
    /// # Errors
    /// [`Why::BadLens`], also for a target with distortion; [`Why::WrongSize`] for sizes out of range.
    pub fn new(
        lens: &Lens,
        source: (usize, usize),
        target: &Lens,
        width: usize,
        height: usize,
    ) -> Result<Self, Why> {
        lens.check()?;
        target.check()?;
        if target.distortion.is_some() {
            return Err(Why::BadLens);
        }
        let fits = |n: usize| (crate::image::SMALLEST..=crate::image::LARGEST).contains(&n);
        if ![width, height, source.0, source.1].iter().all(|&n| fits(n)) {
            return Err(Why::WrongSize);
        }
        let mut places = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let at = target.normalise(x as f64, y as f64).and_then(|at| lens.project(at));
                // Far outside: filled with black.
                let [x, y] = at.unwrap_or([-1e4, -1e4]);
                places.push(Vec2f::from([x.clamp(-1e4, 1e6) as f32, y.clamp(-1e4, 1e6) as f32]));
            }
        }
        Ok(Self { width, height, source, places })
    }

    /// The rectified image, bilinear; black where the lens did not look.
    ///
    /// # Errors
    /// [`Why::WrongSize`] for an image of another size.
    pub fn apply(&self, image: &Gray) -> Result<Gray, Why> {
        if (image.width(), image.height()) != self.source {
            return Err(Why::WrongSize);
        }
        let mut data = vec![0u8; self.width * self.height];
        {
            let (rows, columns) = (self.height as i32, self.width as i32);
            let map = Mat::new_rows_cols_with_data(rows, columns, &self.places)?;
            let mut target = Mat::new_rows_cols_with_data_mut(rows, columns, &mut data)?;
            let none = Mat::default();
            let black = Scalar::all(0.0);
            imgproc::remap(
                &image.mat()?,
                &mut target,
                &map,
                &none,
                imgproc::INTER_LINEAR,
                core::BORDER_CONSTANT,
                black,
            )?;
        }
        Gray::from_bytes(self.width, self.height, data)
    }
}
