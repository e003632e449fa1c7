//! Statements, rules and guards.

use crate::support::*;
use soifra_graph::eval::FaultKind;
use soifra_graph::*;

fn run(
    stmts: Vec<Stmt>,
    locals: &[Type],
    registers: &mut Registers,
    world: &mut World,
) -> Result<(), FaultKind> {
    let ready = Ready::new(graph(), locals, |c, s| c.stmts(s, &stmts)).unwrap_or_else(|e| panic!("{e}"));
    ready.run(registers, world).map(|_| ()).map_err(|f| f.kind)
}

fn x() -> Expr {
    op(Op::State(0), vec![], Type::NUMBER)
}

fn set_x(e: Expr) -> Stmt {
    stmt(StmtKind::Set(0, e))
}

fn note(text: &str) -> Stmt {
    stmt(StmtKind::Note(text.into(), None))
}

#[test]
fn every_statement_has_its_effect() {
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    let twist = constant(Value::Twist([1.0, 0.0, 0.0, 0.0, 0.0, 2.0]), Type::Twist);
    let at_one = constant(Value::Vector([1.0, 2.0, 3.0]), point());
    let none = op(Op::MakeNone("too far".into()), vec![], LENGTH.optional());
    let message = || op(Op::MakeRecord, vec![local(0, Type::Int), at_one.clone(), none.clone()], beacon());
    let stmts = vec![
        stmt(StmtKind::Let(0, binary(Binary::Add, int(1), op(Op::Argument(0), vec![], Type::Int)))),
        set_x(binary(Binary::Add, x(), number(1.5))),
        set_x(binary(Binary::Add, x(), number(1.0))),
        stmt(StmtKind::Command(0, twist)),
        stmt(StmtKind::Publish(0, message())),
        stmt(StmtKind::Tell { performative: "inform".into(), to: "other".into(), content: message() }),
        stmt(StmtKind::Note("hello".into(), Some(x()))),
        stmt(StmtKind::Raise(1)),
        stmt(StmtKind::SetParam(1, length(4.0))),
        stmt(StmtKind::Set(
            1,
            call(
                Function::Push,
                vec![op(Op::State(1), vec![], list(point(), 4)), at_one.clone()],
                list(point(), 4),
            ),
        )),
    ];
    run(stmts, &[Type::Int], &mut registers, &mut world).unwrap();
    // 5 texts of the product come before "too far"; tags are one more than the index.
    let tag = (reason::REASONS.len() + 1) as f64;
    let sent = vec![6.0, 1.0, 2.0, 3.0, tag, 0.0];
    assert_eq!(
        world.done,
        [
            Done::Command(0, vec![1.0, 0.0, 0.0, 0.0, 0.0, 2.0]),
            Done::Publish(0, sent.clone()),
            Done::Tell("inform".into(), "other".into(), "Beacon".into(), sent),
            Done::Note("hello".into(), Some((Type::NUMBER, vec![2.5]))),
            Done::Raise(1),
            Done::SetParam(1, vec![0.0, 4.0]),
        ]
    );
    assert_eq!(registers.states[..5], [2.5, 1.0, 1.0, 2.0, 3.0]);
    assert_eq!(registers.states[5..14], [0.0; 9]);
}

#[test]
fn ways_part_and_join() {
    let body = |v: &str| {
        vec![
            stmt(StmtKind::If(
                binary(Binary::Gt, x(), number(3.0)),
                vec![note("above")],
                vec![note("below")],
            )),
            stmt(StmtKind::Switch {
                value: mode(v),
                arms: vec![(vec![0, 1], vec![note("a or b")])],
                rest: Some(vec![note("other")]),
            }),
            stmt(StmtKind::IfSome {
                value: op(Op::Param(1), vec![], LENGTH.optional()),
                local: 0,
                reason: Some(1),
                then: vec![stmt(StmtKind::Note("near".into(), Some(local(0, LENGTH))))],
                otherwise: vec![stmt(StmtKind::Note("far".into(), Some(local(1, Type::Text))))],
            }),
            note("end"),
        ]
    };
    let locals = [LENGTH, Type::Text];
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    run(body("b"), &locals, &mut registers, &mut world).unwrap();
    let not_given = Some((Type::Text, vec![reason::NOT_GIVEN as f64]));
    let note = |t: &str| Done::Note(t.into(), None);
    assert_eq!(world.done, [note("below"), note("a or b"), Done::Note("far".into(), not_given), note("end")]);

    world.done.clear();
    registers.states[0] = 4.0;
    registers.params = vec![2.0, 0.0, 0.75];
    run(body("c"), &locals, &mut registers, &mut world).unwrap();
    let near = Done::Note("near".into(), Some((LENGTH, vec![0.75])));
    assert_eq!(world.done, [note("above"), note("other"), near, note("end")]);
}

#[test]
fn a_bound_value_outlives_a_change_of_its_state() {
    let trail = || op(Op::State(1), vec![], list(point(), 4));
    let stmts = vec![
        stmt(StmtKind::IfSome {
            value: op(Op::Field(2), vec![op(Op::State(3), vec![], beacon())], LENGTH.optional()),
            local: 0,
            reason: None,
            then: vec![
                stmt(StmtKind::Set(
                    3,
                    op(
                        Op::MakeRecord,
                        vec![
                            int(1),
                            constant(Value::Vector([0.0; 3]), point()),
                            op(Op::MakeSome, vec![length(9.0)], LENGTH.optional()),
                        ],
                        beacon(),
                    ),
                )),
                stmt(StmtKind::Note("was".into(), Some(local(0, LENGTH)))),
            ],
            otherwise: vec![],
        }),
        stmt(StmtKind::Note("trail".into(), Some(call(Function::Length, vec![trail()], Type::Int)))),
    ];
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    let last = registers.states.len() - 1;
    registers.states[last] = 3.0;
    run(stmts, &[LENGTH], &mut registers, &mut world).unwrap();
    assert_eq!(world.done[0], Done::Note("was".into(), Some((LENGTH, vec![3.0]))));
    assert_eq!(registers.states[last], 9.0);
}

fn rule(guard: Vec<Conjunct>, text: &str) -> Rule {
    Rule { guard, body: vec![stmt(StmtKind::Note(text.into(), Some(local(0, LENGTH))))], at: at(5) }
}

#[test]
fn the_first_rule_that_holds_acts() {
    let near = || op(Op::Param(1), vec![], LENGTH.optional());
    let range = || op(Op::Reading(0), vec![], LENGTH);
    let rules = || {
        vec![stmt(StmtKind::Rules(vec![
            rule(
                vec![
                    Conjunct::Binds(0, near()),
                    Conjunct::Holds(binary(Binary::Lt, local(0, LENGTH), range())),
                ],
                "near",
            ),
            rule(
                vec![
                    Conjunct::Holds(binary(Binary::Gt, range(), length(1.0))),
                    Conjunct::Holds(binary(Binary::Lt, range(), length(2.0))),
                ],
                "range",
            ),
            rule(vec![], "otherwise"),
            rule(vec![], "never"),
        ]))]
    };
    let fired = |params: [f64; 3], range: f64| {
        let mut world = World { readings: vec![vec![range]], ..World::default() };
        let mut registers = Registers::new(&graph());
        registers.params = params.to_vec();
        run(rules(), &[LENGTH], &mut registers, &mut world).unwrap();
        assert_eq!(world.asked, 1);
        world.done
    };
    let note = |text: &str, x: f64| Done::Note(text.into(), Some((LENGTH, vec![x])));
    assert_eq!(fired([0.0, 0.0, 0.5], 0.6), [Done::Rule(0), note("near", 0.5)]);
    assert_eq!(fired([0.0, 1.0, 0.0], 1.5), [Done::Rule(1), note("range", 0.0)]);
    assert_eq!(fired([0.0, 1.0, 0.0], 2.5), [Done::Rule(2), note("otherwise", 0.0)]);
    assert_eq!(fired([0.0, 0.0, 3.0], 2.5), [Done::Rule(2), note("otherwise", 3.0)]);
}

#[test]
fn a_guard_binds_for_the_blocks_after_it() {
    let graph = graph();
    let mut texts = graph.texts.clone();
    let mut c = eval::Compiler::for_graph(&graph, &mut texts);
    c.agent(Some(0)).unwrap();
    let mut scope = c.scope(&[LENGTH]).unwrap();
    let near = op(Op::Param(1), vec![], LENGTH.optional());
    let guard = c
        .guard(
            &mut scope,
            &[Conjunct::Binds(0, near), Conjunct::Holds(binary(Binary::Lt, local(0, LENGTH), length(1.0)))],
        )
        .unwrap();
    let always = c.guard(&mut scope, &[]).unwrap();
    let body = c.expr(&mut scope, &binary(Binary::Mul, number(10.0), local(0, LENGTH))).unwrap();
    let program = c.finish();
    let mut frame = vec![0.0; scope.frame()];
    let mut registers = Registers::new(&graph);
    let mut holds = |params: [f64; 3], block, frame: &mut [f64]| {
        registers.params = params.to_vec();
        program.run(block, frame, &mut registers.memory(), &mut World::default()).unwrap();
        frame[block.result as usize]
    };
    assert_eq!(holds([0.0, 1.0, 0.0], &guard, &mut frame), 0.0);
    assert_eq!(holds([0.0, 0.0, 2.0], &guard, &mut frame), 0.0);
    assert_eq!(holds([0.0, 0.0, 0.5], &guard, &mut frame), 1.0);
    assert_eq!(holds([0.0, 0.0, 0.0], &body, &mut frame), 5.0);
    assert_eq!(holds([0.0, 0.0, 0.0], &always, &mut frame), 1.0);
}

#[test]
fn nothing_infinite_leaves() {
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    registers.states[0] = f64::INFINITY;
    let stmts = vec![stmt(StmtKind::Note("x".into(), Some(x())))];
    assert_eq!(run(stmts, &[], &mut registers, &mut world), Err(FaultKind::NotFinite));
    let grown = vec![set_x(binary(Binary::Mul, number(1e300), number(1e300)))];
    assert_eq!(run(grown, &[], &mut registers, &mut world), Err(FaultKind::NotFinite));
    assert!(world.done.is_empty());
}

#[test]
fn a_refused_effect_ends_the_run() {
    let mut world = World { refuse_after: Some(1), ..World::default() };
    let mut registers = Registers::new(&graph());
    let refused = run(vec![note("one"), note("two"), note("three")], &[], &mut registers, &mut world);
    assert_eq!(refused, Err(FaultKind::Refused("no more".into())));
    assert_eq!(world.done.len(), 1);
}

/// The list is taken as it was when the loop began, whatever its statements set.
#[test]
fn a_loop_does_its_statements_for_each_item() {
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    let numbers =
        constant(Value::List(vec![Value::Int(3), Value::Int(5), Value::Int(7)]), list(Type::Int, 4));
    let add = binary(Binary::Add, x(), op(Op::Sqrt, vec![number(4.0)], Type::NUMBER));
    let body = vec![
        stmt(StmtKind::If(binary(Binary::Eq, local(0, Type::Int), int(5)), vec![note("five")], vec![])),
        set_x(add),
        stmt(StmtKind::Note("x".into(), Some(x()))),
    ];
    let each = Each { list: numbers, local: 0, body };
    run(vec![stmt(StmtKind::Each(Box::new(each)))], &[Type::Int], &mut registers, &mut world).unwrap();
    let x = |v: f64| Done::Note("x".into(), Some((Type::NUMBER, vec![v])));
    assert_eq!(world.done, [x(2.0), Done::Note("five".into(), None), x(4.0), x(6.0)]);
    assert_eq!(registers.states[0], 6.0);
}

#[test]
fn a_loop_over_a_state_that_it_changes_ends() {
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    let trail = || op(Op::State(1), vec![], list(point(), 4));
    let push = |e: Expr| stmt(StmtKind::Set(1, call(Function::Push, vec![trail(), e], list(point(), 4))));
    let first = constant(Value::Vector([1.0, 2.0, 3.0]), point());
    let each = Each { list: trail(), local: 0, body: vec![push(local(0, point())), note("again")] };
    let stmts = vec![push(first), stmt(StmtKind::Each(Box::new(each)))];
    run(stmts, &[point()], &mut registers, &mut world).unwrap();
    assert_eq!(world.done, [Done::Note("again".into(), None)]);
    assert_eq!(registers.states[1], 2.0, "one more point");
}

#[test]
fn what_is_said_in_conversations_reaches_the_surroundings() {
    let (mut world, mut registers) = (World::default(), Registers::new(&graph()));
    let agents =
        |n: &[i64]| constant(Value::List(n.iter().map(|i| Value::Int(*i)).collect()), list(Type::Agent, 4));
    let none = op(Op::MakeNone("too far".into()), vec![], LENGTH.optional());
    let at_one = constant(Value::Vector([1.0, 2.0, 3.0]), point());
    let message = op(Op::MakeRecord, vec![int(6), at_one, none], beacon());
    let open = |to: Expr, within: Option<Expr>| {
        let content = Some(message.clone());
        let open = Open { conversation: 0, performative: "cfp".into(), content, to, within };
        stmt(StmtKind::Open(Box::new(open)))
    };
    let one = constant(Value::Int(9), Type::Agent);
    let second = constant(Value::Number(2.0), Type::Quantity(Dim::TIME));
    let thread = constant(Value::Int(12), Type::Conversation("deliver".into()));
    let reason = Some("busy".to_string());
    let reply = Reply { conversation: 0, performative: "refuse".into(), content: None, reason, thread };
    let stmts =
        vec![open(agents(&[4, 5]), None), open(one, Some(second)), stmt(StmtKind::Reply(Box::new(reply)))];
    run(stmts, &[], &mut registers, &mut world).unwrap();
    let tag = (reason::REASONS.len() + 1) as f64;
    let sent = vec![6.0, 1.0, 2.0, 3.0, tag, 0.0];
    assert_eq!(
        world.done,
        [
            Done::Open(0, "cfp".into(), sent.clone(), vec![4.0, 5.0], None),
            Done::Open(0, "cfp".into(), sent, vec![9.0], Some(2.0)),
            Done::Reply(0, "refuse".into(), Some("busy".into()), vec![], 12.0),
        ]
    );
}
