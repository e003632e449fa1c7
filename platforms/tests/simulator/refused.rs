//! Scenes that cannot be simulated are refused with what is wrong.

use crate::scenes::*;
use soifra_graph::Value;
use soifra_platforms::sim::Simulator;
use soifra_runtime::{Scene, scene::Part};

fn refusal(parts: Vec<Part>, world: Vec<Part>) -> String {
    Simulator::new(&scene(parts, world, &[[0.0; 3]])).err().unwrap_or_default()
}

#[test]
fn each_with_its_reason() {
    let full = |more: Vec<Part>| [vec![body(0.1), holonomic(&[]), twist()], more].concat();
    let mut unknown = sensor("ideal_pose", &[]);
    unknown.model = "sixth_sense".into();
    let cases: Vec<(String, &str)> = vec![
        (refusal(vec![holonomic(&[])], vec![]), "platform `tested` has no body"),
        (refusal(vec![body(0.1)], vec![]), "platform `tested` has no drive"),
        (refusal(vec![body(-1.0), holonomic(&[])], vec![]), "`radius` must be greater than zero"),
        (refusal(vec![body(f64::NAN), holonomic(&[])], vec![]), "`radius` is not finite"),
        (
            refusal(vec![body(0.1), wheels(&[("wheel_base", num(0.0))])], vec![]),
            "`wheel_base` must be greater",
        ),
        (refusal(vec![body(0.1), wheels(&[]), strides(1.0)], vec![]), "a stride needs a drive"),
        (refusal(full(vec![unknown]), vec![]), "no such sensor"),
        (
            refusal(full(vec![sensor("encoders", &[("pulse", num(1e-5)), ("period", num(0.01))])]), vec![]),
            "no two wheels",
        ),
        (
            refusal(full(vec![sensor("odometry", &[("pulse", num(1e-5)), ("period", num(0.0))])]), vec![]),
            "shorter than 1 us",
        ),
        (
            refusal(
                full(vec![sensor(
                    "laser",
                    &[
                        ("beams", Value::Int(1 << 40)),
                        ("field", Value::Range(-1.0, 1.0)),
                        ("range", Value::Range(0.0, 1.0)),
                        ("period", num(1.0)),
                    ],
                )]),
                vec![],
            ),
            "`beams` must be between",
        ),
        (
            refusal(
                full(vec![]),
                vec![part(
                    "obstacle",
                    "c",
                    "cylinder",
                    &[("at", at(0.0, f64::INFINITY)), ("radius", num(1.0))],
                )],
            ),
            "obstacle `c` (cylinder): `at` is not finite",
        ),
        (
            refusal(
                full(vec![]),
                vec![part(
                    "mover",
                    "m",
                    "disc",
                    &[("radius", num(1.0)), ("path", path(&[])), ("speed", num(1.0))],
                )],
            ),
            "`path` is missing",
        ),
        (
            refusal(
                full(vec![]),
                vec![part(
                    "mover",
                    "m",
                    "disc",
                    &[("radius", num(1.0)), ("path", path(&[[0.0, 0.0], [1e-6, 0.0]])), ("speed", num(1e6))],
                )],
            ),
            "less than 0.1 ms",
        ),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "`{said}` does not say `{expected}`");
    }
    let mut s: Scene = scene(full(vec![sensor("ideal_pose", &[])]), vec![], &[[0.0; 3]]);
    s.step = None;
    assert!(Simulator::new(&s).unwrap_err().contains("no step clock"));
    s.robots[0].platform = 3;
    assert!(Simulator::new(&s).unwrap_err().contains("has no platform"));
}
