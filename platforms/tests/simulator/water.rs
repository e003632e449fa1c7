//! What swims: it holds its speed over the ground and its depth against a current, which carries it when it has no power.

use crate::scenes::*;
use proptest::prelude::*;
use soifra_graph::Value;
use soifra_platforms::sim::Simulator;
use soifra_runtime::{Platform, Reading, scene::Part};

const HEIGHT: f64 = 1.0;
const CURRENT: [f64; 2] = [0.1, -0.2];
/// How long it takes to rise and to settle (s).
const SETTLED: f64 = 12.0;

fn vector(v: [f64; 3]) -> Value {
    Value::Vector(v)
}

fn submersible(extra: &[(&str, Value)]) -> Vec<Part> {
    let mut drive = vec![
        ("max_speed", num(1.0)),
        ("max_climb", num(0.3)),
        ("max_turn", num(1.0)),
        ("thrust", vector([80.0, 80.0, 100.0])),
        ("torque", num(20.0)),
        ("added_mass", vector([5.0, 8.0, 18.0])),
        ("inertia", num(0.6)),
        ("linear_drag", vector([10.0, 10.0, 30.0])),
        ("quadratic_drag", vector([100.0, 200.0, 190.0])),
        ("quadratic_turn_drag", num(1.5)),
    ];
    drive.extend(extra.iter().cloned());
    vec![
        part("body", "", "cylinder", &[("radius", num(0.3)), ("height", num(0.3)), ("mass", num(12.0))]),
        part("drive", "", "submersible", &drive),
        twist(),
        part("prepare", "", "take_off", &[("height", num(HEIGHT))]),
        part("safe", "", "hover", &[]),
        part("finish", "", "land", &[]),
        sensor("imu", &[("period", num(0.01))]),
        sensor("flow_odometry", &[("period", num(0.01))]),
    ]
}

fn current(velocity: [f64; 3]) -> Part {
    part("current", "", "steady", &[("velocity", vector(velocity))])
}

fn water() -> Vec<Part> {
    vec![current([CURRENT[0], CURRENT[1], 0.0])]
}

fn rig(world: Vec<Part>) -> Rig {
    Rig::new(&scene(submersible(&[]), world, &[[0.0, 0.0, 0.5]]))
}

fn height(rig: &Rig) -> f64 {
    rig.truth().pose(0)[2]
}

/// Velocity over the ground, in map, over the next seconds.
fn velocity(r: &mut Rig, from: f64, to: f64) -> [f64; 2] {
    r.poll(from);
    let a = r.place(0);
    r.poll(to);
    let b = r.place(0);
    [(b[0] - a[0]) / (to - from), (b[1] - a[1]) / (to - from)]
}

#[test]
fn it_rises_from_the_bottom_and_stays_there_in_the_current() {
    let mut r = rig(water());
    r.poll(1.0);
    assert!(height(&r) > 0.05 && height(&r) < 0.5, "{}", height(&r));
    r.poll(SETTLED);
    close(height(&r), HEIGHT, 0.01);
    let [x, y] = velocity(&mut r, SETTLED, SETTLED + 20.0);
    close(libm::hypot(x, y), 0.0, 1e-4);
    // At the start it gave way, until the autopilot knew what the current takes.
    let [x, y, heading] = r.place(0);
    assert!(libm::hypot(x, y) < 0.5, "{x} {y}");
    close(heading, 0.5, 0.05);
    close(height(&r), HEIGHT, 0.01);
}

/// The odometry measures over the ground, so it knows of the current.
#[test]
fn the_commanded_speed_is_one_over_the_ground() {
    let mut r = rig(water());
    r.drive(SETTLED, 0, 0.4, 0.1, 0.0);
    let [x, y] = velocity(&mut r, SETTLED + 10.0, SETTLED + 15.0);
    let heading = r.place(0)[2];
    let (s, c) = libm::sincos(heading);
    close(x * c + y * s, 0.4, 2e-3);
    close(-x * s + y * c, 0.1, 2e-3);
    let odometry = r.latest(0, 1);
    close(odometry[7], 0.4, 2e-3);
    close(odometry[8], 0.1, 2e-3);
}

/// Straight against a current of 0.5 m/s the thrusters give all they have, and the drag of what they make against the water is
/// that: 10 v + 100 v² = 80, v = 0.846 m/s.
#[test]
fn thrust_is_limited_and_the_rest_is_the_current() {
    let against = |x: f64| {
        let world = vec![current([x, 0.0, 0.0])];
        let mut r = Rig::new(&scene(submersible(&[]), world, &[[0.0, 0.0, 0.0]]));
        r.drive(SETTLED, 0, 1.0, 0.0, 0.0);
        velocity(&mut r, SETTLED + 20.0, SETTLED + 25.0)[0]
    };
    let terminal = (-10.0 + libm::sqrt(100.0 + 4.0 * 100.0 * 80.0)) / 200.0;
    // A little of the thrust is left for the axes that share it.
    close(against(-0.5), terminal - 0.5, 0.01);
    close(against(0.0), terminal, 0.01);
    close(against(0.5), 1.0, 0.01);
    // One that is stronger than the thrusters carries it away, however it works.
    close(against(-1.2), terminal - 1.2, 0.02);
}

#[test]
fn without_power_it_drifts_as_fast_as_the_current() {
    let mut parts = submersible(&[]);
    // What it holds is spent after 20 s.
    let battery = [("energy", num(100.0)), ("drive", num(0.0)), ("standby", num(5.0))];
    parts.push(part("power", "", "battery", &battery));
    let mut r = Rig::new(&scene(parts, water(), &[[0.0, 0.0, 0.5]]));
    r.drive(SETTLED, 0, 0.4, 0.0, 0.5);
    r.drive(21.0, 0, 0.4, 0.0, 0.5);
    // Drag fades with the speed against the water: slowly at last.
    let [x, y] = velocity(&mut r, 120.0, 130.0);
    close(x, CURRENT[0], 1e-3);
    close(y, CURRENT[1], 1e-3);
    close(height(&r), HEIGHT, 0.01);
    // Safe actions change nothing about it.
    assert_eq!(r.sim.safe_action(secs(130.0), 0), "hover");
    let [x, y] = velocity(&mut r, 130.0, 140.0);
    close(x, CURRENT[0], 1e-3);
    close(y, CURRENT[1], 1e-3);
}

#[test]
fn it_holds_the_depth_while_it_swims_and_where_it_has_climbed_to() {
    let mut r = rig(water());
    r.drive(SETTLED, 0, 0.5, 0.0, 0.4);
    for k in 0..40 {
        r.poll(SETTLED + 0.5 * f64::from(k));
        close(height(&r), HEIGHT, 0.01);
    }
    r.send(40.0, 0, &[0.0, 0.0, 0.2, 0.0, 0.0, 0.0], 1e6);
    r.send(45.0, 0, &[0.0; 6], 1e6);
    r.poll(60.0);
    let held = height(&r);
    // A metre, less what it takes to get going.
    close(held, HEIGHT + 0.85, 0.15);
    r.poll(90.0);
    close(height(&r), held, 1e-3);
}

#[test]
fn it_turns_as_fast_as_it_is_told_and_slides_on_a_little() {
    let mut r = rig(Vec::new());
    r.drive(SETTLED, 0, 0.4, 0.0, 0.0);
    r.drive(SETTLED + 5.0, 0, 0.4, 0.0, 0.5);
    r.poll(SETTLED + 5.5);
    let sideways = r.latest(0, 1)[8];
    assert!(sideways < -0.005, "it slides the old way: {sideways}");
    r.poll(SETTLED + 12.0);
    let imu = r.latest(0, 0);
    close(imu[4], 0.5, 5e-3);
    assert_eq!((imu[0], imu[1]), (0.0, 0.0));
    close(r.latest(0, 1)[8], 0.0, 5e-3);
}

/// A bias of the gyroscope turns what it takes for straight ahead.
#[test]
fn odometry_drifts_with_the_bias_of_its_gyroscope() {
    let mut parts = submersible(&[]);
    parts.push(part(
        "sensor",
        "log",
        "flow_odometry",
        &[
            ("period", num(0.1)),
            ("turn_bias", Value::Distribution(soifra_graph::Distribution::Uniform(0.01, 0.01))),
        ],
    ));
    let mut r = Rig::new(&scene(parts, water(), &[[0.0, 0.0, 0.5]]));
    r.drive(SETTLED, 0, 0.4, 0.0, 0.0);
    r.poll(SETTLED + 20.0);
    let heading = |o: &[f64]| 2.0 * libm::atan2(o[5], o[6]);
    let drift = heading(r.latest(0, 2)) - heading(r.latest(0, 1));
    close(drift, 0.01 * (SETTLED + 20.0), 1e-6);
}

#[test]
fn it_lands_at_the_end_and_stays_there() {
    let mut r = rig(water());
    r.drive(SETTLED, 0, 0.4, 0.0, 0.0);
    r.poll(SETTLED + 3.0);
    assert_eq!(r.sim.finish(secs(SETTLED + 3.0), 0), "land");
    r.poll(60.0);
    close(height(&r), 0.0, 1e-9);
    assert_eq!(velocity(&mut r, 60.0, 70.0), [0.0, 0.0]);
}

/// What does not swim does not notice a current.
#[test]
fn on_the_ground_a_current_changes_nothing() {
    let run = |world: Vec<Part>| {
        let parts = vec![body(0.1), wheels(&[("lag", num(0.1))]), twist()];
        let mut r = Rig::new(&scene(parts, world, &[[0.0, 0.0, 0.3]]));
        r.drive(0.0, 0, 0.4, 0.0, 0.2);
        r.poll(10.0);
        r.truth().pose(0)
    };
    assert_eq!(run(Vec::new()), run(water()));
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let refusal = |extra: &[(&str, Value)], world: Vec<Part>| {
        Simulator::new(&scene(submersible(extra), world, &[[0.0; 3]])).err().unwrap_or_default()
    };
    let mut grounded = submersible(&[]);
    grounded.retain(|p| &*p.role != "prepare");
    let cases = [
        (refusal(&[("thrust", vector([80.0, 0.0, 80.0]))], vec![]), "a part of `thrust` is below"),
        (refusal(&[("added_mass", vector([-1.0, 0.0, 0.0]))], vec![]), "a part of `added_mass` is below"),
        (refusal(&[("thruster_lag", num(0.4))], vec![]), "quicker (`turn_lag`) than its thrusters"),
        (
            refusal(&[("velocity_lag", num(0.001)), ("thruster_lag", num(0.0))], vec![]),
            "`velocity_lag` is below",
        ),
        (refusal(&[], vec![current([0.1, 0.0, 0.1])]), "`velocity` is not level"),
        (refusal(&[], vec![current([30.0, 0.0, 0.0])]), "`velocity` is above 20 m/s"),
        (refusal(&[], [water(), water()].concat()), "there is a second one"),
        (Simulator::new(&scene(grounded, vec![], &[[0.0; 3]])).err().unwrap_or_default(), "it swims: write"),
    ];
    for (said, expected) in cases {
        assert!(said.contains(expected), "`{said}` does not say `{expected}`");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Looking more often changes nothing.
    #[test]
    fn polling_more_changes_nothing(extra in prop::collection::vec(0.0f64..8.0, 0..30)) {
        let run = |extra: &[f64]| {
            let mut r = rig(water());
            let mut extra = extra.to_vec();
            extra.sort_by(f64::total_cmp);
            let mut next = 0;
            for i in 0..40 {
                let t = 0.2 * f64::from(i);
                while next < extra.len() && extra[next] < t {
                    r.poll(extra[next]);
                    next += 1;
                }
                r.drive(t, 0, 0.6, 0.1, 0.4 * f64::from(i % 5) - 0.8);
            }
            r.poll(8.0);
            let reading = |x: &Reading| {
                let registers = r.readings.registers[x.from as usize..x.to as usize].to_vec();
                (x.delivered, x.sensor, registers)
            };
            let mut readings: Vec<_> = r.readings.items.iter().map(reading).collect();
            readings.sort_by_key(|x| (x.0, x.1));
            (readings, r.sim.truth().unwrap().pose(0))
        };
        prop_assert_eq!(run(&[]), run(&extra));
    }

    /// Whatever it is told in whatever water, it stays finite and no faster than it can swim in it.
    #[test]
    fn it_stays_within_its_limits(
        commands in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0, -9.0f64..9.0), 1..20),
        set in -14.0f64..14.0,
    ) {
        let mut r = rig(vec![current([set, 0.5 * set, 0.0])]);
        for (i, (a, b, c)) in commands.iter().enumerate() {
            let t = 3.0 + 0.3 * i as f64;
            r.send(t, 0, &[*a, *b, *c, 0.0, 0.0, *a], 1e6);
            r.poll(t + 0.15);
            prop_assert!(r.truth().pose(0).iter().all(|x| x.is_finite()));
            let v = &r.latest(0, 1)[7..9];
            prop_assert!(libm::hypot(v[0], v[1]) < 1.5 + 1.2 * set.abs(), "{:?}", v);
        }
    }
}
