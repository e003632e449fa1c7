//! Mean, standard deviation and range of the figures of several runs.

use serde::{Deserialize, Serialize};

/// Figures of one metric over several runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Arithmetic mean.
    pub mean: Option<f64>,
    /// Sample standard deviation (n - 1); 0 for a single run.
    pub sd: Option<f64>,
    /// Least.
    pub min: Option<f64>,
    /// Middle value; mean of the middle two.
    pub median: Option<f64>,
    /// Greatest.
    pub max: Option<f64>,
    /// Number of runs in which the figure exists and is finite.
    pub n: usize,
}

impl Summary {
    /// Summarises the finite values among `values`. The sums run in the order given, so equal inputs
    /// give equal bytes.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Summary {
        let mut v: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        let n = v.len();
        if n == 0 {
            return Summary { mean: None, sd: None, min: None, median: None, max: None, n };
        }
        // From the first value, so that equal values have exactly their mean and no deviation.
        let mean = v[0] + v.iter().map(|x| x - v[0]).sum::<f64>() / n as f64;
        let squares: f64 = v.iter().map(|x| (x - mean) * (x - mean)).sum();
        let sd = if n > 1 { (squares / (n - 1) as f64).sqrt() } else { 0.0 };
        v.sort_by(f64::total_cmp);
        let median = if n % 2 == 1 { v[n / 2] } else { (v[n / 2 - 1] + v[n / 2]) / 2.0 };
        Summary {
            mean: Some(mean),
            sd: Some(sd),
            min: Some(v[0]),
            median: Some(median),
            max: Some(v[n - 1]),
            n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_deviation_and_median() {
        let s = Summary::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0, f64::NAN]);
        assert_eq!((s.mean, s.median, s.min, s.max, s.n), (Some(5.0), Some(4.5), Some(2.0), Some(9.0), 8));
        assert!((s.sd.unwrap() - (32.0f64 / 7.0).sqrt()).abs() < 1e-15);
        assert_eq!(Summary::of([]).mean, None);
        assert_eq!(Summary::of([3.0]).sd, Some(0.0));
        let same = Summary::of([10.1; 20]);
        assert_eq!((same.mean, same.sd), (Some(10.1), Some(0.0)));
    }
}
