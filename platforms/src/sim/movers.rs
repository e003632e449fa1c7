//! Movers: bodies that walk on their own.

use super::{
    args::Args,
    body::{Body, Piece, Place, seconds},
    geometry::{Aabb, Vec2, along, dot, norm, sub, within},
    index::Grid,
    noise::Stream,
};
use soifra_runtime::Time;
use std::f64::consts::{PI, TAU};

/// No piece of a mover's way is shorter (ns), but for the last before a turn: a bound on the number of
/// events of a run.
const SHORTEST: i64 = 100_000;

/// What makes a mover walk.
#[derive(Debug)]
pub enum Mover {
    /// Along a path, for ever.
    Path(Along),
    /// Straight on, with a new heading now and then.
    Wanderer(Box<Wanderer>),
}

impl Mover {
    /// Plans motion until `until` at least. Pieces that ended before `checked` may be forgotten.
    pub fn extend(&mut self, body: &mut Body, until: i64, checked: i64) {
        while body.planned() < until {
            let t = body.planned();
            match self {
                Mover::Path(p) => p.plan(body, t, checked),
                Mover::Wanderer(w) => w.plan(body, t, checked),
            }
        }
    }
}

/// How a path goes on where it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Back the way it came.
    Back,
    /// Straight to its beginning.
    Round,
}

/// Walks along a path, for ever.
#[derive(Debug)]
pub struct Along {
    points: Vec<Vec2>,
    /// Length of the path up to each point.
    upto: Vec<f64>,
    speed: f64,
    /// Where in the round trip it started, metres.
    offset: f64,
    /// The next point in the round trip 0, 1, … n-1, n-2, … 1, 0, 1, …, or 0, 1, … n-1, 1, …, where the last is the first
    /// again, counted on without end.
    next: u64,
    end: End,
}

impl Along {
    /// From `disc(…)` or `walker(…)`: the mover and where it starts.
    pub fn new(args: Args<'_>, end: End) -> Result<(Along, Place), String> {
        let mut points = args.points("path")?;
        if end == End::Round {
            points.extend(points.first().copied());
        }
        points.dedup();
        let speed = args.at_least_zero("speed")?;
        let phase = args.number("phase")?;
        let mut upto = vec![0.0];
        for (a, b) in points.iter().zip(&points[1..]) {
            upto.push(upto[upto.len() - 1] + norm(sub(*b, *a)));
        }
        let length = upto[upto.len() - 1];
        if !length.is_finite() {
            return Err(args.wrong("`path` is too long"));
        }
        if points.len() < 2 || length < 1e-9 {
            points.truncate(1);
            let place = Place { at: points[0], heading: 0.0, path: 0.0 };
            return Ok((Along { points, upto, speed: 0.0, offset: 0.0, next: 1, end }, place));
        }
        if speed > 0.0 && length / speed < SHORTEST as f64 * 1e-9 {
            return Err(args.wrong("the whole path takes less than 0.1 ms"));
        }
        let round = if end == End::Back { 2.0 * length } else { length };
        let mut mover = Along { points, upto, speed, offset: (phase - phase.floor()) * round, next: 1, end };
        while mover.distance(mover.next) <= mover.offset {
            mover.next += 1;
        }
        let start = mover.start();
        Ok((mover, start))
    }

    fn legs(&self) -> u64 {
        self.points.len() as u64 - 1
    }

    /// Legs of a round trip.
    fn round(&self) -> u64 {
        if self.end == End::Back { 2 * self.legs() } else { self.legs() }
    }

    /// The point at a place in the round trip.
    fn point(&self, n: u64) -> usize {
        let k = n % self.round();
        if self.end == End::Back { k.min(self.round() - k) as usize } else { k as usize }
    }

    /// Distance walked from the beginning of the first round trip to a place in it.
    fn distance(&self, n: u64) -> f64 {
        let (length, k) = (self.upto[self.points.len() - 1], n % self.round());
        let rounds = (n / self.round()) as f64;
        let within = self.upto[self.point(n)];
        if self.end == End::Round {
            return rounds * length + within;
        }
        rounds * 2.0 * length + if k <= self.legs() { within } else { 2.0 * length - within }
    }

    fn start(&self) -> Place {
        let (a, b) = (self.points[self.point(self.next - 1)], self.points[self.point(self.next)]);
        let d = sub(b, a);
        let at = along(a, d, (self.offset - self.distance(self.next - 1)) / norm(d));
        Place { at, heading: libm::atan2(d[1], d[0]), path: 0.0 }
    }

    fn plan(&mut self, body: &mut Body, t: i64, checked: i64) {
        let mut from = body.place(t);
        // Arrivals are reckoned from the start of the run, so that rounding does not add up.
        let arrival = |n: u64| Time::from_seconds((self.distance(n) - self.offset) / self.speed);
        let mut next = self.next;
        let end = loop {
            match if self.speed > 0.0 { arrival(next) } else { None } {
                None => return body.push(Piece::rest(t, from), checked),
                Some(Time(end)) if end - t >= SHORTEST => break end,
                _ => next += 1,
            }
        };
        let way = sub(self.points[self.point(next)], from.at);
        let dt = seconds(t, end);
        from.heading = libm::atan2(way[1], way[0]);
        let speed = norm(way) / dt;
        body.push(Piece::sliding(t, end, from, [speed, 0.0], speed), checked);
        self.next = next + 1;
    }
}

/// Discs that a wanderer stays out of, with a grid over them.
#[derive(Debug, Default, Clone)]
pub struct KeepOut {
    discs: Vec<(Vec2, f64)>,
    grid: Grid,
}

impl KeepOut {
    /// Around each of these centres.
    pub fn around(centers: &[Vec2], radius: f64) -> KeepOut {
        let discs: Vec<_> = centers.iter().map(|c| (*c, radius)).collect();
        let mut grid = Grid::default();
        grid.fill(discs.iter().map(|(c, r)| Aabb::around(*c, *r)));
        KeepOut { discs, grid }
    }

    /// Where a wanderer begins that would begin at `at`: on the rim of the disc it would be in, the nearest
    /// place that is well within `bounds`; from the centre of one in direction `heading`. Among discs that
    /// overlap it may stay inside.
    fn pushed_out(&self, mut at: Vec2, heading: f64, bounds: Option<&Aabb>) -> Vec2 {
        for _ in 0..self.discs.len().min(8) {
            let inside = self.discs.iter().find(|(c, r)| norm(sub(at, *c)) < *r);
            let Some((center, radius)) = inside else { break };
            let out = sub(at, *center);
            let out = if norm(out) > TOUCHING { out } else { [libm::cos(heading), libm::sin(heading)] };
            let turned = |degrees: f64| {
                let (s, c) = libm::sincos(degrees.to_radians());
                let way = [c * out[0] - s * out[1], s * out[0] + c * out[1]];
                along(*center, way, (radius + TOUCHING) / norm(way))
            };
            // Where a disc touches the bounds it could go neither way.
            let free = |p: &Vec2| {
                bounds.is_none_or(|b| (0..2).all(|i| b.low[i] + 1e-6 < p[i] && p[i] < b.high[i] - 1e-6))
            };
            let nearest = along(*center, out, (radius + TOUCHING) / norm(out));
            let others = (1..=6).flat_map(|k| [f64::from(30 * k), f64::from(-30 * k)]).map(turned);
            at = std::iter::once(nearest).chain(others).find(free).unwrap_or(nearest);
        }
        at
    }
}

/// Walks straight, draws a new heading at every turn period, and is reflected by the bounds of the world
/// and by keep-out discs; it begins outside of these. Where it is beyond one all the same, pushed by a robot
/// or among discs that overlap, it walks on until it is out.
#[derive(Debug)]
pub struct Wanderer {
    heading: f64,
    speed: f64,
    turn_period: i64,
    /// Where the centre may be.
    bounds: Option<Aabb>,
    keep_out: KeepOut,
    noise: Stream,
}

/// What a wanderer runs into: when, and the unit normal there, outward.
type Hit = (f64, Vec2);

/// Nearer than this (m) it counts as touching rather than beyond.
const TOUCHING: f64 = 1e-9;

impl Wanderer {
    /// From `wanderer(…)`: the mover and where it starts. `anchors` are the robots' starts and targets.
    pub fn new(
        args: Args<'_>,
        bounds: Option<Aabb>,
        anchors: &[Vec2],
        noise: Stream,
    ) -> Result<(Wanderer, Place), String> {
        let [x, y, _] = args.vector("at")?;
        let radius = args.positive("radius")?;
        let heading = args.number("heading")?;
        let keep_out = match args.has("keep_out") {
            true => KeepOut::around(anchors, radius + args.at_least_zero("keep_out")?),
            false => KeepOut::default(),
        };
        let bounds = bounds.map(|b| Aabb {
            low: [b.low[0] + radius, b.low[1] + radius],
            high: [b.high[0] - radius, b.high[1] - radius],
        });
        let speed = args.at_least_zero("speed")?;
        let turn_period = args.period("turn_period")?.0.max(SHORTEST);
        let place = Place { at: keep_out.pushed_out([x, y], heading, bounds.as_ref()), heading, path: 0.0 };
        Ok((Wanderer { heading, speed, turn_period, bounds, keep_out, noise }, place))
    }

    fn plan(&mut self, body: &mut Body, t: i64, checked: i64) {
        let mut from = body.place(t);
        if t > 0 && t % self.turn_period == 0 {
            self.heading = TAU * self.noise.uniform();
        }
        let turn = t.saturating_add(self.turn_period - t % self.turn_period);
        // After a few reflections at one place (a corner, a narrowing gap) it goes back the way it came, and if
        // even that is barred waits for the next turn.
        let back = from.heading + PI;
        for attempt in 0..6 {
            if attempt == 5 {
                self.heading = back;
            }
            let (s, c) = libm::sincos(self.heading);
            let velocity = [self.speed * c, self.speed * s];
            from.heading = self.heading;
            let Some((dt, n)) = self.first_hit(from.at, velocity, seconds(t, turn)) else {
                return body.push(Piece::sliding(t, turn, from, [self.speed, 0.0], self.speed), checked);
            };
            let k = 2.0 * dot(velocity, n);
            self.heading = libm::atan2(velocity[1] - k * n[1], velocity[0] - k * n[0]);
            let end = t.saturating_add((dt * 1e9) as i64).min(turn);
            if end - t >= SHORTEST {
                return body.push(Piece::sliding(t, end, from, [self.speed, 0.0], self.speed), checked);
            }
        }
        let mut rest = Piece::rest(t, from);
        rest.end = turn;
        body.push(rest, checked);
    }

    /// The first reflection within `dt` seconds.
    fn first_hit(&self, at: Vec2, v: Vec2, dt: f64) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        let mut take = |t: f64, n: Vec2| {
            if t <= dt && first.is_none_or(|(f, _)| t < f) {
                first = Some((t, n));
            }
        };
        if let Some(b) = &self.bounds {
            for i in 0..2 {
                for (side, edge) in [(1.0, b.high[i]), (-1.0, b.low[i])] {
                    let (gap, rate) = (side * (edge - at[i]), side * v[i]);
                    if rate > 0.0 && gap >= -TOUCHING {
                        let mut n = [0.0; 2];
                        n[i] = -side;
                        take(gap.max(0.0) / rate, n);
                    }
                }
            }
        }
        let end = along(at, v, dt);
        let way = Aabb {
            low: [at[0].min(end[0]), at[1].min(end[1])],
            high: [at[0].max(end[0]), at[1].max(end[1])],
        };
        self.keep_out.grid.query(&way, |i| {
            let (center, radius) = self.keep_out.discs[i as usize];
            let p = sub(at, center);
            let d = norm(p);
            if dot(p, v) >= 0.0 || d < radius - TOUCHING {
                return;
            }
            if let Some((t, _)) = within(p, v, radius) {
                let t = t.max(0.0);
                let n = along(p, v, t);
                take(t, [n[0] / radius, n[1] / radius]);
            }
        });
        first
    }
}
