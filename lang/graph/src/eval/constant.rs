//! Values of expressions that depend on nothing but given parameters and locals.

use super::{Compiler, Fault, FaultKind, Layout, Memory, NoEnv};
use crate::{Expr, Function, Op, Texts, Type, TypeTable, UserFunction, Value};

/// Parameters and their values, laid out once for the many expressions that may name them.
#[derive(Debug, Clone, Default)]
pub struct Parameters {
    layout: Layout,
    registers: Vec<f64>,
}

impl Parameters {
    /// Parameters in order: type and value; `None` when a value is not of its type. Texts that are new are
    /// added to `texts`.
    pub fn new<'t>(
        types: &TypeTable,
        texts: &mut Texts,
        params: impl IntoIterator<Item = (&'t Type, &'t Value)> + Clone,
    ) -> Option<Self> {
        let mut registers = Vec::new();
        for (t, value) in params.clone() {
            value.flatten(t, types, texts, &mut registers)?;
        }
        Some(Parameters { layout: Layout::new(types, params.into_iter().map(|(t, _)| t)), registers })
    }
}

/// What a constant expression may depend on.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Records and enums.
    pub types: &'a TypeTable,
    /// Functions.
    pub functions: &'a [UserFunction],
    /// Parameters.
    pub params: &'a Parameters,
    /// Locals in order: type, and value where there is one; the others may be bound inside.
    pub locals: &'a [(Type, Option<Value>)],
}

/// The value of an expression. To evaluate one expression many times, compile it.
///
/// # Errors
/// A fault of the evaluation; what is not constant (readings, states, draws …) is
/// [`FaultKind::Unavailable`], a malformed expression or a given local that is not of its type
/// [`FaultKind::Refused`].
pub fn constant(e: &Expr, known: &Known<'_>, texts: &mut Texts) -> Result<Value, Fault> {
    if let Op::Const(value) = &e.op {
        return Ok(value.clone());
    }
    let mut variable = None;
    e.walk(&mut |e| {
        if variable.is_none() {
            variable = not_constant(&e.op, known).map(|what| (what, e.span));
        }
    });
    if let Some((what, at)) = variable {
        return Err(Fault { kind: FaultKind::Unavailable(what), at });
    }
    let refused = |text: &str| Fault { kind: FaultKind::Refused(text.into()), at: e.span };

    let locals: Vec<Type> = known.locals.iter().map(|(t, _)| t.clone()).collect();
    let mut given = Vec::new();
    for (i, (t, value)) in known.locals.iter().enumerate() {
        if let Some(value) = value {
            let mut registers = Vec::new();
            let known = value.flatten(t, known.types, texts, &mut registers);
            known.ok_or_else(|| refused("a local has a value that is not of its type"))?;
            given.push((i as u32, registers));
        }
    }

    let mut compiler = Compiler::new(known.types, texts, known.functions);
    compiler.params(&known.params.layout);
    let mut scope = compiler.scope(&locals)?;
    let block = compiler.expr(&mut scope, e)?;
    let program = compiler.finish();

    let mut frame = vec![0.0; block.frame as usize];
    for (local, registers) in given {
        let from = scope.local(local).unwrap_or_default() as usize;
        if let Some(to) = frame.get_mut(from..from + registers.len()) {
            to.copy_from_slice(&registers);
        }
    }
    let mut memory = Memory { states: &mut [], arguments: &[], params: &known.params.registers };
    program.run(&block, &mut frame, &mut memory, &mut NoEnv)?;
    let from = block.result as usize;
    let registers = frame.get(from..from + block.width as usize).unwrap_or_default();
    Ok(Value::from_registers(registers, &e.ty, known.types, texts))
}

/// Why an operator has no value known beforehand.
fn not_constant(op: &Op, known: &Known<'_>) -> Option<&'static str> {
    match op {
        Op::Offering(_) => Some("the directory"),
        Op::Executed(..) => Some("the executions of a unit"),
        Op::State(_) | Op::Believed(..) => Some("the state of an agent"),
        Op::Argument(_) => Some("an argument of an agent"),
        Op::Param(i) if *i as usize >= known.params.layout.slots() => Some("a parameter"),
        Op::Reading(_) => Some("a sensor"),
        Op::Heard(_) => Some("a topic"),
        Op::Now => Some("the time"),
        Op::StepCount => Some("the step clock"),
        Op::Elapsed => Some("the time in a state"),
        Op::Own(_) | Op::Quantified(_) | Op::OfRobot(_) => Some("a robot"),
        Op::Truth(_) | Op::Run(_) => Some("world truth"),
        Op::Achieved(_) => Some("the status of a goal"),
        Op::Builtin(Function::Draw) => Some("randomness"),
        Op::Builtin(Function::Inside) => Some("the world"),
        Op::Builtin(f) if f.is_service() => Some("a service"),
        _ => None,
    }
}
