//! What is seen in an image, and the questions that it answers.

use soifra_graph::eval::FaultKind;
use soifra_runtime::objects::{Object, Optics};
use soifra_vision::{
    Gray, Why,
    contours::Contours,
    course::{self, Body, Reach},
    flow,
    follow::Moment,
    known::{self, Remembering},
    landmarks::believed,
    look::{Memory, Seen},
    obstacle::Obstacle,
    reckoning::{Stop, relative},
    rectify::Rectification,
    robust::{self, Part, Robust},
    sweep::Tangent,
    turning::{Curve, Footprint, free_turn},
};
use std::{any::Any, sync::Arc};

/// How far ahead a way is to be free to be turned to, m.
const FREE: f64 = 3.0;

/// What is seen in an image, and what is remembered of those before.
#[derive(Debug)]
pub struct Sight {
    /// What is seen.
    pub seen: Seen,
    /// For the next image.
    pub memory: Memory,
    /// The image before, in grey, for what compares two images alone.
    pub previous: Option<Gray>,
    /// How contours are found.
    pub contours: Contours,
    /// The camera at the image.
    pub moment: Moment,
    /// Where the body was at this image and those before.
    pub stops: Vec<Stop>,
    /// How fast the body moved, m/s, when somebody knows.
    pub speed: Option<f64>,
    /// What is to pass.
    pub body: Body,
    /// Since the image before, s.
    pub interval: Option<f64>,
    /// For a lens that distorts.
    pub rectification: Option<Arc<Rectification>>,
    /// The lens.
    pub optics: Optics,
}

impl Object for Sight {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl Sight {
    /// Captured, speed, course off straight ahead, how far ahead of the body's origin the camera is along it.
    pub fn viewpoint(&self) -> [f64; 4] {
        let off = self.slip();
        [self.moment.time, self.speed.unwrap_or(0.0), -off, self.optics.ahead(off)]
    }

    fn first(&self) -> Result<&Obstacle, Why> {
        let seen = self.seen.obstacles.as_ref().map_err(|why| *why)?;
        seen.get(self.seen.first?).ok_or(Why::NoObstacle)
    }

    /// Count, then left, right, contact, deviation of each.
    pub fn obstacles(&self, out: &mut [f64]) -> Result<(), FaultKind> {
        let (count, items) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
        items.fill(0.0);
        let seen = self.seen.obstacles.as_deref().unwrap_or_default();
        let mut n = 0;
        for (slot, o) in items.as_chunks_mut::<4>().0.iter_mut().zip(seen) {
            let bearing = |t: &[Tangent]| t.last().map_or(0.0, |w| libm::atan(w.tangent));
            *slot = [bearing(&o.left_tangents), bearing(&o.right_tangents), o.contact.ttc, o.contact.sigma];
            n += 1;
        }
        *count = f64::from(n);
        Ok(())
    }

    /// By expansion.
    pub fn expansion(&self) -> Result<f64, Why> {
        self.at_speed(self.seen.contact?)
    }

    /// A time to contact at the moment's pace as one at the robot's speed.
    fn at_speed(&self, ttc: f64) -> Result<f64, Why> {
        match self.speed {
            None => Ok(ttc),
            Some(0.0) => Err(Why::SpeedZero),
            Some(speed) => Ok(ttc * self.moment.pace / speed),
        }
    }

    /// By flow, as published.
    pub fn flow(&self) -> Result<f64, Why> {
        self.first()?;
        let tracks: Vec<_> = self.seen.flows.iter().map(|f| f.track).collect();
        Ok(flow::published(&tracks, self.interval.ok_or(Why::TooShort)?)?.ttc)
    }

    /// By flow over a longer time, none above a rate of turning.
    pub fn robust_flow(&self, rotating: f64) -> Result<f64, Why> {
        self.first()?;
        let how = Robust { rotating, ..Robust::default() };
        self.at_speed(robust::history(&self.memory.points, &self.moment, &how)?.ttc)
    }

    /// The published test.
    pub fn diverging(&self) -> Result<bool, Why> {
        self.first()?;
        let of = |part: Part| -> Vec<_> {
            self.seen.flows.iter().filter(|f| f.part == part).map(|f| f.track).collect()
        };
        course::diverging(&of(Part::Left), &of(Part::Right))
    }

    /// Collision, distance, clearance, whether the left is freer, turns to a free way to the left and to the right.
    pub fn course(&self, radius: f64, least: f64) -> Result<[f64; 6], Why> {
        if self.speed.is_none() {
            return Err(Why::SpeedUnknown);
        }
        let now = &self.moment;
        let place = self.stops.last().map_or(now.place, |s| s.place);
        let need = self.body.half_width + self.body.margin;
        let how = Remembering::default();
        let known = self.memory.known.iter().filter(|k| k.is_sure(&how));
        let landmarks = believed(&self.memory.landmarks, &how);
        let footprints: Vec<Footprint> = known
            .map(|k| k.footprint(place, now.course))
            .chain(landmarks.iter().map(|p| [relative(*p, place, now.course); 4]))
            .collect();
        let ahead = self.optics.ahead(self.slip());
        let reach = |f: &Footprint| known::reach(f, need, ahead, now.pace);
        let reaches: Vec<Reach> = footprints.iter().filter_map(reach).collect();
        if reaches.is_empty() {
            return Err(self.seen.obstacles.as_ref().err().copied().unwrap_or(Why::NoObstacle));
        }
        let c = course::course(&reaches, &self.body)?;
        let distance = reaches.get(c.nearest).map_or(0.0, |r| r.ttc * now.pace + ahead);
        let Body { half_width, margin } = self.body;
        let curve = Curve { half_width, margin, radius, length: FREE, least };
        let turn = |sign| free_turn(&footprints, &curve, sign);
        let (left, right) = (turn(1.0), turn(-1.0));
        let freer = if left == right { c.freer == course::Freer::Left } else { left < right };
        let flag = |b: bool| f64::from(u8::from(b));
        Ok([flag(c.collision), distance, c.clearance, flag(freer), left, right])
    }

    /// Where the robot's x axis points, off its course.
    pub(super) fn slip(&self) -> f64 {
        let course = self.moment.course;
        self.stops.last().map_or(course, |s| s.yaw) - course
    }
}
