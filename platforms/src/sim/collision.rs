//! Contacts of robots with each other, with movers, walls and obstacles: swept, with exact times.
//!
//! Broad phase: pairs that can touch before one of the two has walked farther than a margin. It is gathered
//! anew when somebody has. Each pair knows its gap, and is looked at only when the two together have walked
//! that far. Narrow phase: over each stretch of time in which both move at constant velocity, the instants
//! of touch and of parting are roots of a quadratic, taken from the start of that stretch. So neither how
//! often somebody polls nor the margin changes a contact or its time, and nothing tunnels.
//!
//! Contacts are observed; they do not change motion.

use super::{
    body::{Body, Piece},
    geometry::{Aabb, Interval, Vec2, norm, sub, within},
    index::{Neighbours, Spot},
    scene::{Thing, Things},
};
use soifra_runtime::{Report, Time};

/// Two bodies have parted when their gap is larger than this (m). Also covers rounding of gaps.
const HYSTERESIS: f64 = 1e-9;
/// Pairs for each robot that a margin should come to.
const PAIRS: (usize, usize) = (2, 6);

/// Watches for contacts.
#[derive(Debug)]
pub struct Collisions {
    robots: usize,
    /// By body: radius, and height of base and top.
    forms: Vec<(f64, [f64; 2])>,
    pairs: Vec<Pair>,
    /// Contacts are known up to here; before the first sweep, nowhere.
    checked: i64,
    /// By body: where it is, how far it has walked since the pairs were gathered, and how far it may.
    at: Vec<Vec2>,
    walked: Vec<f64>,
    margins: Vec<Margin>,
    /// How far every body may walk beyond what it has walked when pairs are gathered.
    spare: f64,
    least_spare: f64,
    neighbours: Neighbours,
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
    /// They cannot touch before they have together walked farther than this since pairs were gathered.
    gap: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Margin {
    /// Path of the body when pairs were gathered.
    from: f64,
    /// How far it may walk from there.
    allowed: f64,
}

impl Collisions {
    /// For bodies of which the first `robots` are robots.
    pub fn new(robots: usize, bodies: &[Body]) -> Collisions {
        let radius = bodies.iter().map(|b| b.radius).sum::<f64>() / bodies.len().max(1) as f64;
        Collisions {
            robots,
            forms: bodies.iter().map(|b| (b.radius, b.reach())).collect(),
            pairs: Vec::new(),
            checked: -1,
            at: vec![[0.0; 2]; bodies.len()],
            walked: vec![0.0; bodies.len()],
            // Nobody may walk before the first gathering.
            margins: vec![Margin { from: 0.0, allowed: -1.0 }; bodies.len()],
            spare: radius,
            least_spare: 0.25 * radius,
            neighbours: Neighbours::default(),
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

    /// Where a body is at `t`, when contacts were last looked for at that instant.
    pub fn place(&self, body: usize, t: i64) -> Option<Vec2> {
        if self.checked == t { self.at.get(body).copied() } else { None }
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
        if to <= self.checked {
            return;
        }
        let from = self.checked.max(0);
        self.checked = to;
        let mut within = true;
        for (i, body) in bodies.iter().enumerate() {
            let place = body.place(to);
            self.at[i] = place.at;
            self.walked[i] = place.path - self.margins[i].from;
            within &= self.walked[i] <= self.margins[i].allowed;
        }
        if !within {
            self.gather(bodies, things, from);
        }
        let mut pairs = std::mem::take(&mut self.pairs);
        for pair in &mut pairs {
            let me = pair.robot as usize;
            let walked = match pair.other {
                Other::Body(o) => self.walked[me] + self.walked[o as usize],
                Other::Thing(_) => self.walked[me],
            };
            if pair.gap > walked {
                continue;
            }
            let distance = match pair.other {
                Other::Body(o) => norm(sub(self.at[me], self.at[o as usize])) - self.forms[o as usize].0,
                Other::Thing(o) => things.all[o as usize].shape.distance(self.at[me]),
            };
            let gap = distance - self.forms[me].0 - HYSTERESIS;
            // From one gap to another by that much walking, the least gap between is half of what is left.
            if pair.gap - walked + gap <= 0.0 {
                self.examine(pair, bodies, things, from, to);
            }
            pair.gap = if pair.touching { f64::NEG_INFINITY } else { gap + walked };
        }
        self.pairs = pairs;
    }

    /// Gathers the pairs that can touch from `from` on, while nobody walks farther than it has by now and
    /// some more.
    fn gather(&mut self, bodies: &[Body], things: &Things, from: i64) {
        let mut touching: Vec<(u32, Other)> =
            self.pairs.iter().filter(|p| p.touching).map(|p| (p.robot, p.other)).collect();
        touching.sort_unstable();
        let was_touching = |robot: u32, other: Other| {
            !touching.is_empty() && touching.binary_search(&(robot, other)).is_ok()
        };
        self.pairs.clear();
        let spots = bodies.iter().enumerate().map(|(i, b)| {
            let (place, walked) = (b.place(from), self.margins[i].from + self.walked[i]);
            self.walked[i] = walked - place.path;
            let allowed = self.walked[i] + self.spare;
            self.margins[i] = Margin { from: place.path, allowed };
            Spot { at: place.at, reach: b.radius + allowed + HYSTERESIS, item: i as u32 }
        });
        let robots = self.robots as u32;
        let (pairs, forms) = (&mut self.pairs, &self.forms);
        self.neighbours.fill(spots);
        self.neighbours.each(|a, b, distance| {
            let (robot, other) = (a.min(b), a.max(b));
            let ((radius, span), (other_radius, other_span)) = (forms[robot as usize], forms[other as usize]);
            if robot < robots && level(span, other_span) {
                let gap = distance - radius - other_radius - HYSTERESIS;
                let other = Other::Body(other);
                pairs.push(Pair { robot, other, touching: was_touching(robot, other), gap });
            }
        });
        if !things.all.is_empty() {
            for (i, body) in bodies[..self.robots].iter().enumerate() {
                let at = body.place(from).at;
                let reach = body.radius + self.margins[i].allowed + HYSTERESIS;
                things.grid.query(&Aabb::around(at, reach), |j| {
                    let thing = &things.all[j as usize];
                    let gap = thing.shape.distance(at) - body.radius - HYSTERESIS;
                    if level(body.reach(), thing.span) && gap <= self.margins[i].allowed {
                        let (robot, other) = (i as u32, Other::Thing(j));
                        pairs.push(Pair { robot, other, touching: was_touching(robot, other), gap });
                    }
                });
            }
        }
        // Many pairs cost at every sweep, little to spare costs gathering.
        self.spare = match self.pairs.len() {
            n if n > PAIRS.1 * self.robots => (self.spare / 1.5).max(self.least_spare),
            n if n <= PAIRS.0 * self.robots => self.spare * 1.5,
            _ => self.spare,
        };
    }

    fn examine(&mut self, pair: &mut Pair, bodies: &[Body], things: &Things, from: i64, to: i64) {
        let robot = &bodies[pair.robot as usize];
        let (mut touching, mut events) = (pair.touching, std::mem::take(&mut self.events));
        match pair.other {
            Other::Body(o) => {
                let other = &bodies[o as usize];
                let reach = robot.radius + other.radius;
                stretches(robot.pieces(from, to), other.pieces(from, to), from, to, |s, a, b| {
                    let p = sub(a.place(s.start).at, b.place(s.start).at);
                    let v = sub(a.velocity, b.velocity);
                    let level = level(robot.span(s.from), other.span(s.from));
                    let contact = |gap| if level { within(p, v, reach + gap) } else { None };
                    s.contacts(&mut touching, contact, &mut events);
                });
            }
            Other::Thing(o) => {
                let Thing { shape, span, .. } = &things.all[o as usize];
                for a in robot.pieces(from, to) {
                    if let Some(s) = Stretch::new(a.start, a.end, from, to) {
                        let level = level(robot.span(s.from), *span);
                        let contact = |gap| {
                            if level { shape.overlap(a.at, a.velocity, robot.radius + gap) } else { None }
                        };
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
}

/// Whether two things stand at one height somewhere.
fn level(a: [f64; 2], b: [f64; 2]) -> bool {
    a[0] <= b[1] && b[0] <= a[1]
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
fn stretches(
    mut a: impl Iterator<Item = Piece>,
    mut b: impl Iterator<Item = Piece>,
    from: i64,
    to: i64,
    mut f: impl FnMut(Stretch, &Piece, &Piece),
) {
    let (mut piece, mut other) = (a.next(), b.next());
    while let (Some(p), Some(q)) = (&piece, &other) {
        let (start, end) = (p.start.max(q.start), p.end.min(q.end));
        if start <= end
            && let Some(s) = Stretch::new(start, end, from, to)
        {
            f(s, p, q);
        }
        if p.end <= q.end {
            piece = a.next();
        } else {
            other = b.next();
        }
    }
}

fn order(r: &Report) -> (Time, u32, u32) {
    match r {
        Report::ContactBegin { at, robot, other, .. } | Report::ContactEnd { at, robot, other, .. } => {
            (*at, *robot, other.unwrap_or(u32::MAX))
        }
        Report::Lost { at, robot, .. } => (*at, *robot, u32::MAX),
        Report::Over { at } => (*at, u32::MAX, u32::MAX),
    }
}
