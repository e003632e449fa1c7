//! Images: a checked view of the caller's bytes, and the grey image that the services work on.

use opencv::core::Mat;
use opencv::{boxed_ref::BoxedRef, imgproc};

use crate::why::Why;

/// The smallest side in pixels that the filters can work on.
pub const SMALLEST: usize = 16;
/// The largest side in pixels.
pub const LARGEST: usize = 16384;

/// A view of the caller's pixels: rows from the top, x right, y down; one byte a channel, RGB interleaved when
/// there are three.
#[derive(Clone, Copy, Debug)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    channels: usize,
    data: &'a [u8],
}

impl<'a> ImageView<'a> {
    /// Checks that `data` is `width * height * channels` bytes.
    ///
    /// # Errors
    /// [`Why::Empty`], [`Why::WrongChannels`], [`Why::WrongSize`] (also for truncated data), [`Why::TooSmall`].
    pub fn new(width: usize, height: usize, channels: usize, data: &'a [u8]) -> Result<Self, Why> {
        if width == 0 || height == 0 || data.is_empty() {
            return Err(Why::Empty);
        }
        if channels != 1 && channels != 3 {
            return Err(Why::WrongChannels);
        }
        if width > LARGEST || height > LARGEST || data.len() != width * height * channels {
            return Err(Why::WrongSize);
        }
        if width < SMALLEST || height < SMALLEST {
            return Err(Why::TooSmall);
        }
        Ok(Self { width, height, channels, data })
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// 1 (grey) or 3 (RGB).
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The bytes.
    pub fn data(&self) -> &'a [u8] {
        self.data
    }

    /// The channels of a pixel.
    pub fn pixel(&self, x: usize, y: usize) -> Option<&'a [u8]> {
        let at = (y * self.width + x) * self.channels;
        if x < self.width { self.data.get(at..at + self.channels) } else { None }
    }
}

/// A grey image, owned: a plain value that the caller keeps between frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gray {
    width: usize,
    height: usize,
    data: Vec<u8>,
}

/// Mean grey level below which an image counts as black when nothing in it is bright.
const BLACK: (u64, u8) = (6, 24);
/// Mean grey level above which an image counts as white when nothing in it is dark.
const WHITE: (u64, u8) = (249, 231);

impl Gray {
    /// The grey values of `image` (0.299 R + 0.587 G + 0.114 B, as OpenCV does it).
    ///
    /// # Errors
    /// [`Why::OpenCv`] only.
    pub fn of(image: &ImageView<'_>) -> Result<Self, Why> {
        let (width, height) = (image.width, image.height);
        if image.channels == 1 {
            return Ok(Self { width, height, data: image.data.to_vec() });
        }
        let mut data = vec![0u8; width * height];
        {
            let source = Mat::new_rows_cols_with_bytes::<opencv::core::Vec3b>(
                height as i32,
                width as i32,
                image.data,
            )?;
            let mut target = Mat::new_rows_cols_with_data_mut(height as i32, width as i32, &mut data)?;
            imgproc::cvt_color_def(&source, &mut target, imgproc::COLOR_RGB2GRAY)?;
        }
        Ok(Self { width, height, data })
    }

    /// A grey image of these bytes, row after row.
    ///
    /// # Errors
    /// As [`ImageView::new`].
    pub fn from_bytes(width: usize, height: usize, data: Vec<u8>) -> Result<Self, Why> {
        ImageView::new(width, height, 1, &data)?;
        Ok(Self { width, height, data })
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The bytes, row after row.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// Row `y`, empty when there is none.
    pub fn row(&self, y: usize) -> &[u8] {
        self.data.get(y * self.width..(y + 1) * self.width).unwrap_or(&[])
    }

    /// OpenCV's view of these bytes, without a copy.
    pub(crate) fn mat(&self) -> Result<BoxedRef<'_, Mat>, Why> {
        Ok(Mat::new_rows_cols_with_data(self.height as i32, self.width as i32, &self.data)?)
    }

    /// Refuses images in which there is nothing to see, judged on every fourth pixel of every fourth row.
    ///
    /// # Errors
    /// [`Why::Black`], [`Why::White`].
    pub fn lit(&self) -> Result<(), Why> {
        let (mut sum, mut count, mut darkest, mut brightest) = (0u64, 0u64, u8::MAX, 0u8);
        for y in (0..self.height).step_by(4) {
            for &level in self.row(y).iter().step_by(4) {
                sum += u64::from(level);
                count += 1;
                darkest = darkest.min(level);
                brightest = brightest.max(level);
            }
        }
        let mean = sum / count.max(1);
        if mean <= BLACK.0 && brightest <= BLACK.1 {
            Err(Why::Black)
        } else if mean >= WHITE.0 && darkest >= WHITE.1 {
            Err(Why::White)
        } else {
            Ok(())
        }
    }
}
