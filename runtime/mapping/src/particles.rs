//! Where the robot is on a map that is known: Monte Carlo localisation (Dellaert, Fox, Burgard and Thrun, 1999; Thrun, Burgard
//! and Fox, Probabilistic Robotics, 2005, Table 8.2).
//!
//! Particles are moved by the odometry motion model (Table 5.6), weighed by the likelihood field of a scan (Table 6.3) and drawn
//! again with low variance (Table 4.4) when few of them carry the weight.

use crate::{
    field::Field,
    place::{Place, apart, wrap},
    random::Draws,
    scan::{Beam, points},
    why::{Why, finite},
};

/// How it is done.
#[derive(Clone, Copy, Debug)]
pub struct Localising {
    /// How many particles.
    pub count: usize,
    /// Deviation of the first particles about the start: m along each axis, rad.
    pub spread: [f64; 2],
    /// Deviation of a turn for each rad of turn and each m of way, rad.
    pub turning: [f64; 2],
    /// Deviation of a way for each m of way and each rad of turn, m.
    pub going: [f64; 2],
    /// What moves every particle besides: m, rad. It keeps them apart.
    pub jitter: [f64; 2],
    /// Nothing is weighed before the robot has gone or turned so far: m, rad. Scans from one place are not independent.
    pub least: [f64; 2],
    /// So many beams of a scan count, as far as they reach, m.
    pub beams: usize,
    /// m.
    pub reach: f64,
    /// Deviation of the end of a beam from what it met, m: of the range, and of the map.
    pub blur: f64,
    /// What share of beams meets something that is not on the map.
    pub stray: f64,
}

impl Default for Localising {
    fn default() -> Self {
        Localising {
            count: 400,
            spread: [0.2, 0.1],
            turning: [0.05, 0.02],
            going: [0.05, 0.02],
            jitter: [0.005, 0.002],
            least: [0.04, 0.02],
            beams: 60,
            reach: 25.0,
            blur: 0.08,
            stray: 0.1,
        }
    }
}

/// A belief about a pose.
#[derive(Clone, Debug)]
pub struct Particles {
    all: Vec<Particle>,
    /// Where odometry was when they were weighed last.
    odometry: Place,
    /// What comes of them.
    pub estimate: Estimate,
}

#[derive(Clone, Copy, Debug)]
struct Particle {
    place: Place,
    weight: f64,
}

/// What particles come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Their mean.
    pub place: Place,
    /// Where the frame of odometry begins.
    pub origin: Place,
    /// Deviation of the position, m.
    pub deviation: f64,
    /// Deviation of the heading, rad.
    pub turn_deviation: f64,
}

/// The belief after a scan. `field` is that of the map, `odometry` the pose in its own frame at the scan, `random` a number
/// that was drawn. Without a belief before, the robot is about `start`.
///
/// # Errors
/// [`Why::BadNumber`], and [`Why::NothingInRange`] for a scan that met nothing: the belief before holds on.
pub fn localise(
    before: Option<&Particles>,
    start: Place,
    odometry: Place,
    scan: &[Beam],
    field: &Field,
    random: f64,
    how: &Localising,
) -> Result<Particles, Why> {
    finite(&[start.at[0], start.at[1], start.yaw, odometry.at[0], odometry.at[1], odometry.yaw, random])?;
    finite(&how.spread)?;
    let ends = points(scan, how.reach, how.beams);
    if ends.is_empty() {
        return Err(Why::NothingInRange);
    }
    let mut draws = Draws::new(random);
    let mut all = match before {
        None => scattered(start, how, &mut draws),
        Some(p) => {
            let way = p.odometry.inverse().then(odometry);
            if apart(way.at, [0.0, 0.0]) < how.least[0] && way.yaw.abs() < how.least[1] {
                return Ok(p.clone());
            }
            let mut all = p.all.clone();
            all.iter_mut().for_each(|p| p.place = moved(p.place, way, how, &mut draws));
            all
        }
    };
    weigh(&mut all, &ends, field, how);
    let estimate = estimate(&all, odometry);
    let effective = 1.0 / all.iter().map(|p| p.weight * p.weight).sum::<f64>().max(1e-12);
    if effective < 0.5 * all.len() as f64 {
        all = drawn_again(&all, &mut draws);
    }
    Ok(Particles { all, odometry, estimate })
}

fn scattered(start: Place, how: &Localising, draws: &mut Draws) -> Vec<Particle> {
    let n = how.count.clamp(1, 20_000);
    let mut one = || {
        let at = [start.at[0] + draws.normal(how.spread[0]), start.at[1] + draws.normal(how.spread[0])];
        let place = Place { at, yaw: wrap(start.yaw + draws.normal(how.spread[1])) };
        Particle { place, weight: 1.0 / n as f64 }
    };
    (0..n).map(|_| one()).collect()
}

/// The odometry motion model: a turn towards where the robot went, the way, a turn to where it looks.
fn moved(place: Place, way: Place, how: &Localising, draws: &mut Draws) -> Place {
    let length = apart(way.at, [0.0, 0.0]);
    // On the spot there is no direction; backwards it is the other one.
    let backwards = way.at[0] < 0.0;
    let first = if length < 0.005 {
        0.0
    } else if backwards {
        libm::atan2(-way.at[1], -way.at[0])
    } else {
        libm::atan2(way.at[1], way.at[0])
    };
    let second = wrap(way.yaw - first);
    let turned = |turn: f64, draws: &mut Draws| {
        turn + draws.normal(how.turning[0] * turn.abs() + how.turning[1] * length + how.jitter[1])
    };
    let first_turn = turned(first, draws);
    let turns = first.abs() + second.abs();
    let gone = length + draws.normal(how.going[0] * length + how.going[1] * turns + how.jitter[0]);
    let aside = draws.normal(how.jitter[0]);
    let second_turn = turned(second, draws);
    let forward = if backwards { -gone } else { gone };
    let there = place.then(Place::new(0.0, 0.0, first_turn)).then(Place::new(forward, aside, 0.0));
    there.then(Place::new(0.0, 0.0, second_turn))
}

/// Weighs particles by how near the ends of beams are to what is on the map.
fn weigh(all: &mut [Particle], ends: &[[f64; 2]], field: &Field, how: &Localising) {
    let narrow = 0.5 / (how.blur * how.blur).max(1e-9);
    let log = |p: &Particle| -> f64 {
        let one = |end: &[f64; 2]| {
            let at = p.place.outward(*end);
            let d = field.layout.cell_of(at).map_or(f64::INFINITY, |cell| field.at(cell));
            libm::log((1.0 - how.stray) * libm::exp(-narrow * d * d) + how.stray)
        };
        libm::log(p.weight.max(1e-300)) + ends.iter().map(one).sum::<f64>()
    };
    let logs: Vec<f64> = all.iter().map(log).collect();
    let best = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|l| libm::exp(l - best)).collect();
    // The best has 1: the sum is not 0.
    let sum: f64 = weights.iter().sum();
    for (p, w) in all.iter_mut().zip(weights) {
        p.weight = w / sum;
    }
}

fn estimate(all: &[Particle], odometry: Place) -> Estimate {
    let mean = |f: &dyn Fn(&Particle) -> f64| all.iter().map(|p| p.weight * f(p)).sum::<f64>();
    let at = [mean(&|p| p.place.at[0]), mean(&|p| p.place.at[1])];
    let (s, c) = (mean(&|p| libm::sin(p.place.yaw)), mean(&|p| libm::cos(p.place.yaw)));
    let place = Place { at, yaw: libm::atan2(s, c) };
    let off = mean(&|p| {
        let d = apart(p.place.at, at);
        d * d
    });
    let turned = mean(&|p| {
        let d = wrap(p.place.yaw - place.yaw);
        d * d
    });
    Estimate {
        place,
        origin: place.then(odometry.inverse()),
        deviation: off.max(0.0).sqrt(),
        turn_deviation: turned.max(0.0).sqrt(),
    }
}

/// The low variance sampler.
fn drawn_again(all: &[Particle], draws: &mut Draws) -> Vec<Particle> {
    let n = all.len();
    let share = 1.0 / n as f64;
    let first = draws.even() * share;
    let (mut i, mut sum) = (0, all.first().map_or(0.0, |p| p.weight));
    let mut out = Vec::with_capacity(n);
    for m in 0..n {
        let wanted = first + m as f64 * share;
        while wanted > sum && i + 1 < n {
            i += 1;
            sum += all.get(i).map_or(0.0, |p| p.weight);
        }
        out.extend(all.get(i).map(|p| Particle { weight: share, ..*p }));
    }
    out
}
