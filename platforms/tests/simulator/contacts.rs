//! Contacts against analytic times and brute force.

use crate::scenes::*;
use proptest::prelude::*;
use soifra_graph::Value;
use soifra_runtime::Platform;

fn discs(radius: f64, starts: &[[f64; 3]], world: Vec<soifra_runtime::scene::Part>) -> Rig {
    let fast = holonomic(&[("max_speed", num(1000.0))]);
    Rig::new(&scene(vec![body(radius), fast, twist()], world, starts))
}

#[test]
fn two_discs_meet_and_part_once_at_the_exact_time() {
    let mut rig = discs(0.1, &[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![]);
    rig.drive(0.0, 0, 1.0, 0.0, 0.0);
    for i in 0..50 {
        rig.poll(0.1 * f64::from(i));
    }
    let found = contacts(&rig.reports);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0], (1_800_000_000, true, 0, Some(1), "r[1]".into()));
    assert!(!found[1].1 && (found[1].0 - 2_200_000_001).abs() <= 1, "{found:?}");
    assert_eq!(
        (rig.truth().collisions(0), rig.truth().collisions(1), rig.truth().total_collisions()),
        (1, 1, 1)
    );
    assert!(!rig.truth().in_collision(0));
}

#[test]
fn standing_together_is_one_contact_from_the_start() {
    let mut rig = discs(0.1, &[[0.0, 0.0, 0.0], [0.15, 0.0, 0.0]], vec![]);
    for i in 0..20 {
        rig.poll(f64::from(i));
    }
    assert_eq!(contacts(&rig.reports), [(0, true, 0, Some(1), "r[1]".into())]);
    assert!(rig.truth().in_collision(1));
}

#[test]
fn resting_at_the_rim_does_not_chatter() {
    let wall = part(
        "wall",
        "east",
        "segment",
        &[("from", at(1.0, -1.0)), ("to", at(1.0, 1.0)), ("thickness", num(0.2))],
    );
    let parts = vec![body(0.1), holonomic(&[]), strides(0.5)];
    let mut rig = Rig::new(&scene(parts, vec![wall], &[[0.0, 0.0, 0.0]]));
    // Exactly up to the wall, in strides whose sum rounds; then along it.
    for i in 0..8 {
        rig.send(f64::from(i), 0, &[0.0, 0.1], 1e6);
        rig.poll(f64::from(i) + 0.7);
    }
    for i in 8..30 {
        rig.send(f64::from(i), 0, &[NORTH, 0.01], 1e6);
        rig.poll(f64::from(i) + 0.7);
    }
    assert!(rig.truth().collisions(0) <= 1, "{:?}", contacts(&rig.reports));
}

#[test]
fn heights_decide() {
    let low =
        part("obstacle", "curb", "cylinder", &[("at", Value::Vector([1.0, 0.0, 0.5])), ("radius", num(0.1))]);
    let mut rig = discs(0.1, &[[0.0, 0.0, 0.0]], vec![low]);
    rig.drive(0.0, 0, 1.0, 0.0, 0.0);
    rig.poll(3.0);
    // The robot is 0.3 m tall and passes below.
    assert_eq!(rig.truth().total_collisions(), 0);
}

#[test]
fn movers_walls_and_boxes_have_names() {
    let world = vec![
        part(
            "wall",
            "north",
            "segment",
            &[("from", at(-9.0, 1.0)), ("to", at(9.0, 1.0)), ("thickness", num(0.1))],
        ),
        part(
            "obstacle",
            "crate",
            "box",
            &[("at", at(0.0, -1.0)), ("size", Value::Vector([0.2, 0.2, 0.2])), ("heading", num(0.5 * NORTH))],
        ),
        part(
            "mover",
            "cart",
            "disc",
            &[("radius", num(0.2)), ("path", path(&[[5.0, 0.0], [1.0, 0.0]])), ("speed", num(1.0))],
        ),
    ];
    let mut rig = discs(0.1, &[[0.0, 0.0, NORTH], [0.0, 0.3, -NORTH], [0.9, 0.0, 0.0]], world);
    rig.drive(0.0, 0, 1.0, 0.0, 0.0);
    rig.drive(0.0, 1, 1.0, 0.0, 0.0);
    rig.poll(4.0);
    let all = contacts(&rig.reports);
    let begin = |name: &str, robot: u32| {
        all.iter().find(|c| c.1 && c.2 == robot && c.4 == name).unwrap_or_else(|| panic!("{name}: {all:?}")).0
    };
    close(begin("north", 0) as f64, 0.85e9, 2.0);
    // The corner of the turned box points at the robot: its tip is 0.1 · √2 from the centre.
    close(begin("crate", 1) as f64, (1.2 - 0.1 * 2f64.sqrt()) * 1e9, 2.0);
    close(begin("cart", 2) as f64, (5.0 - 0.9 - 0.3) * 1e9, 2.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever the speed and however the time is cut, two discs that cross are seen to touch, at the time
    /// that the quadratic says.
    #[test]
    fn nothing_tunnels(
        speed in 0.01f64..900.0, offset in -0.25f64..0.25, start in -50.0f64..-1.0,
        cuts in prop::collection::vec(0.0f64..1.0, 0..6),
    ) {
        let mut rig = discs(0.1, &[[start, offset, 0.0], [0.0, 0.0, 0.0]], vec![]);
        rig.drive(0.0, 0, speed, 0.0, 0.0);
        let end = 2.0 * -start / speed;
        let mut cuts: Vec<f64> = cuts.into_iter().map(|c| c * end).collect();
        cuts.sort_by(f64::total_cmp);
        for c in cuts.into_iter().chain([end + 1.0]) {
            rig.poll(c);
        }
        let found = contacts(&rig.reports);
        let reach = 0.04 - offset * offset;
        if reach < -1e-6 {
            prop_assert_eq!(found.len(), 0);
        } else if reach > 1e-6 {
            prop_assert_eq!(found.len(), 2);
            let half = reach.sqrt();
            prop_assert!((found[0].0 as f64 - (-start - half) / speed * 1e9).abs() <= 2.0, "{:?}", found);
            prop_assert!((found[1].0 as f64 - (-start + half) / speed * 1e9).abs() <= 2.0 + 100.0 / speed, "{:?}", found);
        }
    }

    /// The same against a turned box, by sampling.
    #[test]
    fn a_box_is_met_where_it_is(
        heading in -3.0f64..3.0, w in 0.05f64..1.0, h in 0.05f64..1.0, offset in -1.0f64..1.0, speed in 0.1f64..100.0,
    ) {
        let crate_ = part("obstacle", "crate", "box",
            &[("at", at(0.0, 0.0)), ("size", Value::Vector([w, h, 1.0])), ("heading", num(heading))]);
        let mut rig = discs(0.1, &[[-3.0, offset, 0.0]], vec![crate_]);
        rig.drive(0.0, 0, speed, 0.0, 0.0);
        rig.poll(6.0 / speed);
        let (s, c) = libm::sincos(heading);
        let gap = |x: f64| {
            let (u, v) = (x * c + offset * s, offset * c - x * s);
            libm::hypot((u.abs() - 0.5 * w).max(0.0), (v.abs() - 0.5 * h).max(0.0)) - 0.1
        };
        let steps = 60_000;
        let xs = (0..=steps).map(|i| -3.0 + 6.0 * f64::from(i) / f64::from(steps));
        let inside: Vec<f64> = xs.filter(|x| gap(*x) <= 0.0).collect();
        let found = contacts(&rig.reports);
        if inside.len() > 2 {
            prop_assert_eq!(found.len(), 2);
            let x = -3.0 + speed * found[0].0 as f64 * 1e-9;
            let y = -3.0 + speed * found[1].0 as f64 * 1e-9;
            prop_assert!((x - inside[0]).abs() < 2e-4, "{} {}", x, inside[0]);
            prop_assert!((y - inside[inside.len() - 1]).abs() < 2e-4);
        } else if inside.is_empty() {
            // A grazing pass between two samples is the only thing that may be found.
            prop_assert!(found.is_empty() || found[1].0 - found[0].0 < (4e-3 / speed * 1e9) as i64);
        }
    }

    /// Many robots with commands that change: pairs found through the grid are those found by trying all.
    #[test]
    fn the_broad_phase_loses_nobody(seed in any::<u64>(), n in 2usize..40, side in 0.5f64..8.0) {
        let mut x = seed | 1;
        let mut random = || {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            (x >> 11) as f64 / (1u64 << 53) as f64
        };
        let starts: Vec<[f64; 3]> = (0..n).map(|_| [side * random(), side * random(), 4.0 * NORTH * random()]).collect();
        let parts = vec![body(0.1), holonomic(&[("max_speed", num(2.0))]), twist()];
        let mut rig = Rig::new(&scene(parts, vec![], &starts));
        let mut touching = std::collections::BTreeSet::new();
        let mut brute = 0;
        for step in 0..20 {
            let t = 0.25 * f64::from(step);
            let velocities: Vec<[f64; 2]> = (0..n).map(|_| [3.0 * random() - 1.5, 3.0 * random() - 1.5]).collect();
            rig.poll(t);
            let at: Vec<[f64; 3]> = (0..n).map(|i| rig.place(i as u32)).collect();
            let mut ground = Vec::new();
            for (i, v) in velocities.iter().enumerate() {
                rig.drive(t, i as u32, v[0], v[1], 0.0);
                let k = (2.0 / libm::hypot(v[0], v[1])).min(1.0);
                let (s, c) = libm::sincos(at[i][2]);
                ground.push([k * (v[0] * c - v[1] * s), k * (v[0] * s + v[1] * c)]);
            }
            for i in 0..n {
                for j in i + 1..n {
                    let p = [at[i][0] - at[j][0], at[i][1] - at[j][1]];
                    let v = [ground[i][0] - ground[j][0], ground[i][1] - ground[j][1]];
                    let least = (-(p[0] * v[0] + p[1] * v[1]) / (v[0] * v[0] + v[1] * v[1])).clamp(0.0, 0.25);
                    let gap = |t: f64| libm::hypot(p[0] + v[0] * t, p[1] + v[1] * t) - 0.2;
                    if !touching.contains(&(i, j)) && gap(least) <= 0.0 {
                        touching.insert((i, j));
                        brute += 1;
                    }
                    if gap(0.25) > 0.0 {
                        touching.remove(&(i, j));
                    }
                }
            }
        }
        rig.poll(5.0);
        prop_assert_eq!(rig.truth().total_collisions(), brute);
    }

    /// Extra polls change neither contacts nor their times nor readings.
    #[test]
    fn polling_more_changes_nothing(extra in prop::collection::vec(0.0f64..4.0, 0..30)) {
        let run = |extra: &[f64]| {
            let parts = vec![
                body(0.1), wheels(&[("lag", num(0.06)), ("wheel_error", normal(0.02)), ("rotation_error", normal(0.02)), ("wheel_acceleration", num(130.0))]),
                twist(),
                sensor("infrared", &[("bearings", list(&[0.0, 0.8, -0.8])), ("range", Value::Range(0.002, 0.5)), ("period", num(0.02)),
                    ("latency", num(0.005)), ("noise", normal(0.04)), ("false_alarm", num(0.05))]),
                sensor("odometry", &[("pulse", num(7e-6)), ("period", num(0.03))]),
            ];
            let world = vec![
                part("mover", "cart", "disc", &[("radius", num(0.1)), ("path", path(&[[0.5, -1.0], [0.5, 1.0]])), ("speed", num(0.7)), ("phase", num(0.3))]),
                part("mover", "fly", "wanderer", &[("radius", num(0.1)), ("at", at(0.0, 0.5)), ("heading", num(0.3)), ("speed", num(0.4)), ("turn_period", num(0.7))]),
                part("bounds", "", "rectangle", &[("low", at(-1.0, -1.0)), ("high", at(2.0, 1.0))]),
            ];
            let mut rig = Rig::new(&scene(parts, world, &[[0.0, 0.0, 0.0], [1.0, 0.0, 3.0]]));
            let mut extra = extra.to_vec();
            extra.sort_by(f64::total_cmp);
            let mut next = 0;
            for i in 0..40 {
                let t = 0.1 * f64::from(i);
                while next < extra.len() && extra[next] < t {
                    rig.poll(extra[next]);
                    next += 1;
                }
                rig.drive(t, i % 2, 0.3, 0.0, f64::from(i % 5) - 2.0);
            }
            rig.poll(4.0);
            (contacts(&rig.reports), rig.readings.items, rig.readings.registers, rig.sim.truth().unwrap().pose(0))
        };
        let (plain, polled) = (run(&[]), run(&extra));
        prop_assert_eq!(plain.0, polled.0);
        prop_assert_eq!(plain.3, polled.3);
        prop_assert_eq!(plain.1.len(), polled.1.len());
        for (a, b) in plain.1.iter().zip(&polled.1) {
            prop_assert_eq!((a.robot, a.sensor, a.captured, a.delivered), (b.robot, b.sensor, b.captured, b.delivered));
            prop_assert_eq!(&plain.2[a.from as usize..a.to as usize], &polled.2[b.from as usize..b.to as usize]);
        }
    }
}
