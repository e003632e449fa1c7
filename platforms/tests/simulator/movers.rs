//! Movers: on their paths, within their bounds, out of what they keep out of.

use crate::scenes::*;
use proptest::prelude::*;
use soifra_runtime::scene::Part;

fn rig(world: Vec<Part>, starts: &[[f64; 3]]) -> Rig {
    let mut s = scene(vec![body(0.1), holonomic(&[]), twist()], world, starts);
    for r in &mut s.robots {
        r.target = Some([-r.start[0], -r.start[1], 0.0]);
    }
    Rig::new(&s)
}

fn mover(rig: &Rig) -> [f64; 2] {
    let (_, p) = rig.truth().movers().remove(0);
    [p[0], p[1]]
}

#[test]
fn to_and_fro_with_a_phase() {
    let cart = |phase: f64| {
        part(
            "mover",
            "cart",
            "disc",
            &[
                ("radius", num(0.1)),
                ("path", path(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]])),
                ("speed", num(0.5)),
                ("phase", num(phase)),
            ],
        )
    };
    // The round trip is 6 m, 12 s.
    let expected = |t: f64| {
        let s = (0.5 * t).rem_euclid(6.0);
        let s = if s > 3.0 { 6.0 - s } else { s };
        if s < 2.0 { [s, 0.0] } else { [2.0, s - 2.0] }
    };
    for phase in [0.0, 0.1, 0.5, 0.75, 1.25] {
        let mut rig = rig(vec![cart(phase)], &[]);
        for i in 0..400 {
            let t = 0.37 * f64::from(i);
            rig.poll(t);
            let ([x, y], e) = (mover(&rig), expected(t + 12.0 * phase));
            close(x, e[0], 1e-6);
            close(y, e[1], 1e-6);
        }
    }
}

#[test]
fn a_walker_goes_round() {
    let walker = part(
        "mover",
        "guest",
        "walker",
        &[
            ("radius", num(0.3)),
            ("path", path(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])),
            ("speed", num(0.5)),
            ("phase", num(0.25)),
        ],
    );
    // The round is 6 m.
    let expected = |s: f64| match s {
        s if s < 2.0 => [s, 0.0],
        s if s < 3.0 => [2.0, s - 2.0],
        s if s < 5.0 => [5.0 - s, 1.0],
        s => [0.0, 6.0 - s],
    };
    let mut rig = rig(vec![walker], &[]);
    for i in 0..200 {
        let t = 0.37 * f64::from(i);
        rig.poll(t);
        let ([x, y], e) = (mover(&rig), expected((1.5 + 0.5 * t).rem_euclid(6.0)));
        close(x, e[0], 1e-6);
        close(y, e[1], 1e-6);
    }
}

#[test]
fn a_mover_may_stand() {
    for points in [vec![[1.0, 2.0]], vec![[1.0, 2.0], [1.0, 2.0]]] {
        let cart = part(
            "mover",
            "cart",
            "disc",
            &[("radius", num(0.1)), ("path", path(&points)), ("speed", num(1.0))],
        );
        let mut rig = rig(vec![cart], &[]);
        rig.poll(100.0);
        assert_eq!(mover(&rig), [1.0, 2.0]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_wanderer_stays_in_and_keeps_out(
        heading in -3.0f64..3.0, speed in 0.1f64..5.0, period in 0.05f64..5.0, x in -1.5f64..1.5, y in -1.5f64..1.5,
    ) {
        wander(heading, speed, period, x, y)?;
    }
}

/// The nearest place out of the disc would be where it touches the bounds.
#[test]
fn a_wanderer_does_not_begin_in_a_wedge() {
    wander(1.785, 0.1, 0.05, 0.0, -1.415).unwrap();
}

fn wander(heading: f64, speed: f64, period: f64, x: f64, y: f64) -> Result<(), TestCaseError> {
    let world = vec![
        part("bounds", "", "rectangle", &[("low", at(-2.0, -2.0)), ("high", at(2.0, 2.0))]),
        part(
            "mover",
            "fly",
            "wanderer",
            &[
                ("radius", num(0.2)),
                ("at", at(x, y)),
                ("heading", num(heading)),
                ("speed", num(speed)),
                ("turn_period", num(period)),
                ("keep_out", some(0.3)),
            ],
        ),
    ];
    let mut rig = rig(world, &[[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 1.3, 0.0]]);
    let mut walked = 0.0;
    let mut last = mover(&rig);
    for i in 0..2000 {
        rig.poll(0.01 * f64::from(i));
        let [x, y] = mover(&rig);
        prop_assert!(x.abs() <= 1.8 + 1e-6 && y.abs() <= 1.8 + 1e-6, "{} {}", x, y);
        for c in [[1.0, 1.0], [-1.0, 1.0], [0.0, 1.3], [-1.0, -1.0], [1.0, -1.0], [0.0, -1.3]] {
            prop_assert!(libm::hypot(x - c[0], y - c[1]) >= 0.5 - 1e-6, "{} {}", x, y);
        }
        walked += libm::hypot(x - last[0], y - last[1]);
        last = [x, y];
    }
    prop_assert!(walked > 0.5 * speed * 20.0, "{}", walked);
    Ok(())
}
