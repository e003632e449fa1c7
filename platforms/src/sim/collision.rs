//! Contacts of robots with each other, with movers, walls and obstacles: swept, with exact times.
//!
//! Broad phase: pairs that could touch within a lookahead, however their drives are commanded (a drive has
//! a top speed). Each pair sleeps until its gap could be closed. Narrow phase: over each stretch of time in
//! which both move at constant velocity, the instants of touch and of parting are roots of a quadratic,
//! taken from the start of that stretch. So neither how often somebody polls, nor the lookahead, changes a
//! contact or its time, and nothing tunnels.
//!
//! Contacts are observed; they do not change motion.

use super::{
    body::{Body, Piece, seconds},
    geometry::{Aabb, Interval, sub, within},
    index::Grid,
    scene::Things,
};
use soifra_runtime::{Report, Time};

/// Two bodies have parted when their gap is larger than this (m).
const HYSTERESIS: f64 = 1e-9;
/// The lookahead stays within these (ns).
const LOOKAHEAD: (i64, i64) = (1_000_000, 10_000_000_000);
/// Pairs for each robot that a lookahead should come to.
const PAIRS: (usize, usize) = (2, 6);

/// Watches for contacts.
#[derive(Debug)]
pub struct Collisions {
    robots: usize,
    pairs: Vec<Pair>,
    /// The earliest that any pair wakes.
    wake: i64,
    /// Contacts are known up to here.
    checked: i64,
    /// When the pairs must be gathered anew.
    expires: i64,
    lookahead: i64,
    /// No shorter than this: the neighbours of a crowd are too many for any lookahead.
    shortest: i64,
    grid: Grid,
    events: Vec<(i64, bool)>,
    reports: Vec<Report>,
    counts: Vec<u32>,
    active: Vec<u32>,
    total: u32,
}

/// What a robot may touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Other {
    /// A robot or mover, by body.
    Body(u32),
    /// A wall or obstacle.
    Thing(u32),
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    robot: u32,
    other: Other,
    touching: bool,
    /// No contact begins before this.
    wake: i64,
}

impl Collisions {
    /// For bodies of which the first `robots` are robots.
    pub fn new(robots: usize, bodies: &[Body]) -> Collisions {
        let fastest = bodies.iter().map(|b| b.top_speed).fold(0.0, f64::max);
        let radius = bodies.iter().map(|b| b.radius).sum::<f64>() / bodies.len().max(1) as f64;
        let shortest = later(0, 0.5 * radius / fastest).clamp(LOOKAHEAD.0, LOOKAHEAD.1);
        Collisions {
            robots,
            pairs: Vec::new(),
            wake: i64::MAX,
            checked: 0,
            expires: 0,
            lookahead: shortest,
            shortest,
            grid: Grid::default(),
            events: Vec::new(),
            reports: Vec::new(),
            counts: vec![0; robots],
            active: vec![0; robots],
            total: 0,
        }
    }

    /// Contacts are known up to here; earlier motion may be forgotten.
    pub fn checked(&self) -> i64 {
        self.checked
    }

    /// When [`Collisions::gather`] is needed.
    pub fn expires(&self) -> i64 {
        self.expires
    }

    /// Moves the reports out, in order of time, robot, other.
    pub fn take(&mut self, out: &mut Vec<Report>) {
        self.reports.sort_by_key(order);
        out.append(&mut self.reports);
    }

    /// Contacts a robot took part in.
    pub fn count(&self, robot: usize) -> u32 {
        self.counts.get(robot).copied().unwrap_or(0)
    }

    /// Whether a robot is in contact.
    pub fn touching(&self, robot: usize) -> bool {
        self.active.get(robot).is_some_and(|n| *n > 0)
    }

    /// Contacts of all robots, each once.
    pub fn total(&self) -> u32 {
        self.total
    }

    /// Finds what begins and ends up to `to`. All motion up to then must be planned.
    pub fn sweep(&mut self, bodies: &[Body], things: &Things, to: i64) {
        let from = self.checked;
        self.checked = to;
        if self.wake > to {
            return;
        }
        let mut pairs = std::mem::take(&mut self.pairs);
        let mut wake = i64::MAX;
        for pair in &mut pairs {
            if pair.wake <= to {
                self.examine(pair, bodies, things, from, to);
            }
            wake = wake.min(pair.wake);
        }
        (self.pairs, self.wake) = (pairs, wake);
    }

    fn examine(&mut self, pair: &mut Pair, bodies: &[Body], things: &Things, from: i64, to: i64) {
        let robot = &bodies[pair.robot as usize];
        let (mut touching, mut events) = (pair.touching, std::mem::take(&mut self.events));
        match pair.other {
            Other::Body(o) => {
                let other = &bodies[o as usize];
                let reach = robot.radius + other.radius;
                stretches(robot.pieces(), other.pieces(), from, to, |s, a, b| {
                    let p = sub(a.place(s.start).at, b.place(s.start).at);
                    let v = sub(a.velocity, b.velocity);
                    s.contacts(&mut touching, |gap| within(p, v, reach + gap), &mut events);
                });
            }
            Other::Thing(o) => {
                let shape = &things.all[o as usize].shape;
                for a in robot.pieces() {
                    if let Some(s) = Stretch::new(a.start, a.end, from, to) {
                        let contact = |gap| shape.overlap(a.at, a.velocity, robot.radius + gap);
                        s.contacts(&mut touching, contact, &mut events);
                    }
                }
            }
        }
        for (at, begin) in events.drain(..) {
            self.report(pair, bodies, things, at, begin);
        }
        self.events = events;
        pair.touching = touching;
        pair.wake = if touching { to } else { wake(robot, pair.other, bodies, things, to) };
    }

    fn report(&mut self, pair: &Pair, bodies: &[Body], things: &Things, at: i64, begin: bool) {
        let (robot, at) = (pair.robot, Time(at));
        let (other, with) = match pair.other {
            Other::Body(o) => ((o < self.robots as u32).then_some(o), bodies[o as usize].name.clone()),
            Other::Thing(o) => (None, things.all[o as usize].name.clone()),
        };
        for r in [Some(robot), other].into_iter().flatten() {
            if begin {
                self.counts[r as usize] += 1;
                self.active[r as usize] += 1;
            } else {
                self.active[r as usize] -= 1;
            }
        }
        self.total += u32::from(begin);
        self.reports.push(match begin {
            true => Report::ContactBegin { at, robot, other, with },
            false => Report::ContactEnd { at, robot, other, with },
        });
    }

    /// Gathers the pairs that could touch within the lookahead from `now`, the instant last swept to.
    pub fn gather(&mut self, bodies: &[Body], things: &Things, now: i64) {
        let mut touching: Vec<(u32, Other)> =
            self.pairs.iter().filter(|p| p.touching).map(|p| (p.robot, p.other)).collect();
        touching.sort_unstable();
        self.pairs.clear();
        self.wake = i64::MAX;
        let ahead = seconds(0, self.lookahead);
        let reach = |b: &Body| b.radius + b.top_speed * ahead + HYSTERESIS;
        self.grid.fill(bodies.iter().map(|b| Aabb::around(b.place(now).at, reach(b))));
        for i in 0..self.robots {
            let (robot, first) = (&bodies[i], self.pairs.len());
            let area = *self.grid.area(i);
            let pairs = &mut self.pairs;
            let mut add = |other: Other, span: [f64; 2]| {
                if robot.level_with(span) {
                    let wake = wake(robot, other, bodies, things, now);
                    if wake <= now + self.lookahead {
                        pairs.push(Pair { robot: i as u32, other, touching: false, wake });
                    }
                }
            };
            self.grid.query(&area, |j| {
                if j > i as u32 {
                    add(Other::Body(j), bodies[j as usize].span);
                }
            });
            things.grid.query(&area, |j| add(Other::Thing(j), things.all[j as usize].span));
            for p in &mut self.pairs[first..] {
                p.touching = !touching.is_empty() && touching.binary_search(&(p.robot, p.other)).is_ok();
                self.wake = self.wake.min(p.wake);
            }
        }
        self.expires = now.saturating_add(self.lookahead);
        // Many pairs cost at every sweep, a short lookahead costs gathering.
        self.lookahead = match self.pairs.len() {
            n if n > PAIRS.1 * self.robots => self.lookahead / 3 * 2,
            n if n <= PAIRS.0 * self.robots => self.lookahead / 2 * 3,
            _ => self.lookahead,
        }
        .clamp(self.shortest, LOOKAHEAD.1);
    }
}

/// The instant before which two cannot touch, whatever they are told.
fn wake(robot: &Body, other: Other, bodies: &[Body], things: &Things, now: i64) -> i64 {
    let at = robot.place(now).at;
    let (gap, speed) = match other {
        Other::Body(o) => {
            let o = &bodies[o as usize];
            let d = sub(o.place(now).at, at);
            (libm::hypot(d[0], d[1]) - o.radius, robot.top_speed + o.top_speed)
        }
        Other::Thing(o) => (things.all[o as usize].shape.distance(at), robot.top_speed),
    };
    let gap = gap - robot.radius - HYSTERESIS;
    if gap <= 0.0 { now } else { later(now, gap / speed) }
}

/// The last whole nanosecond within `dt` seconds from `t`.
fn later(t: i64, dt: f64) -> i64 {
    // `as` saturates, also for a division by a speed of zero.
    t.saturating_add((dt * 1e9) as i64)
}

/// A stretch of time in which two move at constant velocity, and the part of it that is examined.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    start: i64,
    from: i64,
    to: i64,
}

impl Stretch {
    fn new(start: i64, end: i64, from: i64, to: i64) -> Option<Stretch> {
        let (from, to) = (from.max(start), to.min(end));
        (from <= to).then_some(Stretch { start, from, to })
    }

    /// Appends what begins and ends here. `contact` gives the times, in seconds from the start, at which
    /// the bodies overlap when grown by a gap.
    fn contacts(
        &self,
        touching: &mut bool,
        contact: impl Fn(f64) -> Option<Interval>,
        out: &mut Vec<(i64, bool)>,
    ) {
        if !*touching
            && let Some((first, last)) = contact(0.0)
            && last >= 0.0
        {
            let begin = self.instant(first);
            // What began earlier was seen earlier.
            let new = begin > self.from || begin == self.start && self.from == self.start;
            if new && begin <= self.to {
                out.push((begin, true));
                *touching = true;
            }
        }
        if *touching {
            let end = match contact(HYSTERESIS) {
                Some((_, last)) if last >= 0.0 => self.instant(last),
                _ => self.start,
            };
            if end <= self.to && end < i64::MAX {
                out.push((end, false));
                *touching = false;
            }
        }
    }

    /// The first whole nanosecond at or after `t` seconds from the start, but not before it.
    fn instant(&self, t: f64) -> i64 {
        self.start.saturating_add((t * 1e9).ceil().max(0.0) as i64)
    }
}

/// Calls `f` for every stretch of constant velocities of two trajectories that has a part in `from..=to`.
fn stretches(a: &[Piece], b: &[Piece], from: i64, to: i64, mut f: impl FnMut(Stretch, &Piece, &Piece)) {
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let (p, q) = (&a[i], &b[j]);
        let (start, end) = (p.start.max(q.start), p.end.min(q.end));
        if start <= end
            && let Some(s) = Stretch::new(start, end, from, to)
        {
            f(s, p, q);
        }
        if start > to {
            return;
        }
        if p.end <= q.end {
            i += 1;
        } else {
            j += 1;
        }
    }
}

fn order(r: &Report) -> (Time, u32, u32) {
    match r {
        Report::ContactBegin { at, robot, other, .. } | Report::ContactEnd { at, robot, other, .. } => {
            (*at, *robot, other.unwrap_or(u32::MAX))
        }
        Report::Lost { at, robot, .. } => (*at, *robot, u32::MAX),
    }
}
