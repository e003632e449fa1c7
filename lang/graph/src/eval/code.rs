//! Bytecode: instructions of 16 bytes and the tables they refer to.
//!
//! `d` is the first register of the result, `a` and `b` those of the operands, `k` an index of the
//! constant pool, `to` an instruction, `n` a number of registers. Truth values are 0 and 1.

use super::FaultKind;
use crate::Execution;
use crate::{Function, Govern, Name, Own, Run, Span, Truth, Type};

/// Where registers lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Space {
    /// The frame of the run.
    Frame,
    /// States of the agent.
    States,
    /// Arguments of the agent.
    Arguments,
    /// Mission parameters.
    Params,
    /// The constant pool.
    Constants,
}

/// An instruction.
#[rustfmt::skip] // One line an instruction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Instr {
    /// The block or function ends.
    End,
    /// An enum value is none of its variants.
    Fail,

    Jump { to: u32 },
    JumpIf { a: u32, to: u32 },
    JumpUnless { a: u32, to: u32 },
    JumpLt { a: u32, b: u32, to: u32 },
    JumpLe { a: u32, b: u32, to: u32 },
    JumpEq { a: u32, b: u32, to: u32 },
    JumpNe { a: u32, b: u32, to: u32 },
    JumpLtK { a: u32, k: u32, to: u32 },
    JumpLeK { a: u32, k: u32, to: u32 },
    JumpGtK { a: u32, k: u32, to: u32 },
    JumpGeK { a: u32, k: u32, to: u32 },
    JumpEqK { a: u32, k: u32, to: u32 },
    JumpNeK { a: u32, k: u32, to: u32 },

    Const { d: u32, k: u32 },
    Move { d: u32, a: u32 },
    Move3 { d: u32, a: u32 },
    LoadState { d: u32, at: u32 },
    StoreState { at: u32, a: u32, n: u32 },
    Load { space: Space, d: u32, at: u32 },
    Copy { space: Space, d: u32, at: u32, n: u32 },

    Add { d: u32, a: u32, b: u32 },
    Sub { d: u32, a: u32, b: u32 },
    Mul { d: u32, a: u32, b: u32 },
    Div { d: u32, a: u32, b: u32 },
    AddK { d: u32, a: u32, k: u32 },
    /// `k - a`
    SubFromK { d: u32, a: u32, k: u32 },
    MulK { d: u32, a: u32, k: u32 },
    /// `a / k`; `k` is not zero.
    DivK { d: u32, a: u32, k: u32 },
    AddInt { d: u32, a: u32, b: u32 },
    SubInt { d: u32, a: u32, b: u32 },
    MulInt { d: u32, a: u32, b: u32 },
    /// Sum of a heading and an angle.
    AddWrap { d: u32, a: u32, b: u32 },
    /// Difference of two headings, or of a heading and an angle.
    SubWrap { d: u32, a: u32, b: u32 },
    Neg { d: u32, a: u32 },
    Not { d: u32, a: u32 },
    Sqrt { d: u32, a: u32 },
    Abs { d: u32, a: u32 },
    Min { d: u32, a: u32, b: u32 },
    Max { d: u32, a: u32, b: u32 },
    MinK { d: u32, a: u32, k: u32 },
    MaxK { d: u32, a: u32, k: u32 },
    Power { d: u32, a: u32, n: i32 },
    PowerInt { d: u32, a: u32, n: i32 },

    Lt { d: u32, a: u32, b: u32 },
    Le { d: u32, a: u32, b: u32 },
    Eq { d: u32, a: u32, b: u32 },
    Ne { d: u32, a: u32, b: u32 },
    LtK { d: u32, a: u32, k: u32 },
    LeK { d: u32, a: u32, k: u32 },
    GtK { d: u32, a: u32, k: u32 },
    GeK { d: u32, a: u32, k: u32 },
    EqK { d: u32, a: u32, k: u32 },
    NeK { d: u32, a: u32, k: u32 },
    /// Whether `n` registers are equal.
    EqN { n: u8, d: u32, a: u32, b: u32 },

    Add3 { d: u32, a: u32, b: u32 },
    Sub3 { d: u32, a: u32, b: u32 },
    /// `b` is a scalar.
    Scale3 { d: u32, a: u32, b: u32 },
    /// `b` is a scalar.
    Div3 { d: u32, a: u32, b: u32 },
    AddN { n: u16, d: u32, a: u32, b: u32 },
    SubN { n: u16, d: u32, a: u32, b: u32 },
    NegN { n: u16, d: u32, a: u32 },
    /// `b` is a scalar.
    ScaleN { n: u16, d: u32, a: u32, b: u32 },
    /// `b` is a scalar.
    DivN { n: u16, d: u32, a: u32, b: u32 },
    Dot { d: u32, a: u32, b: u32 },
    Norm { d: u32, a: u32 },
    Distance { d: u32, a: u32, b: u32 },

    /// Turns a vector about z; the constant `k` and the one behind it are cosine and sine.
    TurnK { d: u32, a: u32, k: u32 },

    Yaw { d: u32, a: u32 },
    Roll { d: u32, a: u32 },
    Pitch { d: u32, a: u32 },
    /// Any other function of one argument.
    Function1 { f: Function, d: u32, a: u32 },
    /// Any other function of two arguments.
    Function2 { f: Function, d: u32, a: u32, b: u32 },
    /// Any other function; arguments one after the other from `a`.
    FunctionN { f: Function, d: u32, a: u32 },

    /// (r × n) · (n × c)
    MatrixProduct { r: u8, n: u8, c: u8, d: u32, a: u32, b: u32 },
    Transpose { r: u8, c: u8, d: u32, a: u32 },
    /// An optional of an n × n matrix.
    Inverse { n: u8, d: u32, a: u32 },

    /// Runs a function whose frame begins at `base`.
    Call { function: u32, base: u32 },

    Now { d: u32 },
    Steps { d: u32 },
    Elapsed { d: u32 },
    Own { which: Own, d: u32, n: u32 },
    Reading { optional: bool, d: u32, port: u32, n: u32 },
    Heard { d: u32, topic: u32, n: u32 },
    Truth { which: Truth, d: u32, n: u32 },
    RunFact { which: Run, d: u32 },
    /// `state` indexes [`Program::believed`].
    Believed { d: u32, state: u32 },
    /// `service` indexes [`Program::services`].
    Offering { d: u32, service: u32, n: u32 },
    /// `unit` indexes [`Program::executed`].
    Executed { d: u32, unit: u32 },
    Achieved { d: u32, goal: u32 },
    Inside { d: u32, a: u32, b: u32 },
    /// A service; arguments one after the other from `a`. `sizes` indexes [`Program::sizes`].
    Service { f: Function, d: u32, a: u32, sizes: u32 },
    Draw { d: u32, a: u32 },

    /// Puts robot 0 in question; keeps the former one, the index and the count in `q`, `q + 1`, `q + 2`.
    /// Jumps when there is no robot.
    RobotFirst { q: u32, to: u32 },
    /// Puts the next robot in question and jumps, or puts the former one back.
    RobotNext { q: u32, to: u32 },
    /// Puts the robot of a group in question and keeps the former one in `q`.
    RobotSet { q: u32, group: u32 },
    /// Puts the former robot back.
    RobotRestore { q: u32 },
    /// The number of robots the loop goes through.
    RobotCount { d: u32, q: u32 },

    /// Makes the first item current; jumps when there is none. `list` indexes [`Program::lists`].
    ListFirst { list: u32, to: u32 },
    /// Makes the next item current and jumps; falls through after the last.
    ListNext { list: u32, to: u32 },
    /// As `ListFirst`, for a list in the frame, of whose items the body reads three registers.
    ListFirst3 { list: u32, to: u32 },
    /// As `ListNext`, for a list in the frame, of whose items the body reads three registers to `item`.
    /// Items lie `stride` apart; `q` is the list's state.
    ListNext3 { stride: u16, q: u32, item: u32, to: u32 },
    /// Appends the current item to the list at `d`.
    Keep { list: u32, d: u32 },
    /// Appends the value at `a` to the list at `d`.
    Append { list: u32, d: u32, a: u32 },
    /// Appends the three registers at `a` to the list at `d`, which has room for `most`.
    Append3 { most: u16, d: u32, a: u32 },
    /// The current item as an optional.
    Found { list: u32, d: u32 },
    /// The current item as an optional, when its key is the least so far.
    Least { list: u32, d: u32, a: u32 },
    /// The current item as an optional, when its key is the greatest so far.
    Greatest { list: u32, d: u32, a: u32 },
    ListLength { list: u32, d: u32 },
    /// The item at the index in `a`, as an optional.
    ListAt { list: u32, d: u32, a: u32 },
    ListLast { list: u32, d: u32 },
    /// The list with the value at `a` at its end.
    ListPush { list: u32, d: u32, a: u32 },
    ListSum { list: u32, d: u32 },
    ListSmallest { list: u32, d: u32 },
    ListLargest { list: u32, d: u32 },

    /// Zeroes what a value does not use. `shape` indexes [`Program::shapes`].
    Tidy { a: u32, shape: u32 },
    /// An effect on the value at `a`. `effect` indexes [`Program::effects`].
    Command { port: u32, a: u32, n: u32 },
    Publish { topic: u32, a: u32, n: u32 },
    Do { effect: u32, a: u32 },
}

/// A list operand, with what a loop over it needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ListRef {
    /// Where the list is.
    pub space: Space,
    /// Its count; items follow.
    pub at: u32,
    /// Most items.
    pub capacity: u32,
    /// Registers of an item.
    pub width: u32,
    /// Two registers for where what the body reads lies, of the current item and behind the last, as bits;
    /// a third for the best key so far.
    pub state: u32,
    /// Where the body wants the item.
    pub item: u32,
    /// The part of the item the body reads: first register and length.
    pub part: (u32, u32),
    /// Registers of an item of the list that is made.
    pub out_width: u32,
    /// Most items of the list that is made.
    pub out_capacity: u32,
}

/// How an effect is done.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum EffectCode {
    Tell {
        performative: Name,
        to: Name,
        content: Name,
        n: u32,
    },
    Use(u32),
    /// Registers: content, then the agents, then the time to wait.
    Open {
        conversation: u32,
        performative: Name,
        n: u32,
        to: Recipients,
        within: bool,
    },
    /// Registers: content, then the conversation.
    Reply {
        conversation: u32,
        performative: Name,
        reason: Option<String>,
        n: u32,
    },
    Note {
        text: String,
        value: Option<(Type, u32)>,
    },
    Raise(u32),
    Govern(Govern),
    SetParam {
        param: u32,
        n: u32,
    },
    Rule {
        rule: u32,
        at: Span,
    },
}

/// Whom a conversation is opened with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Recipients {
    One,
    /// A list of this capacity.
    List(u32),
}

/// Where a type has registers that a value may leave unused.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// So many registers, all used.
    Flat(usize),
    /// A list: capacity, width and shape of an item.
    List(usize, usize, Box<Shape>),
    /// An optional: width and shape of the value.
    Option(usize, Box<Shape>),
    /// Parts one after the other, with their widths.
    Parts(Vec<(usize, Shape)>),
}

/// A compiled function.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FunctionCode {
    /// First instruction.
    pub start: u32,
    /// Whether it is written out where it is called.
    pub short: bool,
    /// First register of the value, within the function's frame.
    pub result: u32,
    /// Registers of its frame, with those of the functions it calls.
    pub frame: u32,
    /// Most instructions.
    pub bound: u64,
    /// How deep it calls.
    pub depth: u32,
}

/// Compiled blocks and functions; immutable, shared freely between threads.
#[derive(Debug, Clone, Default)]
pub struct Program {
    pub(super) code: Vec<Instr>,
    /// Where each instruction was written.
    pub(super) spans: Vec<Span>,
    pub(super) constants: Vec<f64>,
    pub(super) lists: Vec<ListRef>,
    pub(super) effects: Vec<EffectCode>,
    pub(super) shapes: Vec<Shape>,
    pub(super) functions: Vec<FunctionCode>,
    /// Agent, state, width.
    pub(super) believed: Vec<(u32, u32, u32)>,
    /// Agent, unit, what is asked.
    pub(super) executed: Vec<(u32, u32, Execution)>,
    /// Registers of the arguments and of the value of a service.
    pub(super) sizes: Vec<(u32, u32)>,
    /// Names that the directory is asked for.
    pub(super) services: Vec<Name>,
}

impl Shape {
    /// Zeroes the items a list does not have and the value an optional does not have, so that equal
    /// values have equal registers.
    pub fn tidy(&self, r: &mut [f64]) -> Result<(), FaultKind> {
        match self {
            Shape::Flat(_) => {}
            Shape::List(capacity, width, item) => {
                let (count, items) = r.split_first_mut().ok_or(FaultKind::Malformed)?;
                let n = (*count as usize).min(*capacity);
                *count = n as f64;
                let used = items.len().min(n * width);
                let (items, rest) = items.split_at_mut(used);
                rest.fill(0.0);
                if !matches!(**item, Shape::Flat(_)) && *width > 0 {
                    for i in items.chunks_exact_mut(*width) {
                        item.tidy(i)?;
                    }
                }
            }
            Shape::Option(_, value) => {
                let (tag, v) = r.split_first_mut().ok_or(FaultKind::Malformed)?;
                if *tag == 0.0 {
                    value.tidy(v)?;
                } else {
                    v.fill(0.0);
                }
            }
            Shape::Parts(parts) => {
                let mut from = 0;
                for (width, part) in parts {
                    part.tidy(r.get_mut(from..from + width).ok_or(FaultKind::Malformed)?)?;
                    from += width;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn instructions_stay_small() {
        assert!(size_of::<super::Instr>() <= 16);
    }
}
