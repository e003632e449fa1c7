//! Exact response times of tasks on one core under preemptive fixed priorities.
//!
//! Joseph and Pandya, Finding Response Times in a Real-Time System (1986); with release jitter, blocking and
//! several activations in one busy period: Tindell, Burns and Wellings, An Extendible Approach for Analyzing
//! Fixed Priority Hard Real-Time Tasks (1994), equations (1) to (4). All times are whole nanoseconds.

/// What is known of a task. Tasks come in order of priority, the most urgent first; no two are equal.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Load {
    /// Period, or least time between two releases.
    pub period: i64,
    /// Worst-case execution time that has to be done by the deadline.
    pub worst: i64,
    /// More execution that it may be given until its deadline, which is within its period; it delays those
    /// below it.
    pub optional: i64,
    /// Longest time from the arrival to the release.
    pub jitter: i64,
    /// Resources it holds, by number, and for how long.
    pub sections: Vec<(usize, i64)>,
}

/// The most rounds of a fixed-point iteration before a core is taken for one that cannot keep up.
const ROUNDS: usize = 200_000;
/// The most activations of one busy period that are looked at.
const ACTIVATIONS: i64 = 10_000;

/// Share of the core that all tasks ask for, optional work left out.
pub fn utilization(loads: &[Load]) -> f64 {
    loads.iter().map(|l| l.worst as f64 / l.period.max(1) as f64).sum()
}

/// Liu and Layland, Scheduling Algorithms for Multiprogramming in a Hard-Real-Time Environment (1973),
/// theorem 5: what `n` tasks may ask for and be sure of their periods under rate-monotonic priorities.
pub fn bound(n: usize) -> f64 {
    if n == 0 {
        return 1.0;
    }
    n as f64 * (libm::pow(2.0, 1.0 / n as f64) - 1.0)
}

/// The longest time that task `i` waits for one below it that holds a resource at a priority not below its
/// own: one section at most, under the immediate priority ceiling protocol (Sha, Rajkumar and Lehoczky 1990).
pub fn blocking(loads: &[Load], i: usize) -> i64 {
    let ceiling = |resource: usize| loads.iter().position(|l| l.sections.iter().any(|(r, _)| *r == resource));
    let below = loads.iter().skip(i + 1).flat_map(|l| &l.sections);
    below.filter(|(r, _)| ceiling(*r).is_some_and(|c| c <= i)).map(|(_, t)| *t).max().unwrap_or(0)
}

/// The longest time from the arrival of task `i` to its completion; `None` when it may grow without bound.
pub fn response(loads: &[Load], i: usize) -> Option<i64> {
    let me = loads.get(i)?;
    let blocked = blocking(loads, i);
    let mut longest = 0;
    for q in 0..ACTIVATIONS {
        let own = blocked.checked_add(me.worst.checked_mul(q + 1)?)?;
        let window = window(&loads[..i], own)?;
        let since = q.checked_mul(me.period)?;
        longest = longest.max(me.jitter.checked_add(window)?.checked_sub(since)?);
        // The next activation arrives when this one has ended: the busy period is over. What is optional is cut
        // off before.
        if me.optional > 0 || window.checked_add(me.jitter)? <= since.checked_add(me.period)? {
            return Some(longest);
        }
    }
    None
}

/// The shortest window in which `own` and everything more urgent can be executed.
fn window(above: &[Load], own: i64) -> Option<i64> {
    let mut w = own;
    for _ in 0..ROUNDS {
        let mut next = own;
        for l in above {
            let period = l.period.max(1);
            let releases = (w.checked_add(l.jitter)?).checked_add(period - 1)? / period;
            // A task that is released at the very end of nothing still interferes.
            let releases = releases.max(i64::from(w == 0));
            next = next.checked_add(releases.checked_mul(l.worst.checked_add(l.optional)?)?)?;
        }
        if next == w {
            return Some(w);
        }
        w = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(period: i64, worst: i64) -> Load {
        Load { period, worst, ..Load::default() }
    }

    #[test]
    fn the_published_task_set() {
        let set = [
            load(89_000, 16_300),
            load(100_000, 24_400),
            load(100_000, 24_400),
            load(2_000_000, 40_900),
            load(50_000_000, 19_900),
            load(50_000_000, 19_900),
        ];
        let r: Vec<_> = (0..6).map(|i| response(&set, i)).collect();
        assert_eq!(r, [16_300, 40_700, 65_100, 171_100, 256_100, 292_300].map(Some));
        assert!((bound(6) - 0.734_772).abs() < 1e-6);
        assert!((utilization(&set) - 0.692_392).abs() < 1e-6);
    }

    #[test]
    fn a_section_below_blocks_once() {
        let mut set = [load(10, 2), load(20, 4), load(40, 8)];
        set[0].sections = vec![(0, 1)];
        set[2].sections = vec![(0, 3)];
        assert_eq!(blocking(&set, 0), 3);
        assert_eq!(blocking(&set, 1), 3, "the ceiling is above it");
        assert_eq!(blocking(&set, 2), 0);
        assert_eq!(response(&set, 0), Some(5));
        assert_eq!(response(&set, 1), Some(9));
    }

    #[test]
    fn jitter_adds_itself_and_lets_releases_crowd() {
        let mut set = [load(10, 3), load(30, 5)];
        set[0].jitter = 4;
        assert_eq!(response(&set, 0), Some(7));
        // Within 11: releases at -4 (seen at 0) and 6.
        assert_eq!(response(&set, 1), Some(11));
    }

    #[test]
    fn busy_periods_of_several_activations() {
        // Lehoczky 1990: the second activation is later than the first.
        let set = [load(70, 26), load(100, 62)];
        assert_eq!(response(&set, 1), Some(118));
    }

    #[test]
    fn what_asks_for_more_than_there_is_has_no_bound() {
        assert_eq!(response(&[load(10, 6), load(10, 5)], 1), None);
        assert_eq!(response(&[load(10, 10), load(100, 1)], 1), None);
        let full = [load(10, 5), load(10, 5)];
        assert_eq!(response(&full, 1), Some(10));
    }
}
