//! Operations on lists against the same operations on vectors.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::eval::FaultKind;
use soifra_graph::*;

const CAPACITY: u32 = 8;

/// A list operation with the list in local 0 and the item in local 1.
fn on(items: &[f64], make: impl Fn(Expr, Expr) -> Expr) -> Value {
    let t = list(LENGTH, CAPACITY);
    let value = Value::List(items.iter().map(|x| Value::Number(*x)).collect());
    let arguments = [(t, value), (LENGTH, Value::Number(0.0)), (LENGTH, Value::Number(0.0))];
    applied(|x| make(x[0].clone(), x[1].clone()), &arguments).unwrap()
}

fn optional(x: Option<f64>) -> Value {
    match x {
        Some(x) => Value::Some(Box::new(Value::Number(x))),
        None => Value::None("none found".into()),
    }
}

fn numbers(items: impl IntoIterator<Item = f64>) -> Value {
    Value::List(items.into_iter().map(Value::Number).collect())
}

proptest! {
    #[test]
    fn lists_are_like_vectors(items in prop::collection::vec(-5.0..5f64, 0..=8), limit in -5.0..5f64, index in -2..10i64) {
        let below = |item: Expr| binary(Binary::Lt, item, length(limit));
        let lists = |o: ListOp, ty: Type| on(&items, |l, i| op(Op::List(o, 1), vec![l, below(i)], ty.clone()));
        let t = list(LENGTH, CAPACITY);
        prop_assert_eq!(lists(ListOp::Filter, t.clone()), numbers(items.iter().copied().filter(|x| *x < limit)));
        prop_assert_eq!(lists(ListOp::Any, Type::Bool), Value::Bool(items.iter().any(|x| *x < limit)));
        prop_assert_eq!(lists(ListOp::All, Type::Bool), Value::Bool(items.iter().all(|x| *x < limit)));
        prop_assert_eq!(lists(ListOp::Count, Type::Int), Value::Int(items.iter().filter(|x| **x < limit).count() as i64));
        prop_assert_eq!(lists(ListOp::Find, LENGTH.optional()), optional(items.iter().copied().find(|x| *x < limit)));

        let twice = |item: Expr| binary(Binary::Mul, item, number(2.0));
        let mapped = on(&items, |l, i| op(Op::List(ListOp::Map, 1), vec![l, twice(i)], t.clone()));
        prop_assert_eq!(mapped, numbers(items.iter().map(|x| 2.0 * x)));

        let off = |item: Expr| call(Function::Abs, vec![binary(Binary::Sub, item, length(limit))], LENGTH);
        let by = |o: ListOp| on(&items, |l, i| op(Op::List(o, 1), vec![l, off(i)], LENGTH.optional()));
        let key = |x: f64| (x - limit).abs();
        let least = items.iter().copied().reduce(|a, b| if key(b) < key(a) { b } else { a });
        let most = items.iter().copied().reduce(|a, b| if key(b) > key(a) { b } else { a });
        prop_assert_eq!(by(ListOp::MinBy), optional(least));
        prop_assert_eq!(by(ListOp::MaxBy), optional(most));

        let folded = on(&items, |l, i| {
            let acc = local(2, LENGTH);
            let body = binary(Binary::Sub, binary(Binary::Mul, number(0.5), acc), i);
            op(Op::Fold(2, 1), vec![l, length(1.0), body], LENGTH)
        });
        prop_assert_eq!(folded, Value::Number(items.iter().fold(1.0, |a, x| 0.5 * a - x)));
        let branching = on(&items, |l, i| {
            let acc = local(2, LENGTH);
            let larger = binary(Binary::Gt, i.clone(), acc.clone());
            op(Op::Fold(2, 1), vec![l, length(0.0), op(Op::If, vec![larger, i, acc], LENGTH)], LENGTH)
        });
        prop_assert_eq!(branching, Value::Number(items.iter().fold(0.0, |a, x| if *x > a { *x } else { a })));

        let f = |f: Function, ty: Type| on(&items, |l, _| call(f, vec![l], ty.clone()));
        prop_assert_eq!(f(Function::Length, Type::Int), Value::Int(items.len() as i64));
        prop_assert_eq!(f(Function::Sum, LENGTH), Value::Number(items.iter().fold(0.0, |a, x| a + x)));
        prop_assert_eq!(f(Function::Smallest, LENGTH.optional()), optional(items.iter().copied().reduce(f64::min)));
        prop_assert_eq!(f(Function::Largest, LENGTH.optional()), optional(items.iter().copied().reduce(f64::max)));
        let item = |x: Option<&f64>| match x {
            Some(x) => optional(Some(*x)),
            None => Value::None("no such item".into()),
        };
        prop_assert_eq!(f(Function::First, LENGTH.optional()), item(items.first()));
        prop_assert_eq!(f(Function::Last, LENGTH.optional()), item(items.last()));
        let at = on(&items, |l, _| call(Function::At, vec![l, int(index)], LENGTH.optional()));
        prop_assert_eq!(at, item(usize::try_from(index).ok().and_then(|i| items.get(i))));
        let pushed = on(&items, |l, _| call(Function::Push, vec![l, length(9.0)], t.clone()));
        let mut model = items.clone();
        if model.len() == CAPACITY as usize {
            model.remove(0);
        }
        model.push(9.0);
        prop_assert_eq!(pushed, numbers(model));
    }

    /// Lists within lists, and loops within loops.
    #[test]
    fn loops_nest(xs in prop::collection::vec(-5.0..5f64, 0..=8), ys in prop::collection::vec(-5.0..5f64, 0..=8)) {
        let t = list(LENGTH, CAPACITY);
        let value = |items: &[f64]| numbers(items.iter().copied());
        let zero = || (LENGTH, Value::Number(0.0));
        let arguments = [(t.clone(), value(&xs)), (t.clone(), value(&ys)), zero(), zero()];
        // Items of xs for which some item of ys is greater, then the least of them.
        let found = applied(|x| {
            let greater = binary(Binary::Gt, x[3].clone(), x[2].clone());
            let any = op(Op::List(ListOp::Any, 3), vec![x[1].clone(), greater], Type::Bool);
            let filtered = op(Op::List(ListOp::Filter, 2), vec![x[0].clone(), any], t.clone());
            op(Op::List(ListOp::MinBy, 2), vec![filtered, x[2].clone()], LENGTH.optional())
        }, &arguments);
        let model = xs.iter().copied().filter(|x| ys.iter().any(|y| y > x)).reduce(f64::min);
        prop_assert_eq!(found.unwrap(), optional(model));
    }
}

fn beacon_value(rank: i64, x: f64, range: Option<f64>) -> Value {
    let range = match range {
        Some(r) => Value::Some(Box::new(Value::Number(r))),
        None => Value::None("nothing in range".into()),
    };
    Value::Record(vec![Value::Int(rank), Value::Vector([x, 0.0, 0.0]), range])
}

#[test]
fn records_in_lists_keep_all_their_fields() {
    let t = list(beacon(), 4);
    let items =
        vec![beacon_value(3, 1.0, None), beacon_value(1, 2.0, Some(0.5)), beacon_value(2, 3.0, Some(0.25))];
    let arguments = [
        (t.clone(), Value::List(items.clone())),
        (beacon(), beacon_value(0, 0.0, None)),
        (LENGTH, Value::Number(0.0)),
    ];
    let field = |i: u32, e: Expr, t: Type| op(Op::Field(i), vec![e], t);
    let rank = |e: &Expr| field(0, e.clone(), Type::Int);
    // The loop reads one field, the result has all of them.
    let filtered = applied(
        |x| {
            op(
                Op::List(ListOp::Filter, 1),
                vec![x[0].clone(), binary(Binary::Ge, rank(&x[1]), int(2))],
                t.clone(),
            )
        },
        &arguments,
    );
    assert_eq!(filtered, Ok(Value::List(vec![items[0].clone(), items[2].clone()])));
    let nearest = applied(
        |x| {
            let range = op(
                Op::IfSome { local: 2, reason: None },
                vec![field(2, x[1].clone(), LENGTH.optional()), x[2].clone(), length(10.0)],
                LENGTH,
            );
            op(Op::List(ListOp::MinBy, 1), vec![x[0].clone(), range], beacon().optional())
        },
        &arguments,
    );
    assert_eq!(nearest, Ok(Value::Some(Box::new(items[2].clone()))));
    let xs = applied(
        |x| {
            let part = op(Op::Part(Part::X), vec![field(1, x[1].clone(), point())], LENGTH);
            op(Op::List(ListOp::Map, 1), vec![x[0].clone(), part], list(LENGTH, 4))
        },
        &arguments,
    );
    assert_eq!(xs, Ok(numbers([1.0, 2.0, 3.0])));
}

#[test]
fn a_shorter_list_stands_for_a_longer_one() {
    let short = || op(Op::MakeList, vec![length(1.0), length(2.0)], list(LENGTH, 2));
    let empty = || op(Op::MakeList, vec![], list(Type::NUMBER, 0));
    let condition = || {
        binary(
            Binary::Gt,
            op(Op::Now, vec![], quantity(Dim::TIME)),
            constant(Value::Number(1.0), quantity(Dim::TIME)),
        )
    };
    let e = op(Op::If, vec![condition(), short(), empty()], list(LENGTH, 5));
    assert_eq!(value(&e), numbers([1.0, 2.0]));
    let e = op(Op::If, vec![condition(), empty(), short()], list(LENGTH, 5));
    assert_eq!(value(&e), numbers([]));
    let e = op(Op::If, vec![condition(), length(1.0), length(2.0)], LENGTH.optional());
    assert_eq!(value(&e), optional(Some(1.0)));
}

#[test]
fn unused_registers_are_zero() {
    let mut world = World {
        readings: vec![vec![0.0], vec![2.0, 5.0, 1.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0]],
        ..World::default()
    };
    let scan = op(Op::Reading(1), vec![], list(LENGTH, 8));
    let near = binary(Binary::Lt, local(0, LENGTH), length(3.0));
    let e = op(Op::List(ListOp::Filter, 0), vec![scan.clone(), near], list(LENGTH, 8));
    let r = registers_of(&e, &[LENGTH], &mut world).unwrap();
    assert_eq!(r, [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(registers_of(&scan, &[], &mut world).unwrap(), [2.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_loop_reads_a_sensor_once() {
    let mut world = World {
        readings: vec![vec![2.0], vec![3.0, 5.0, 1.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0]],
        ..World::default()
    };
    let scan = op(Op::Reading(1), vec![], list(LENGTH, 8));
    let near = binary(Binary::Gt, local(0, LENGTH), op(Op::Reading(0), vec![], LENGTH));
    let e = op(Op::List(ListOp::Count, 0), vec![scan, near], Type::Int);
    assert_eq!(registers_of(&e, &[LENGTH], &mut world).unwrap(), [2.0]);
    assert_eq!(world.asked, 2);
}

#[test]
fn counts_beyond_the_capacity_do_no_harm() {
    let mut world = World {
        readings: vec![vec![0.0], vec![1e9, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]],
        ..World::default()
    };
    let scan = || op(Op::Reading(1), vec![], list(LENGTH, 8));
    let sum = call(Function::Sum, vec![scan()], LENGTH);
    assert_eq!(registers_of(&sum, &[], &mut world).unwrap(), [8.0]);
    world.readings[1][0] = f64::NAN;
    let length = call(Function::Length, vec![scan()], Type::Int);
    assert_eq!(registers_of(&length, &[], &mut world).unwrap(), [0.0]);
    world.readings[1][0] = -3.0;
    assert_eq!(registers_of(&length, &[], &mut world).unwrap(), [0.0]);
    assert_eq!(
        fault(&op(Op::Truth(Truth::Collisions), vec![], Type::Int)),
        FaultKind::Unavailable("a robot in question")
    );
}
