//! From the world to the page: what is shown, at what scale, with which axes.

use crate::plot::axis::nice;

/// A rectangle of the world and where it lies on the page.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// South-west corner in metres.
    low: [f64; 2],
    /// North-east corner in metres.
    high: [f64; 2],
    /// Upper left corner on the page.
    pub origin: [f64; 2],
    /// Points on the page for a metre.
    pub scale: f64,
}

/// The unit of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// As written.
    pub name: &'static str,
    /// In metres.
    pub metres: f64,
}

/// Whether places or sizes can be drawn: they are numbers, and nothing in a world is a million kilometres
/// away.
pub(super) fn in_sight(metres: &[f64]) -> bool {
    metres.iter().all(|x| x.abs() < 1e9)
}

/// A smallest rectangle around points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    low: [f64; 2],
    high: [f64; 2],
}

impl Extent {
    /// Around nothing.
    pub(super) const NOTHING: Extent = Extent { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    /// Grows to hold a disc (a point when it has no radius).
    pub(super) fn take(&mut self, at: [f64; 2], radius: f64) {
        if in_sight(&at) && in_sight(&[radius]) {
            for ((low, high), x) in self.low.iter_mut().zip(&mut self.high).zip(at) {
                *low = low.min(x - radius);
                *high = high.max(x + radius);
            }
        }
    }
}

impl View {
    /// Shows an extent with a margin in a room of the page, as large as fits. A very long and thin extent is
    /// widened to a quarter of its length.
    pub(super) fn new(extent: Extent, origin: [f64; 2], room: [f64; 2]) -> View {
        let Extent { mut low, mut high } = extent;
        for i in 0..2 {
            if low[i] > high[i] {
                (low[i], high[i]) = (-0.5, 0.5);
            }
        }
        let longest = f64::max(high[0] - low[0], high[1] - low[1]).max(1e-3);
        for i in 0..2 {
            let missing = f64::max(0.0, longest / 4.0 - (high[i] - low[i])) / 2.0;
            low[i] -= missing + 0.03 * longest;
            high[i] += missing + 0.03 * longest;
        }
        let scale = f64::min(room[0] / (high[0] - low[0]), room[1] / (high[1] - low[1]));
        View { low, high, origin, scale }
    }

    /// Width and height on the page.
    pub(super) fn size(&self) -> [f64; 2] {
        [(self.high[0] - self.low[0]) * self.scale, (self.high[1] - self.low[1]) * self.scale]
    }

    /// A place on the page.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + (x - self.low[0]) * self.scale, self.origin[1] + (self.high[1] - y) * self.scale]
    }

    /// The unit in which coordinates are short numbers.
    pub(super) fn unit(&self) -> Unit {
        match f64::max(self.high[0] - self.low[0], self.high[1] - self.low[1]) {
            x if x < 0.02 => Unit { name: "mm", metres: 1e-3 },
            x if x < 1.5 => Unit { name: "cm", metres: 1e-2 },
            x if x < 5e3 => Unit { name: "m", metres: 1.0 },
            _ => Unit { name: "km", metres: 1e3 },
        }
    }

    /// Distance between ticks in `unit`, the same for both axes: 1, 2 or 5 times a power of ten, at least
    /// `least` points apart on the page.
    pub(super) fn step(&self, unit: Unit, least: f64) -> f64 {
        nice(least / self.scale / unit.metres)
    }

    /// Ticks of an axis (0 is x, 1 is y): coordinate on the page along the axis, and label.
    pub(super) fn ticks(&self, axis: usize, unit: Unit, step: f64) -> Vec<(f64, String)> {
        let (low, high) = (self.low[axis] / unit.metres / step, self.high[axis] / unit.metres / step);
        let decimals = (-libm::floor(libm::log10(step) + 1e-9)).clamp(0.0, 9.0) as usize;
        (low.ceil() as i64..=high.floor() as i64)
            .map(|k| {
                let value = k as f64 * step;
                let place = self.place([value * unit.metres; 2])[axis];
                (place, format!("{value:.decimals$}").replace('-', "−"))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers() {
        let mut extent = Extent::NOTHING;
        extent.take([0.0, 0.0], 0.0);
        extent.take([0.25, 0.25], 0.0);
        let view = View::new(extent, [0.0; 2], [500.0; 2]);
        let unit = view.unit();
        assert_eq!(unit.name, "cm");
        let labels: Vec<String> =
            view.ticks(0, unit, view.step(unit, 60.0)).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0", "5", "10", "15", "20", "25"]);
    }

    #[test]
    fn an_empty_world_has_a_view() {
        let view = View::new(Extent::NOTHING, [0.0; 2], [500.0; 2]);
        assert!(view.size().iter().all(|s| s.is_finite() && *s > 100.0));
    }
}
