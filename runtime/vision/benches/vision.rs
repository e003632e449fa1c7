//! Each service against the bare OpenCV calls that it makes, on the same frames, in the same run. At most 1.1 times.
#![expect(clippy::print_stdout, reason = "a bench tells its figures on the terminal")]
#![expect(clippy::disallowed_methods, reason = "a bench reads the clock")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;
use opencv::core::{Mat, Point2f, Vector};
use soifra_vision::contours::{Thresholds, derivatives, thresholds, verticals};
use soifra_vision::follow::Moment;
use soifra_vision::look::{Looking, Memory, look, look_at, nearest};
use soifra_vision::points;
use soifra_vision::{Gray, ImageView, Lens};

#[path = "../tests/vision/scene.rs"]
mod scene;

mod bare;

use bare::{detect, flow};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
const FRAMES: usize = 24;

/// RGB frames of an approach at 0.5 m/s, 20 Hz, from 4 m.
fn frames(lens: &Lens) -> Vec<Vec<u8>> {
    let room = scene::Room {
        back: 14.0,
        sides: 6.0,
        wall: scene::Paint::Bricks,
        floor: scene::Paint::Checker(0.5),
        blocks: vec![scene::Block {
            x: [6.0, 7.0],
            y: [-0.4, 0.6],
            height: 2.0,
            paint: scene::Paint::Clouds(0.4),
        }],
    };
    (0..FRAMES)
        .map(|k| {
            let camera =
                scene::Camera { at: [2.0 + 0.025 * k as f64, 0.0, 0.6], attitude: Default::default() };
            let gray = room.frame(&camera, lens, WIDTH, HEIGHT, 2.0, k as u64);
            gray.iter().flat_map(|&l| [l, l, l]).collect()
        })
        .collect()
}

fn view(rgb: &[u8]) -> ImageView<'_> {
    ImageView::new(WIDTH, HEIGHT, 3, rgb).expect("a frame")
}

/// The service and the bare calls by turns, so that the machine's moods meet both: the ratio of the medians over
/// the rounds of a pass through all frames.
fn ratio(name: &str, mut service: impl FnMut(usize), mut bare: impl FnMut(usize)) -> f64 {
    let mut times = [Vec::new(), Vec::new()];
    for round in 0..40 * FRAMES {
        let k = 1 + round % (FRAMES - 1);
        let begin = Instant::now();
        service(k);
        let middle = Instant::now();
        bare(k);
        times[0].push(middle - begin);
        times[1].push(middle.elapsed());
    }
    let median = |t: &mut Vec<Duration>| {
        t.sort();
        t[t.len() / 2].as_secs_f64() * 1e3
    };
    let (a, b) = (median(&mut times[0]), median(&mut times[1]));
    println!("{name:<24} {a:.3} ms, bare calls {b:.3} ms: {:.3} times", a / b);
    a / b
}

fn main() {
    soifra_vision::single_thread().expect("one thread");
    let lens = Lens::ideal(WIDTH, HEIGHT, 60f64.to_radians()).expect("a lens");
    let frames = frames(&lens);
    let grays: Vec<Gray> = frames.iter().map(|f| Gray::of(&view(f)).expect("grey")).collect();
    let mats: Vec<_> = grays
        .iter()
        .map(|g| Mat::new_rows_cols_with_data(HEIGHT as i32, WIDTH as i32, g.data()).expect("a mat"))
        .collect();
    let how = Looking::default();
    let limits: Vec<(f64, f64)> =
        grays.iter().map(|g| thresholds(g, Thresholds::Automatic).expect("thresholds")).collect();
    let left: Vec<(Mat, Mat)> =
        grays.iter().map(|g| derivatives(g, 0.0, &how.contours).expect("derivatives")).collect();
    let moment = |k: usize| Moment::straight(k as f64 * 0.05);

    // What is remembered before each frame, and the points that the flow is asked for.
    let mut memories = vec![Memory::default()];
    for k in 0..FRAMES {
        let next = look_at(grays[k].clone(), &memories[k], &moment(k), &lens, &how, None).expect("a look").1;
        memories.push(next);
    }
    let starts: Vec<Vector<Point2f>> = memories
        .iter()
        .map(|m| m.points.iter().map(|p| Point2f::new(p.pixel[0] as f32, p.pixel[1] as f32)).collect())
        .collect();

    let grey = |k: usize| bare::grey(&frames[k], (WIDTH, HEIGHT));
    let none = Vector::<Point2f>::new();
    let mut worst: f64 = 0.0;
    let mut tell = |r: f64| worst = worst.max(r);
    tell(ratio(
        "verticals",
        |k| {
            let _ = black_box(verticals(&grays[k], 0.0, &how.contours));
        },
        |k| {
            black_box(detect(&mats[k], &left[k], limits[k], &how.contours));
        },
    ));
    tell(ratio(
        "look",
        |k| {
            let _ = black_box(look(&view(&frames[k]), &memories[k], &moment(k), &lens, &how));
        },
        |k| {
            let gray = grey(k);
            black_box(detect(&gray, &left[k], limits[k], &how.contours));
            if !starts[k].is_empty() {
                black_box(flow(&mats[k - 1], &gray, &starts[k], &how.points));
            }
        },
    ));
    let published: Vec<Vector<Point2f>> = (0..FRAMES)
        .map(|k| match nearest(&grays[k.max(1) - 1], &grays[k], 0.0, &lens, &how.contours, &how.points) {
            Ok(pair) => points::choose(&grays[k], &pair.left, &pair.right, &how.points)
                .iter()
                .map(|p| Point2f::new(p.at[0] as f32, p.at[1] as f32))
                .collect(),
            Err(_) => none.clone(),
        })
        .collect();
    tell(ratio(
        "nearest (published)",
        |k| {
            let _ = black_box(nearest(&grays[k - 1], &grays[k], 0.0, &lens, &how.contours, &how.points));
        },
        |k| {
            black_box(detect(&mats[k], &left[k], limits[k], &how.contours));
            if !published[k].is_empty() {
                black_box(flow(&mats[k], &mats[k - 1], &published[k], &how.points));
            }
        },
    ));
    println!("worst {worst:.3} times (bar 1.1)");

    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let last = FRAMES - 1;
    criterion.bench_function("vision/look", |b| {
        b.iter(|| look(&view(&frames[last]), &memories[last], &moment(last), &lens, &how));
    });
    let seen = look(&view(&frames[last]), &memories[last], &moment(last), &lens, &how).expect("a look");
    let memory = seen.1;
    criterion.bench_function("vision/flow_robust", |b| {
        b.iter(|| {
            soifra_vision::robust::history(black_box(&memory.points), &moment(last), &Default::default())
        });
    });
}
