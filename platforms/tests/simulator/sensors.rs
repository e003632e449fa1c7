//! Sensors against analytic geometry.

use crate::scenes::*;
use proptest::prelude::*;
use soifra_graph::{Value, reason};
use soifra_runtime::{Platform, Time, scene::Part};

fn wall(name: &str, from: [f64; 2], to: [f64; 2], extra: &[(&str, Value)]) -> Part {
    let mut args = vec![("from", at(from[0], from[1])), ("to", at(to[0], to[1])), ("thickness", num(0.02))];
    args.extend(extra.iter().cloned());
    part("wall", name, "segment", &args)
}

fn cylinder(name: &str, x: f64, y: f64, radius: f64, extra: &[(&str, Value)]) -> Part {
    let mut args = vec![("at", at(x, y)), ("radius", num(radius))];
    args.extend(extra.iter().cloned());
    part("obstacle", name, "cylinder", &args)
}

fn infrared(extra: &[(&str, Value)]) -> Part {
    let mut args = vec![
        ("bearings", list(&[0.0, NORTH, -NORTH, 2.0 * NORTH])),
        ("range", Value::Range(0.01, 1.0)),
        ("period", num(0.02)),
    ];
    args.extend(extra.iter().cloned());
    sensor("infrared", &args)
}

/// One robot of radius 0.1 with this sensor, polled at the start.
fn look(sensor: Part, world: Vec<Part>, starts: &[[f64; 3]]) -> Rig {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), twist(), sensor], world, starts));
    rig.poll(0.0);
    rig
}

#[test]
fn infrared_measures_from_the_rim() {
    let world = vec![wall("east", [0.51, -1.0], [0.51, 1.0], &[]), cylinder("pillar", 0.0, 0.6, 0.2, &[])];
    let rig = look(infrared(&[]), world, &[[0.0, 0.0, 0.0]]);
    let beams = rig.beams(0, 0);
    close(beams[0].1.unwrap(), 0.4, 1e-12);
    close(beams[1].1.unwrap(), 0.3, 1e-12);
    assert_eq!(beams[2].1, None);
    assert_eq!(rig.latest(0, 0)[1 + 3 * 2 + 1], reason::tag(reason::NOTHING_IN_RANGE));
    close(beams[3].0, 2.0 * NORTH, 0.0);
}

#[test]
fn infrared_sees_robots_and_movers_but_not_itself() {
    let mover = part(
        "mover",
        "cart",
        "disc",
        &[("radius", num(0.1)), ("path", path(&[[0.0, 0.7]])), ("speed", num(0.0))],
    );
    let rig = look(infrared(&[]), vec![mover], &[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]);
    close(rig.beams(0, 0)[0].1.unwrap(), 0.3, 1e-12);
    close(rig.beams(0, 0)[1].1.unwrap(), 0.5, 1e-12);
    close(rig.beams(1, 0)[3].1.unwrap(), 0.3, 1e-12);
}

#[test]
fn a_beam_passes_over_what_is_lower_and_turns_with_the_robot() {
    let low = cylinder("curb", 0.5, 0.0, 0.1, &[("height", num(0.01))]);
    let rig = look(infrared(&[]), vec![low.clone()], &[[0.0, 0.0, 0.0]]);
    assert_eq!(rig.beams(0, 0)[0].1, None);
    let rig = look(infrared(&[("height", num(0.005))]), vec![low], &[[0.0, 0.0, NORTH]]);
    assert_eq!(rig.beams(0, 0)[0].1, None);
    close(rig.beams(0, 0)[2].1.unwrap(), 0.3, 1e-12);
}

#[test]
fn what_is_too_near_reads_as_the_low_end() {
    let rig = look(
        infrared(&[("range", Value::Range(0.05, 1.0))]),
        vec![cylinder("c", 0.22, 0.0, 0.1, &[])],
        &[[0.0, 0.0, 0.0]],
    );
    assert_eq!(rig.beams(0, 0)[0].1, Some(0.05));
}

#[test]
fn dark_things_seem_farther_and_vanish_sooner() {
    let dark = part(
        "material",
        "soot",
        "plain",
        &[("color", Value::Text("#101010".into())), ("reflectance", num(0.2))],
    );
    let of = [("material", Value::Text("soot".into()))];
    let near = look(infrared(&[]), vec![dark.clone(), cylinder("c", 0.5, 0.0, 0.1, &of)], &[[0.0, 0.0, 0.0]]);
    close(near.beams(0, 0)[0].1.unwrap(), 0.3 * 2.0, 1e-12);
    let far = look(infrared(&[]), vec![dark, cylinder("c", 0.8, 0.0, 0.1, &of)], &[[0.0, 0.0, 0.0]]);
    assert_eq!(far.beams(0, 0)[0].1, None);
}

fn ultrasonic(cone: f64) -> Part {
    sensor(
        "ultrasonic",
        &[
            ("bearings", list(&[0.0])),
            ("range", Value::Range(0.05, 2.0)),
            ("cone", num(cone)),
            ("period", num(0.1)),
        ],
    )
}

#[test]
fn ultrasound_finds_the_nearest_point_in_its_cone() {
    // The rim is at (0.1, 0); the pillar's nearest point lies outside the ray but inside the cone.
    let pillar = cylinder("pillar", 1.1, 0.3, 0.1, &[]);
    let rig = look(ultrasonic(1.0), vec![pillar.clone()], &[[0.0, 0.0, 0.0]]);
    close(rig.beams(0, 0)[0].1.unwrap(), libm::hypot(1.0, 0.3) - 0.1, 1e-12);
    let rig = look(ultrasonic(0.2), vec![pillar], &[[0.0, 0.0, 0.0]]);
    assert_eq!(rig.beams(0, 0)[0].1, None);
}

fn laser(beams: i64, field: (f64, f64), range: f64) -> Part {
    sensor(
        "laser",
        &[
            ("beams", Value::Int(beams)),
            ("field", Value::Range(field.0, field.1)),
            ("range", Value::Range(0.05, range)),
            ("period", num(0.1)),
        ],
    )
}

#[test]
fn a_laser_sees_a_wall_as_a_secant() {
    let rig = look(
        laser(181, (-NORTH, NORTH), 30.0),
        vec![wall("east", [2.01, -5.0], [2.01, 5.0], &[])],
        &[[0.0, 0.0, 0.0]],
    );
    for (bearing, range) in rig.beams(0, 0) {
        let expected = 2.0 / libm::cos(bearing);
        if expected * libm::sin(bearing).abs() < 4.99 {
            close(range.unwrap(), expected, 1e-9);
        } else if expected * libm::sin(bearing).abs() > 5.05 {
            assert_eq!(range, None);
        }
    }
}

#[test]
fn discs_come_nearest_first_and_robots_are_none() {
    let world = vec![
        cylinder("far", 3.0, 0.0, 0.5, &[]),
        part(
            "mover",
            "cart",
            "disc",
            &[("radius", num(0.1)), ("path", path(&[[0.0, 1.0]])), ("speed", num(0.0))],
        ),
        cylinder("wide", 0.0, -2.0, 1.2, &[]),
        cylinder("out", 6.0, 0.0, 0.5, &[]),
        wall("east", [0.51, -1.0], [0.51, 1.0], &[]),
    ];
    let discs = |n| sensor("discs", &[("range", num(2.6)), ("capacity", Value::Int(n))]);
    let rig = look(discs(5), world.clone(), &[[0.0, 0.0, 0.0], [0.4, 0.0, 0.0]]);
    let r = rig.latest(0, 0);
    assert_eq!(r.len(), 21);
    assert_eq!(&r[..13], &[3.0, 0.0, -2.0, 0.0, 1.2, 0.0, 1.0, 0.0, 0.1, 3.0, 0.0, 0.0, 0.5]);
    assert!(r[13..].iter().all(|x| *x == 0.0));
    let rig = look(discs(2), world, &[[0.0, 0.0, 0.0]]);
    assert_eq!((rig.latest(0, 0)[0], rig.latest(0, 0).len()), (2.0, 9));
}

#[test]
fn encoders_count_and_odometry_reckons() {
    let parts = vec![
        body(0.1),
        wheels(&[("wheel_acceleration", num(1e12))]),
        twist(),
        sensor("encoders", &[("pulse", num(1e-5)), ("period", num(0.01))]),
        sensor("odometry", &[("pulse", num(1e-5)), ("period", num(0.01))]),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[3.0, 4.0, NORTH]]));
    rig.drive(0.0, 0, 0.3, 0.0, 0.6);
    rig.poll(2.0);
    // Wheels at 0.27 and 0.33 m/s.
    close(rig.latest(0, 0)[0], 54_000.0, 1.0);
    close(rig.latest(0, 0)[1], 66_000.0, 1.0);
    let o = rig.latest(0, 1).to_vec();
    close(o[0], 0.5 * libm::sin(1.2), 1e-4);
    close(o[1], 0.5 * (1.0 - libm::cos(1.2)), 1e-4);
    close(2.0 * libm::atan2(o[5], o[6]), 1.2, 1e-3);
    close(o[7], 0.3, 2e-3);
    close(o[12], 0.6, 2e-2);
}

#[test]
fn odometry_does_not_see_slip() {
    let parts = vec![
        body(0.1),
        wheels(&[("wheel_error", normal(0.05)), ("rotation_error", normal(0.05))]),
        twist(),
        sensor("odometry", &[("pulse", num(1e-5)), ("period", num(0.01))]),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0, 0.0, 0.0]]));
    rig.drive(0.0, 0, 0.5, 0.0, 0.0);
    rig.poll(4.0);
    close(rig.latest(0, 0)[0], 2.0, 1e-3);
    close(rig.latest(0, 0)[1], 0.0, 1e-9);
    assert!((rig.place(0)[0] - 2.0).abs() + rig.place(0)[1].abs() > 5e-3);
}

#[test]
fn odometry_of_strides_is_in_odom() {
    let parts = vec![
        body(0.1),
        holonomic(&[]),
        strides(0.5),
        sensor("odometry", &[("pulse", num(1e-6)), ("period", num(0.1))]),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[5.0, 5.0, NORTH]]));
    rig.send(0.0, 0, &[NORTH, 1.0], 1e6);
    rig.send(1.0, 0, &[2.0 * NORTH, 0.5], 1e6);
    rig.poll(2.0);
    let o = rig.latest(0, 0);
    close(o[0], 1.0, 2e-6);
    close(o[1], 0.5, 2e-6);
    close(2.0 * libm::atan2(o[5], o[6]), NORTH, 1e-9);
}

#[test]
fn odometry_of_a_holonomic_body_follows_its_arcs() {
    let parts = vec![
        body(0.1),
        holonomic(&[("error", normal(0.05))]),
        twist(),
        sensor("odometry", &[("pulse", num(1e-6)), ("period", num(0.1))]),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[5.0, 5.0, NORTH]]));
    rig.drive(0.0, 0, 0.5, 0.0, 1.0);
    rig.drive(NORTH, 0, 0.0, 0.3, 0.0);
    rig.drive(NORTH + 1.0, 0, 0.0, 0.0, 0.0);
    rig.poll(4.0);
    // A quarter of a circle of 0.5 m to the left, then sideways, which is backwards in odom.
    let o = rig.latest(0, 0);
    close(o[0], 0.5 - 0.3, 1e-5);
    close(o[1], 0.5, 1e-5);
    close(2.0 * libm::atan2(o[5], o[6]), NORTH, 1e-6);
    // On the ground it went otherwise.
    assert!((rig.place(0)[0] - 4.5).abs() + (rig.place(0)[1] - 5.2).abs() > 1e-3);
}

#[test]
fn a_sensor_captures_the_world_of_its_instant() {
    let mover = part(
        "mover",
        "cart",
        "disc",
        &[("radius", num(0.1)), ("path", path(&[[1.2, 0.0], [11.2, 0.0]])), ("speed", num(0.1))],
    );
    let ir = infrared(&[("range", Value::Range(0.01, 5.0)), ("period", num(0.5)), ("latency", num(0.3))]);
    let mut rig =
        Rig::new(&scene(vec![body(0.1), holonomic(&[]), twist(), ir], vec![mover], &[[0.0, 0.0, 0.0]]));
    rig.poll(10.0);
    let items: Vec<_> = rig.readings.items.clone();
    assert_eq!(items.len(), 20);
    for (i, r) in items.iter().enumerate() {
        assert_eq!((r.captured, r.delivered), (secs(0.5 * i as f64), secs(0.5 * i as f64 + 0.3)));
        close(rig.readings.registers[r.from as usize + 3], 1.0 + 0.1 * 0.5 * i as f64, 1e-9);
    }
}

#[test]
fn nobody_reads_nothing_is_simulated() {
    let mut s =
        scene(vec![body(0.1), holonomic(&[]), twist(), sensor("ideal_pose", &[])], vec![], &[[0.0; 3]]);
    s.robots[0].consumed = vec![false];
    let mut rig = Rig::new(&s);
    assert_eq!(rig.sim.next_due(), None);
    rig.poll(10.0);
    assert!(rig.readings.items.is_empty());
    s.robots[0].consumed = vec![true];
    assert_eq!(Rig::new(&s).sim.next_due(), Some(Time::ZERO));
}

fn random_world(x: &mut u64, n: usize) -> Vec<Part> {
    let mut random = |low: f64, high: f64| {
        *x ^= *x << 13;
        *x ^= *x >> 7;
        *x ^= *x << 17;
        low + (high - low) * ((*x >> 11) as f64 / (1u64 << 53) as f64)
    };
    (0..n)
        .map(|i| match i % 3 {
            0 => cylinder(&format!("c{i}"), random(-5.0, 5.0), random(-5.0, 5.0), random(0.05, 0.6), &[]),
            1 => part(
                "obstacle",
                &format!("b{i}"),
                "box",
                &[
                    ("at", at(random(-5.0, 5.0), random(-5.0, 5.0))),
                    ("size", Value::Vector([random(0.05, 1.0), random(0.05, 1.0), 1.0])),
                    ("heading", num(random(-3.0, 3.0))),
                ],
            ),
            _ => wall(
                &format!("w{i}"),
                [random(-5.0, 5.0), random(-5.0, 5.0)],
                [random(-5.0, 5.0), random(-5.0, 5.0)],
                &[],
            ),
        })
        .collect()
}

/// Distance along a ray to a part, by marching. A ray that grazes a disc of radius r comes within g of it some √(2rg)
/// before it meets it, so g must be well below the square of what the comparison allows.
fn march(world: &[Part], from: [f64; 2], bearing: f64, reach: f64) -> Option<f64> {
    let (s, c) = libm::sincos(bearing);
    let mut d = 0.0;
    while d <= reach {
        let p = [from[0] + c * d, from[1] + s * d];
        let gap = world.iter().map(|w| gap(w, p)).fold(f64::INFINITY, f64::min);
        if gap < 1e-13 {
            return Some(d);
        }
        d += gap;
    }
    None
}

fn gap(w: &Part, p: [f64; 2]) -> f64 {
    let point = |n: &str| match &w.args[n] {
        Value::Vector(v) => *v,
        _ => [0.0; 3],
    };
    let (centre, heading, half) = match &*w.model {
        "cylinder" => {
            let c = point("at");
            return libm::hypot(p[0] - c[0], p[1] - c[1]) - w.number("radius");
        }
        "box" => (point("at"), w.number("heading"), [0.5 * point("size")[0], 0.5 * point("size")[1]]),
        _ => {
            let (a, b) = (point("from"), point("to"));
            let d = [b[0] - a[0], b[1] - a[1]];
            let c = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.0];
            (c, libm::atan2(d[1], d[0]), [0.5 * libm::hypot(d[0], d[1]), 0.5 * w.number("thickness")])
        }
    };
    let (s, c) = libm::sincos(heading);
    let q = [p[0] - centre[0], p[1] - centre[1]];
    let (u, v) = ((q[0] * c + q[1] * s).abs() - half[0], (q[1] * c - q[0] * s).abs() - half[1]);
    libm::hypot(u.max(0.0), v.max(0.0)) + u.max(v).min(0.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// A scan through the index, against all things: what a beam meets is on a rim, and nothing is before it.
    #[test]
    fn a_scan_is_what_trying_all_finds(seed in 1u64.., n in 1usize..60, heading in -3.0f64..3.0) {
        let mut x = seed | 1;
        let world = random_world(&mut x, n);
        let rig = look(laser(90, (-3.0, 3.0), 4.0), world.clone(), &[[0.3, -0.2, heading]]);
        for (bearing, range) in rig.beams(0, 0) {
            let (s, c) = libm::sincos(heading + bearing);
            let gap = |d: f64| world.iter().map(|w| gap(w, [0.3 + c * d, -0.2 + s * d])).fold(f64::INFINITY, f64::min);
            let free = range.unwrap_or(4.0);
            if let Some(d) = range && d > 0.05 {
                prop_assert!(gap(d) < 1e-9, "{} at {}", gap(d), d);
            }
            if range != Some(0.05) {
                let deepest = (0..1000).map(|i| gap(free * f64::from(i) / 1000.0)).fold(f64::INFINITY, f64::min);
                prop_assert!(deepest > -1e-9, "{} {} {:?}", deepest, bearing, range);
            }
        }
    }

    /// A cone against a fan of rays.
    #[test]
    fn a_cone_is_a_fan_of_rays(seed in 1u64.., n in 1usize..30, cone in 0.05f64..3.0) {
        let mut x = seed | 1;
        let world = random_world(&mut x, n);
        let rig = look(ultrasonic(cone), world.clone(), &[[0.0, 0.0, 0.0]]);
        let fan = (0..=600).map(|i| cone * (f64::from(i) / 600.0 - 0.5));
        let nearest = fan.filter_map(|b| march(&world, [0.1, 0.0], b, 2.0)).reduce(f64::min);
        match (rig.beams(0, 0)[0].1, nearest) {
            (Some(a), Some(b)) => prop_assert!(a <= b.max(0.05) + 1e-6 && a > b - 0.05, "{} {}", a, b),
            (None, Some(b)) => prop_assert!(b > 1.99, "{}", b),
            _ => {}
        }
    }
}
