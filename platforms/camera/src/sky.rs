//! What is seen where there is no triangle.

use crate::facet::Optics;
use crate::shade::{Lanes, brighten, lanes};

/// A gradient over elevation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sky {
    /// Colour straight up.
    pub zenith: [u8; 3],
    /// Colour at the height of the eye.
    pub horizon: [u8; 3],
    /// Colour straight down.
    pub nadir: [u8; 3],
}

impl Default for Sky {
    fn default() -> Self {
        Self { zenith: [96, 140, 205], horizon: [205, 218, 232], nadir: [120, 118, 112] }
    }
}

impl Sky {
    /// The same colour everywhere.
    #[must_use]
    pub const fn plain(colour: [u8; 3]) -> Self {
        Self { zenith: colour, horizon: colour, nadir: colour }
    }

    /// Colours of the pixels of row `y` from column `x` on; `exposure` in 256ths.
    pub(crate) fn fill(&self, optics: &Optics, y: usize, x: usize, exposure: u32, out: &mut [Lanes]) {
        let [zenith, horizon, nadir] = [self.zenith, self.horizon, self.nadir].map(lanes);
        for (i, out) in out.iter_mut().enumerate() {
            let height = optics.elevation((x + i) as f64 + 0.5, y as f64 + 0.5);
            let far = if height < 0.0 { nadir } else { zenith };
            let share = (height.abs() * 256.0) as u64;
            let mixed = horizon * (256 - share.min(256)) + far * share.min(256) + 0x0080_0080_0080;
            *out = brighten((mixed >> 8) & 0x00ff_00ff_00ff, exposure);
        }
    }
}
