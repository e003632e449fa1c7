//! Motion against closed forms.

use crate::scenes::*;
use soifra_runtime::Platform;
use std::f64::consts::PI;

#[test]
fn a_straight_line() {
    let mut rig = Rig::new(&scene(vec![body(0.1), wheels(&[]), twist()], vec![], &[[1.0, 2.0, NORTH]]));
    rig.drive(0.0, 0, 0.5, 0.0, 0.0);
    rig.poll(3.0);
    let [x, y, h] = rig.place(0);
    close(x, 1.0, 1e-9);
    // Up to 0.5 m/s at 2e4 m/s2 costs v² / 2a.
    close(y, 2.0 + 1.5 - 0.25 / 4e4, 1e-9);
    close(h, NORTH, 1e-12);
    close(rig.truth().path_length(0), 1.5 - 0.25 / 4e4, 1e-9);
}

#[test]
fn a_circle_closes() {
    for drive in [wheels(&[("wheel_acceleration", num(1e12))]), holonomic(&[])] {
        let mut rig = Rig::new(&scene(vec![body(0.1), drive, twist()], vec![], &[[0.0, 0.0, 0.0]]));
        rig.drive(0.0, 0, 0.4, 0.0, 0.8);
        for quarter in 1..=4 {
            let angle = 0.5 * PI * f64::from(quarter);
            rig.poll(angle / 0.8);
            let [x, y, _] = rig.place(0);
            close(x, 0.5 * libm::sin(angle), 1e-6);
            close(y, 0.5 * (1.0 - libm::cos(angle)), 1e-6);
        }
        close(rig.truth().path_length(0), 0.5 * 2.0 * PI, 1e-6);
    }
}

#[test]
fn the_lag_answers_a_step_exponentially() {
    let tau = 0.06;
    let parts = vec![body(0.1), wheels(&[("lag", num(tau)), ("wheel_acceleration", num(1e9))]), twist()];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0, 0.0, 0.0]]));
    rig.drive(0.0, 0, 0.5, 0.0, 0.0);
    for t in [0.001, 0.0305, 0.06, 0.2, 0.6, 1.5] {
        rig.poll(t);
        // Between substeps of 2 ms a chord stands for the curve: a h² / 8 off at most.
        close(rig.place(0)[0], 0.5 * (t - tau * (1.0 - libm::exp(-t / tau))), 5e-6);
    }
}

#[test]
fn the_acceleration_limit_makes_a_ramp() {
    // 50 rad/s2 at 2 cm: 1 m/s2.
    let parts = vec![body(0.1), wheels(&[("wheel_acceleration", num(50.0))]), twist()];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0, 0.0, 0.0]]));
    rig.drive(0.0, 0, 0.5, 0.0, 0.0);
    rig.poll(0.3);
    close(rig.place(0)[0], 0.5 * 0.09, 1e-6);
    rig.poll(2.0);
    close(rig.place(0)[0], 0.125 + 0.5 * 1.5, 1e-6);
    rig.sim.safe_action(secs(2.0), 0);
    rig.poll(4.0);
    close(rig.place(0)[0], 0.125 + 0.75 + 0.125, 1e-6);
}

#[test]
fn too_fast_a_twist_keeps_its_arc() {
    let mut rig = Rig::new(&scene(vec![body(0.1), wheels(&[]), twist()], vec![], &[[0.0, 0.0, 0.0]]));
    // Radius 0.5 m; the outer wheel would need 2.2 m/s.
    rig.drive(0.0, 0, 2.0, 0.0, 4.0);
    rig.poll(1.0);
    let [x, y, h] = rig.place(0);
    close(libm::hypot(x, y - 0.5), 0.5, 1e-4);
    close(h, 4.0 / 2.2, 1e-3);
}

#[test]
fn a_holonomic_body_moves_sideways_at_its_limit() {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), twist()], vec![], &[[0.0, 0.0, NORTH]]));
    rig.drive(0.0, 0, 0.0, 40.0, 0.0);
    rig.poll(0.5);
    let [x, y, _] = rig.place(0);
    close(x, -5.0, 1e-9);
    close(y, 0.0, 1e-9);
}

#[test]
fn holonomic_lag_and_turning_while_moving() {
    let tau = 0.2;
    let parts = vec![body(0.1), holonomic(&[("lag", num(tau))]), twist()];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0, 0.0, 0.0]]));
    rig.drive(0.0, 0, 1.0, 0.0, 0.5);
    rig.poll(1.3);
    // Both velocities lag alike, so the path is an arc of radius 2 with the lagged length.
    let s = 1.3 - tau * (1.0 - libm::exp(-1.3 / tau));
    let [x, y, h] = rig.place(0);
    close(h, 0.5 * s, 1e-9);
    close(x, 2.0 * libm::sin(0.5 * s), 1e-6);
    close(y, 2.0 * (1.0 - libm::cos(0.5 * s)), 1e-6);
}

#[test]
fn a_stride_takes_its_duration_and_its_heading() {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), strides(0.8)], vec![], &[[0.0, 0.0, 0.0]]));
    rig.send(1.0, 0, &[NORTH, 0.4], 1e6);
    rig.poll(1.2);
    close(rig.place(0)[1], 0.1, 1e-12);
    rig.poll(5.0);
    let [x, y, h] = rig.place(0);
    close(x, 0.0, 1e-12);
    close(y, 0.4, 1e-12);
    close(h, NORTH, 1e-12);
    // Faster than the drive can go: falls short.
    rig.send(6.0, 0, &[0.0, 100.0], 1e6);
    rig.poll(9.0);
    close(rig.place(0)[0], 8.0, 1e-9);
    // Backwards.
    rig.send(10.0, 0, &[0.0, -2.0], 1e6);
    rig.poll(12.0);
    close(rig.place(0)[0], 6.0, 1e-9);
    close(rig.truth().path_length(0), 0.4 + 8.0 + 2.0, 1e-9);
}

#[test]
fn a_stride_in_the_middle_of_another_replaces_it() {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), strides(1.0)], vec![], &[[0.0, 0.0, 0.0]]));
    rig.send(0.0, 0, &[0.0, 1.0], 1e6);
    rig.send(0.5, 0, &[NORTH, 1.0], 1e6);
    rig.poll(3.0);
    let [x, y, _] = rig.place(0);
    close(x, 0.5, 1e-12);
    close(y, 1.0, 1e-12);
}

#[test]
fn rotation_error_is_one_factor_a_turn() {
    let parts = vec![
        body(0.1),
        wheels(&[("rotation_error", normal(0.05)), ("wheel_acceleration", num(1e12))]),
        twist(),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0, 0.0, 0.0]]));
    let mut turns = Vec::new();
    for i in 0..200 {
        let t = 2.0 * f64::from(i);
        let before = rig.place(0)[2];
        rig.drive(t, 0, 0.0, 0.0, 1.0);
        rig.drive(t + 0.5, 0, 0.0, 0.0, 1.0);
        rig.poll(t + 0.5);
        let half = (rig.place(0)[2] - before).rem_euclid(2.0 * PI);
        rig.poll(t + 1.0);
        rig.drive(t + 1.0, 0, 0.0, 0.0, 0.0);
        rig.poll(t + 1.9);
        let whole = (rig.place(0)[2] - before).rem_euclid(2.0 * PI);
        close(whole, 2.0 * half, 1e-6);
        turns.push(whole - 1.0);
    }
    let mean = turns.iter().sum::<f64>() / 200.0;
    let sd = (turns.iter().map(|e| e * e).sum::<f64>() / 200.0).sqrt();
    close(mean, 0.0, 0.015);
    close(sd, 0.05, 0.01);
}

#[test]
fn slipping_wheels_scatter_where_a_robot_ends() {
    let parts = vec![body(0.1), wheels(&[("wheel_error", normal(0.01))]), twist()];
    let starts: Vec<[f64; 3]> = (0..200).map(|i| [0.0, f64::from(i) * 10.0, 0.0]).collect();
    let mut rig = Rig::new(&scene(parts, vec![], &starts));
    for i in 0..200 {
        rig.drive(0.0, i, 0.5, 0.0, 0.0);
    }
    rig.poll(4.0);
    // n = 2 m / circumference draws for each wheel; the heading scatters by sd · √(2n) · circumference / base.
    let around = 2.0 * PI * 0.02;
    let n = 2.0 / around;
    let expected = 0.01 * (2.0f64 * n).sqrt() * around / 0.1;
    let sd = ((0..200).map(|i| rig.place(i)[2].powi(2)).sum::<f64>() / 200.0).sqrt();
    close(sd, expected, 0.2 * expected);
}
