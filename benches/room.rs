//! What the mission of the room costs beside its images: to rendering them bare and the bare OpenCV calls on them, on one
//! core and on two; and whether memory stays flat over ten minutes of it.
#![expect(clippy::print_stdout, reason = "a bench tells its figures on the terminal")]

#[path = "support/memory.rs"]
mod memory;
mod support;

#[path = "../runtime/vision/benches/bare/mod.rs"]
mod bare;

use opencv::core::{Mat, Point2f, Vector};
use soifra_platforms::sim::camera::Rendered;
use soifra_runtime::{
    Event, Record, Time, TraceSink,
    objects::{Cameras, Frame},
};
use soifra_vision::{
    Gray, ImageView, Lens,
    contours::{Thresholds, derivatives, thresholds},
    follow::Moment,
    look::{Looking, Memory, look_at},
};
use std::sync::{Arc, atomic::AtomicBool};

/// The agents of the room.
const AGENTS: &str = "missions/soifra/avoidance.soi";
/// Simulated seconds of a bench run.
const SPAN: f64 = 20.0;

/// Keeps from where images were taken.
#[derive(Default)]
struct Views(Vec<(u32, u32, Time, Vec<f64>)>);

impl TraceSink for Views {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        if let Event::Image { robot, sensor, captured, view, .. } = &record.event {
            self.0.push((*robot, *sensor, *captured, view.clone()));
        }
        Ok(())
    }
}

/// Resident memory in MB after a minute and after ten, where the system tells it (Linux).
#[derive(Default)]
struct Resident([Option<f64>; 2]);

impl TraceSink for Resident {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        for (slot, after) in self.0.iter_mut().zip([60.0, 599.0]) {
            if slot.is_none() && record.t.seconds() >= after {
                *slot = memory::resident();
            }
        }
        Ok(())
    }
}

/// What is done to a frame by bare calls.
struct Bare {
    limits: (f64, f64),
    derivatives: (Mat, Mat),
    points: Vector<Point2f>,
}

/// Thresholds and followed points of each frame, as the services choose them.
fn bare_calls(frames: &[Arc<Frame>], how: &Looking) -> Vec<Bare> {
    let mut memory = Memory::default();
    frames
        .iter()
        .map(|f| {
            let size = (f.width as usize, f.height as usize);
            let gray = Gray::of(&ImageView::new(size.0, size.1, 3, &f.data).expect("a frame")).expect("grey");
            let limits = thresholds(&gray, Thresholds::Automatic).expect("thresholds");
            let derivatives = derivatives(&gray, 0.0, &how.contours).expect("derivatives");
            let [fx, fy] = f.optics.focal;
            let lens =
                Lens { fx, fy, cx: f.optics.centre[0] - 0.5, cy: f.optics.centre[1] - 0.5, distortion: None };
            let moment = Moment::straight(f.captured.seconds());
            if let Ok((_, next)) = look_at(gray, &memory, &moment, &lens, how, None) {
                memory = next;
            }
            let point = |p: [f64; 2]| Point2f::new(p[0] as f32, p[1] as f32);
            Bare { limits, derivatives, points: memory.points.iter().map(|p| point(p.pixel)).collect() }
        })
        .collect()
}

fn main() {
    soifra_vision::single_thread().expect("one thread");
    let mission = support::scratch(
        "room_bench.soi",
        &support::read("benches/room.soi.in").replace("$AGENTS", &support::project(AGENTS)),
    );
    let span = |s: f64| vec![("span", format!("{s} s"))];
    let alone = support::Compiled::new(&mission, &span(SPAN));
    let mut both = support::Compiled::new(&mission, &span(SPAN));
    both.settings.threads = 2;
    let (alone, both) = (alone.prepared(), both.prepared());
    let never = AtomicBool::new(false);

    let mut views = Views::default();
    alone.run_into(&mut views, &never).expect("a run");
    let mut again = Rendered.of(alone.scene()).expect("cameras");
    let mut take = |n: usize| {
        let (robot, sensor, captured, view) = &views.0[n];
        again.retake(*robot, *sensor, *captured, view).expect("an image")
    };
    let frames: Vec<Arc<Frame>> = (0..views.0.len()).map(&mut take).collect();
    let how = Looking::default();
    let calls = bare_calls(&frames, &how);
    drop(frames);

    let mut bare = || {
        support::seconds(|| {
            let mut before: Option<Mat> = None;
            for (n, call) in calls.iter().enumerate() {
                let frame = take(n);
                let size = (frame.width as usize, frame.height as usize);
                let grey = bare::grey(&frame.data, size);
                std::hint::black_box(bare::detect(&grey, &call.derivatives, call.limits, &how.contours));
                if let Some(before) = before.as_ref().filter(|_| !call.points.is_empty()) {
                    std::hint::black_box(bare::flow(before, &grey, &call.points, &how.points));
                }
                before = Some(grey);
            }
        })
    };
    let run =
        |prepared: &soifra::execute::Prepared<'_>| support::seconds(|| prepared.run(&never).expect("a run"));
    if support::trying() {
        bare();
        return;
    }
    let pairs = 7;
    let one = support::ratio(pairs, || run(&alone), &mut bare);
    support::verdict(
        "room_one_core",
        "room on one thread, to bare rendering and OpenCV calls",
        one,
        Some(1.25),
    );
    let two = support::ratio(pairs, || run(&both), &mut bare);
    support::verdict("room_two_cores", "room on two threads, to the same on one", two, Some(0.65));
    let factor = SPAN / run(&alone);
    println!("room: {factor:.1} times real time on one thread, {:.1} on two", SPAN / run(&both));

    let long = support::Compiled::new(&mission, &span(600.0));
    let mut resident = Resident::default();
    long.prepared().run_into(&mut resident, &never).expect("a long run");
    if let [Some(early), Some(late)] = resident.0 {
        let what = "resident memory after 10 simulated minutes of images looked at, to that after 1 minute";
        support::verdict("room_memory", what, late / early, Some(1.05));
    }
}
