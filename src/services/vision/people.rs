//! Watching people: from the registers of a call to who is there.

use super::eye::{Reckoned, Registers, Tilted, alone, stop, straight};
use soifra_graph::eval::FaultKind;
use soifra_runtime::objects::{Frame, Object, Optics, Shelf};
use soifra_vision::{
    ImageView, Lens, Why,
    attitude::Attitude,
    ground::Ground,
    people::{People, Standpoint, people},
    person::Searching,
};
use std::any::Any;

/// Somebody who was seen that long ago, in seconds, is still told of.
const LATELY: f64 = 1.0;

/// Who is seen in an image, and remembered of those before.
#[derive(Debug)]
pub struct Crowd {
    people: People,
    optics: Optics,
}

impl Object for Crowd {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Watches. The registers: image, people before?, reading of odometry, of an inertial unit?.
pub fn watch(args: &[f64], shelf: &dyn Shelf) -> Result<Result<Crowd, Why>, FaultKind> {
    alone();
    let mut rest = Registers(args);
    let [image] = rest.take()?;
    let before = rest.optional::<1>()?.map(|[n]| n);
    let odometry = Reckoned::of(rest.take()?);
    let imu = rest.optional()?.map(Tilted::of);
    let object = shelf.get(image).ok_or(FaultKind::Unavailable("this image"))?;
    let frame = object.as_any().downcast_ref::<Frame>().ok_or(FaultKind::Malformed)?;
    let before = before.map(|b| shelf.get(b).ok_or(FaultKind::Unavailable("these people"))).transpose()?;
    let before = before.as_ref().and_then(|b| b.as_any().downcast_ref::<Crowd>());
    Ok(see(frame, before, &odometry, imu.as_ref()))
}

fn see(
    frame: &Frame,
    before: Option<&Crowd>,
    odometry: &Reckoned,
    imu: Option<&Tilted>,
) -> Result<Crowd, Why> {
    let optics = frame.optics;
    let image = ImageView::new(frame.width as usize, frame.height as usize, 3, &frame.data)?;
    let time = frame.captured.seconds();
    let stop = stop(time, odometry, imu);
    let level = imu.map_or(Attitude::default(), |i| i.attitude(time, 0.0));
    let at = level.level(optics.at);
    let (s, c) = libm::sincos(stop.yaw);
    let place = [stop.place[0] + c * at[0] - s * at[1], stop.place[1] + s * at[0] + c * at[1]];
    let lens = Lens { distortion: optics.distortion, ..straight(&optics) };
    let ground = Ground { lens, attitude: level.looking_down(optics.tilt), height: at[2] };
    let here = Standpoint { time, place, yaw: stop.yaw, ground };
    // Of another camera nothing is remembered.
    let before = before.filter(|b| b.optics == optics).map(|b| &b.people);
    Ok(Crowd { people: people(&image, before, &here, &Searching::default())?, optics })
}

impl Crowd {
    /// Count, then number, place, velocity, whether walking, unseen for.
    pub fn seen(&self, out: &mut [f64]) -> Result<(), FaultKind> {
        let (count, items) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
        items.fill(0.0);
        let People { time, tracks, .. } = &self.people;
        let sure = tracks.iter().filter(|t| t.is_sure() && time - t.seen <= LATELY);
        let mut n = 0;
        for (slot, t) in items.as_chunks_mut::<9>().0.iter_mut().zip(sure) {
            let ([x, y], [u, v]) = (t.place, t.velocity);
            *slot = [f64::from(t.number), x, y, 0.0, u, v, 0.0, f64::from(u8::from(t.walks)), time - t.seen];
            n += 1;
        }
        *count = f64::from(n);
        Ok(())
    }
}
