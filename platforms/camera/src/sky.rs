//! What is seen where there is no triangle.

use crate::colour::{Colour, WHOLE, blend, brighten, opaque};
use crate::facet::Optics;

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
    pub(crate) fn fill(&self, optics: &Optics, y: usize, x: usize, exposure: u32, out: &mut [Colour]) {
        let [zenith, horizon, nadir] = [self.zenith, self.horizon, self.nadir].map(opaque);
        for (i, out) in out.iter_mut().enumerate() {
            let height = optics.elevation((x + i) as f64 + 0.5, y as f64 + 0.5);
            let far = if height < 0.0 { nadir } else { zenith };
            let share = ((height.abs() * f64::from(WHOLE)) as u32).min(WHOLE);
            *out = brighten(blend(horizon, far, share), exposure);
        }
    }
}
