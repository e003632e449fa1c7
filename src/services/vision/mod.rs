//! The vision services: what a mission sees, out of images.

use soifra_graph::{Function, eval::FaultKind, reason};
use soifra_runtime::objects::{Frame, Object, Optics, Shelf};
use soifra_vision::{
    Gray, ImageView, Lens, Why,
    attitude::{Attitude, Rates},
    course::{self, Bearing, Body, Reach},
    flow,
    follow::Moment,
    look::{Looking, Memory, Seen, look_at},
    rectify::Rectification,
    robust::{self, Part, Robust},
};
use std::{any::Any, sync::Arc};

/// What is seen in an image, and what is remembered of those before.
#[derive(Debug)]
struct Sight {
    seen: Seen,
    memory: Memory,
    moment: Moment,
    /// Since the image before, s.
    interval: Option<f64>,
    lens: Lens,
    /// For a lens that distorts.
    rectification: Option<Arc<Rectification>>,
    optics: Optics,
}

impl Object for Sight {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Computes a service.
pub fn call(which: Function, args: &[f64], shelf: &mut dyn Shelf, out: &mut [f64]) -> Result<(), FaultKind> {
    if which == Function::Look {
        let made = look(args, shelf)?;
        return optional(out, made.map(|sight| [shelf.put(Arc::new(sight))]));
    }
    let (number, rest) = args.split_first().ok_or(FaultKind::Malformed)?;
    let object = shelf.get(*number).ok_or(FaultKind::Unavailable("this sight"))?;
    let sight = object.as_any().downcast_ref::<Sight>().ok_or(FaultKind::Malformed)?;
    match (which, rest) {
        (Function::Obstacles, []) => sight.obstacles(out),
        (Function::ContactByExpansion, []) => optional(out, sight.expansion().map(|t| [t])),
        (Function::ContactByFlow, []) => optional(out, sight.flow().map(|t| [t])),
        (Function::ContactByRobustFlow, []) => optional(out, sight.robust_flow().map(|t| [t])),
        (Function::Diverging, []) => optional(out, sight.diverging().map(|b| [f64::from(u8::from(b))])),
        (Function::CourseAhead, [speed, half_width, margin]) => {
            optional(out, sight.course(*speed, Body { half_width: *half_width, margin: *margin }))
        }
        _ => Err(FaultKind::Malformed),
    }
}

/// Registers of an optional: tag and value.
fn optional<const N: usize>(out: &mut [f64], value: Result<[f64; N], Why>) -> Result<(), FaultKind> {
    let (tag, rest) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
    if rest.len() != N {
        return Err(FaultKind::Malformed);
    }
    match value {
        Ok(value) => {
            *tag = 0.0;
            rest.copy_from_slice(&value);
        }
        Err(why) => {
            *tag = reason::tag(reason::index(why.text()));
            rest.fill(0.0);
        }
    }
    Ok(())
}

/// Looks at an image: its number, tag and number of the sight before, roll, pitch, three rates, heading, course.
fn look(args: &[f64], shelf: &dyn Shelf) -> Result<Result<Sight, Why>, FaultKind> {
    let [image, none, before, roll, pitch, p, q, r, heading, course] = *args else {
        return Err(FaultKind::Malformed);
    };
    let object = shelf.get(image).ok_or(FaultKind::Unavailable("this image"))?;
    let frame = object.as_any().downcast_ref::<Frame>().ok_or(FaultKind::Malformed)?;
    let before = match none == 0.0 {
        true => Some(shelf.get(before).ok_or(FaultKind::Unavailable("this sight"))?),
        false => None,
    };
    let before = before.as_ref().and_then(|b| b.as_any().downcast_ref::<Sight>());
    let moment = Moment {
        time: frame.captured.seconds(),
        attitude: Attitude { roll, pitch, yaw: heading },
        rates: Rates { roll: p, pitch: q, yaw: r },
        course,
    };
    Ok(see(frame, before, moment))
}

fn see(frame: &Frame, before: Option<&Sight>, moment: Moment) -> Result<Sight, Why> {
    let size = (frame.width as usize, frame.height as usize);
    let gray = Gray::of(&ImageView::new(size.0, size.1, 3, &frame.data)?)?;
    // Of another camera nothing is remembered.
    let before = before.filter(|b| b.optics == frame.optics);
    let [fx, fy] = frame.optics.focal;
    // There a pixel's centre is a whole number.
    let [cx, cy] = frame.optics.centre.map(|c| c - 0.5);
    let lens = Lens { fx, fy, cx, cy, distortion: None };
    let rectification = match (before, frame.optics.distortion) {
        (_, None) => None,
        (Some(Sight { rectification: Some(known), .. }), _) => Some(Arc::clone(known)),
        (_, distortion) => {
            let source = Lens { distortion, ..lens };
            Some(Arc::new(Rectification::new(&source, size, &lens, size.0, size.1)?))
        }
    };
    let gray = match &rectification {
        Some(r) => r.apply(&gray)?,
        None => gray,
    };
    let empty = Memory::default();
    let memory = before.map_or(&empty, |b| &b.memory);
    let interval = memory.time.map(|t| moment.time - t);
    let (seen, memory) = look_at(gray, memory, &moment, &lens, &Looking::default())?;
    Ok(Sight { seen, memory, moment, interval, lens, rectification, optics: frame.optics })
}

impl Sight {
    fn nearest(&self) -> Result<&soifra_vision::obstacle::Obstacle, Why> {
        self.seen.obstacles.as_ref().map_err(|why| *why)?.first().ok_or(Why::NoObstacle)
    }

    /// Count, then left, right, contact, deviation of each.
    fn obstacles(&self, out: &mut [f64]) -> Result<(), FaultKind> {
        let (count, items) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
        items.fill(0.0);
        let seen = self.seen.obstacles.as_deref().unwrap_or_default();
        let mut n = 0;
        for (slot, o) in items.as_chunks_mut::<4>().0.iter_mut().zip(seen) {
            let bearing =
                |t: &[soifra_vision::expansion::Width]| t.last().map_or(0.0, |w| libm::atan(w.width));
            *slot = [bearing(&o.left_tangents), bearing(&o.right_tangents), o.contact.ttc, o.contact.sigma];
            n += 1;
        }
        *count = f64::from(n);
        Ok(())
    }

    fn expansion(&self) -> Result<f64, Why> {
        Ok(self.nearest()?.contact.ttc)
    }

    fn flow(&self) -> Result<f64, Why> {
        self.nearest()?;
        let tracks: Vec<_> = self.seen.flows.iter().map(|f| f.track).collect();
        Ok(flow::published(&tracks, self.interval.ok_or(Why::TooShort)?)?.ttc)
    }

    fn robust_flow(&self) -> Result<f64, Why> {
        self.nearest()?;
        let Moment { time, course, rates, .. } = self.moment;
        Ok(robust::history(&self.memory.points, time, course, &rates, &Robust::default())?.ttc)
    }

    fn diverging(&self) -> Result<bool, Why> {
        self.nearest()?;
        let of = |part: Part| -> Vec<_> {
            self.seen.flows.iter().filter(|f| f.part == part).map(|f| f.track).collect()
        };
        course::diverging(&of(Part::Left), &of(Part::Right))
    }

    /// Collision, contact, clearance, whether the left is freer, sidesteps to the left and to the right.
    fn course(&self, speed: f64, body: Body) -> Result<[f64; 6], Why> {
        let seen = self.seen.obstacles.as_ref().map_err(|why| *why)?;
        let reach = |o: &soifra_vision::obstacle::Obstacle| {
            let closing = 1.0 / o.contact.ttc;
            let (left, right) =
                (Bearing::fit(&o.left_tangents, closing)?, Bearing::fit(&o.right_tangents, closing)?);
            Reach::predict(&left, &right, o.contact.ttc, speed)
        };
        let reaches = seen.iter().map(reach).collect::<Result<Vec<_>, Why>>()?;
        let c = course::course(&reaches, &body)?;
        let contact = reaches.get(c.nearest).map_or(0.0, |r| r.ttc);
        let flag = |b: bool| f64::from(u8::from(b));
        let freer = flag(c.freer == course::Freer::Left);
        Ok([flag(c.collision), contact, c.clearance, freer, c.to_left, c.to_right])
    }

    /// The lens of the images that were looked at.
    #[allow(dead_code, reason = "overlays will ask for it, 2026-11")]
    fn lens(&self) -> &Lens {
        &self.lens
    }
}
