//! The circle swap with the crate dodgy_2d (ORCA), with the parameters of RVO2's example `Circle`: neighbours
//! within 15 m, at most the 10 nearest, 10 s ahead. Neighbours are looked up in a grid.

use dodgy_2d::{Agent, AvoidanceOptions, Vec2};
use std::borrow::Cow;

const RADIUS: f32 = 1.5;
const SPEED: f32 = 2.0;
pub const STEP: f32 = 0.25;
const RANGE: f32 = 15.0;
const MOST: usize = 10;
const HORIZON: f32 = 10.0;

/// A robot has arrived when it is no farther from its target.
const REACHED: f32 = 0.5;

/// More steps than any run takes.
const ENDLESS: usize = 20_000;

/// Agents and where they go.
pub struct Swap {
    agents: Vec<Agent>,
    targets: Vec<Vec2>,
    grid: Grid,
}

impl Swap {
    /// Agents at their starts.
    pub fn new(starts: &[[f64; 2]], targets: &[[f64; 2]]) -> Swap {
        let point = |p: &[f64; 2]| Vec2::new(p[0] as f32, p[1] as f32);
        let agent = |p| Agent {
            position: point(p),
            velocity: Vec2::ZERO,
            radius: RADIUS,
            avoidance_responsibility: 1.0,
        };
        let agents: Vec<Agent> = starts.iter().map(agent).collect();
        let targets: Vec<Vec2> = targets.iter().map(point).collect();
        let far = |p: &Vec2| p.x.abs().max(p.y.abs());
        let extent = targets.iter().map(far).fold(0.0, f32::max);
        Swap { agents, targets, grid: Grid::new(1.2 * extent) }
    }

    /// Steps until all have arrived.
    pub fn run(mut self) -> usize {
        (0..ENDLESS).find(|_| self.step()).unwrap_or(ENDLESS)
    }

    /// One step for all; true, and no step, when all have arrived.
    fn step(&mut self) -> bool {
        let near = |(a, t): (&Agent, &Vec2)| a.position.distance_squared(*t) <= REACHED * REACHED;
        if self.agents.iter().zip(&self.targets).all(near) {
            return true;
        }
        self.grid.fill(&self.agents);
        let options =
            AvoidanceOptions { obstacle_margin: 0.0, time_horizon: HORIZON, obstacle_time_horizon: HORIZON };
        let mut near: Vec<(f32, u32)> = Vec::new();
        let mut neighbours: Vec<Cow<'_, Agent>> = Vec::new();
        let mut velocities: Vec<Vec2> = Vec::with_capacity(self.agents.len());
        for (i, (agent, target)) in self.agents.iter().zip(&self.targets).enumerate() {
            near.clear();
            self.grid.around(agent.position, |j| {
                let d = self.agents[j as usize].position.distance_squared(agent.position);
                if j as usize != i && d <= RANGE * RANGE {
                    near.push((d, j));
                }
            });
            if near.len() > MOST {
                near.select_nth_unstable_by(MOST, |a, b| a.0.total_cmp(&b.0));
                near.truncate(MOST);
            }
            neighbours.clear();
            neighbours.extend(near.iter().map(|n| Cow::Borrowed(&self.agents[n.1 as usize])));
            let way = *target - agent.position;
            let wanted = if way.length() > SPEED * STEP { SPEED * way.normalize() } else { way / STEP };
            velocities.push(agent.compute_avoiding_velocity(&neighbours, &[], wanted, SPEED, STEP, &options));
        }
        for (agent, velocity) in self.agents.iter_mut().zip(velocities) {
            agent.velocity = velocity;
            agent.position += velocity * STEP;
        }
        false
    }
}

/// Square cells as wide as the range, over a square around the origin; what is outside is in the outermost.
struct Grid {
    extent: f32,
    side: usize,
    /// First agent of each cell, and the end.
    starts: Vec<u32>,
    agents: Vec<u32>,
}

impl Grid {
    fn new(extent: f32) -> Grid {
        let side = (2.0 * extent / RANGE).ceil().max(1.0) as usize;
        Grid { extent, side, starts: Vec::new(), agents: Vec::new() }
    }

    fn cell(&self, p: Vec2) -> [usize; 2] {
        [p.x, p.y].map(|x| (((x + self.extent) / RANGE).max(0.0) as usize).min(self.side - 1))
    }

    fn fill(&mut self, agents: &[Agent]) {
        self.starts.clear();
        self.starts.resize(self.side * self.side + 1, 0);
        for a in agents {
            let cell = self.index(a.position);
            self.starts[cell] += 1;
        }
        let mut sum = 0;
        for s in &mut self.starts {
            sum += *s;
            *s = sum;
        }
        self.agents.resize(agents.len(), 0);
        for (i, a) in agents.iter().enumerate().rev() {
            let cell = self.index(a.position);
            self.starts[cell] -= 1;
            self.agents[self.starts[cell] as usize] = i as u32;
        }
    }

    fn index(&self, p: Vec2) -> usize {
        let [x, y] = self.cell(p);
        y * self.side + x
    }

    /// Visits all in the cell of a place and the eight around it.
    fn around(&self, p: Vec2, mut visit: impl FnMut(u32)) {
        let [x, y] = self.cell(p);
        let last = (x + 1).min(self.side - 1);
        for y in y.saturating_sub(1)..=(y + 1).min(self.side - 1) {
            let row = y * self.side;
            let (from, to) = (self.starts[row + x.saturating_sub(1)], self.starts[row + last + 1]);
            self.agents[from as usize..to as usize].iter().for_each(|j| visit(*j));
        }
    }
}
