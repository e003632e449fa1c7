//! How a body that flies moves besides its way over the ground: its height, and how it is tilted. A row of legs of
//! constant rates, as the pieces of its way are.

use super::body::seconds;

/// Constant rates for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Holds from here (ns) …
    pub start: i64,
    /// … to here; after it everything stays as it is.
    pub end: i64,
    /// Height of base_link, roll and pitch, at the start.
    pub from: [f64; 3],
    /// Their rates.
    pub rates: [f64; 3],
}

/// Height and tilt at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Attitude {
    /// Height of base_link.
    pub height: f64,
    /// About the forward axis: positive leans to the right.
    pub roll: f64,
    /// About the axis to the left: positive looks down.
    pub pitch: f64,
    /// Rates of roll and pitch.
    pub rates: [f64; 2],
    /// Rate of the height.
    pub climb: f64,
}

/// The legs of one body, the last one in force until another is added.
#[derive(Debug, Clone)]
pub struct Flight(Vec<Leg>);

impl Leg {
    /// Level and still at a height.
    pub fn still(start: i64, height: f64) -> Leg {
        Leg { start, end: i64::MAX, from: [height, 0.0, 0.0], rates: [0.0; 3] }
    }

    /// Where it is at `t`, or at its end when that is earlier.
    fn at(&self, t: i64) -> Attitude {
        let dt = seconds(self.start, t.min(self.end)).max(0.0);
        let [height, roll, pitch] = std::array::from_fn(|i| self.from[i] + self.rates[i] * dt);
        let [climb, rates @ ..] = if t <= self.end { self.rates } else { [0.0; 3] };
        Attitude { height, roll, pitch, rates, climb }
    }
}

impl Flight {
    /// Standing at a height.
    pub fn new(height: f64) -> Flight {
        Flight(vec![Leg::still(0, height)])
    }

    /// At an instant that is not forgotten.
    pub fn at(&self, t: i64) -> Attitude {
        let leg = self.0.iter().rfind(|l| l.start <= t).or(self.0.first());
        leg.map_or_else(Attitude::default, |l| l.at(t))
    }

    /// Goes on with a leg: from its start on nothing else is planned. Forgets what ended before `checked`.
    pub fn push(&mut self, leg: Leg, checked: i64) {
        while self.0.last().is_some_and(|l| l.start >= leg.start) {
            self.0.pop();
        }
        if let Some(last) = self.0.last_mut() {
            last.end = last.end.min(leg.start);
        }
        // The last of them may still be in force at `checked`. Only now and then: it is a move of all the others.
        let stale = self.0.iter().take_while(|l| l.end < checked).count();
        if stale > 16 {
            self.0.drain(..stale - 1);
        }
        self.0.push(leg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_ends_where_the_next_begins() {
        let mut f = Flight::new(0.1);
        f.push(Leg { start: 1_000, end: 1_000_001_000, from: [0.1, 0.0, 0.0], rates: [2.0, 0.1, -0.1] }, -1);
        assert_eq!(f.at(0).height, 0.1);
        assert_eq!(f.at(500_001_000).height, 1.1);
        assert_eq!(f.at(500_001_000).rates, [0.1, -0.1]);
        f.push(Leg::still(500_001_000, 1.1), -1);
        assert_eq!((f.at(900_000_000).height, f.at(900_000_000).rates), (1.1, [0.0; 2]));
        assert_eq!(f.at(250_001_000).height, 0.6);
    }

    #[test]
    fn what_is_checked_is_forgotten() {
        let mut f = Flight::new(0.0);
        for i in 1..10_000_i64 {
            f.push(Leg { start: i, end: i + 1, from: [0.0; 3], rates: [0.0; 3] }, i - 100);
        }
        assert!(f.0.len() < 150, "{}", f.0.len());
    }
}
