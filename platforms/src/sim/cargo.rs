//! Parcels: things that lie on the ground until a gripper closes around them, and go where their robot goes. One
//! gripper holds one parcel, and a parcel is held by one gripper. They are in nobody's way.

use super::{
    args::Args,
    body::Body,
    geometry::{Vec2, along, norm, sub},
};
use soifra_runtime::{Scene, Time};

/// Something to be carried.
#[derive(Debug, Clone)]
pub struct Parcel {
    /// Name.
    pub name: String,
    /// Radius.
    pub radius: f64,
    /// Where it lies while nobody holds it.
    at: Vec2,
    /// Who holds it.
    holder: Option<u32>,
}

/// All parcels, in order of declaration: they are numbered so.
#[derive(Debug, Clone, Default)]
pub struct Cargo {
    parcels: Vec<Parcel>,
}

impl Cargo {
    /// Of a scene.
    pub fn new(scene: &Scene) -> Result<Cargo, String> {
        let mut parcels = Vec::new();
        for part in scene.world.iter().filter(|p| &*p.role == "parcel") {
            let args = Args { part, of: "the world" };
            let [x, y, _] = args.vector("at")?;
            let radius = args.positive("radius")?;
            parcels.push(Parcel { name: part.name.clone(), radius, at: [x, y], holder: None });
        }
        Ok(Cargo { parcels })
    }

    /// Number of the parcel that a robot holds.
    pub fn held_by(&self, robot: u32) -> Option<usize> {
        self.parcels.iter().position(|p| p.holder == Some(robot))
    }

    /// Closes a robot's gripper around the nearest free parcel whose rim is within reach of the robot's.
    pub fn close(&mut self, robot: u32, body: &Body, reach: f64, now: i64) {
        if self.held_by(robot).is_some() {
            return;
        }
        let here = body.place(now).at;
        let gap = |p: &Parcel| norm(sub(p.at, here)) - p.radius - body.radius;
        let free = self.parcels.iter_mut().filter(|p| p.holder.is_none());
        let nearest = free.min_by(|a, b| gap(a).total_cmp(&gap(b)));
        if let Some(p) = nearest.filter(|p| norm(sub(p.at, here)) - p.radius - body.radius <= reach) {
            p.holder = Some(robot);
        }
    }

    /// Opens it: what it held lies in front of the robot.
    pub fn open(&mut self, robot: u32, body: &Body, now: i64) {
        if let Some(p) = self.parcels.iter_mut().find(|p| p.holder == Some(robot)) {
            let ahead = body.direction(Time(now));
            p.at = along(body.place(now).at, ahead, body.radius + p.radius);
            p.holder = None;
        }
    }

    /// Names and poses: a parcel that is held is where its robot is.
    pub fn poses<'c>(
        &'c self,
        bodies: &'c [Body],
        now: i64,
    ) -> impl Iterator<Item = (String, [f64; 7])> + 'c {
        self.parcels.iter().map(move |p| {
            let body = p.holder.and_then(|r| bodies.get(r as usize));
            let [x, y] = body.map_or(p.at, |b| b.place(now).at);
            (p.name.clone(), [x, y, 0.0, 0.0, 0.0, 0.0, 1.0])
        })
    }
}
