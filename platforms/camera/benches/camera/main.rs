//! Frames of a room of 640 × 480 pixels: one core against the crate retrofire-core, two cores against one, noise.
//!
//! Every ratio is taken in pairs: ours and the reference run in turn, and the median of the ratios of neighbours
//! counts. So what else the machine does weighs on both.
#![expect(clippy::print_stdout, reason = "a bench tells its ratios on the terminal")]

mod reference;
mod room;

use std::time::{Duration, Instant};

use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use reference::Reference;
use soifra_camera::{Filter, Image, Lens, Light, Pose, Scene, Scratch, View, noise, noise_in_bands, render};

/// Ours, with what it renders.
struct Ours<'a> {
    scene: &'a Scene,
    lens: Lens,
    light: Light,
    poses: Vec<Pose>,
    image: Image,
    scratch: Scratch,
}

impl Ours<'_> {
    /// A frame from each pose.
    fn frames(&mut self, filter: Filter, bands: usize) {
        for pose in &self.poses {
            let view = View { lens: &self.lens, pose: *pose, light: &self.light, filter };
            render(self.scene, &[], &view, bands, &mut self.image, &mut self.scratch);
        }
    }
}

/// Seconds that something takes.
#[expect(clippy::disallowed_methods, reason = "a bench measures the wall clock")]
fn seconds(what: impl FnOnce()) -> f64 {
    let start = Instant::now();
    what();
    start.elapsed().as_secs_f64()
}

/// Adds a bench of a routine that renders several frames: the time of one.
fn add(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, frames: usize, mut routine: impl FnMut()) {
    group.bench_function(name, |b| {
        b.iter_custom(|n| {
            let all: f64 = (0..n).map(|_| seconds(&mut routine)).sum();
            Duration::from_secs_f64(all / frames as f64)
        });
    });
}

/// The median ratio of two routines that run in turn.
fn ratio(pairs: usize, mut ours: impl FnMut(), mut reference: impl FnMut()) -> f64 {
    ours();
    reference();
    let mut ratios: Vec<f64> = (0..pairs)
        .map(|i| {
            // Neither is always the one that comes first.
            if i % 2 == 0 {
                let a = seconds(&mut ours);
                a / seconds(&mut reference)
            } else {
                let b = seconds(&mut reference);
                seconds(&mut ours) / b
            }
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

fn verdict(name: &str, what: &str, ratio: f64, bar: f64) {
    let words = if ratio <= bar { "held" } else { "NOT HELD" };
    println!("{name}: {ratio:.3} ({what}; bar {bar}: {words})");
}

fn main() {
    let trying = std::env::args().any(|a| a == "--test") || !std::env::args().any(|a| a == "--bench");
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .without_plots()
        .configure_from_args();
    let room = room::room();
    let (lens, light, poses) = (room::lens(), room::light(), room::poses());
    println!("{} triangles, {} poses", room.scene.fixed.len(), poses.len());
    let count = poses.len();
    let mut ours = Ours {
        scene: &room.scene,
        lens,
        light,
        poses: poses.clone(),
        image: Image::default(),
        scratch: Scratch::new(),
    };
    let mut unsorted = Reference::new(&room, &lens, false);
    let mut sorted = Reference::new(&room, &lens, true);
    for pose in &poses {
        unsorted.render(&lens, pose);
        let view = View { lens: &lens, pose: *pose, light: &light, filter: Filter::Bilinear };
        render(&room.scene, &[], &view, 1, &mut ours.image, &mut ours.scratch);
        println!("mean difference to the reference: {:.2} grey levels", unsorted.difference(&ours.image));
    }

    let mut group = criterion.benchmark_group("camera 640 x 480");
    for (name, filter, bands) in [
        ("bilinear, one core", Filter::Bilinear, 1),
        ("mipmaps, one core", Filter::Mipmap, 1),
        ("mipmaps, two cores", Filter::Mipmap, 2),
        ("trilinear, one core", Filter::Trilinear, 1),
    ] {
        add(&mut group, name, count, || ours.frames(filter, bands));
    }
    add(&mut group, "retrofire-core bilinear", count, || {
        poses.iter().for_each(|p| unsorted.render(&lens, p))
    });
    add(&mut group, "retrofire-core bilinear, sorted", count, || {
        poses.iter().for_each(|p| sorted.render(&lens, p));
    });
    let mut noisy = Image::new(640, 480);
    noisy.data.fill(128);
    add(&mut group, "noise, one core", 1, || noise(&mut noisy, 2.0, 7, 1));
    add(&mut group, "noise, two cores", 1, || noise_in_bands(&mut noisy, 2.0, 7, 1, 2));
    group.finish();
    if trying {
        return;
    }

    let mipmaps = |ours: &mut Ours| ours.frames(Filter::Mipmap, 1);
    let plain = ratio(25, || mipmaps(&mut ours), || poses.iter().for_each(|p| unsorted.render(&lens, p)));
    let best = ratio(25, || mipmaps(&mut ours), || poses.iter().for_each(|p| sorted.render(&lens, p)));
    let reference = if plain > best { plain } else { best };
    verdict("camera_frame", "time of a frame with mipmaps to retrofire-core's without", reference, 0.7);
    let mut other = Ours { image: Image::default(), scratch: Scratch::new(), poses, ..ours };
    let mut one =
        Ours { image: Image::default(), scratch: Scratch::new(), poses: other.poses.clone(), ..other };
    let two = ratio(25, || other.frames(Filter::Mipmap, 2), || one.frames(Filter::Mipmap, 1));
    verdict("camera_bands", "time of a frame with two bands to that with one", two, 1.0 / 1.6);
    criterion.final_summary();
}
