//! Movers and round obstacles nearby, as discs on the map.

use super::{Mount, Needs, Sensor, View};
use crate::sim::geometry::{Aabb, Shape, Vec2, norm, sub};

/// Registers: count, then x y z radius of each, nearest rim first, padded with zeros to the capacity.
/// Distances are from the centre of the robot to the rim.
#[derive(Debug)]
pub struct Discs {
    range: f64,
    capacity: usize,
    found: Vec<Found>,
}

#[derive(Debug, Clone, Copy)]
struct Found {
    distance: f64,
    /// Movers first, then things, each in order of declaration: ties are decided by it.
    rank: u64,
    disc: [f64; 4],
}

impl Discs {
    /// From `discs(…)`.
    pub fn new(mount: Mount<'_>) -> Result<Discs, String> {
        let range = mount.args.positive("range")?;
        Ok(Discs { range, capacity: mount.args.count("capacity", 10_000)?, found: Vec::new() })
    }

    fn take(&mut self, from: Vec2, at: Vec2, z: f64, radius: f64, rank: u64) {
        let distance = norm(sub(at, from)) - radius;
        if distance <= self.range {
            self.found.push(Found { distance, rank, disc: [at[0], at[1], z, radius] });
        }
    }
}

impl Sensor for Discs {
    fn needs(&self) -> Needs {
        Needs { movers: true, robots: false }
    }

    fn capture(&mut self, _: usize, robot: usize, view: &View<'_>, out: &mut Vec<f64>) {
        let from = view.bodies[robot].place(view.at.0).at;
        let area = Aabb::around(from, self.range);
        self.found.clear();
        view.nearby.movers.query(&area, |i| {
            let b = &view.bodies[(view.nearby.count + i) as usize];
            self.take(from, b.place(view.at.0).at, b.span(view.at.0)[0], b.radius, u64::from(i));
        });
        view.things.grid.query(&area, |i| {
            let t = &view.things.all[i as usize];
            if let Shape::Disc { at, radius } = t.shape {
                self.take(from, at, t.span[0], radius, u64::from(i) + (1 << 32));
            }
        });
        self.found.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.rank.cmp(&b.rank)));
        self.found.truncate(self.capacity);
        out.push(self.found.len() as f64);
        self.found.iter().for_each(|f| out.extend_from_slice(&f.disc));
        out.resize(out.len() + 4 * (self.capacity - self.found.len()), 0.0);
    }
}
