//! Every built-in function, at least once.

use crate::support::*;
use soifra_graph::eval::{FaultKind, sample};
use soifra_graph::*;
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};

fn vec3(x: f64, y: f64, z: f64) -> Value {
    Value::Vector([x, y, z])
}

fn numbers(items: &[f64]) -> Expr {
    constant(Value::List(items.iter().map(|x| Value::Number(*x)).collect()), list(Type::NUMBER, 4))
}

/// A call and its value.
fn cases() -> Vec<(Function, Vec<Expr>, Type, Value)> {
    use Function as F;
    let n = Value::Number;
    let num = || Type::NUMBER;
    let h = || Type::Heading(map());
    let p = |x: f64, y: f64| constant(vec3(x, y, 0.0), point());
    let v = |x: f64, y: f64| constant(vec3(x, y, 0.0), vector());
    let body = Type::Vector(Frame::base_link(), Dim::LENGTH);
    let body_point = Type::Point(Frame::base_link());
    // At (1, 2), facing north: exact square roots keep the numbers readable.
    let s = 0.5f64.sqrt();
    let north = || constant(Value::Pose([1.0, 2.0, 0.0, 0.0, 0.0, s, s]), pose());
    let quarter = Value::Pose([1.0, 2.0, 0.0, 0.0, 0.0, libm::sin(PI / 4.0), libm::cos(PI / 4.0)]);
    let range = || constant(Value::Range(1.0, 3.0), Type::Range(Dim::NONE));
    let optional = || Type::NUMBER.optional();
    let some = |x: f64| Value::Some(Box::new(Value::Number(x)));
    let drawn = |d: Distribution| (Type::Distribution(Dim::NONE), Value::Distribution(d));
    vec![
        (F::Abs, vec![number(-2.0)], num(), n(2.0)),
        (F::Min, vec![number(1.0), number(2.0)], num(), n(1.0)),
        (F::Max, vec![number(1.0), number(2.0)], num(), n(2.0)),
        (F::Clamp, vec![number(5.0), number(1.0), number(2.0)], num(), n(2.0)),
        (F::Sign, vec![number(-3.0)], num(), n(-1.0)),
        (F::Floor, vec![number(-1.5)], Type::Int, Value::Int(-2)),
        (F::Ceil, vec![number(-1.5)], Type::Int, Value::Int(-1)),
        (F::Round, vec![number(-2.5)], Type::Int, Value::Int(-3)),
        (F::Modulo, vec![number(-1.0), number(3.0)], num(), n(2.0)),
        (F::Sin, vec![angle(0.0)], num(), n(0.0)),
        (F::Cos, vec![angle(0.0)], num(), n(1.0)),
        (F::Tan, vec![angle(0.0)], num(), n(0.0)),
        (F::Asin, vec![number(1.0)], ANGLE, n(FRAC_PI_2)),
        (F::Acos, vec![number(1.0)], ANGLE, n(0.0)),
        (F::Atan2, vec![number(1.0), number(0.0)], ANGLE, n(FRAC_PI_2)),
        (F::Exp, vec![number(0.0)], num(), n(1.0)),
        (F::Log, vec![number(1.0)], num(), n(0.0)),
        (F::Hypot, vec![number(3.0), number(4.0)], num(), n(5.0)),
        (F::Wrap, vec![angle(-PI)], ANGLE, n(PI)),
        (F::Towards, vec![angle(3.0 * PI)], h(), n(PI)),
        (F::AngleOf, vec![heading(1.0)], ANGLE, n(1.0)),
        (F::HeadingOf, vec![v(0.0, 2.0)], h(), n(FRAC_PI_2)),
        (F::Polar, vec![length(2.0), heading(0.0)], vector(), vec3(2.0, 0.0, 0.0)),
        (F::Norm, vec![v(3.0, 4.0)], LENGTH, n(5.0)),
        (F::Unit, vec![v(0.0, 0.0)], Type::Vector(map(), Dim::NONE), vec3(0.0, 0.0, 0.0)),
        (F::Distance, vec![p(1.0, 1.0), p(4.0, 5.0)], LENGTH, n(5.0)),
        (F::Rotate, vec![v(1.0, 2.0), angle(0.0)], vector(), vec3(1.0, 2.0, 0.0)),
        (F::PoseAt, vec![p(1.0, 2.0), heading(FRAC_PI_2)], pose(), quarter),
        (F::Bearing, vec![p(1.0, 3.0), north()], ANGLE, n(0.0)),
        (
            F::Place,
            vec![north(), constant(Value::Pose([0., 0., 0., 0., 0., 0., 1.]), pose())],
            pose(),
            Value::Pose([1.0, 2.0, 0.0, 0.0, 0.0, s, s]),
        ),
        (
            F::FromBody,
            vec![constant(vec3(0.0, 0.0, 1.0), body.clone()), north()],
            vector(),
            vec3(0.0, 0.0, 1.0),
        ),
        (F::ToBody, vec![constant(vec3(0.0, 0.0, 1.0), vector()), north()], body, vec3(0.0, 0.0, 1.0)),
        (
            F::PointFromBody,
            vec![constant(vec3(0.0, 0.0, 1.0), body_point.clone()), north()],
            point(),
            vec3(1.0, 2.0, 1.0),
        ),
        (F::PointToBody, vec![p(1.0, 2.0), north()], body_point, vec3(0.0, 0.0, 0.0)),
        (
            F::Twist,
            vec![
                constant(n(1.0), quantity(Dim::VELOCITY)),
                constant(n(2.0), quantity(Dim::ANGULAR_VELOCITY)),
                constant(n(3.0), quantity(Dim::VELOCITY)),
                constant(n(4.0), quantity(Dim::VELOCITY)),
            ],
            Type::Twist,
            Value::Twist([1.0, 3.0, 4.0, 0.0, 0.0, 2.0]),
        ),
        (
            F::CircleIntersections,
            vec![p(0.0, 0.0), length(1.0), p(2.0, 0.0), length(1.0)],
            list(point(), 2),
            Value::List(vec![vec3(1.0, 0.0, 0.0)]),
        ),
        (F::FirstContact, vec![p(0.0, 0.0), v(4.0, 0.0), p(3.0, 0.0), length(1.0)], optional(), some(0.5)),
        (
            F::Inside,
            vec![p(1.0, 0.0), constant(Value::Int(2), Type::Handle("Region".into()))],
            Type::Bool,
            Value::Bool(true),
        ),
        (F::Length, vec![numbers(&[3.0, 1.0])], Type::Int, Value::Int(2)),
        (F::At, vec![numbers(&[3.0, 1.0]), int(1)], optional(), some(1.0)),
        (F::First, vec![numbers(&[3.0, 1.0])], optional(), some(3.0)),
        (F::Last, vec![numbers(&[3.0, 1.0])], optional(), some(1.0)),
        (
            F::Push,
            vec![numbers(&[1.0, 2.0, 3.0, 4.0]), number(5.0)],
            list(num(), 4),
            Value::List(vec![n(2.0), n(3.0), n(4.0), n(5.0)]),
        ),
        (F::Sum, vec![numbers(&[3.0, 1.0])], num(), n(4.0)),
        (F::Smallest, vec![numbers(&[3.0, 1.0])], optional(), some(1.0)),
        (F::Largest, vec![numbers(&[])], optional(), Value::None("none found".into())),
        (F::Exactly, vec![number(1.0)], drawn(Distribution::Exact(1.0)).0, drawn(Distribution::Exact(1.0)).1),
        (
            F::Normal,
            vec![number(2.0), number(1.0)],
            drawn(Distribution::Exact(0.0)).0,
            drawn(Distribution::Normal(1.0, 2.0)).1,
        ),
        (
            F::Uniform,
            vec![number(1.0), number(2.0)],
            drawn(Distribution::Exact(0.0)).0,
            drawn(Distribution::Uniform(1.0, 2.0)).1,
        ),
        (
            F::Skewed,
            vec![number(1.0), number(2.0), number(9.0)],
            drawn(Distribution::Exact(0.0)).0,
            drawn(Distribution::Skewed(1.0, 2.0, 9.0)).1,
        ),
        (
            F::Draw,
            vec![constant(Value::Distribution(Distribution::Exact(7.0)), Type::Distribution(Dim::NONE))],
            num(),
            n(7.0),
        ),
        (F::Low, vec![range()], num(), n(1.0)),
        (F::High, vec![range()], num(), n(3.0)),
        (F::Within, vec![number(3.0), range()], Type::Bool, Value::Bool(true)),
    ]
}

/// Equal but for the last digits of single numbers and poses.
fn close(a: &Value, b: &Value) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() < 1e-15;
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => near(*x, *y),
        (Value::Pose(x), Value::Pose(y)) => x.iter().zip(y).all(|(x, y)| near(*x, *y)),
        _ => a == b,
    }
}

#[test]
fn every_function_has_its_value() {
    let mut covered = BTreeSet::new();
    for (f, args, ty, wanted) in cases() {
        let folded = value(&call(f, args.clone(), ty.clone()));
        assert!(close(&folded, &wanted), "{f:?}: {folded:?}");
        // The same with arguments the compiler does not know.
        let known: Vec<(Type, Value)> =
            args.iter().map(|a| (a.ty.clone(), a.as_const().expect("a constant").clone())).collect();
        if !known.iter().any(|(t, _)| matches!(t, Type::Handle(_))) {
            let run = applied(|names| call(f, names.to_vec(), ty), &known);
            assert_eq!(run, Ok(folded), "{f:?}");
        }
        covered.insert(f);
    }
    // Services are computed elsewhere.
    let own = FUNCTIONS.iter().filter(|(f, _, _)| !f.is_service());
    let missing: Vec<_> = own.filter(|(f, _, _)| !covered.contains(f)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn functions_refuse_what_they_have_no_value_for() {
    let domain = |f: Function, args: Vec<Expr>, ty: Type| {
        let kind = fault(&call(f, args, ty));
        assert!(matches!(kind, FaultKind::Domain(_)), "{f:?}: {kind}");
    };
    domain(Function::Asin, vec![number(1.1)], ANGLE);
    domain(Function::Acos, vec![number(-1.1)], ANGLE);
    domain(Function::Log, vec![number(0.0)], Type::NUMBER);
    let d = || Type::Distribution(Dim::NONE);
    domain(Function::Normal, vec![number(-1.0), number(0.0)], d());
    domain(Function::Uniform, vec![number(1.0), number(0.0)], d());
    domain(Function::Skewed, vec![number(1.0), number(0.0), number(2.0)], d());
    let modulo = call(Function::Modulo, vec![number(1.0), number(0.0)], Type::NUMBER);
    assert_eq!(fault(&modulo), FaultKind::DivisionByZero);
    assert_eq!(fault(&call(Function::Exp, vec![number(1000.0)], Type::NUMBER)), FaultKind::NotFinite);
}

/// Mean and standard deviation of many draws.
fn moments(d: Distribution) -> (f64, f64, f64, f64) {
    let mut state = 1;
    let draws: Vec<f64> = (0..100_000).map(|_| sample(d, &mut || split_mix(&mut state))).collect();
    let n = draws.len() as f64;
    let mean = draws.iter().sum::<f64>() / n;
    let sd = (draws.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n).sqrt();
    let least = draws.iter().copied().fold(f64::INFINITY, f64::min);
    let most = draws.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (mean, sd, least, most)
}

#[test]
fn draws_have_the_declared_moments() {
    let (mean, sd, ..) = moments(Distribution::Normal(3.0, 2.0));
    assert!((mean - 3.0).abs() < 0.03 && (sd - 2.0).abs() < 0.03, "{mean} {sd}");
    let (mean, sd, least, most) = moments(Distribution::Uniform(-1.0, 1.0));
    assert!(mean.abs() < 0.01 && (sd - (1.0f64 / 3.0).sqrt()).abs() < 0.01, "{mean} {sd}");
    assert!(least >= -1.0 && most < 1.0);
    let (mean, _, least, most) = moments(Distribution::Skewed(580.0, 602.4, 1228.0));
    assert!((mean - 602.4).abs() < 0.5, "{mean}");
    assert!(least >= 580.0 && most <= 1228.0);
    // Bulk at the best, also when the best is the greatest.
    let mut state = 3;
    let d = Distribution::Skewed(10.0, 9.0, 0.0);
    let near = (0..1000).filter(|_| sample(d, &mut || split_mix(&mut state)) > 9.0).count();
    assert!(near > 550, "{near}");
    assert_eq!(moments(Distribution::Skewed(1.0, 1.0, 1.0)).0, 1.0);
    assert_eq!(moments(Distribution::Skewed(1.0, 2.0, 2.0)), (2.0, 0.0, 2.0, 2.0));
}
