//! Axes: round steps, and how times are written beside them.

use soifra_runtime::Time;

/// The least of 1, 2, 5 times a power of ten that is not below `x`.
pub(super) fn nice(x: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(x)));
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|n| *n >= x * (1.0 - 1e-9)).unwrap_or(power)
}

/// A unit in which times are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TimeUnit {
    /// As written.
    pub name: &'static str,
    /// Digits of a nanosecond after the point.
    digits: usize,
}

const UNITS: [TimeUnit; 4] = [
    TimeUnit { name: "ns", digits: 0 },
    TimeUnit { name: "us", digits: 3 },
    TimeUnit { name: "ms", digits: 6 },
    TimeUnit { name: "s", digits: 9 },
];

impl TimeUnit {
    /// The largest unit of which a span has at least one.
    pub(super) fn of(span: Time) -> TimeUnit {
        UNITS.into_iter().rev().find(|u| span.0.unsigned_abs() >= u.nanoseconds()).unwrap_or(UNITS[0])
    }

    fn nanoseconds(self) -> u64 {
        10u64.pow(self.digits as u32)
    }

    /// As many decimals as it takes to write all these times to the nanosecond.
    pub(super) fn decimals(self, times: impl IntoIterator<Item = Time>) -> usize {
        let of = |t: Time| self.fraction(t).trim_end_matches('0').len();
        times.into_iter().map(of).max().unwrap_or(0)
    }

    /// All decimals of a time.
    fn fraction(self, t: Time) -> String {
        if self.digits == 0 {
            return String::new();
        }
        format!("{:0digits$}", t.0.unsigned_abs() % self.nanoseconds(), digits = self.digits)
    }

    /// A time with so many decimals, without the unit.
    pub(super) fn write(self, t: Time, decimals: usize) -> String {
        let sign = if t.0 < 0 { "−" } else { "" };
        let whole = t.0.unsigned_abs() / self.nanoseconds();
        match self.fraction(t).get(..decimals).unwrap_or_default() {
            "" => format!("{sign}{whole}"),
            fraction => format!("{sign}{whole}.{fraction}"),
        }
    }

    /// A time to the nanosecond, with its unit.
    pub(super) fn exact(self, t: Time) -> String {
        format!("{} {}", self.write(t, self.decimals([t])), self.name)
    }
}

/// Instants between two, both included, at whole multiples of a step of 1, 2 or 5 times a power of ten
/// nanoseconds that is not below `least`.
pub(super) fn instants(from: Time, to: Time, least: f64) -> Vec<Time> {
    // A double holds every such step that a time can be compared with.
    let step = nice(least.clamp(1.0, 5e18)).round() as i128;
    let first = i128::from(from.0).div_euclid(step) * step;
    let steps = (0..1000).map(|k| first + k * step);
    steps
        .skip_while(|t| *t < i128::from(from.0))
        .take_while(|t| *t <= i128::from(to.0))
        .filter_map(|t| i64::try_from(t).ok().map(Time))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!([0.7, 1.0, 1.1, 3.0, 70.0].map(nice), [1.0, 1.0, 2.0, 5.0, 100.0]);
    }

    #[test]
    fn times_are_written_to_the_nanosecond() {
        let ms = TimeUnit::of(Time(5_300_000));
        assert_eq!(ms.name, "ms");
        let times = [Time(0), Time(89_000), Time(-1_500_000)];
        assert_eq!(ms.decimals(times), 3);
        assert_eq!(times.map(|t| ms.write(t, 3)), ["0.000", "0.089", "−1.500"]);
        assert_eq!(TimeUnit::of(Time(12)).exact(Time(12)), "12 ns");
        assert_eq!(TimeUnit::of(Time::MAX).exact(Time(i64::MIN)), "−9223372036.854775808 s");
    }

    #[test]
    fn instants_lie_within() {
        let times = instants(Time(150), Time(401), 80.0);
        assert_eq!(times, [200, 300, 400].map(Time));
        assert_eq!(instants(Time(-100), Time(100), 99.0), [-100, 0, 100].map(Time));
        for (from, to) in [(i64::MIN, i64::MAX), (i64::MAX - 1, i64::MAX), (5, 5), (7, 3)] {
            let span = to as f64 - from as f64;
            assert!(instants(Time(from), Time(to), span / 10.0).len() <= 12);
        }
    }
}
