//! Many robots: cost and memory, and two runs alike. Figures are printed by
//! `cargo test --release -- --ignored --nocapture swarm`.

use crate::scenes::*;
use soifra_graph::Value;
use soifra_runtime::{Platform, Scene};

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

#[test]
#[ignore = "prints figures; they mean something in a release build on a quiet machine"]
#[allow(clippy::disallowed_methods)]
fn swarm_figures() {
    for n in [100usize, 250, 1000, 10_000] {
        let steps = 2_000_000 / n;
        let s = lattice(n, walkers());
        let from = std::time::Instant::now();
        let (_, touched) = walk(&s, steps);
        let each = from.elapsed().as_secs_f64() / (n * steps) as f64;
        println!("strides  {n:6} robots: {:6.1} ns a robot-step, {touched} contacts", each * 1e9);
    }
    for n in [100usize, 250, 1000, 10_000] {
        let steps = 1_000_000 / n;
        let drive = holonomic(&[("max_speed", num(0.02))]);
        let s =
            lattice(n, vec![body(0.0025), drive, twist(), sensor("ideal_pose", &[("period", some(0.1))])]);
        let from = std::time::Instant::now();
        let mut rig = Rig::new(&s);
        for step in 0..steps {
            let t = step as f64 * 0.1;
            rig.readings.clear();
            rig.poll(t);
            for i in 0..n {
                let heading = ((i * 7919 + step * 104_729) % 628) as f64 * 0.01;
                let (s, c) = libm::sincos(heading);
                rig.send(t, i as u32, &[0.01 * c, 0.01 * s, 0.0, 0.0, 0.0, 0.0], t + 0.2);
            }
            rig.poll(t + 0.001);
        }
        let each = from.elapsed().as_secs_f64() / (n * steps) as f64;
        println!("twists   {n:6} robots: {:6.1} ns a robot-step", each * 1e9);
    }
    for n in [100usize, 1000] {
        let ir = sensor(
            "infrared",
            &[
                ("bearings", list(&[0.0, 0.78, 1.57, 2.35, 3.14, -2.35, -1.57, -0.78])),
                ("range", Value::Range(0.002, 0.01)),
                ("period", num(0.02)),
                ("latency", num(0.005)),
                ("noise", normal(0.04)),
            ],
        );
        let drive = wheels(&[
            ("lag", num(0.06)),
            ("wheel_acceleration", num(130.0)),
            ("wheel_error", normal(0.005)),
            ("rotation_error", normal(0.01)),
        ]);
        let s = lattice(n, vec![body(0.0025), drive, twist(), ir]);
        let from = std::time::Instant::now();
        let mut rig = Rig::new(&s);
        let steps = 200_000 / n;
        for step in 0..steps {
            let t = step as f64 * 0.02;
            rig.readings.clear();
            rig.poll(t);
            for i in 0..n {
                rig.drive(t, i as u32, 0.01, 0.0, if i % 2 == 0 { 1.0 } else { -1.0 });
            }
        }
        let each = from.elapsed().as_secs_f64() / (n * steps) as f64;
        println!("wheels, 8 infrared beams, 20 ms: {n:6} robots: {:6.1} ns a robot-step", each * 1e9);
    }
}
