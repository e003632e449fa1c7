//! Images that cover faces, with their pyramids.

mod names;
mod pattern;
mod pyramid;
mod value_noise;

use core::fmt;
use std::sync::Arc;

pub use names::NAMES;
pub(crate) use pyramid::Level;
pub(crate) use value_noise::mix;

/// An RGB image that repeats in both directions, kept in all sizes down to a single texel so that a distant face
/// shows its mean colour and not a moiré.
#[derive(Clone, Debug)]
pub struct Texture {
    levels: Arc<[Level]>,
    /// Width over height of what it was made from.
    proportion: f64,
}

/// Why bytes are not a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureError {
    /// No pixels, or more than [`Texture::MOST_PIXELS`] along a side.
    Size,
    /// Not three bytes a pixel.
    Length {
        /// Bytes that the size asks for.
        expected: usize,
        /// Bytes that there are.
        found: usize,
    },
}

impl fmt::Display for TextureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => write!(f, "a texture has 1 to {} pixels along each side", Texture::MOST_PIXELS),
            Self::Length { expected, found } => {
                write!(f, "the texture's size asks for {expected} bytes of RGB, there are {found}")
            }
        }
    }
}

impl core::error::Error for TextureError {}

impl Texture {
    /// Along each side of an image that is given.
    pub const MOST_PIXELS: usize = 16_384;

    /// From the rows of an image, top row first, three bytes a pixel. Sides that are not powers of two are brought
    /// up to the next one (at most 4096); a repeat of it keeps the proportions of the image.
    ///
    /// # Errors
    /// If the size is out of range or the bytes are not as many as it asks for.
    pub fn from_rgb8(width: usize, height: usize, rgb: &[u8]) -> Result<Self, TextureError> {
        if [width, height].iter().any(|side| !(1..=Self::MOST_PIXELS).contains(side)) {
            return Err(TextureError::Size);
        }
        let expected = 3 * width * height;
        if rgb.len() != expected {
            return Err(TextureError::Length { expected, found: rgb.len() });
        }
        Ok(Self {
            levels: pyramid::build(width, height, rgb).into(),
            proportion: width as f64 / height as f64,
        })
    }

    /// One colour all over.
    #[must_use]
    pub fn plain(colour: [u8; 3]) -> Self {
        Self { levels: pyramid::build(1, 1, &colour).into(), proportion: 1.0 }
    }

    /// Cloth of a colour: woven threads and folds, contrast enough to be followed.
    #[must_use]
    pub fn cloth(colour: [u8; 3]) -> Self {
        pattern::cloth(colour)
    }

    /// The procedural texture or plain colour of this name; [`NAMES`] has them all.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        names::by_name(name)
    }

    /// The colour of the whole, as it is seen from far.
    #[must_use]
    pub fn mean(&self) -> [u8; 3] {
        self.levels.last().map_or([0; 3], Level::first)
    }

    /// Width over height of a repeat.
    #[must_use]
    pub fn proportion(&self) -> f64 {
        self.proportion
    }

    /// Width and height in texels, each a power of two.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        self.levels.first().map_or((0, 0), Level::size)
    }

    /// The largest image as RGB rows, top row first: what was given, or a procedure made.
    #[must_use]
    pub fn to_rgb8(&self) -> Vec<u8> {
        self.levels.first().map_or_else(Vec::new, Level::to_rgb8)
    }

    /// From the finest to a single texel; never empty.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}
