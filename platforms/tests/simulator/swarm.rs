//! Many robots: cost and memory, and two runs alike. Figures are printed by
//! `cargo test --release -- --ignored --nocapture swarm`.

use crate::scenes::*;
use soifra_graph::Value;
use soifra_runtime::Scene;

/// Robots on a square lattice, four radii apart, as dense at every number.
fn lattice(n: usize, parts: Vec<soifra_runtime::scene::Part>) -> Scene {
    let side = (n as f64).sqrt().ceil() as usize;
    let starts: Vec<[f64; 3]> =
        (0..n).map(|i| [(i % side) as f64 * 0.01, (i / side) as f64 * 0.01, 0.0]).collect();
    scene(parts, vec![], &starts)
}

fn walkers() -> Vec<soifra_runtime::scene::Part> {
    let drive = holonomic(&[("max_speed", num(0.0111))]);
    vec![body(0.0025), drive, strides(0.9), sensor("ideal_pose", &[])]
}

/// All walk strides that look random for this many steps; returns the state of all.
fn walk(scene: &Scene, steps: usize) -> (Vec<[f64; 7]>, u32) {
    let mut rig = Rig::new(scene);
    let n = scene.robots.len();
    for step in 0..steps {
        rig.readings.clear();
        rig.poll(step as f64);
        assert_eq!(rig.readings.items.len(), n);
        for i in 0..n {
            let heading = ((i * 7919 + step * 104_729) % 628) as f64 * 0.01;
            rig.send(step as f64, i as u32, &[heading, 0.01], 1e9);
        }
        rig.poll(step as f64 + 0.01);
    }
    ((0..n as u32).map(|i| rig.truth().pose(i)).collect(), rig.truth().total_collisions())
}

#[test]
fn two_runs_are_alike() {
    let s = lattice(400, walkers());
    let (a, b) = (walk(&s, 20), walk(&s, 20));
    assert_eq!(a, b);
    assert!(a.1 > 0, "a crowd that touches");
}

/// Nanoseconds this thread has run: on a shared machine wall time says little.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|t| t.parse().ok()).unwrap_or(f64::NAN)
}

/// Nanoseconds of processor time for each of `steps` steps of all robots of a scene.
fn each(scene: &Scene, steps: usize, mut step: impl FnMut(&mut Rig, usize)) -> f64 {
    let mut rig = Rig::new(scene);
    let from = processor_time();
    for i in 0..steps {
        rig.readings.clear();
        rig.reports.clear();
        step(&mut rig, i);
    }
    (processor_time() - from) / (scene.robots.len() * steps) as f64
}

fn looks_random(i: usize, step: usize) -> f64 {
    ((i * 7919 + step * 104_729) % 628) as f64 * 0.01
}

#[test]
#[ignore = "prints figures; they mean something in a release build on a quiet machine"]
#[allow(clippy::print_stdout)]
fn swarm_figures() {
    // `SWARM=strides SWARM_SIZE=250` for one of them.
    let wanted = std::env::var("SWARM").unwrap_or_default();
    let size = std::env::var("SWARM_SIZE").ok().and_then(|n| n.parse().ok());
    for n in [100usize, 250, 1000, 10_000].into_iter().filter(|n| size.is_none_or(|s: usize| s == *n)) {
        let robots = 0..n as u32;
        if wanted.is_empty() || wanted == "strides" {
            // To and fro, so that the crowd stays as dense as it is.
            let t = each(&lattice(n, walkers()), 100_000 / n, |rig, step| {
                rig.poll(step as f64);
                for i in robots.clone() {
                    let heading =
                        looks_random(i as usize, step / 2) + if step % 2 == 0 { 0.0 } else { 2.0 * NORTH };
                    rig.send(step as f64, i, &[heading, 0.005], 1e9);
                }
            });
            println!("strides, {n:6} robots: {t:7.1} ns a robot-step");
        }
        if wanted.is_empty() || wanted == "twists" {
            let drive = holonomic(&[("max_speed", num(0.02))]);
            let parts = vec![body(0.0025), drive, twist(), sensor("ideal_pose", &[("period", some(0.1))])];
            let t = each(&lattice(n, parts), 100_000 / n, |rig, step| {
                let t = step as f64 * 0.1;
                rig.poll(t);
                for i in robots.clone() {
                    let (s, c) = libm::sincos(looks_random(i as usize, step / 10));
                    let v = if step / 5 % 2 == 0 { 0.01 } else { -0.01 };
                    rig.send(t, i, &[v * c, v * s, 0.0, 0.0, 0.0, 0.0], t + 0.2);
                }
            });
            println!("twists,  {n:6} robots: {t:7.1} ns a robot-step");
        }
        if wanted.is_empty() || wanted == "wheels" {
            let ir = sensor(
                "infrared",
                &[
                    (
                        "bearings",
                        list(&[0.0, 0.5, 1.0, 1.5, 2.0, 2.5, -0.5, -1.0].map(|quarters| quarters * NORTH)),
                    ),
                    ("range", Value::Range(0.002, 0.01)),
                    ("period", num(0.02)),
                    ("latency", num(0.005)),
                    ("noise", normal(0.04)),
                ],
            );
            let errors = [("wheel_error", normal(0.005)), ("rotation_error", normal(0.01))];
            let drive =
                wheels(&[&[("lag", num(0.06)), ("wheel_acceleration", num(130.0))], &errors[..]].concat());
            let t = each(&lattice(n, vec![body(0.0025), drive, twist(), ir]), 100_000 / n, |rig, step| {
                let t = step as f64 * 0.02;
                rig.poll(t);
                for i in robots.clone() {
                    rig.drive(t, i, 0.01, 0.0, if i % 2 == 0 { 1.0 } else { -1.0 });
                }
            });
            println!("wheels and 8 infrared beams every 20 ms, {n:6} robots: {t:7.1} ns a robot-step");
        }
    }
}
