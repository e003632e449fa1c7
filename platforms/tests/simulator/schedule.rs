//! Periods, latencies, lifetimes, safe actions.

use crate::scenes::*;
use soifra_graph::Value;
use soifra_runtime::{Platform, Time};

#[test]
fn readings_come_in_order_of_delivery_robot_sensor() {
    let parts = vec![
        body(0.1),
        holonomic(&[]),
        twist(),
        sensor("ideal_pose", &[("period", some(0.02)), ("latency", num(0.03))]),
        sensor("discs", &[("range", num(1.0)), ("capacity", Value::Int(1)), ("period", some(0.05))]),
        sensor("odometry", &[("pulse", num(1e-3)), ("period", num(0.05))]),
    ];
    let mut rig = Rig::new(&scene(parts, vec![], &[[0.0; 3], [5.0, 0.0, 0.0]]));
    let mut last = Time(-1);
    while let Some(due) = rig.sim.next_due()
        && due <= secs(0.5)
    {
        assert!(due > last, "{due:?} after {last:?}");
        let before = rig.readings.items.len();
        rig.sim.poll(due, &mut rig.readings, &mut rig.reports);
        assert!(rig.readings.items.len() > before);
        assert!(rig.readings.items[before..].iter().all(|r| r.delivered == due));
        last = due;
    }
    let keys: Vec<_> = rig.readings.items.iter().map(|r| (r.delivered, r.robot, r.sensor)).collect();
    assert!(keys.is_sorted());
    assert_eq!(keys.iter().filter(|k| k.2 == 0).count(), 2 * 24);
    assert_eq!(keys.iter().filter(|k| k.2 == 1).count(), 2 * 11);
    // All in one poll: the same.
    let parts = scene_parts();
    let mut once = Rig::new(&scene(parts, vec![], &[[0.0; 3], [5.0, 0.0, 0.0]]));
    once.poll(0.5);
    assert_eq!(
        keys,
        once.readings.items.iter().map(|r| (r.delivered, r.robot, r.sensor)).collect::<Vec<_>>()
    );
}

fn scene_parts() -> Vec<soifra_runtime::scene::Part> {
    vec![
        body(0.1),
        holonomic(&[]),
        twist(),
        sensor("ideal_pose", &[("period", some(0.02)), ("latency", num(0.03))]),
        sensor("discs", &[("range", num(1.0)), ("capacity", Value::Int(1)), ("period", some(0.05))]),
        sensor("odometry", &[("pulse", num(1e-3)), ("period", num(0.05))]),
    ]
}

#[test]
fn without_a_period_a_sensor_captures_at_every_step() {
    let mut rig = Rig::new(&scene(
        vec![body(0.1), holonomic(&[]), strides(0.9), sensor("ideal_pose", &[])],
        vec![],
        &[[0.0; 3]],
    ));
    for i in 0..5 {
        rig.send(f64::from(i), 0, &[0.0, 0.5], 1e6);
    }
    rig.poll(4.5);
    let at: Vec<f64> = rig.readings.items.iter().map(|r| rig.readings.registers[r.from as usize]).collect();
    assert_eq!(rig.readings.items.len(), 5);
    for (i, x) in at.iter().enumerate() {
        close(*x, 0.5 * i as f64, 1e-12);
    }
}

#[test]
fn an_expired_twist_stops_the_robot() {
    for drive in [holonomic(&[]), wheels(&[("wheel_acceleration", num(1e12))])] {
        let mut rig = Rig::new(&scene(vec![body(0.1), drive, twist()], vec![], &[[0.0; 3]]));
        rig.send(1.0, 0, &[0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 1.2);
        rig.poll(9.0);
        close(rig.place(0)[0], 0.1, 1e-9);
        // One that is renewed goes on.
        for i in 0..10 {
            let t = 10.0 + 0.1 * f64::from(i);
            rig.send(t, 0, &[0.5, 0.0, 0.0, 0.0, 0.0, 0.0], t + 0.2);
        }
        rig.poll(20.0);
        close(rig.place(0)[0], 0.1 + 0.5 * 1.1, 1e-9);
    }
}

#[test]
fn an_expired_stride_is_broken_off() {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), strides(1.0)], vec![], &[[0.0; 3]]));
    rig.send(0.0, 0, &[0.0, 1.0], 0.25);
    rig.poll(3.0);
    close(rig.place(0)[0], 0.25, 1e-12);
}

#[test]
fn the_safe_action_stops_and_has_a_name() {
    let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), twist()], vec![], &[[0.0; 3]]));
    rig.drive(0.0, 0, 1.0, 0.0, 0.0);
    assert_eq!(rig.sim.safe_action(secs(0.5), 0), "stop");
    rig.poll(2.0);
    close(rig.place(0)[0], 0.5, 1e-12);
}

#[test]
fn senseless_commands_stop_the_robot() {
    let bad: [&[f64]; 5] =
        [&[f64::NAN; 6], &[f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0], &[], &[1.0], &[0.0; 9]];
    for command in bad {
        let mut rig = Rig::new(&scene(vec![body(0.1), holonomic(&[]), twist()], vec![], &[[0.0; 3]]));
        rig.drive(0.0, 0, 1.0, 0.0, 0.0);
        rig.send(0.5, 0, command, 1e6);
        rig.poll(2.0);
        close(rig.place(0)[0], 0.5, 1e-12);
        // Nobody there: nothing happens.
        rig.send(2.0, 99, &[0.0; 6], 1e6);
        rig.sim.send(secs(2.0), 0, 7, &[0.0; 6], secs(9.0));
        rig.sim.safe_action(secs(2.0), 99);
    }
}

#[test]
fn huge_commands_and_times_stay_finite() {
    for drive in [holonomic(&[("lag", num(0.1))]), wheels(&[("lag", num(0.1))])] {
        let mut rig = Rig::new(&scene(vec![body(0.1), drive, twist()], vec![], &[[0.0; 3]]));
        rig.drive(0.0, 0, f64::MAX, -f64::MAX, f64::MAX);
        rig.poll(5.0);
        assert!(rig.place(0).iter().all(|x| x.is_finite()));
        rig.drive(5.0, 0, f64::MIN_POSITIVE, 1e-300, -1e-300);
        rig.poll(1e3);
        assert!(rig.place(0).iter().all(|x| x.is_finite()));
    }
}
