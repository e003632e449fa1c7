//! Why there is no answer: every refusal of this crate, typed, with a short text.

use std::fmt;

/// The reason why a service gives no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Why {
    /// Width, height or the number of bytes is wrong.
    WrongSize,
    /// Neither one channel nor three.
    WrongChannels,
    /// An image without pixels.
    Empty,
    /// Too few pixels for the filters (less than 16 on a side).
    TooSmall,
    /// All black: the camera is covered, off, or the light is out.
    Black,
    /// All white: overexposed.
    White,
    /// The lens parameters are not finite or not positive, or rectification is missing.
    BadLens,
    /// A parameter or a number handed in is not finite or out of its range.
    BadNumber,
    /// Nothing to see: no edges, no corners.
    NoFeatures,
    /// An edge on one side only.
    OneEdge,
    /// Edges, but no two of them that move as one nearer thing.
    NoObstacle,
    /// Seen too shortly, or in too few frames, to say.
    TooShort,
    /// The interval between the frames is zero.
    ZeroInterval,
    /// The interval between the frames is negative.
    NegativeInterval,
    /// Nothing moves in the image.
    NoMotion,
    /// It moves, but does not come nearer.
    NotApproaching,
    /// The equations have no single solution.
    Degenerate,
    /// The robot turns too fast.
    Rotating,
    /// The robot stands: there is no time to contact.
    SpeedZero,
    /// Nobody has told how fast the robot is.
    SpeedUnknown,
    /// OpenCV refused.
    OpenCv,
}

impl Why {
    /// A short text, without a full stop.
    pub fn text(self) -> &'static str {
        match self {
            Why::WrongSize => "wrong image size",
            Why::WrongChannels => "wrong number of channels",
            Why::Empty => "empty image",
            Why::TooSmall => "image too small",
            Why::Black => "image all black",
            Why::White => "image all white",
            Why::BadLens => "lens parameters unusable",
            Why::BadNumber => "a number is not finite or out of range",
            Why::NoFeatures => "no features",
            Why::OneEdge => "one edge only",
            Why::NoObstacle => "no obstacle among the edges",
            Why::TooShort => "seen too shortly",
            Why::ZeroInterval => "zero interval",
            Why::NegativeInterval => "negative interval",
            Why::NoMotion => "no motion in the image",
            Why::NotApproaching => "not approaching",
            Why::Degenerate => "degenerate geometry",
            Why::Rotating => "rotating",
            Why::SpeedZero => "speed zero",
            Why::SpeedUnknown => "speed unknown",
            Why::OpenCv => "OpenCV refused",
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.text())
    }
}

impl std::error::Error for Why {}

impl From<opencv::Error> for Why {
    fn from(_: opencv::Error) -> Self {
        Why::OpenCv
    }
}

/// The interval is positive and finite, or why not.
pub fn interval(dt: f64) -> Result<f64, Why> {
    if !dt.is_finite() {
        Err(Why::BadNumber)
    } else if dt == 0.0 {
        Err(Why::ZeroInterval)
    } else if dt < 0.0 {
        Err(Why::NegativeInterval)
    } else {
        Ok(dt)
    }
}
