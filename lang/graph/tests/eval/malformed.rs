//! Graphs that no compiler wrote: refused, or run to a fault, never a panic.

use crate::support::*;
use proptest::prelude::*;
use proptest::strategy::Strategy;
use soifra_graph::*;

fn refused(e: Expr, locals: &[Type]) -> String {
    match Ready::new(graph(), locals, |c, s| c.expr(s, &e)) {
        Ok(_) => panic!("compiled: {e:?}"),
        Err(why) => why.text,
    }
}

#[test]
fn wrong_indices_and_counts_are_refused() {
    let n = || Type::NUMBER;
    for e in [
        op(Op::Local(3), vec![], n()),
        op(Op::State(9), vec![], n()),
        op(Op::Param(9), vec![], n()),
        op(Op::Argument(9), vec![], Type::Int),
        op(Op::Reading(9), vec![], n()),
        op(Op::Heard(9), vec![], list(beacon(), 4)),
        op(Op::Call(0), vec![], n()),
        op(Op::Believed(0, 9), vec![], n()),
        op(Op::Believed(9, 0), vec![], n()),
        op(Op::Achieved(9), vec![], Type::Bool),
        op(Op::OfRobot(9), vec![number(1.0)], n()),
        op(Op::Binary(Binary::Add), vec![number(1.0)], n()),
        op(Op::Binary(Binary::Add), vec![number(1.0), boolean(true)], n()),
        op(Op::Binary(Binary::Add), vec![number(1.0), number(1.0)], point()),
        op(Op::Sqrt, vec![], n()),
        op(Op::If, vec![boolean(true), number(1.0)], n()),
        op(Op::If, vec![boolean(true), number(1.0), constant(Value::Vector([0.0; 3]), point())], n()),
        op(Op::Not, vec![constant(Value::Vector([0.0; 3]), point())], Type::Bool),
        op(Op::Builtin(Function::Min), vec![number(1.0)], n()),
        op(Op::Builtin(Function::Clamp), vec![number(1.0), number(1.0)], n()),
        op(Op::Builtin(Function::Sum), vec![number(1.0)], n()),
        op(Op::Builtin(Function::Draw), vec![number(1.0)], n()),
        op(Op::MakeRecord, vec![], beacon()),
        op(Op::MakeRecord, vec![], Type::Record("Nothing".into())),
        op(Op::MakeList, vec![number(1.0), number(2.0)], list(n(), 1)),
        op(Op::Field(7), vec![op(Op::State(3), vec![], beacon())], n()),
        op(Op::Field(0), vec![number(1.0)], n()),
        op(Op::Item(2, 0), vec![op(Op::MakeMatrix, vec![number(1.0)], Type::Matrix(1, 1))], n()),
        op(Op::Part(Part::Heading), vec![number(1.0)], n()),
        op(Op::Switch { variants: vec![0, 9], rest: false }, vec![mode("a"), number(1.0), number(1.0)], n()),
        op(Op::Switch { variants: vec![0], rest: true }, vec![mode("a"), number(1.0)], n()),
        op(Op::List(ListOp::Map, 0), vec![number(1.0), number(1.0)], list(n(), 4)),
        constant(Value::Number(1.0), point()),
        constant(Value::Number(f64::NAN), n()),
        constant(Value::Variant("zebra".into()), Type::Enum("Mode".into())),
        constant(Value::Int(0), Type::Record("Beacon".into())),
    ] {
        refused(e, &[]);
    }
    let scan = || op(Op::Reading(1), vec![], list(LENGTH, 8));
    let near = || binary(Binary::Lt, local(0, LENGTH), length(1.0));
    refused(op(Op::List(ListOp::Filter, 0), vec![scan(), near()], list(LENGTH, 4)), &[LENGTH]);
    refused(op(Op::List(ListOp::Filter, 0), vec![scan(), near()], list(LENGTH, 8)), &[point()]);
    refused(op(Op::Reading(2), vec![], LENGTH), &[]);
    refused(op(Op::Heard(0), vec![], list(LENGTH, 4)), &[]);
}

#[test]
fn records_that_hold_themselves_are_refused() {
    let mut g = graph();
    for (name, of) in [("A", "B"), ("B", "A")] {
        let fields = vec![("x".into(), Type::Record(of.into())), ("y".into(), Type::Record(of.into()))];
        g.types.records.insert(name.into(), Record { name: name.into(), fields });
    }
    let mut texts = Texts::default();
    let mut c = eval::Compiler::for_graph(&g, &mut texts);
    assert!(c.scope(&[Type::Record("A".into())]).is_err());
    assert!(c.scope(&[list(list(Type::NUMBER, 1 << 12), 1 << 12)]).is_err());
    assert!(c.scope(&vec![list(Type::NUMBER, 1 << 19); 100]).is_err());
}

/// As deep as a graph file may nest, on the smallest stack a thread gets.
#[test]
fn deep_expressions_do_not_overflow_the_stack() {
    let deep: [fn(Expr) -> Expr; 7] = [
        |e| binary(Binary::Add, e, op(Op::State(0), vec![], Type::NUMBER)),
        |e| binary(Binary::Add, op(Op::State(0), vec![], Type::NUMBER), e),
        |e| op(Op::If, vec![binary(Binary::Gt, e, number(3.0)), number(1.0), number(2.0)], Type::NUMBER),
        |e| op(Op::If, vec![boolean(true), op(Op::State(0), vec![], Type::NUMBER), e], Type::NUMBER),
        |e| {
            let t = list(Type::NUMBER, 1);
            let l = op(Op::MakeList, vec![e], t);
            op(
                Op::Fold(0, 1),
                vec![l, number(0.0), binary(Binary::Add, local(0, Type::NUMBER), local(1, Type::NUMBER))],
                Type::NUMBER,
            )
        },
        |e| op(Op::Let(0), vec![number(1.0), e], Type::NUMBER),
        |e| {
            let body = op(Op::Let(0), vec![local(1, Type::NUMBER), e], Type::NUMBER);
            let some = op(Op::MakeSome, vec![number(1.0)], Type::NUMBER.optional());
            op(Op::IfSome { local: 1, reason: None }, vec![some, body, number(1.0)], Type::NUMBER)
        },
    ];
    for (i, wrap) in deep.into_iter().enumerate() {
        std::thread::Builder::new()
            .stack_size(2 << 20)
            .spawn(move || {
                let levels = [2040, 2040, 680, 1020, 500, 1020, 400][i];
                let e = (0..levels).fold(op(Op::State(0), vec![], Type::NUMBER), |e, _| wrap(e));
                let locals = [Type::NUMBER, Type::NUMBER];
                let ready =
                    Ready::new(graph(), &locals, |c, s| c.expr(s, &e)).unwrap_or_else(|e| panic!("{i}: {e}"));
                let mut registers = Registers::new(&ready.graph);
                ready.run(&mut registers, &mut World::default()).unwrap();
                // Twice as deep is refused.
                let e = (0..2000).fold(e, |e, _| wrap(e));
                assert!(Ready::new(graph(), &locals, |c, s| c.expr(s, &e)).is_err());
                // Dropping it is not what is tested here.
                std::mem::forget(e);
            })
            .unwrap()
            .join()
            .unwrap();
    }
}

/// Any tree of operators over a few types.
fn any_expr() -> impl Strategy<Value = Expr> {
    let types = prop::sample::select(vec![
        Type::Bool,
        Type::Int,
        Type::NUMBER,
        LENGTH,
        ANGLE,
        Type::Text,
        Type::Heading(map()),
        point(),
        vector(),
        pose(),
        Type::Twist,
        beacon(),
        Type::Enum("Mode".into()),
        list(Type::NUMBER, 4),
        list(LENGTH, 8),
        list(beacon(), 4),
        LENGTH.optional(),
        beacon().optional(),
        Type::Matrix(2, 2),
        Type::Range(Dim::NONE),
        Type::Distribution(Dim::NONE),
    ]);
    let functions =
        prop::sample::select(FUNCTIONS.iter().map(|(f, _, _)| Op::Builtin(*f)).collect::<Vec<_>>());
    let binaries = prop::sample::select({
        use Binary::*;
        [Add, Sub, Mul, Div, Lt, Le, Gt, Ge, Eq, Ne, And, Or].map(Op::Binary).to_vec()
    });
    let others = prop::sample::select(vec![
        Op::Sqrt,
        Op::Dot,
        Op::Power(3),
        Op::Neg,
        Op::Not,
        Op::If,
        Op::Let(1),
        Op::IfSome { local: 1, reason: Some(2) },
        Op::Switch { variants: vec![0, 1], rest: true },
        Op::MakeRecord,
        Op::Field(1),
        Op::MakeList,
        Op::MakeVector,
        Op::MakeRange,
        Op::MakeMatrix,
        Op::MakeSome,
        Op::Part(Part::Heading),
        Op::Part(Part::X),
        Op::List(ListOp::Filter, 1),
        Op::List(ListOp::Map, 1),
        Op::List(ListOp::MinBy, 1),
        Op::Fold(1, 2),
        Op::Transpose,
        Op::Inverse,
        Op::Item(1, 1),
        Op::Quantified(Quantifier::Least),
        Op::OfRobot(1),
        Op::Call(0),
    ]);
    let leaf = (types.clone(), 0..12u32).prop_map(|(t, i)| match i {
        0 => op(Op::State(0), vec![], Type::NUMBER),
        1 => op(Op::State(1), vec![], list(point(), 4)),
        2 => op(Op::State(3), vec![], beacon()),
        3 => op(Op::Reading(1), vec![], list(LENGTH, 8)),
        4 => op(Op::Local(1), vec![], t),
        5 => op(Op::Local(2), vec![], t),
        6 => op(Op::Truth(Truth::Pose), vec![], pose()),
        7 => number(2.0),
        8 => length(0.0),
        9 => constant(Value::Vector([1.0, 2.0, 3.0]), point()),
        10 => boolean(true),
        _ => op(Op::State(0), vec![], t),
    });
    let ops = prop_oneof![functions, binaries, others];
    leaf.prop_recursive(6, 40, 4, move |inner| {
        (ops.clone(), prop::collection::vec(inner, 1..4), types.clone(), any::<bool>()).prop_map(
            |(o, mut args, t, fitting)| {
                // Half of them are given what the operator wants as far as can be told, so that some compile.
                let ty = match (&o, fitting) {
                    (Op::Binary(b), true) if args.len() > 1 => {
                        args.truncate(2);
                        typing::binary(*b, &args[0].ty, &args[1].ty).unwrap_or(t)
                    }
                    (Op::Not | Op::Neg, true) => {
                        args.truncate(1);
                        args[0].ty.clone()
                    }
                    (Op::MakeSome, true) => {
                        args.truncate(1);
                        args[0].ty.clone().optional()
                    }
                    (Op::If | Op::Let(_) | Op::Quantified(_) | Op::OfRobot(_), true) => {
                        args[args.len() - 1].ty.clone()
                    }
                    (Op::Builtin(f), true) => {
                        args.truncate(f.signature().parameters.len());
                        let mut vars = pattern::Bindings::default();
                        let fit = args
                            .iter()
                            .zip(&f.signature().parameters)
                            .all(|(a, p)| p.pattern.matches(&a.ty, &mut vars));
                        f.signature().result.instantiate(&vars).filter(|_| fit).unwrap_or(t)
                    }
                    _ => t,
                };
                op(o, args, ty)
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn no_tree_panics(e in any_expr(), first in prop::sample::select(vec![Type::NUMBER, LENGTH, point(), beacon()])) {
        let locals = [Type::NUMBER, first, LENGTH];
        if let Ok(ready) = Ready::new(graph(), &locals, |c, s| c.expr(s, &e)) {
            let mut world = World {
                readings: vec![vec![1.0], vec![2.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]],
                robots: 2,
                xs: vec![1.0, 2.0],
                ..World::default()
            };
            let mut registers = Registers::new(&ready.graph);
            // Code and frame go together always: the machine's own checks never have to save us.
            match ready.run(&mut registers, &mut world) {
                Ok(r) => prop_assert_eq!(r.len(), ready.graph.types.width(&e.ty)),
                Err(f) => prop_assert_ne!(f.kind, eval::FaultKind::Malformed),
            }
        }
    }
}
