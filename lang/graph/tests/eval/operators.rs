//! Operators, control, and what is asked of the surroundings.

use crate::support::*;
use proptest::prelude::*;
use soifra_graph::eval::{FaultKind, Known, Parameters};
use soifra_graph::*;
use std::f64::consts::PI;

fn number_of(v: Value) -> f64 {
    v.number().expect("a number")
}

fn two(b: Binary, t: Type, x: f64, y: f64) -> Result<f64, FaultKind> {
    let arguments = [(t.clone(), Value::Number(x)), (t, Value::Number(y))];
    applied(|a| binary(b, a[0].clone(), a[1].clone()), &arguments).map(number_of).map_err(|f| f.kind)
}

proptest! {
    #[test]
    fn quantities_add_and_multiply_as_numbers_do(x in -1e6..1e6f64, y in -1e6..1e6f64) {
        prop_assert_eq!(two(Binary::Add, LENGTH, x, y), Ok(x + y));
        prop_assert_eq!(two(Binary::Sub, LENGTH, x, y), Ok(x - y));
        prop_assert_eq!(two(Binary::Mul, LENGTH, x, y), Ok(x * y));
        let quotient = if y == 0.0 { Err(FaultKind::DivisionByZero) } else { Ok(x / y) };
        prop_assert_eq!(two(Binary::Div, LENGTH, x, y), quotient);
    }

    /// A constant on either side, a register on either side, and both folded give the same.
    #[test]
    fn constants_and_registers_agree(x in -100.0..100f64, y in -100.0..100f64) {
        use Binary::*;
        for b in [Add, Sub, Mul, Div, Lt, Le, Gt, Ge, Eq, Ne] {
            let n = |v: f64| (Type::NUMBER, Value::Number(v));
            let registers = applied(|a| binary(b, a[0].clone(), a[1].clone()), &[n(x), n(y)]);
            let left = applied(|a| binary(b, number(x), a[0].clone()), &[n(y)]);
            let right = applied(|a| binary(b, a[0].clone(), number(y)), &[n(x)]);
            let folded = value_in(&binary(b, number(x), number(y)), &[], &mut World::default());
            prop_assert_eq!(&registers, &left);
            prop_assert_eq!(&registers, &right);
            prop_assert_eq!(&registers, &folded);
            // The same comparison as a condition.
            if !matches!(b, Add | Sub | Mul | Div) {
                let as_condition = applied(|a| {
                    let c = binary(b, a[0].clone(), a[1].clone());
                    op(Op::If, vec![c, boolean(true), boolean(false)], Type::Bool)
                }, &[n(x), n(y)]);
                prop_assert_eq!(&registers, &as_condition);
                let right = applied(|a| {
                    let c = op(Op::Not, vec![binary(b, number(x), a[0].clone())], Type::Bool);
                    op(Op::If, vec![c, boolean(false), boolean(true)], Type::Bool)
                }, &[n(y)]);
                prop_assert_eq!(&registers, &right);
            }
        }
    }

    #[test]
    fn headings_wrap(a in -10.0..10f64, b in -10.0..10f64) {
        let h = Type::Heading(map());
        let turned = |b: f64, sign: Binary| number_of(applied(
            |x| binary(sign, x[0].clone(), x[1].clone()),
            &[(h.clone(), Value::Number(a)), (ANGLE, Value::Number(b))],
        ).unwrap());
        for (sign, sum) in [(Binary::Add, a + b), (Binary::Sub, a - b)] {
            let t = turned(b, sign);
            prop_assert!(t > -PI && t <= PI);
            prop_assert!((libm::sin(t) - libm::sin(sum)).abs() < 1e-12);
            prop_assert!((libm::cos(t) - libm::cos(sum)).abs() < 1e-12);
        }
        let difference = number_of(applied(
            |x| binary(Binary::Sub, x[0].clone(), x[1].clone()),
            &[(h.clone(), Value::Number(a)), (h.clone(), Value::Number(b))],
        ).unwrap());
        prop_assert!(difference > -PI && difference <= PI);
        prop_assert!((libm::cos(difference) - libm::cos(a - b)).abs() < 1e-12);
    }

    #[test]
    fn logic_is_logic(p: bool, q: bool, r: bool) {
        let b = |x: bool| (Type::Bool, Value::Bool(x));
        let of = |make: &dyn Fn(&[Expr]) -> Expr| applied(make, &[b(p), b(q), b(r)]).unwrap();
        let not = |e: Expr| op(Op::Not, vec![e], Type::Bool);
        let (and, or) = (Binary::And, Binary::Or);
        let mix = |x: &[Expr]| binary(or, binary(and, x[0].clone(), not(x[1].clone())), not(binary(or, x[1].clone(), x[2].clone())));
        let expected = if q { false } else { p || !r };
        prop_assert_eq!(of(&mix), Value::Bool(expected));
        let condition = |x: &[Expr]| op(Op::If, vec![mix(x), int(1), int(2)], Type::Int);
        prop_assert_eq!(of(&condition), Value::Int(if expected { 1 } else { 2 }));
        let both = |x: &[Expr]| not(binary(and, binary(or, x[0].clone(), x[1].clone()), binary(or, not(x[0].clone()), x[2].clone())));
        prop_assert_eq!(of(&both), Value::Bool(!((p || q) && (!p || r))));
    }

    #[test]
    fn powers_are_products(x in -50.0..50f64, n in 0..8i32) {
        let t = typing::power(&Type::NUMBER, n).unwrap();
        let power = applied(|a| op(Op::Power(n), vec![a[0].clone()], t.clone()), &[(Type::NUMBER, Value::Number(x))]);
        let product = (0..n).fold(1.0, |p, _| p * x);
        let power = number_of(power.unwrap());
        prop_assert!((power - product).abs() <= 1e-12 * product.abs());
    }
}

#[test]
fn a_sum_of_angles_is_not_wrapped_but_a_heading_is() {
    assert_eq!(value(&binary(Binary::Add, angle(3.0), angle(3.0))), Value::Number(6.0));
    let turned = number_of(value(&binary(Binary::Add, heading(3.0), angle(3.0))));
    assert!((turned - (6.0 - 2.0 * PI)).abs() < 1e-15);
    let south = binary(Binary::Sub, heading(0.0), angle(PI));
    assert_eq!(value(&south), Value::Number(PI));
}

#[test]
fn whole_numbers_end_at_two_to_the_53() {
    let big = int(1 << 53);
    assert_eq!(value(&binary(Binary::Sub, big.clone(), int(1))), Value::Int((1 << 53) - 1));
    assert_eq!(fault(&binary(Binary::Add, big.clone(), int(2))), FaultKind::Overflow);
    assert_eq!(fault(&binary(Binary::Mul, big.clone(), int(2))), FaultKind::Overflow);
    // What would be rounded to 2^53 is beyond it, what is 2^53 is not.
    assert_eq!(fault(&binary(Binary::Add, big.clone(), int(1))), FaultKind::Overflow);
    assert_eq!(fault(&binary(Binary::Add, int(1), big.clone())), FaultKind::Overflow);
    assert_eq!(fault(&binary(Binary::Sub, int(-1), big)), FaultKind::Overflow);
    assert_eq!(fault(&binary(Binary::Mul, int(3), int(3_002_399_751_580_331))), FaultKind::Overflow);
    assert_eq!(value(&binary(Binary::Add, int((1 << 53) - 1), int(1))), Value::Int(1 << 53));
    assert_eq!(value(&binary(Binary::Mul, int(1 << 20), int(1 << 33))), Value::Int(1 << 53));
    let cube = op(Op::Power(3), vec![int(1 << 20)], Type::Int);
    assert_eq!(fault(&cube), FaultKind::Overflow);
    assert_eq!(value(&op(Op::Power(3), vec![int(-3)], Type::Int)), Value::Int(-27));
    let ceil = call(Function::Ceil, vec![number(1e300)], Type::Int);
    assert_eq!(fault(&ceil), FaultKind::Overflow);
}

#[test]
fn faults_name_the_operation() {
    let mut division = binary(Binary::Div, number(1.0), binary(Binary::Sub, number(2.0), number(2.0)));
    division.span = at(42);
    let e = binary(Binary::Add, number(1.0), division);
    let f = value_in(&e, &[], &mut World::default()).unwrap_err();
    assert_eq!((f.kind, f.at), (FaultKind::DivisionByZero, at(42)));
    assert_eq!(fault(&binary(Binary::Mul, number(1e200), number(1e200))), FaultKind::NotFinite);
    assert!(matches!(fault(&op(Op::Sqrt, vec![number(-1.0)], Type::NUMBER)), FaultKind::Domain(_)));
    assert_eq!(fault(&op(Op::Power(-1), vec![number(0.0)], Type::NUMBER)), FaultKind::DivisionByZero);
}

#[test]
fn what_is_not_evaluated_does_not_fault() {
    let bad = || binary(Binary::Gt, binary(Binary::Div, number(1.0), number(0.0)), number(0.0));
    assert_eq!(value(&binary(Binary::And, boolean(false), bad())), Value::Bool(false));
    assert_eq!(value(&binary(Binary::Or, boolean(true), bad())), Value::Bool(true));
    assert_eq!(fault(&binary(Binary::And, boolean(true), bad())), FaultKind::DivisionByZero);
    let chosen = op(Op::If, vec![boolean(true), boolean(true), bad()], Type::Bool);
    assert_eq!(value(&chosen), Value::Bool(true));
}

#[test]
fn vectors_matrices_and_twists() {
    let v = |x: f64, y: f64, z: f64| constant(Value::Vector([x, y, z]), vector());
    let p = constant(Value::Vector([1.0, 1.0, 1.0]), point());
    assert_eq!(value(&binary(Binary::Add, p.clone(), v(1.0, 2.0, 3.0))), Value::Vector([2.0, 3.0, 4.0]));
    assert_eq!(value(&binary(Binary::Sub, p.clone(), p.clone())), Value::Vector([0.0; 3]));
    assert_eq!(value(&binary(Binary::Mul, number(2.0), v(1.0, 2.0, 3.0))), Value::Vector([2.0, 4.0, 6.0]));
    assert_eq!(value(&binary(Binary::Mul, v(1.0, 2.0, 3.0), number(2.0))), Value::Vector([2.0, 4.0, 6.0]));
    assert_eq!(value(&binary(Binary::Div, v(1.0, 2.0, 3.0), number(2.0))), Value::Vector([0.5, 1.0, 1.5]));
    let dot = op(Op::Dot, vec![v(1.0, 2.0, 3.0), v(4.0, 5.0, 6.0)], quantity(Dim::LENGTH.power(2).unwrap()));
    assert_eq!(value(&dot), Value::Number(32.0));
    assert_eq!(value(&op(Op::Neg, vec![v(1.0, 2.0, 3.0)], vector())), Value::Vector([-1.0, -2.0, -3.0]));
    assert_eq!(value(&binary(Binary::Eq, p.clone(), p.clone())), Value::Bool(true));
    assert_eq!(value(&binary(Binary::Ne, v(1.0, 2.0, 3.0), v(1.0, 2.0, 4.0))), Value::Bool(true));

    let m = |r: u8, c: u8, items: &[f64]| {
        let args = items.iter().map(|x| number(*x)).collect();
        op(Op::MakeMatrix, args, Type::Matrix(r, c))
    };
    let a = m(2, 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let transposed = op(Op::Transpose, vec![a.clone()], Type::Matrix(3, 2));
    assert_eq!(value(&transposed), Value::Matrix(vec![1.0, 4.0, 2.0, 5.0, 3.0, 6.0]));
    let square = binary(Binary::Mul, a.clone(), transposed);
    assert_eq!(value(&square), Value::Matrix(vec![14.0, 32.0, 32.0, 77.0]));
    assert_eq!(value(&op(Op::Item(1, 0), vec![square.clone()], Type::NUMBER)), Value::Number(32.0));
    let inverse = op(Op::Inverse, vec![square.clone()], Type::Matrix(2, 2).optional());
    let Value::Some(inverse) = value(&inverse) else { panic!("no inverse") };
    let Value::Matrix(i) = *inverse else { panic!("no matrix") };
    let product = [
        i[0] * 14.0 + i[1] * 32.0,
        i[0] * 32.0 + i[1] * 77.0,
        i[2] * 14.0 + i[3] * 32.0,
        i[2] * 32.0 + i[3] * 77.0,
    ];
    for (x, y) in product.iter().zip([1.0, 0.0, 0.0, 1.0]) {
        assert!((x - y).abs() < 1e-12);
    }
    let singular = op(Op::Inverse, vec![m(2, 2, &[1.0, 2.0, 2.0, 4.0])], Type::Matrix(2, 2).optional());
    assert_eq!(value(&singular), Value::None("the matrix is singular".into()));
    assert_eq!(value(&binary(Binary::Sub, a.clone(), a)), Value::Matrix(vec![0.0; 6]));

    let t = constant(Value::Twist([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), Type::Twist);
    let half = binary(Binary::Mul, number(0.5), binary(Binary::Add, t.clone(), t.clone()));
    assert_eq!(value(&half), Value::Twist([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let turn = op(Op::Part(Part::Turn), vec![t], quantity(Dim::ANGULAR_VELOCITY));
    assert_eq!(value(&turn), Value::Number(6.0));
}

#[test]
fn records_optionals_and_enums() {
    let none = op(Op::MakeNone("too far".into()), vec![], LENGTH.optional());
    let at_one = constant(Value::Vector([1.0, 2.0, 3.0]), point());
    let some = op(Op::MakeSome, vec![length(2.0)], LENGTH.optional());
    let make = |range: Expr| op(Op::MakeRecord, vec![int(3), at_one.clone(), range], beacon());
    assert_eq!(
        value(&make(none.clone())),
        Value::Record(vec![Value::Int(3), Value::Vector([1.0, 2.0, 3.0]), Value::None("too far".into())])
    );
    let next = op(Op::Field(1), vec![make(none.clone())], point());
    assert_eq!(value(&op(Op::Part(Part::Y), vec![next], LENGTH)), Value::Number(2.0));

    let either = |of: Expr| {
        let text = || op(Op::MakeNone("never".into()), vec![], LENGTH.optional());
        let body = binary(Binary::Add, local(0, LENGTH), length(1.0));
        let then = op(Op::MakeSome, vec![body], LENGTH.optional());
        op(Op::IfSome { local: 0, reason: None }, vec![of, then, text()], LENGTH.optional())
    };
    let locals = [LENGTH, Type::Text];
    let value = |e: &Expr| value_in(e, &locals, &mut World::default()).unwrap();
    assert_eq!(value(&either(some.clone())), Value::Some(Box::new(Value::Number(3.0))));
    assert_eq!(value(&either(none.clone())), Value::None("never".into()));
    let why = |of: Expr| {
        let text = constant(Value::Text("there".into()), Type::Text);
        op(Op::IfSome { local: 0, reason: Some(1) }, vec![of, text, local(1, Type::Text)], Type::Text)
    };
    assert_eq!(value(&why(none)), Value::Text("too far".into()));
    assert_eq!(value(&why(some)), Value::Text("there".into()));

    let switch = |v: &str, rest: bool| {
        let mut args = vec![mode(v), int(10), int(20)];
        if rest {
            args.push(int(99));
        }
        op(Op::Switch { variants: vec![0, 2], rest }, args, Type::Int)
    };
    assert_eq!(value(&switch("a", false)), Value::Int(10));
    assert_eq!(value(&switch("c", true)), Value::Int(20));
    assert_eq!(value(&switch("b", true)), Value::Int(99));
    assert!(value_in(&switch("b", false), &[], &mut World::default()).is_err());

    let shared = op(
        Op::Let(0),
        vec![
            binary(Binary::Add, length(1.0), op(Op::Own(Own::Radius), vec![], LENGTH)),
            binary(Binary::Sub, local(0, LENGTH), local(0, LENGTH)),
        ],
        LENGTH,
    );
    assert_eq!(value(&shared), Value::Number(0.0));
    let range = op(Op::MakeRange, vec![length(1.0), length(2.0)], Type::Range(Dim::LENGTH));
    assert_eq!(value(&range), Value::Range(1.0, 2.0));
    assert_eq!(value(&binary(Binary::Eq, range.clone(), range)), Value::Bool(true));
}

#[test]
fn questions_reach_the_surroundings() {
    let mut world = World { robots: 3, robot: Some(1), xs: vec![1.0, 5.0, 3.0], ..World::default() };
    let mut ask = |e: Expr| value_in(&e, &[], &mut world).unwrap();
    let duration = || quantity(Dim::TIME);
    assert_eq!(ask(op(Op::Now, vec![], duration())), Value::Number(12.5));
    assert_eq!(ask(op(Op::StepCount, vec![], quantity(Dim::STEP))), Value::Number(3.0));
    assert_eq!(ask(op(Op::Elapsed, vec![], duration())), Value::Number(0.5));
    assert_eq!(ask(op(Op::Own(Own::Index), vec![], Type::Int)), Value::Int(1));
    assert_eq!(ask(op(Op::Own(Own::Target), vec![], point())), Value::Vector([2.0; 3]));
    assert_eq!(ask(op(Op::Own(Own::Start), vec![], pose())), Value::Pose([1.0; 7]));
    assert_eq!(ask(op(Op::Run(Run::Collisions), vec![], Type::Int)), Value::Int(1));
    assert_eq!(ask(op(Op::Achieved(0), vec![], Type::Bool)), Value::Bool(true));
    assert_eq!(ask(op(Op::Param(0), vec![], Type::NUMBER)), Value::Number(2.0));
    assert_eq!(ask(op(Op::Argument(0), vec![], Type::Int)), Value::Int(5));
    assert_eq!(ask(op(Op::Believed(0, 0), vec![], Type::NUMBER)), Value::Number(100.0));

    let path = || op(Op::Truth(Truth::PathLength), vec![], LENGTH);
    let far = || binary(Binary::Gt, path(), length(2.0));
    let of = |q: Quantifier, e: Expr, t: Type| op(Op::Quantified(q), vec![e], t);
    assert_eq!(ask(of(Quantifier::Each, far(), Type::Bool)), Value::Bool(false));
    assert_eq!(ask(of(Quantifier::Some, far(), Type::Bool)), Value::Bool(true));
    assert_eq!(ask(of(Quantifier::Count, far(), Type::Int)), Value::Int(2));
    assert_eq!(ask(of(Quantifier::Sum, path(), LENGTH)), Value::Number(9.0));
    assert_eq!(ask(of(Quantifier::Least, path(), LENGTH)), Value::Number(1.0));
    assert_eq!(ask(of(Quantifier::Most, path(), LENGTH)), Value::Number(5.0));
    assert_eq!(ask(of(Quantifier::Mean, path(), LENGTH)), Value::Number(3.0));
    // Nested: robots with a longer path than some other one.
    let other = op(Op::OfRobot(0), vec![path()], LENGTH);
    let longer = of(Quantifier::Some, binary(Binary::Gt, path(), length(4.0)), Type::Bool);
    let nested = binary(Binary::And, binary(Binary::Gt, path(), other), longer);
    assert_eq!(ask(of(Quantifier::Count, nested, Type::Int)), Value::Int(2));
    let bad = of(
        Quantifier::Sum,
        binary(Binary::Div, length(1.0), binary(Binary::Sub, path(), length(5.0))),
        LENGTH,
    );
    assert!(value_in(&Expr { ty: Type::NUMBER, ..bad }, &[], &mut world).is_err());
    assert_eq!(world.robot, Some(1), "the robot in question is put back, also after a fault");
}

#[test]
fn a_reading_is_fetched_once() {
    let mut world = World { readings: vec![vec![1.5]], ..World::default() };
    let range = || op(Op::Reading(0), vec![], LENGTH);
    let e = binary(Binary::Add, binary(Binary::Add, range(), range()), range());
    assert_eq!(registers_of(&e, &[], &mut world).unwrap(), [4.5]);
    assert_eq!(world.asked, 1);
    // On two ways of which one is taken it is fetched on that way.
    let e = op(
        Op::If,
        vec![
            boolean(false),
            range(),
            binary(Binary::Add, range(), binary(Binary::Add, range(), length(1.0))),
        ],
        LENGTH,
    );
    assert_eq!(registers_of(&e, &[], &mut world).unwrap(), [4.0]);
    assert_eq!(world.asked, 2);
}

#[test]
fn functions_call_each_other_but_not_themselves() {
    let n = Type::NUMBER;
    let function = |name: &str, body: Expr| UserFunction {
        name: name.into(),
        parameters: vec![("x".into(), Type::NUMBER)],
        locals: vec![Type::NUMBER],
        body,
        span: at(3),
    };
    let square = function("square", binary(Binary::Mul, local(0, n.clone()), local(0, n.clone())));
    let call_of = |i: u32, arg: Expr| op(Op::Call(i), vec![arg], Type::NUMBER);
    let fourth = function("fourth", call_of(0, call_of(0, local(0, n.clone()))));
    let endless = function("endless", call_of(2, local(0, n.clone())));
    let types = TypeTable::default();
    let functions = [square, fourth, endless];
    let known = Known { types: &types, functions: &functions, params: &Parameters::default(), locals: &[] };
    let of = |e: &Expr| eval::constant(e, &known, &mut Texts::default());
    let e = binary(Binary::Add, call_of(1, number(3.0)), call_of(0, number(2.0)));
    assert_eq!(of(&e), Ok(Value::Number(85.0)));
    let f = of(&call_of(2, number(1.0))).unwrap_err();
    assert!(f.to_string().contains("calls itself"), "{f}");
    assert!(of(&call_of(3, number(1.0))).is_err());
}

#[test]
fn constants_depend_on_what_is_given_only() {
    let types = types();
    let params = [(LENGTH, Value::Number(2.0)), (list(LENGTH, 3), Value::List(vec![Value::Number(4.0)]))];
    let given = params.iter().map(|(t, v)| (t, v));
    let params = Parameters::new(&types, &mut Texts::default(), given).unwrap();
    let locals = [(Type::Int, Some(Value::Int(3))), (LENGTH, None)];
    let known = Known { types: &types, functions: &[], params: &params, locals: &locals };
    let of = |e: &Expr| eval::constant(e, &known, &mut Texts::default());
    let sum = call(Function::Sum, vec![op(Op::Param(1), vec![], list(LENGTH, 3))], LENGTH);
    let e =
        binary(Binary::Mul, local(0, Type::Int), binary(Binary::Add, op(Op::Param(0), vec![], LENGTH), sum));
    assert_eq!(of(&e), Ok(Value::Number(18.0)));
    let now = op(Op::Now, vec![], quantity(Dim::TIME));
    assert_eq!(of(&now).unwrap_err().kind, FaultKind::Unavailable("the time"));
    assert!(matches!(of(&op(Op::State(0), vec![], Type::Int)).unwrap_err().kind, FaultKind::Unavailable(_)));
}

#[test]
fn bounds_hold() {
    use soifra_graph::eval::Compiler;
    let graph = graph();
    let mut texts = Texts::default();
    let mut c = Compiler::for_graph(&graph, &mut texts);
    c.agent(Some(0)).unwrap();
    let t = list(LENGTH, 8);
    let mut scope = c.scope(&[t.clone(), LENGTH]).unwrap();
    let leaf = binary(Binary::Gt, op(Op::State(0), vec![], Type::NUMBER), number(3.0));
    let leaf = c.expr(&mut scope, &leaf).unwrap();
    assert!(leaf.bound <= 4, "{}", leaf.bound);
    let near = binary(Binary::Lt, local(1, LENGTH), length(1.0));
    let count = op(Op::List(ListOp::Count, 1), vec![local(0, t), near], Type::Int);
    let count = c.expr(&mut scope, &count).unwrap();
    assert!((8 * 3..8 * 4 + 8).contains(&count.bound), "{}", count.bound);
}
