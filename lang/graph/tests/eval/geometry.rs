//! Geometry keeps its laws.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::*;

fn vec3(v: Value) -> [f64; 3] {
    let Value::Vector(v) = v else { panic!("no vector: {v:?}") };
    v
}

fn near(a: &[f64], b: &[f64], within: f64) -> bool {
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= within)
}

prop_compose! {
    fn any_vector()(x in -10.0..10f64, y in -10.0..10f64, z in -10.0..10f64) -> [f64; 3] {
        [x, y, z]
    }
}

prop_compose! {
    fn any_pose()(p in any_vector(), q in prop::array::uniform4(-1.0..1f64)) -> [f64; 7] {
        let n = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        let q = if n < 0.1 { [0.0, 0.0, 0.0, 1.0] } else { q.map(|c| c / n) };
        [p[0], p[1], p[2], q[0], q[1], q[2], q[3]]
    }
}

fn poses(f: Function, a: [f64; 7], b: [f64; 7]) -> [f64; 7] {
    let arguments = [(pose(), Value::Pose(a)), (pose(), Value::Pose(b))];
    match applied(|x| call(f, x.to_vec(), pose()), &arguments) {
        Ok(Value::Pose(p)) => p,
        other => panic!("{other:?}"),
    }
}

fn mapped(f: Function, v: [f64; 3], p: [f64; 7]) -> [f64; 3] {
    let body = Type::Vector(Frame::base_link(), Dim::LENGTH);
    let body_point = Type::Point(Frame::base_link());
    let (from, to) = match f {
        Function::FromBody => (body, vector()),
        Function::ToBody => (vector(), body),
        Function::PointFromBody => (body_point, point()),
        _ => (point(), body_point),
    };
    vec3(applied(|x| call(f, x.to_vec(), to), &[(from, Value::Vector(v)), (pose(), Value::Pose(p))]).unwrap())
}

proptest! {
    #[test]
    fn turning_back_undoes_turning(v in any_vector(), by in -7.0..7f64) {
        let turn = |v: [f64; 3], by: f64| vec3(applied(
            |x| call(Function::Rotate, x.to_vec(), vector()),
            &[(vector(), Value::Vector(v)), (ANGLE, Value::Number(by))],
        ).unwrap());
        prop_assert!(near(&turn(turn(v, by), -by), &v, 1e-12));
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        prop_assert!((length(turn(v, by)) - length(v)).abs() < 1e-10);
    }

    #[test]
    fn placing_is_associative(a in any_pose(), b in any_pose(), c in any_pose()) {
        let left = poses(Function::Place, poses(Function::Place, a, b), c);
        let right = poses(Function::Place, a, poses(Function::Place, b, c));
        prop_assert!(near(&left[..3], &right[..3], 1e-10));
        // A quaternion and its negative are one rotation.
        let same = near(&left[3..], &right[3..], 1e-10);
        let opposite = near(&left[3..], &right[3..].iter().map(|x| -x).collect::<Vec<_>>(), 1e-10);
        prop_assert!(same || opposite);
    }

    #[test]
    fn body_and_map_are_inverse(v in any_vector(), p in any_pose()) {
        prop_assert!(near(&mapped(Function::FromBody, mapped(Function::ToBody, v, p), p), &v, 1e-10));
        prop_assert!(near(&mapped(Function::PointToBody, mapped(Function::PointFromBody, v, p), p), &v, 1e-10));
    }

    #[test]
    fn placing_a_pose_places_its_points(v in any_vector(), a in any_pose(), b in any_pose()) {
        let through = mapped(Function::PointFromBody, mapped(Function::PointFromBody, v, a), b);
        let placed = mapped(Function::PointFromBody, v, poses(Function::Place, a, b));
        prop_assert!(near(&through, &placed, 1e-9));
    }

    #[test]
    fn a_pose_faces_its_heading(p in any_vector(), h in -3.1..3.1f64, ahead in 0.1..5f64) {
        let at = [(point(), Value::Vector(p)), (Type::Heading(map()), Value::Number(h))];
        let heading_back = applied(|x| {
            let pose = call(Function::PoseAt, x.to_vec(), pose());
            op(Op::Part(Part::Heading), vec![pose], Type::Heading(map()))
        }, &at).unwrap().number().unwrap();
        prop_assert!((heading_back - h).abs() < 1e-12);
        let bearing = applied(|x| {
            let pose = call(Function::PoseAt, x.to_vec(), pose());
            let polar = call(Function::Polar, vec![length(ahead), x[1].clone()], vector());
            let target = binary(Binary::Add, x[0].clone(), polar);
            call(Function::Bearing, vec![target, pose], ANGLE)
        }, &at).unwrap().number().unwrap();
        prop_assert!(bearing.abs() < 1e-10);
        for part in [Part::Roll, Part::Pitch] {
            let level = applied(|x| op(Op::Part(part), vec![call(Function::PoseAt, x.to_vec(), pose())], ANGLE), &at);
            prop_assert!(level.unwrap().number().unwrap().abs() < 1e-12);
        }
    }

    #[test]
    fn polar_and_heading_are_inverse(r in 0.01..100f64, h in -3.1..3.1f64) {
        let arguments = [(LENGTH, Value::Number(r)), (Type::Heading(map()), Value::Number(h))];
        let back = applied(|x| {
            call(Function::HeadingOf, vec![call(Function::Polar, x.to_vec(), vector())], Type::Heading(map()))
        }, &arguments).unwrap().number().unwrap();
        prop_assert!((back - h).abs() < 1e-12);
    }

    #[test]
    fn circles_cross_on_both_circles(a in any_vector(), b in any_vector(), ra in 0.0..10f64, rb in 0.0..10f64) {
        let arguments = [
            (point(), Value::Vector(a)),
            (LENGTH, Value::Number(ra)),
            (point(), Value::Vector(b)),
            (LENGTH, Value::Number(rb)),
        ];
        let found = applied(|x| call(Function::CircleIntersections, x.to_vec(), list(point(), 2)), &arguments);
        let Ok(Value::List(points)) = found else { panic!("{found:?}") };
        let d = libm::hypot(b[0] - a[0], b[1] - a[1]);
        prop_assert_eq!(points.is_empty(), d > ra + rb || d < (ra - rb).abs());
        for p in &points {
            let p = vec3(p.clone());
            // Near tangency the points lie only as exactly on the circles as rounding lets them.
            prop_assert!((libm::hypot(p[0] - a[0], p[1] - a[1]) - ra).abs() < 1e-6);
            prop_assert!((libm::hypot(p[0] - b[0], p[1] - b[1]) - rb).abs() < 1e-6);
            prop_assert_eq!(p[2], a[2]);
        }
        if let [first, _] = points.as_slice() {
            let p = vec3(first.clone());
            let left = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            prop_assert!(left >= 0.0);
        }
    }

    #[test]
    fn the_first_contact_touches(from in any_vector(), motion in any_vector(), center in any_vector(), radius in 0.0..5f64) {
        let arguments = [
            (point(), Value::Vector(from)),
            (vector(), Value::Vector(motion)),
            (point(), Value::Vector(center)),
            (LENGTH, Value::Number(radius)),
        ];
        let found = applied(|x| call(Function::FirstContact, x.to_vec(), Type::NUMBER.optional()), &arguments);
        let distance = |t: f64| {
            libm::hypot(from[0] + t * motion[0] - center[0], from[1] + t * motion[1] - center[1])
        };
        match found.unwrap() {
            Value::Some(t) => {
                let t = t.number().unwrap();
                prop_assert!((0.0..=1.0).contains(&t));
                if t == 0.0 {
                    prop_assert!(distance(0.0) <= radius);
                } else {
                    prop_assert!((distance(t) - radius).abs() < 1e-6);
                    for i in 0..10 {
                        prop_assert!(distance(t * f64::from(i) / 10.0) >= radius - 1e-6);
                    }
                }
            }
            _ => {
                for i in 0..=20 {
                    prop_assert!(distance(f64::from(i) / 20.0) >= radius - 1e-9);
                }
            }
        }
    }
}
