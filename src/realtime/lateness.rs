//! Lateness: how much later than it was due an instant came, on the wall clock. It is told beside the run and
//! enters no trace and no digest.

use crate::{files, report::Refusal};
use serde::Serialize;
use soifra_runtime::Time;
use std::{
    fs::File,
    io::{self, BufWriter, Write},
};

/// Later than this counts as late.
const LATE: Time = Time(1_000_000);

/// Values below this have a bin each; above, every doubling has half as many.
const FINE: u64 = 128;

/// Bins that take any number of nanoseconds.
const BINS: usize = bin(u64::MAX) + 1;

/// The bin of a value: narrower than a sixty-fourth of it.
const fn bin(x: u64) -> usize {
    if x < FINE {
        return x as usize;
    }
    let coarse = (u64::BITS - FINE.trailing_zeros() - x.leading_zeros()) as u64;
    (coarse * (FINE / 2) + (x >> coarse)) as usize
}

/// The greatest value of a bin.
fn greatest(bin: usize) -> u64 {
    let bin = bin as u64;
    if bin < FINE {
        return bin;
    }
    let coarse = bin / (FINE / 2) - 1;
    let first = bin - coarse * (FINE / 2);
    // The last bin ends with the numbers.
    ((u128::from(first + 1) << coarse) - 1).min(u128::from(u64::MAX)) as u64
}

/// Lateness of the instants of a run. Takes the same room for an hour and for a year.
pub struct Lateness {
    instants: u64,
    late: u64,
    sum: u128,
    max: u64,
    bins: Vec<u64>,
    file: Option<Csv>,
}

/// The file, until it cannot be written.
struct Csv {
    path: String,
    out: io::Result<BufWriter<File>>,
}

/// What is told of the lateness of a run, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Summary {
    /// Instants after the first, which the run begins with.
    pub instants: u64,
    /// Of them, those that came more than a millisecond late.
    pub late: u64,
    /// Mean.
    pub mean_s: Option<f64>,
    /// 99 of 100 are not greater; exact to a sixty-fourth of itself.
    pub p99_s: Option<f64>,
    /// Greatest.
    pub max_s: Option<f64>,
}

impl Lateness {
    /// Of no instant yet.
    pub fn new() -> Self {
        Lateness { instants: 0, late: 0, sum: 0, max: 0, bins: vec![0; BINS], file: None }
    }

    /// Writes each to a file, too.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn into_file(path: &str) -> Result<Self, Refusal> {
        let create = || {
            files::make_folder(path)?;
            let mut out = BufWriter::new(File::create(path)?);
            out.write_all(b"sim_time_s,lateness_s\n")?;
            // So that a disk that is full is known at the start.
            out.flush()?;
            Ok(out)
        };
        let out = create().map_err(|e| files::unwritable(path, &e))?;
        Ok(Lateness { file: Some(Csv { path: path.into(), out: Ok(out) }), ..Lateness::new() })
    }

    /// The instant `at` comes `late`.
    pub fn take(&mut self, at: Time, late: Time) {
        let late = Time(late.0.max(0));
        let ns = late.0.unsigned_abs();
        self.instants += 1;
        self.late += u64::from(late > LATE);
        self.sum += u128::from(ns);
        self.max = self.max.max(ns);
        self.bins[bin(ns)] += 1;
        if let Some(Csv { out, .. }) = &mut self.file
            && let Ok(o) = out
            && let Err(e) = writeln!(o, "{},{}", Decimal(at), Decimal(late))
        {
            *out = Err(e);
        }
    }

    /// What is to be told, and what is wrong with the file.
    pub fn finish(self) -> (Summary, Option<Refusal>) {
        let some = |ns: f64| (self.instants > 0).then_some(ns / 1e9);
        let summary = Summary {
            instants: self.instants,
            late: self.late,
            mean_s: some(self.sum as f64 / self.instants.max(1) as f64),
            p99_s: some(self.percentile(99).min(self.max) as f64),
            max_s: some(self.max as f64),
        };
        let wrong = self.file.and_then(|Csv { path, out }| {
            let flushed = out.and_then(|mut o| o.flush());
            flushed.err().map(|e| files::unwritable(&path, &e))
        });
        (summary, wrong)
    }

    /// The least value that `percent` of 100 are not greater than, up to the width of its bin.
    fn percentile(&self, percent: u64) -> u64 {
        let wanted = (u128::from(self.instants) * u128::from(percent)).div_ceil(100);
        let mut seen = 0;
        for (b, n) in self.bins.iter().enumerate() {
            seen += u128::from(*n);
            if seen >= wanted {
                return greatest(b);
            }
        }
        self.max
    }
}

impl Default for Lateness {
    fn default() -> Self {
        Lateness::new()
    }
}

/// Seconds to the nanosecond, of a time that is not negative.
struct Decimal(Time);

impl std::fmt::Display for Decimal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{:09}", self.0.0 / 1_000_000_000, self.0.0 % 1_000_000_000)
    }
}

impl Summary {
    /// In a line.
    pub fn line(&self) -> String {
        let ms = |s: Option<f64>| s.map_or("–".into(), |s| format!("{:.3} ms", s * 1e3));
        let Summary { instants, late, mean_s, p99_s, max_s } = self;
        format!(
            "real time: {instants} instants, {late} late by more than 1 ms; lateness mean {}, p99 {}, max {}",
            ms(*mean_s),
            ms(*p99_s),
            ms(*max_s)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_follow_each_other_without_gap() {
        let values = (0..100_000).chain((10..64).flat_map(|e| {
            let x = 1u64 << e;
            [x - 1, x, x + 1, x + x / 3]
        }));
        for x in values.chain([u64::MAX]) {
            let b = bin(x);
            assert!(greatest(b) >= x && (b == 0 || greatest(b - 1) < x), "{x} in {b}");
            assert!(greatest(b) - x <= x / 64, "{x} in {b}");
        }
        assert_eq!(greatest(BINS - 1), u64::MAX);
    }

    #[test]
    fn figures_of_known_lateness() {
        let mut l = Lateness::new();
        for i in 1..=1000 {
            l.take(Time(i), Time(i * 2_000));
        }
        let (s, _) = l.finish();
        assert_eq!((s.instants, s.late), (1000, 500));
        assert!((s.mean_s.unwrap() - 1.001e-3).abs() < 1e-9);
        assert_eq!(s.max_s, Some(2e-3));
        let p99 = s.p99_s.unwrap();
        assert!((1.98e-3..1.98e-3 * (1.0 + 1.0 / 64.0)).contains(&p99), "{p99}");
        let (none, _) = Lateness::new().finish();
        assert_eq!((none.instants, none.mean_s, none.p99_s, none.max_s), (0, None, None, None));
        let mut one = Lateness::new();
        one.take(Time(5), Time(-3));
        assert_eq!(one.finish().0.max_s, Some(0.0), "nothing comes early");
    }
}
