//! What is really so.

use super::Simulator;
use soifra_runtime::{Time, WorldTruth};

impl WorldTruth for Simulator {
    /// The identity for a robot that does not exist.
    fn pose(&self, robot: u32) -> [f64; 7] {
        match self.bodies.get(robot as usize) {
            Some(b) => b.pose(Time(self.now)),
            None => [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        }
    }

    fn position(&self, robot: u32) -> [f64; 3] {
        // The search for contacts has just asked all bodies where they are.
        if let Some([x, y]) = self.collisions.place(robot as usize, self.now) {
            return [x, y, self.bodies[robot as usize].span(self.now)[0]];
        }
        self.bodies.get(robot as usize).map_or([0.0; 3], |b| b.position(Time(self.now)))
    }

    fn path_length(&self, robot: u32) -> f64 {
        self.bodies.get(robot as usize).map_or(0.0, |b| b.place(self.now).path)
    }

    fn collisions(&self, robot: u32) -> u32 {
        self.collisions.count(robot as usize)
    }

    fn in_collision(&self, robot: u32) -> bool {
        self.collisions.touching(robot as usize)
    }

    fn total_collisions(&self) -> u32 {
        self.collisions.total()
    }

    fn movers(&self) -> Vec<(String, [f64; 7])> {
        let movers = self.bodies.iter().skip(self.drives.len());
        let movers = movers.map(|b| (b.name.clone(), b.pose(Time(self.now))));
        movers.chain(self.cargo.poses(&self.bodies, self.now)).collect()
    }
}
