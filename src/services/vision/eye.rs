//! Looking at an image: from the registers of a call to what is seen.

use super::{super::Readings, sight::Sight};
use rayon::{ThreadPool, ThreadPoolBuilder};
use soifra_graph::eval::FaultKind;
use soifra_runtime::objects::{Frame, Optics, Shelf};
use soifra_vision::{
    Gray, ImageView, Lens, Why,
    attitude::{Attitude, Rates},
    contours::Thresholds,
    course::{Body, Lane},
    follow::Moment,
    known::Remembering,
    look::{Looking, Memory, look_at},
    reckoning::{Motion, Stop, motion},
    rectify::Rectification,
};
use std::sync::{Arc, LazyLock, Once};

/// That OpenCV leaves the threads to us.
static SINGLE: Once = Once::new();

/// A thread that takes part of a look; none where the system gives none.
static HELPER: LazyLock<Option<ThreadPool>> =
    LazyLock::new(|| ThreadPoolBuilder::new().num_threads(1).thread_name(|_| "look".into()).build().ok());

/// Leaves the threads to us; what is computed does not depend on it.
pub(super) fn alone() {
    SINGLE.call_once(|| {
        let _ = soifra_vision::single_thread();
    });
}

/// How far back the speed is measured, s.
const RECENT: f64 = 0.4;

/// A slower robot's way counts as time at this speed, m/s: it still sees what it saw a while ago.
const SLOWEST: f64 = 0.25;

/// A reading of an inertial unit.
#[derive(Clone, Copy)]
pub(super) struct Tilted {
    roll: f64,
    pitch: f64,
    rates: Rates,
    captured: f64,
}

/// A reading of odometry.
#[derive(Clone, Copy)]
pub(super) struct Reckoned {
    place: [f64; 2],
    yaw: f64,
    forward: f64,
    left: f64,
    turn: f64,
    captured: f64,
}

impl Tilted {
    /// From registers.
    pub(super) fn of([roll, pitch, p, q, r, captured]: [f64; 6]) -> Tilted {
        Tilted { roll, pitch, rates: Rates { roll: p, pitch: q, yaw: r }, captured }
    }

    /// The attitude of the body at an instant, by the rates; its yaw is given.
    pub(super) fn attitude(&self, time: f64, yaw: f64) -> Attitude {
        let later = time - self.captured;
        Attitude {
            roll: self.roll + self.rates.roll * later,
            pitch: self.pitch + self.rates.pitch * later,
            yaw,
        }
    }
}

impl Reckoned {
    /// From registers.
    pub(super) fn of([x, y, _, _, _, qz, qw, forward, left, _, _, _, turn, captured]: [f64; 14]) -> Reckoned {
        Reckoned { place: [x, y], yaw: 2.0 * libm::atan2(qz, qw), forward, left, turn, captured }
    }
}

/// What a call asks for beside the image.
struct Asked {
    imu: Option<Tilted>,
    odometry: Option<Reckoned>,
    body: Body,
    thresholds: Thresholds,
    window: f64,
    helper: Option<&'static ThreadPool>,
}

/// Looks at an image. The registers: image, sight before?, reading of an inertial unit?, of odometry?, half width and
/// margin of the body, thresholds low? and high?, window.
pub fn look(args: &[f64], shelf: &dyn Shelf) -> Result<Result<Sight, Why>, FaultKind> {
    alone();
    let mut rest = Registers(args);
    let [image] = rest.take()?;
    let before = rest.optional::<1>()?.map(|[n]| n);
    let imu = rest.optional()?.map(Tilted::of);
    let odometry = rest.optional()?.map(Reckoned::of);
    let [half_width, margin] = rest.take()?;
    let (low, high) = (rest.optional::<1>()?, rest.optional::<1>()?);
    let thresholds = match (low, high) {
        (None, None) => Thresholds::Automatic,
        // One of them tells the other, in the usual proportion.
        (low, high) => {
            let [high] = high.or(low.map(|[l]| [3.0 * l])).ok_or(FaultKind::Malformed)?;
            Thresholds::Fixed { low: low.map_or(high / 3.0, |[l]| l), high }
        }
    };
    let [window] = rest.take()?;
    let object = shelf.get(image).ok_or(FaultKind::Unavailable("this image"))?;
    let frame = object.as_any().downcast_ref::<Frame>().ok_or(FaultKind::Malformed)?;
    let before = before.map(|b| shelf.get(b).ok_or(FaultKind::Unavailable("this sight"))).transpose()?;
    let before = before.as_ref().and_then(|b| b.as_any().downcast_ref::<Sight>());
    let helper = if shelf.threads() > 1 { HELPER.as_ref() } else { None };
    let body = Body { half_width, margin };
    Ok(see(frame, before, &Asked { imu, odometry, body, thresholds, window, helper }))
}

/// How far back edges are remembered unless a call says otherwise, s.
const WINDOW: f64 = 2.5;

/// Looks at an image outside of a run, with what `look` takes where a call leaves it out.
pub(super) fn look_on(frame: &Frame, before: Option<&Sight>, known: &Readings) -> Result<Sight, Why> {
    alone();
    let asked = Asked {
        imu: known.imu.map(Tilted::of),
        odometry: known.odometry.map(Reckoned::of),
        body: Body { half_width: known.half_width, margin: 0.0 },
        thresholds: Thresholds::Automatic,
        window: WINDOW,
        helper: HELPER.as_ref(),
    };
    see(frame, before, &asked)
}

/// Registers that are taken from the front.
pub(super) struct Registers<'a>(pub(super) &'a [f64]);

impl Registers<'_> {
    pub(super) fn take<const N: usize>(&mut self) -> Result<[f64; N], FaultKind> {
        let (first, rest) = self.0.split_first_chunk::<N>().ok_or(FaultKind::Malformed)?;
        self.0 = rest;
        Ok(*first)
    }

    pub(super) fn optional<const N: usize>(&mut self) -> Result<Option<[f64; N]>, FaultKind> {
        let [tag] = self.take()?;
        let value = self.take()?;
        Ok((tag == 0.0).then_some(value))
    }
}

/// The lens of an image after its distortion has been taken out.
pub(super) fn straight(optics: &Optics) -> Lens {
    let [fx, fy] = optics.focal;
    // There a pixel's centre is a whole number.
    let [cx, cy] = optics.centre.map(|c| c - 0.5);
    Lens { fx, fy, cx, cy, distortion: None }
}

fn see(frame: &Frame, before: Option<&Sight>, asked: &Asked) -> Result<Sight, Why> {
    let size = (frame.width as usize, frame.height as usize);
    let gray = Gray::of(&ImageView::new(size.0, size.1, 3, &frame.data)?)?;
    // Of another camera nothing is remembered.
    let before = before.filter(|b| b.optics == frame.optics);
    let lens = straight(&frame.optics);
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
    let time = frame.captured.seconds();
    let (stop, moving) = moving(time, before, asked)?;
    let mut stops: Vec<Stop> = before.map(|b| b.stops.clone()).unwrap_or_default();
    stops.retain(|s| time - s.time <= RECENT);
    stops.push(stop);
    let moment = moment(&stop, &moving, asked, &frame.optics);
    let aside = frame.optics.aside(stop.yaw - moving.course);
    let need = asked.body.half_width + asked.body.margin;
    let mut how = Looking { lane: Lane { left: need - aside, right: -need - aside }, ..Looking::default() };
    how.contours.thresholds = asked.thresholds;
    how.remembering = asked.odometry.map(|_| (Remembering::default(), moving.speed));
    how.pairing.window.length = asked.window;
    how.edges.memory = how.edges.memory.max(asked.window);
    let empty = Memory::default();
    let memory = before.map_or(&empty, |b| &b.memory);
    let interval = memory.time.map(|t| time - t);
    let (seen, memory) = look_at(gray, memory, &moment, &lens, &how, asked.helper)?;
    let speed = asked.odometry.map(|_| moving.speed);
    let (body, optics) = (asked.body, frame.optics);
    let previous = before.and_then(|b| b.memory.image.clone());
    let contours = how.contours;
    Ok(Sight {
        seen,
        memory,
        previous,
        contours,
        moment,
        stops,
        speed,
        body,
        interval,
        rectification,
        optics,
    })
}

/// Where the body was at an instant.
pub(super) fn stop(time: f64, o: &Reckoned, imu: Option<&Tilted>) -> Stop {
    let later = time - o.captured;
    let turn = imu.map_or(o.turn, |i| i.rates.yaw);
    let yaw = o.yaw + turn * later;
    let (s, c) = libm::sincos(yaw);
    let place = [
        o.place[0] + (o.forward * c - o.left * s) * later,
        o.place[1] + (o.forward * s + o.left * c) * later,
    ];
    Stop { time, place, yaw }
}

/// Where the body was at the image, and how it moved: readings are brought back to its instant by their own rates.
fn moving(time: f64, before: Option<&Sight>, asked: &Asked) -> Result<(Stop, Motion), Why> {
    let Some(o) = asked.odometry else {
        // Straight ahead, at a speed that nobody knows.
        return Ok((Stop { time, place: [time, 0.0], yaw: 0.0 }, Motion { course: 0.0, speed: 1.0 }));
    };
    let stop = stop(time, &o, asked.imu.as_ref());
    let known = before.map_or(&[][..], |b| &b.stops[..]);
    let moving = match motion(known, &stop) {
        // Nothing to compare with yet: what the reading says.
        Err(Why::TooShort) => {
            let slip = if o.forward == 0.0 && o.left == 0.0 { 0.0 } else { libm::atan2(o.left, o.forward) };
            Motion { course: stop.yaw + slip, speed: libm::hypot(o.forward, o.left) }
        }
        other => other?,
    };
    Ok((stop, moving))
}

/// The camera at the image.
fn moment(stop: &Stop, moving: &Motion, asked: &Asked, optics: &Optics) -> Moment {
    let level = Tilted { roll: 0.0, pitch: 0.0, rates: Rates::default(), captured: stop.time };
    let i = asked.imu.unwrap_or(level);
    let body = i.attitude(stop.time, stop.yaw);
    let at = body.level(optics.at);
    let place = match asked.odometry {
        Some(_) => [stop.place[0] + at[0], stop.place[1] + at[1]],
        None => stop.place,
    };
    Moment {
        time: stop.time,
        attitude: body.looking_down(optics.tilt),
        rates: i.rates.looking_down(optics.tilt),
        place,
        course: moving.course,
        pace: if asked.odometry.is_some() { moving.speed.max(SLOWEST) } else { moving.speed },
    }
}
