//! What flies: it takes off, tilts to go somewhere, settles after a turn, and comes down.

use crate::scenes::*;
use proptest::prelude::*;
use soifra_graph::Value;
use soifra_runtime::{Platform, Reading, scene::Part};

const HEIGHT: f64 = 1.0;

fn quadrotor(gust: f64) -> Vec<Part> {
    let drive = [
        ("max_speed", num(3.0)),
        ("max_climb", num(1.0)),
        ("max_turn", num(2.0)),
        ("max_tilt", num(0.3)),
        ("drag", num(0.1)),
        ("gust", normal(gust)),
    ];
    vec![
        body(0.3),
        part("drive", "", "quadrotor", &drive),
        twist(),
        part("prepare", "", "take_off", &[("height", num(HEIGHT))]),
        part("safe", "", "hover", &[]),
        part("finish", "", "land", &[]),
        sensor("imu", &[("period", num(0.01))]),
        sensor("flow_odometry", &[("period", num(0.01))]),
    ]
}

fn rig(gust: f64) -> Rig {
    Rig::new(&scene(quadrotor(gust), Vec::new(), &[[0.0, 0.0, 0.5]]))
}

fn height(rig: &Rig) -> f64 {
    rig.truth().pose(0)[2]
}

/// Roll and pitch of the truth.
fn tilt(rig: &Rig) -> [f64; 2] {
    let [.., x, y, z, w] = rig.truth().pose(0);
    let pitch = libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0));
    [libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)), pitch]
}

#[test]
fn it_takes_off_before_it_follows_commands() {
    let mut r = rig(0.0);
    r.drive(0.0, 0, 1.0, 0.0, 0.5);
    r.poll(0.8);
    let [x, y, heading] = r.place(0);
    assert_eq!(([x, y], heading), ([0.0, 0.0], 0.5));
    assert!(height(&r) > 0.1 && height(&r) < HEIGHT);
    r.drive(4.0, 0, 0.0, 0.0, 0.0);
    r.poll(12.0);
    close(height(&r), HEIGHT, 0.01);
}

#[test]
fn it_tilts_to_go_somewhere() {
    let mut r = rig(0.0);
    r.drive(5.0, 0, 1.0, 0.0, 0.0);
    r.poll(5.3);
    let [roll, pitch] = tilt(&r);
    assert!(pitch > 0.05 && pitch <= 0.3 + 0.05, "it looks down to go ahead, {pitch}");
    close(roll, 0.0, 1e-9);
    let imu = r.latest(0, 0).to_vec();
    close(imu[1], pitch, 1e-9);
    r.poll(9.0);
    let [_, pitch] = tilt(&r);
    // What the air takes from the speed the tilt gives back: tan(pitch) = drag · v / g.
    close(pitch, libm::atan(0.1 / 9.80665), 1e-3);
    let odometry = r.latest(0, 1);
    close(odometry[7], 1.0, 0.01);
    let [x, y, _] = r.place(0);
    close(libm::atan2(y, x), 0.5, 1e-6);
    close(odometry[0], libm::hypot(x, y), 1e-6);
    // To the left it leans to the left, which is a negative roll.
    r.drive(9.0, 0, 0.0, 1.0, 0.0);
    r.poll(9.3);
    assert!(tilt(&r)[0] < -0.05, "{:?}", tilt(&r));
}

/// The gyroscope says how fast it turns at every reading, also at those that fall on the end of a step of the drive.
#[test]
fn it_knows_how_fast_it_turns() {
    let mut r = rig(0.0);
    r.drive(5.0, 0, 0.0, 0.0, 0.8);
    for k in 0..20 {
        r.poll(7.0 + 0.01 * f64::from(k));
        close(r.latest(0, 0)[4], 0.8, 0.01);
    }
}

#[test]
fn it_needs_time_to_settle_after_a_turn() {
    let mut r = rig(0.0);
    r.drive(5.0, 0, 1.0, 0.0, 0.0);
    r.drive(8.0, 0, 1.0, 0.0, 1.5);
    r.drive(9.0, 0, 1.0, 0.0, 0.0);
    r.poll(9.0);
    let sideways = |r: &Rig| r.latest(0, 1)[8];
    let at_once = sideways(&r);
    assert!(at_once < -0.2, "it still slides the old way: {at_once}");
    r.poll(12.0);
    close(sideways(&r), 0.0, 0.02);
    close(r.latest(0, 1)[7], 1.0, 0.02);
}

#[test]
fn it_hovers_when_in_doubt_and_lands_at_the_end() {
    let mut r = rig(0.0);
    r.drive(5.0, 0, 1.0, 0.0, 0.0);
    r.poll(7.0);
    assert_eq!(r.sim.safe_action(secs(7.0), 0), "hover");
    r.poll(12.0);
    let there = r.place(0);
    close(height(&r), HEIGHT, 0.01);
    r.poll(13.0);
    close(r.place(0)[0], there[0], 1e-3);
    assert_eq!(r.sim.finish(secs(13.0), 0), "land");
    r.drive(13.5, 0, 1.0, 0.0, 0.0);
    r.poll(25.0);
    close(height(&r), 0.0, 1e-9);
    assert_eq!(tilt(&r), [0.0, 0.0]);
    r.poll(26.0);
    close(r.place(0)[0], there[0], 0.05);
}

#[test]
fn it_climbs_and_holds_what_it_has_climbed_to() {
    let mut r = rig(0.0);
    r.send(5.0, 0, &[0.0, 0.0, 0.5, 0.0, 0.0, 0.0], 1e6);
    r.send(7.0, 0, &[0.0; 6], 1e6);
    r.poll(12.0);
    close(height(&r), HEIGHT + 1.0, 0.15);
    let held = height(&r);
    r.poll(20.0);
    close(height(&r), held, 0.01);
}

#[test]
fn it_flies_over_what_is_low_and_hits_what_is_high() {
    let box_of = |name: &str, height: f64, y: f64| {
        let size = Value::Vector([0.5, 0.5, height]);
        part("obstacle", name, "box", &[("at", at(3.0, y)), ("size", size)])
    };
    let world = vec![box_of("low", 0.5, 0.0), box_of("high", 2.0, 5.0)];
    let mut r = Rig::new(&scene(quadrotor(0.0), world, &[[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]]));
    for robot in [0, 1] {
        r.drive(5.0, robot, 1.0, 0.0, 0.0);
    }
    r.poll(12.0);
    let met = contacts(&r.reports);
    assert!(met.iter().all(|c| c.2 == 1 && c.4 == "high"), "{met:?}");
    assert_eq!(met.len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Looking more often changes nothing.
    #[test]
    fn polling_more_changes_nothing(extra in prop::collection::vec(0.0f64..8.0, 0..30)) {
        let run = |extra: &[f64]| {
            let mut r = rig(0.05);
            let mut extra = extra.to_vec();
            extra.sort_by(f64::total_cmp);
            let mut next = 0;
            for i in 0..40 {
                let t = 0.2 * f64::from(i);
                while next < extra.len() && extra[next] < t {
                    r.poll(extra[next]);
                    next += 1;
                }
                r.drive(t, 0, 0.8, 0.1, 0.4 * f64::from(i % 5) - 0.8);
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

    /// It never tilts farther than it may, by more than the overshoot of its attitude, and stays finite.
    #[test]
    fn it_stays_within_its_limits(commands in prop::collection::vec((-9.0f64..9.0, -9.0f64..9.0, -9.0f64..9.0), 1..20)) {
        let mut r = rig(0.2);
        for (i, (a, b, c)) in commands.iter().enumerate() {
            let t = 3.0 + 0.3 * i as f64;
            r.send(t, 0, &[*a, *b, *c, 0.0, 0.0, *a], 1e6);
            r.poll(t + 0.15);
            let [roll, pitch] = tilt(&r);
            prop_assert!(roll.abs() < 0.4 && pitch.abs() < 0.4, "{} {}", roll, pitch);
            let pose = r.truth().pose(0);
            prop_assert!(pose.iter().all(|x| x.is_finite()));
            let v = &r.latest(0, 1)[7..9];
            prop_assert!(libm::hypot(v[0], v[1]) < 3.5);
        }
    }
}
