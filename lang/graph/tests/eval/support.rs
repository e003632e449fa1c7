//! Builders of expressions, and surroundings that record what is done to them.

use soifra_graph::eval::{Block, Compiler, Fault, Scope};
use soifra_graph::eval::{Effect, Env, FaultKind, Layout, Memory, Program, sample};
use soifra_graph::*;

/// A quantity of dimension `dim`.
pub fn quantity(dim: Dim) -> Type {
    Type::Quantity(dim)
}

pub const LENGTH: Type = Type::Quantity(Dim::LENGTH);
pub const ANGLE: Type = Type::Quantity(Dim::ANGLE);

pub fn map() -> Frame {
    Frame::map()
}

pub fn point() -> Type {
    Type::Point(map())
}

pub fn vector() -> Type {
    Type::Vector(map(), Dim::LENGTH)
}

pub fn pose() -> Type {
    Type::Pose(map())
}

pub fn list(t: Type, n: u32) -> Type {
    Type::List(Box::new(t), n)
}

pub fn at(n: usize) -> Span {
    Span::new(0, n, n + 1)
}

/// An operator on arguments.
pub fn op(op: Op, args: Vec<Expr>, ty: Type) -> Expr {
    Expr::new(op, args, ty, at(7))
}

pub fn constant(value: Value, ty: Type) -> Expr {
    Expr::constant(value, ty, at(1))
}

pub fn number(x: f64) -> Expr {
    constant(Value::Number(x), Type::NUMBER)
}

pub fn length(x: f64) -> Expr {
    constant(Value::Number(x), LENGTH)
}

pub fn angle(x: f64) -> Expr {
    constant(Value::Number(x), ANGLE)
}

pub fn int(i: i64) -> Expr {
    constant(Value::Int(i), Type::Int)
}

pub fn boolean(b: bool) -> Expr {
    constant(Value::Bool(b), Type::Bool)
}

pub fn heading(x: f64) -> Expr {
    constant(Value::Number(x), Type::Heading(map()))
}

pub fn local(i: u32, ty: Type) -> Expr {
    op(Op::Local(i), vec![], ty)
}

pub fn call(f: Function, args: Vec<Expr>, ty: Type) -> Expr {
    op(Op::Builtin(f), args, ty)
}

/// A binary operator with the type that goes with its operands.
pub fn binary(b: Binary, l: Expr, r: Expr) -> Expr {
    let ty = typing::binary(b, &l.ty, &r.ty).expect("operands go together");
    op(Op::Binary(b), vec![l, r], ty)
}

pub fn stmt(kind: StmtKind) -> Stmt {
    Stmt { kind, at: at(9) }
}

/// An effect, owned.
#[derive(Debug, Clone, PartialEq)]
pub enum Done {
    Command(u32, Vec<f64>),
    Publish(u32, Vec<f64>),
    Tell(String, String, String, Vec<f64>),
    Note(String, Option<(Type, Vec<f64>)>),
    Open(u32, String, Vec<f64>, Vec<f64>, Option<f64>),
    Reply(u32, String, Option<String>, Vec<f64>, f64),
    Use(u32, f64),
    Raise(u32),
    SetParam(u32, Vec<f64>),
    Rule(u32),
}

/// Surroundings with fixed answers that count what they are asked.
#[derive(Debug, Default)]
pub struct World {
    pub done: Vec<Done>,
    pub readings: Vec<Vec<f64>>,
    pub heard: Vec<Vec<f64>>,
    pub asked: usize,
    pub robots: u32,
    pub robot: Option<u32>,
    /// Truth of each robot: x of its pose.
    pub xs: Vec<f64>,
    pub bits: u64,
    /// Effects are refused from this one on.
    pub refuse_after: Option<usize>,
}

impl Env for World {
    fn now(&self) -> Result<f64, FaultKind> {
        Ok(12.5)
    }
    fn steps(&self) -> Result<f64, FaultKind> {
        Ok(3.0)
    }
    fn elapsed(&self) -> Result<f64, FaultKind> {
        Ok(0.5)
    }
    fn own(&self, which: Own, out: &mut [f64]) -> Result<(), FaultKind> {
        out.fill(match which {
            Own::Index => f64::from(self.robot.unwrap_or(9)),
            Own::Radius => 0.07,
            Own::Height => 0.06,
            Own::CruiseSpeed => 0.5,
            Own::Start => 1.0,
            Own::Target => 2.0,
        });
        Ok(())
    }
    fn reading(&mut self, port: u32, optional: bool, out: &mut [f64]) -> Result<(), FaultKind> {
        self.asked += 1;
        let registers = self.readings.get(port as usize).ok_or(FaultKind::Malformed)?;
        let from = usize::from(optional);
        if optional {
            out[0] = 0.0;
        }
        out[from..].copy_from_slice(registers);
        Ok(())
    }
    fn heard(&mut self, topic: u32, out: &mut [f64]) -> Result<(), FaultKind> {
        self.asked += 1;
        let registers = self.heard.get(topic as usize).ok_or(FaultKind::Malformed)?;
        out[..registers.len()].copy_from_slice(registers);
        Ok(())
    }
    fn truth(&self, robot: u32, which: Truth, out: &mut [f64]) -> Result<(), FaultKind> {
        out.fill(0.0);
        let x = self.xs[robot as usize];
        match which {
            Truth::Pose => (out[0], out[6]) = (x, 1.0),
            Truth::PathLength => out[0] = x,
            Truth::Collisions => out[0] = f64::from(robot),
            Truth::InCollision => out[0] = 1.0,
        }
        Ok(())
    }
    fn run(&self, _: Run) -> Result<f64, FaultKind> {
        Ok(1.0)
    }
    fn believed(&self, robot: u32, agent: u32, state: u32, out: &mut [f64]) -> Result<(), FaultKind> {
        out.fill(f64::from(100 * robot + 10 * agent + state));
        Ok(())
    }
    fn achieved(&self, goal: u32) -> Result<bool, FaultKind> {
        Ok(goal == 0)
    }
    fn robots(&self) -> Result<u32, FaultKind> {
        Ok(self.robots)
    }
    fn robot_of_group(&self, group: u32) -> Option<u32> {
        (group < self.robots).then_some(group)
    }
    fn robot(&self) -> Option<u32> {
        self.robot
    }
    fn set_robot(&mut self, robot: Option<u32>) {
        self.robot = robot;
    }
    fn inside(&self, point: [f64; 3], region: u32) -> Result<bool, FaultKind> {
        Ok(region == 2 && point[0] > 0.0)
    }
    fn draw(&mut self, from: Distribution) -> Result<f64, FaultKind> {
        let bits = &mut self.bits;
        Ok(sample(from, &mut || split_mix(bits)))
    }
    fn command(&mut self, port: u32, registers: &[f64]) -> Result<(), FaultKind> {
        self.note(Done::Command(port, registers.to_vec()))
    }

    fn publish(&mut self, topic: u32, registers: &[f64]) -> Result<(), FaultKind> {
        self.note(Done::Publish(topic, registers.to_vec()))
    }

    fn effect(&mut self, effect: Effect<'_>) -> Result<(), FaultKind> {
        self.note(match effect {
            Effect::Govern(what) => Done::Note(format!("{what:?}"), None),
            Effect::Tell { performative, to, content, registers } => {
                Done::Tell(performative.into(), to.into(), content.to_string(), registers.to_vec())
            }
            Effect::Note { text, value } => {
                Done::Note(text.into(), value.map(|(t, r)| (t.clone(), r.to_vec())))
            }
            Effect::Open { conversation, performative, registers, to, within } => {
                let content = registers.to_vec();
                Done::Open(conversation, performative.into(), content, to.to_vec(), within)
            }
            Effect::Reply { conversation, performative, reason, registers, thread } => {
                let reason = reason.map(str::to_string);
                Done::Reply(conversation, performative.into(), reason, registers.to_vec(), thread)
            }
            Effect::Use { device, seconds } => Done::Use(device, seconds),
            Effect::Raise(event) => Done::Raise(event),
            Effect::SetParam { param, registers } => Done::SetParam(param, registers.to_vec()),
            Effect::RuleFired { rule, .. } => Done::Rule(rule),
        })
    }
}

impl World {
    fn note(&mut self, done: Done) -> Result<(), FaultKind> {
        if self.refuse_after.is_some_and(|n| self.done.len() >= n) {
            return Err(FaultKind::Refused("no more".into()));
        }
        self.done.push(done);
        Ok(())
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): any generator will do here.
pub fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A record `Beacon { rank: Int, next: Point<map>, range: Length? }` and an enum `Mode { a, b, c }`.
pub fn types() -> TypeTable {
    let mut table = TypeTable::default();
    let fields =
        vec![("rank".into(), Type::Int), ("next".into(), point()), ("range".into(), LENGTH.optional())];
    table.records.insert("Beacon".into(), Record { name: "Beacon".into(), fields });
    let variants = vec!["a".into(), "b".into(), "c".into()];
    table.enums.insert("Mode".into(), Enum { name: "Mode".into(), variants });
    table
}

pub fn beacon() -> Type {
    Type::Record("Beacon".into())
}

pub fn mode(v: &str) -> Expr {
    constant(Value::Variant(v.into()), Type::Enum("Mode".into()))
}

fn component(role: &str, name: &str) -> Component {
    Component {
        role: role.into(),
        name: name.into(),
        model: "channel".into(),
        args: vec![],
        count: None,
        ty: None,
        at: at(0),
    }
}

fn port(name: &str, ty: Type, optional: bool) -> Port {
    Port { name: name.into(), ty, optional, span: at(0) }
}

/// A graph with one agent: states x: Number, trail: List<Point, 4>, mode: Mode, beacon: Beacon; argument rank: Int;
/// sensors range: Length, scan: List<Length, 8>, maybe: Length?; actuator base: Twist; topic 0: Beacon; parameters
/// gain: Number, near: Length?; two events; a goal; two robot groups.
pub fn graph() -> Graph {
    let state = |name: &str, ty: Type| State { name: name.into(), ty, initial: number(0.0), span: at(0) };
    let agent = Agent {
        restart: None,
        name: "walker".into(),
        collaborative: false,
        parameters: vec![("rank".into(), Type::Int)],
        offers: vec![],
        sensors: vec![
            port("range", LENGTH, false),
            port("scan", list(LENGTH, 8), false),
            port("maybe", LENGTH, true),
        ],
        actuators: vec![port("base", Type::Twist, false)],
        states: vec![
            state("x", Type::NUMBER),
            state("trail", list(point(), 4)),
            state("mode", Type::Enum("Mode".into())),
            state("beacon", beacon()),
        ],
        events: vec!["go".into(), "stop".into()],
        devices: vec![],
        units: vec![],
        arbiters: vec![],
        span: at(0),
    };
    let group = |name: &str| RobotGroup {
        unfit: vec![],
        name: name.into(),
        count: None,
        platform: 0,
        alternatives: vec![],
        host: false,
        start: number(0.0),
        scatter: None,
        target: None,
        agents: vec![],
        at: at(0),
    };
    Graph {
        plans: vec![],
        faults: vec![],
        schema: SCHEMA,
        edition: 1,
        name: "test".into(),
        title: String::new(),
        sources: vec![],
        types: types(),
        texts: Texts::default(),
        params: vec![
            Param { name: "gain".into(), ty: Type::NUMBER, default: Value::Number(2.0), at: at(0) },
            Param {
                name: "near".into(),
                ty: LENGTH.optional(),
                default: Value::None("not given".into()),
                at: at(0),
            },
        ],
        functions: vec![],
        world: vec![],
        platforms: vec![],
        topics: vec![Topic { ty: beacon(), channel: component("topic", "plan") }],
        conversations: vec![],
        agents: vec![agent],
        robots: vec![group("r1"), group("r2")],
        step: None,
        goals: vec![Goal { name: "arrive".into(), on_request: false, subgoals: vec![], at: at(0) }],
        done: boolean(true),
        within: None,
        expects: vec![],
        metrics: vec![],
    }
}

/// The memory of the agent of [`graph`], all zero but for the parameters and the rank 5.
pub struct Registers {
    pub states: Vec<f64>,
    pub arguments: Vec<f64>,
    pub params: Vec<f64>,
}

impl Registers {
    pub fn new(graph: &Graph) -> Self {
        let states = vec![0.0; Layout::states(&graph.types, &graph.agents[0]).len()];
        Registers { states, arguments: vec![5.0], params: vec![2.0, 4.0, 0.0] }
    }

    pub fn memory(&mut self) -> Memory<'_> {
        Memory { states: &mut self.states, arguments: &self.arguments, params: &self.params }
    }
}

/// A compiled block of the agent, ready to run.
pub struct Ready {
    pub graph: Graph,
    pub texts: Texts,
    pub program: Program,
    pub block: Block,
    pub scope: Scope,
}

impl Ready {
    pub fn new(
        graph: Graph,
        locals: &[Type],
        make: impl FnOnce(&mut Compiler<'_>, &mut Scope) -> Result<Block, soifra_graph::eval::CompileError>,
    ) -> Result<Ready, soifra_graph::eval::CompileError> {
        let mut texts = graph.texts.clone();
        let mut compiler = Compiler::for_graph(&graph, &mut texts);
        compiler.agent(Some(0))?;
        let mut scope = compiler.scope(locals)?;
        let block = make(&mut compiler, &mut scope)?;
        let program = compiler.finish();
        Ok(Ready { graph, texts, program, block, scope })
    }

    /// Runs and returns the registers of the result.
    pub fn run(&self, registers: &mut Registers, world: &mut World) -> Result<Vec<f64>, Fault> {
        let mut frame = vec![0.0; self.scope.frame().max(self.block.frame as usize)];
        self.program.run(&self.block, &mut frame, &mut registers.memory(), world)?;
        let from = self.block.result as usize;
        Ok(frame[from..from + self.block.width as usize].to_vec())
    }
}

/// The value of an expression of the agent of [`graph`], in register form.
pub fn registers_of(e: &Expr, locals: &[Type], world: &mut World) -> Result<Vec<f64>, Fault> {
    let ready = Ready::new(graph(), locals, |c, s| c.expr(s, e))?;
    let mut registers = Registers::new(&ready.graph);
    ready.run(&mut registers, world)
}

/// The value of an expression; also checks that a second run gives the same bits.
pub fn value_in(e: &Expr, locals: &[Type], world: &mut World) -> Result<Value, Fault> {
    let ready = Ready::new(graph(), locals, |c, s| c.expr(s, e))?;
    let mut registers = Registers::new(&ready.graph);
    let bits = world.bits;
    let first = ready.run(&mut registers, world)?;
    world.bits = bits;
    let second = ready.run(&mut registers, world)?;
    let bits = |r: &[f64]| r.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&first), bits(&second));
    Ok(Value::from_registers(&first, &e.ty, &ready.graph.types, &ready.texts))
}

/// The value of an expression that asks nothing.
pub fn value(e: &Expr) -> Value {
    value_in(e, &[], &mut World::default()).unwrap_or_else(|f| panic!("{e:?}: {f}"))
}

pub fn fault(e: &Expr) -> FaultKind {
    match value_in(e, &[], &mut World::default()) {
        Ok(v) => panic!("a fault was expected, not {v:?}"),
        Err(f) => f.kind,
    }
}

/// The value of an expression with `arguments` in its first locals, so that nothing is folded.
pub fn applied(make: impl FnOnce(&[Expr]) -> Expr, arguments: &[(Type, Value)]) -> Result<Value, Fault> {
    let locals: Vec<Type> = arguments.iter().map(|(t, _)| t.clone()).collect();
    let names: Vec<Expr> = locals.iter().enumerate().map(|(i, t)| local(i as u32, t.clone())).collect();
    let e = make(&names);
    let ready = Ready::new(graph(), &locals, |c, s| c.expr(s, &e))?;
    let mut texts = ready.texts.clone();
    let mut frame = vec![0.0; ready.block.frame as usize];
    for (i, (t, v)) in arguments.iter().enumerate() {
        let mut r = Vec::new();
        v.flatten(t, &ready.graph.types, &mut texts, &mut r).expect("a value of its type");
        let from = ready.scope.local(i as u32).expect("a local") as usize;
        frame[from..from + r.len()].copy_from_slice(&r);
    }
    let mut registers = Registers::new(&ready.graph);
    ready.program.run(&ready.block, &mut frame, &mut registers.memory(), &mut World::default())?;
    let from = ready.block.result as usize;
    let result = &frame[from..from + ready.block.width as usize];
    Ok(Value::from_registers(result, &e.ty, &ready.graph.types, &texts))
}
