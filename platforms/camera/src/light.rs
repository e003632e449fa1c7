//! How bright a face is.

use crate::geometry::{Point, dot, unit};

/// What lights a scene, and how the camera exposes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Share of its texture's colour that every face shows, whichever way it faces.
    pub ambient: f64,
    /// From the ground toward the sun, in the world; any length.
    pub sun: Point,
    /// What the sun adds to a face turned at it. It falls off to nothing on a face turned away, half of it left
    /// on one that is edge-on, so that no two faces of a corner in the shade look the same.
    pub strength: f64,
    /// What the exposure multiplies all by, the sky included; channels saturate at 255.
    pub gain: f64,
}

impl Default for Light {
    /// A bright room: full colours where a face looks at the sun, nearly half of them where it looks away.
    fn default() -> Self {
        Self { ambient: 0.45, sun: [0.35, 0.55, 0.8], strength: 0.55, gain: 1.0 }
    }
}

/// One, in the fixed point of [`Light::shade`].
pub(crate) const FULL: u32 = 256;

impl Light {
    /// What a face's colours are multiplied by, in 256ths; `normal` is of unit length, in the world.
    pub(crate) fn shade(&self, normal: Point) -> u32 {
        let facing = unit(self.sun).map_or(0.0, |sun| 0.5 + 0.5 * dot(sun, normal));
        fixed(self.gain * (self.ambient + self.strength * facing))
    }

    /// What the sky's colours are multiplied by, in 256ths.
    pub(crate) fn exposure(&self) -> u32 {
        fixed(self.gain)
    }
}

/// To 256ths, from 0 to 255; what is not a number is 0.
fn fixed(factor: f64) -> u32 {
    (factor * f64::from(FULL) + 0.5).clamp(0.0, 255.0 * f64::from(FULL)) as u32
}

#[cfg(test)]
mod tests {
    use super::Light;

    #[test]
    fn brightness_falls_off_and_stays_in_range() {
        let light = Light { ambient: 0.25, sun: [0.0, 0.0, 3.0], strength: 0.75, gain: 1.0 };
        assert_eq!(light.shade([0.0, 0.0, 1.0]), 256);
        assert_eq!(light.shade([1.0, 0.0, 0.0]), 160);
        assert_eq!(light.shade([0.0, 0.0, -1.0]), 64);
        let wrong = Light { ambient: f64::NAN, sun: [0.0; 3], strength: -1.0, gain: f64::INFINITY };
        assert_eq!(wrong.shade([0.0, 0.0, 1.0]), 0);
        assert_eq!(Light { gain: 1e300, ..light }.shade([0.0, 0.0, 1.0]), 255 * 256);
    }
}
