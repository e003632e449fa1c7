//! Reasons why a value is absent that the product itself gives. They stand first in every text table,
//! so that their register form is the same in every mission.

/// No reading has been delivered yet.
pub const NO_READING: usize = 0;
/// The last reading is older than its lifetime.
pub const EXPIRED: usize = 1;
/// A beam met nothing within its range.
pub const NOTHING_IN_RANGE: usize = 2;
/// An argument that was left out.
pub const NOT_GIVEN: usize = 3;
/// A list has no item at that index.
pub const NO_SUCH_ITEM: usize = 4;
/// A list has no item for which the condition holds, or none at all.
pub const NONE_FOUND: usize = 5;
/// A moving point never comes that near.
pub const NO_CONTACT: usize = 6;
/// A matrix has no inverse.
pub const SINGULAR: usize = 7;
/// The sensor gave a number that is not finite.
pub const INVALID: usize = 8;

/// The texts, by index.
pub const REASONS: &[&str] = &[
    "no reading yet",
    "the reading has expired",
    "nothing in range",
    "not given",
    "no such item",
    "none found",
    "no contact",
    "the matrix is singular",
    "the reading was not finite",
    "wrong image size",
    "wrong number of channels",
    "empty image",
    "image too small",
    "image all black",
    "image all white",
    "lens parameters unusable",
    "a number is not finite or out of range",
    "no features",
    "one edge only",
    "no obstacle among the edges",
    "seen too shortly",
    "zero interval",
    "negative interval",
    "no motion in the image",
    "not approaching",
    "degenerate geometry",
    "rotating",
    "speed zero",
    "speed unknown",
    "OpenCV refused",
    "a map of too many cells",
    "the world has no bounds",
    "the start is not free",
    "the target is not free",
    "no way",
    "the scan does not fit the map",
    "unknown",
];

/// The index of a reason; the last one for a text that is none of them.
pub fn index(text: &str) -> usize {
    REASONS.iter().position(|r| *r == text).unwrap_or(REASONS.len() - 1)
}

/// The optional's tag for a reason: 0 is some, so it is one more than the index.
pub const fn tag(reason: usize) -> f64 {
    (reason + 1) as f64
}
